#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/openpose.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/keypoint_layout_estimate.h"
#include "ingest/sources/depth_images.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {
namespace {

constexpr std::ptrdiff_t kMostPeople = 100;    // of an image
constexpr std::size_t kMostEstimated = 10000;  // people used to measure the layout, evenly over views and frames

using Poses = ImagePoses;  ///< of the people of an image who have a point

/// The files of one camera.
struct ViewFrames {
  const Camera* camera = nullptr;
  std::vector<Poses> frames;  ///< (F)
};

/// Points that count as not observed.
struct PointsNotSeen {
  PointsOfFiles unsure, not_finite;
};

bool SeenKeypoints(const OpenPosePerson& person) {
  return std::any_of(person.pose.begin(), person.pose.end(), [](const DetectedKeypoint& p) { return p.detected(); });
}

/// Reads a camera's files. A file with more people than kMostPeople counts as unreadable, because a view stores the
/// same number of people for every image.
ViewFrames ReadView(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, PointsNotSeen& unseen,
                    IngestedClip& ingested) {
  ViewFrames view;
  view.frames.resize(static_cast<std::size_t>(span.frames));
  const auto take = [&](int f, const std::string& bytes, const std::string& name) -> Status {
    Expected<OpenPoseFrame> frame = ParseOpenPose(bytes, name);
    if (!frame) return Forward(frame);
    unseen.unsure.Add(frame->uncertain_points, name);
    unseen.not_finite.Add(frame->not_finite, name);
    const auto seen = std::count_if(frame->people.begin(), frame->people.end(), SeenKeypoints);
    if (seen > kMostPeople) {
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(seen) + " people are listed, at most " + std::to_string(kMostPeople) + " are allowed",
                  name, "check that it is the file of one image");
    }
    for (OpenPosePerson& person : frame->people) {
      if (SeenKeypoints(person)) view.frames[static_cast<std::size_t>(f)].push_back(std::move(person.pose));
    }
    return {};
  };
  ReadFrameFiles(camera, files, span, take, ingested);
  std::vector<std::string> names(view.frames.size());
  for (const auto& [number, image] : files) names[static_cast<std::size_t>(number - span.first)] = image->name;
  if (auto far = ExcludeFarKeypoints(names, view.frames)) ingested.findings.push_back(*std::move(far));
  if (auto odd = ExcludeImplausibleConfidences(names, view.frames)) ingested.findings.push_back(*std::move(odd));
  return view;
}

const KeypointLayout* LayoutNamed(const std::string& name) {
  for (const KeypointLayout& layout : KeypointLayouts()) {
    if (layout.name == name) return &layout;
  }
  return nullptr;
}

/// The coordinates of each camera alone: one of several may have been written in another unit.
void AddNumberFindings(const SourceFile& file, const ViewFrames& view, IngestedClip& ingested) {
  std::vector<OpenPosePerson> people;
  for (const Poses& poses : view.frames) {
    for (const auto& pose : poses) people.emplace_back().pose = pose;
  }
  for (Finding& finding : CheckKeypointNumbers(people)) {
    finding.message = "camera " + view.camera->name + ": " + finding.message;
    finding.action = ContradictionAction(file.source);
    ingested.findings.push_back(std::move(finding));
  }
}

/// The declared layout, checked against the bones, or the measured one.
Expected<const KeypointLayout*> LayoutOf(const SourceFile& file, const std::vector<ViewFrames>& views,
                                         IngestedClip& ingested) {
  std::map<std::size_t, std::size_t> counts;  // points -> people
  for (const ViewFrames& view : views) {
    for (const Poses& poses : view.frames) {
      for (const auto& pose : poses) ++counts[pose.size()];
    }
  }
  if (counts.empty()) {
    return Fail(ErrorCode::kInconsistent, "no person is found in any of " + Counted(views.size(), "view"), file.name,
                "check that these are files of keypoints");
  }
  const auto usual =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::size_t step = 1 + (usual->second - 1) / kMostEstimated;
  std::vector<OpenPosePerson> people;
  std::size_t at = 0;
  for (const ViewFrames& view : views) {
    for (const Poses& poses : view.frames) {
      for (const auto& pose : poses) {
        if (pose.size() != usual->first || at++ % step != 0) continue;
        people.emplace_back();
        people.back().pose = pose;
      }
    }
  }
  for (const ViewFrames& view : views) AddNumberFindings(file, view, ingested);
  const Measured measured = EstimateKeypointLayout(people);
  const bool declared = file.source.keypoints != "measured";
  if (!declared && measured.value.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "the order of the " + std::to_string(usual->first) + " keypoints is ambiguous: " + measured.evidence,
                file.name, "set ingest.source.keypoints to the layout's name");
  }
  const KeypointLayout* layout = LayoutNamed(declared ? file.source.keypoints : measured.value);
  if (layout->points.size() != usual->first) {
    return Fail(ErrorCode::kInconsistent,
                "people have " + std::to_string(usual->first) + " keypoints, the layout " + layout->name + " has " +
                    std::to_string(layout->points.size()),
                file.name, "correct ingest.source.keypoints");
  }
  if (!measured.value.empty()) ingested.shown["keypoints_contradiction"] = {measured.value != layout->name, 1.0};
  if (declared && !measured.value.empty() && measured.value != layout->name) {
    ingested.findings.push_back(Contradiction(file.source, "keypoints_contradiction", measured.confidence,
                                              "the source declares keypoints " + layout->name +
                                                  ", the bones are those of " + measured.value + ": " +
                                                  measured.evidence + "; correct ingest.source.keypoints"));
  }
  ingested.clip.provenance["keypoints"] =
      layout->name + (declared ? " (declared)" : " (measured: " + measured.evidence + ")");
  return layout;
}

