#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/base/text.h"
#include "core/formats/openpose.h"
#include "core/geometry/camera.h"
#include "core/pipeline/stage.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/sources/frame_files.h"
#include "ingest/sources/rig_calibration.h"

namespace mocurate {
namespace {

constexpr const char* kMissing = "depth_images_missing";

/// Adds depth views to a clip of keypoints, one image per frame of the span. A frame without an image of a camera has
/// an empty name and counts in a finding "depth_images_missing", as does a clip without any image. Errors of
/// PartnersOf, SetImageSize and AddDepthImage.
Status AddDepthBeside(const SourceFile& file, const Rig& rig, const std::map<std::string, FilesOfCamera>& depth,
                      const std::map<std::string, FilesOfCamera>& keypoints, const FrameSpan& span,
                      IngestedClip& ingested) {
  if (!HasDepthBeside(file.source)) return {};
  if (depth.empty()) {
    ingested.findings.push_back(CameraFinding(
        kMissing, span.frames, "the clip has no depth images; only its keypoints are used", FindingAction::kKept));
    return {};
  }
  std::vector<Finding> findings;
  const auto partners = PartnersOf(file, rig, depth, findings, keypoints);
  if (!partners) return Forward(partners);
  for (Finding& finding : findings) {  // cameras without any files are reported already
    if (finding.code == "camera_not_calibrated") ingested.findings.push_back(std::move(finding));
  }
  for (const auto& [name, camera] : *partners) {
    const FilesOfCamera& images = depth.at(name);
    DepthView view;
    view.camera = *camera;
    view.camera.name = name;
    view.metres_per_unit = file.source.depth_unit;
    if (Status sized = SetImageSize(*images.begin()->second, view.camera); !sized) return sized;
    int missing = 0;
    for (int f = 0; f < span.frames; ++f) {
      const double time_s = ingested.clip.rate.FrameTime(f);
      const auto image = images.find(span.first + f);
      if (image != images.end()) {
        if (Status added = AddDepthImage(*image->second, time_s, view); !added) return added;
        continue;
      }
      ++missing;
      view.files.emplace_back();
      view.sha256.emplace_back();
      view.time_s.push_back(time_s);
    }
    if (missing > 0) {
      ingested.findings.push_back(MakeFinding(kMissing, Severity::kInfo, missing,
                                              "camera '" + name + "' has no depth image of " + std::to_string(missing) +
                                                  " of " + std::to_string(span.frames) + " frames",
                                              FindingAction::kMissing));
    }
    ingested.clip.evidence.depth_views.push_back(std::move(view));
  }
  return {};
}

constexpr std::ptrdiff_t kMostPeople = 100;    // of an image
constexpr std::size_t kMostEstimated = 10000;  // people used to measure the layout, evenly over views and frames

/// The files of one camera.
struct ViewFrames {
  const Camera* camera = nullptr;
  std::vector<ImagePoses> frames;  ///< (F) of the people who have a point
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
    unseen.Add(*frame, name);
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
  for (const ImagePoses& poses : view.frames) {
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
    for (const ImagePoses& poses : view.frames) {
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
    for (const ImagePoses& poses : view.frames) {
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
  for (const ImagePoses& poses : frames.frames) most = std::max(most, poses.size());
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
  for (Finding& finding : unseen.Findings()) ingested.findings.push_back(std::move(finding));
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

void ProposeOpenPose(const Proposal& proposal, DeclarationWriter& writer) {
  const std::optional<FramePattern> frames = WriteFrames(FirstFiles(proposal, ".json"), true, writer);
  const std::string depth = frames ? EstimateDepthBeside(proposal, frames->recording) : std::string();
  if (!depth.empty()) {
    writer.Value("depth_files", YamlQuoted(depth), "what their names have in common: depth cameras beside the others");
    writer.Value("depth_unit", "1 mm", "a choice: images do not declare it; most sensors write millimetres");
  }
  WritePersonAndLabel(true, writer);
  const int most = proposal.source.Ask(&InspectedClip::people).value.value_or(1);
  writer.Value("subjects", "1",
               "a choice: in most files up to " + std::to_string(most) + " people are seen, bystanders among them");
  WriteCalibration(proposal, writer);
  const Vote<std::string> layout = proposal.source.Ask(&InspectedClip::skeleton);
  writer.Value("keypoints", layout.value.value_or("measured"), layout.comment);
  WriteRate(proposal, writer);
}

}  // namespace

FormatDriver OpenPoseFormat() {
  FormatDriver d;
  d.name = "openpose";
  d.kinds = {FileKind::kOpenPose};
  d.gives = EvidenceKind::kKeypoints;
  d.unit = UnitOf::kCalibration;
  d.grouped_by = {"camera", "frame"};
  d.check = CheckGrouped;
  d.options = {"calibration", "camera_pose", "cameras",     "first_frame",
               "keypoints",   "subjects",    "depth_files", "depth_unit"};
  d.propose = ProposeOpenPose;
  d.to_clip = ReadOpenPoseClip;
  return d;
}

}  // namespace mocurate
