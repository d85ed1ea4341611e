#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/median.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/inspect/clip_report.h"
#include "ingest/inspect/keypoint_layout_estimate.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {
namespace {

/// Frames per second by the files' clock. Files may be missing: the usual step, their median, tells how many moments
/// lie between two of them. 0: unknown.
double RateByClock(const std::vector<PanopticBodies>& scenes) {
  std::vector<double> steps_ms;
  double last_ms = 0.0;
  for (const PanopticBodies& scene : scenes) {
    if (scene.time_ms <= 0.0) continue;
    if (last_ms > 0.0 && scene.time_ms > last_ms) steps_ms.push_back(scene.time_ms - last_ms);
    last_ms = scene.time_ms;
  }
  if (steps_ms.empty()) return 0.0;
  const double usual_ms = Median(steps_ms);
  double moments = 0.0, span_ms = 0.0;
  for (const double step : steps_ms) {
    moments += std::round(step / usual_ms);
    span_ms += step;
  }
  return 1000.0 * moments / span_ms;
}

/// The usual number of points of people who have any; 0: none has.
std::size_t UsualPoints(const std::vector<OpenPoseFrame>& frames) {
  std::map<std::size_t, std::size_t> people;
  for (const OpenPoseFrame& frame : frames) {
    for (const OpenPosePerson& person : frame.people) {
      if (!person.pose.empty()) people[person.pose.size()] += 1;
    }
  }
  const auto usual =
      std::max_element(people.begin(), people.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return usual == people.end() ? 0 : usual->first;
}

}  // namespace

RawClip ReadRawKeypoints(const std::vector<OpenPoseFrame>& frames, const std::vector<OpenPosePerson>& everybody) {
  RawClip clip;
  clip.format = "openpose";
  clip.frames = static_cast<int>(frames.size());
  std::size_t most = 0, fewest = frames.empty() ? 0 : frames[0].people.size();
  const std::size_t joints = UsualPoints(frames);
  std::size_t points = 0, missing = 0, without = 0, odd = 0;
  for (const OpenPoseFrame& frame : frames) {
    most = std::max(most, frame.people.size());
    fewest = std::min(fewest, frame.people.size());
    for (const OpenPosePerson& person : frame.people) {
      without += person.pose.empty() ? 1 : 0;
      odd += !person.pose.empty() && person.pose.size() != joints ? 1 : 0;
      for (const DetectedKeypoint& point : person.pose) {
        ++points;
        missing += point.detected() ? 0 : 1;
      }
    }
  }
  clip.joints = static_cast<int>(joints);
  clip.people = static_cast<int>(most);
  clip.fewest_people = static_cast<int>(fewest);
  clip.people_evidence = "entries of the files, one a frame; bystanders count as well";
  clip.layout_evidence = "one file a frame";
  clip.units = "px";
  clip.silence = "keypoints of one image: no depth";
  clip.rate_evidence = "the files do not declare it";
  if (points > 0) clip.missing_share = static_cast<double>(missing) / static_cast<double>(points);
  clip.skeleton = MeasuredText(EstimateKeypointLayout(everybody));
  std::vector<OpenPosePerson> here;
  for (const OpenPoseFrame& frame : frames) here.insert(here.end(), frame.people.begin(), frame.people.end());
  for (const Finding& doubt : CheckKeypointNumbers(here)) clip.remarks.push_back(doubt);
  if (odd > 0) {
    clip.remarks.push_back(MakeFinding("keypoint_count", Severity::kWarning, static_cast<double>(odd),
                                       std::to_string(odd) + (odd == 1 ? " person has" : " people have") +
                                           " another number of keypoints than " + std::to_string(joints) +
                                           ": a run takes them as not seen"));
  }
  if (without > 0) {
    clip.remarks.push_back(MakeFinding("empty_person", Severity::kInfo, static_cast<double>(without),
                                       std::to_string(without) + " entries of people hold no keypoints"));
  }
  return clip;
}

std::vector<RawClip> ReadRawPanoptic(const std::vector<PanopticBodies>& scenes) {
  std::vector<int> ids;
  std::size_t most = 0, fewest = scenes.empty() ? 0 : scenes[0].bodies.size(), joints = 0;
  for (const PanopticBodies& scene : scenes) {
    most = std::max(most, scene.bodies.size());
    fewest = std::min(fewest, scene.bodies.size());
    for (const PanopticBody& body : scene.bodies) {
      joints = std::max(joints, body.position_cm.size());
      if (std::find(ids.begin(), ids.end(), body.id) == ids.end()) ids.push_back(body.id);
    }
  }
  std::vector<RawClip> clips;
  for (const int id : ids) {
    RawClip clip;
    clip.id = ids.size() > 1 ? "[" + std::to_string(clips.size()) + "]" : "";
    clip.format = "panoptic_bodies";
    clip.frames = static_cast<int>(scenes.size());
    clip.joints = static_cast<int>(joints);
    clip.people = static_cast<int>(most);
    clip.fewest_people = static_cast<int>(fewest);
    clip.people_evidence = "bodies of the files, one a frame";
    clip.layout_evidence = "one file a frame";
    clip.facts.emplace_back("body", std::to_string(id));
    clip.positions = JointPositions(clip.frames, clip.joints);
    clip.confidence.assign(static_cast<std::size_t>(clip.frames) * joints, 0.0);
    for (std::size_t f = 0; f < scenes.size(); ++f) {
      for (const PanopticBody& body : scenes[f].bodies) {
        for (std::size_t j = 0; body.id == id && j < body.position_cm.size(); ++j) {
          if (body.confidence[j] < 0.0) continue;
          clip.positions.at(static_cast<int>(f), static_cast<int>(j)) = body.position_cm[j];
          clip.confidence[f * joints + j] = std::max(1e-6, body.confidence[j]);
        }
      }
    }
    if (const double rate_hz = RateByClock(scenes); rate_hz > 0.0) {
      clip.rate_hz = std::round(100.0 * rate_hz) / 100.0;
      clip.rate_evidence = "univTime of the files, " + scenes.front().fps_type;
    }
    clip.units = "cm";
    clip.names.assign(PanopticJointNames().begin(), PanopticJointNames().begin() + static_cast<std::ptrdiff_t>(joints));
    clip.skeleton = AsDeclared(joints == 19 ? "coco19" : "coco15", "joints19 or joints15 of the file");
    clip.points = FindHandednessPoints([&](std::string_view name) -> std::optional<int> {
      const std::string wanted = name == "head" ? "nose" : std::string(name);
      const auto at = std::find(clip.names.begin(), clip.names.end(), wanted);
      if (at == clip.names.end()) return std::nullopt;
      return static_cast<int>(at - clip.names.begin());
    });
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace mocurate