KeypointView MakeKeypointView(const ViewFrames& frames, std::size_t points, FrameRate rate, std::size_t& odd) {
  KeypointView view;
  view.camera = *frames.camera;
  std::size_t most = 0;
  for (const Poses& poses : frames.frames) most = std::max(most, poses.size());
  view.people = static_cast<int>(most);
  view.values.assign(frames.frames.size() * most * points * 3, 0.0);
  for (std::size_t f = 0; f < frames.frames.size(); ++f) {
    view.time_s.push_back(rate.FrameTime(static_cast<std::int64_t>(f)));
    double* value = view.values.data() + f * most * points * 3;
    for (const auto& pose : frames.frames[f]) {
      if (pose.size() != points) {
        ++odd;
        continue;
      }
      for (const DetectedKeypoint& point : pose) {
        if (point.detected()) {
          value[0] = point.u_px, value[1] = point.v_px;
          value[2] = std::min(point.confidence, 1.0);  // peaks of heat maps reach a little beyond
        }
        value += 3;
      }
    }
  }
  return view;
}

/// Where fewer people than declared are found. A person visible in one view only has no depth, so that the second best
/// view counts.
void NoteMissingPeople(const SourceFile& file, const Evidence& evidence, std::vector<Finding>& findings) {
  std::vector<int> people;
  for (const KeypointView& view : evidence.keypoint_views) people.push_back(view.people);
  std::sort(people.rbegin(), people.rend());
  const int seen = people.size() > 1 ? people[1] : people[0];
  if (file.named.bodies <= seen) return;
  findings.push_back(CameraFinding("people_missing", seen,
                                   std::to_string(file.named.bodies) +
                                       " people are declared, two views never observe more "
                                       "than " +
                                       std::to_string(seen) + " at once",
                                   FindingAction::kFlagged));
}

/// JSON files of a detector, one per camera and frame, and the calibration of the cameras -> keypoint views in the
/// canonical world with every person found. A frame whose file is missing or unreadable has no person: findings
/// "frames_missing", "unreadable_frames" per camera. "camera_not_calibrated", "camera_without_files": names of files
/// and calibration do not match. The order of the points is declared or measured; "keypoints_contradiction" where the
/// bones contradict the declaration.
Expected<IngestedClip> ReadOpenPoseClip(const SourceFile& file) {
  IngestedClip ingested;
  Expected<Rig> rig = ReadRig(file);
  if (!rig) return Forward(rig);
  ingested.findings = rig->findings;
  ingested.content = rig->content;
  auto cameras = SortByCamera(file.source.files, "ingest.source.files", file.frame_files);
  if (!cameras) return Forward(cameras);
  auto depth = HasDepthBeside(file.source)
                   ? SortByCamera(file.source.depth_files, "ingest.source.depth_files", file.depth_files)
                   : Expected<std::map<std::string, FilesOfCamera>>();
  if (!depth) return Forward(depth);
  const auto partners = PartnersOf(file, *rig, *cameras, ingested.findings, *depth);
  if (!partners) return Forward(partners);
  KeepPartners(*partners, *cameras);
  const Expected<FrameSpan> span = MatchViews(file, *cameras, &*depth);
  if (!span) return Forward(span);
  std::vector<ViewFrames> views;
  PointsNotSeen unseen;
  for (const auto& [name, camera] : *partners) {
    views.push_back(ReadView(name, cameras->at(name), *span, unseen, ingested));
    views.back().camera = camera;
  }
  if (unseen.unsure.points > 0) {
    ingested.findings.push_back(CameraFinding("uncertain_points", static_cast<double>(unseen.unsure.points),
                                              UnsurePointsWords(unseen.unsure), FindingAction::kMissing));
  }
  if (unseen.not_finite.points > 0) {
    ingested.findings.push_back(CameraFinding("keypoints_not_finite", static_cast<double>(unseen.not_finite.points),
                                              NotFiniteWords(unseen.not_finite), FindingAction::kMissing));
  }
  const auto layout = LayoutOf(file, views, ingested);
  if (!layout) return Forward(layout);
  Clip& clip = ingested.clip;
  clip.rate = FrameRate::FromHz(*file.source.rate_hz);
  clip.evidence.keypoint_names = (*layout)->points;
  clip.evidence.subject = file.named.body - 1;
  std::size_t odd = 0;
  for (const ViewFrames& view : views) {
    clip.evidence.keypoint_views.push_back(MakeKeypointView(view, (*layout)->points.size(), clip.rate, odd));
  }
  if (odd > 0) {
    ingested.findings.push_back(
        CameraFinding("keypoint_count", static_cast<double>(odd),
                      std::to_string(odd) + " people have another number of keypoints than " + (*layout)->name,
                      FindingAction::kMissing));
  }
  NoteMissingPeople(file, clip.evidence, ingested.findings);
  if (Status added = AddDepthBeside(file, *rig, *depth, *cameras, *span, ingested); !added) return Forward(added);
  clip.provenance["calibration"] = rig->meaning;
  if (Status checked = CheckKeypoints(clip.evidence); !checked) return Forward(checked);
  return ingested;
}

}  // namespace

FormatDriver OpenPoseFormat() {
  FormatDriver d;
  d.name = "openpose";
  d.gives = EvidenceKind::kKeypoints;
  d.unit = UnitOf::kCalibration;
  d.grouped_by = {"camera", "frame"};
  d.check = CheckGrouped;
  d.options = {"calibration", "camera_pose", "cameras",     "first_frame",
               "keypoints",   "subjects",    "depth_files", "depth_unit"};
  d.to_clip = ReadOpenPoseClip;
  return d;
}

}  // namespace mocurate
