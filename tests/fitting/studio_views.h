#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {

/// A take of the studio before RGB cameras, all 24 joints detected.
struct StudioView {
  std::string name;
  Motion truth;
  Evidence evidence;
  RigFaults faults;
};

/// Four pixels of noise, 10 % missed, 3 % misplaced.
inline StudioOptions FourViews(std::int64_t seed) {
  StudioOptions options;
  options.seed = seed;
  options.subjects = 2;
  options.rig.kind = RigKind::kRing;
  options.keypoints.noise = 4.0;
  options.keypoints.miss_share = 0.10;
  options.keypoints.wrong_share = 0.03;
  options.keypoints.wrong_px = 120.0;
  return options;
}

/// Every action of the studio in its first variant.
inline const std::vector<SetClass>& OneVariantPerAction() {
  static const std::vector<SetClass> classes = [] {
    std::vector<SetClass> chosen;
    for (const std::string& action : KnownActions()) {
      for (const HumanAct12Variant& variant : HumanAct12Variants()) {
        if (action != variant.action) continue;
        chosen.push_back({static_cast<int>(chosen.size()) + 1, variant.action, variant.action, variant.seated});
        break;
      }
    }
    return chosen;
  }();
  return classes;
}

/// The first `count` takes of the studio's actions. From frame `moved_from` on, cameras have the poses of faults.real.
inline std::vector<StudioView> StudioViews(const StudioOptions& options, int count, int moved_from = 0) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const auto cast = Cast(options.seed, options.subjects, *skeleton);
  const auto plan = PlanTakes(options, OneVariantPerAction(), {options.subjects, 1, 30.0, 0.3, 0.6});
  const std::vector<Camera> rig = RigOf(options.rig, SensorKind::kColour);
  std::vector<StudioView> takes;
  for (const PlannedTake& planned : *plan) {
    if (static_cast<int>(takes.size()) >= count) break;
    StudioView take;
    take.name = planned.Key();
    take.truth = PerformScript(planned.script, cast[planned.subject - 1], skeleton, FrameRate{30, 1});
    take.faults = FaultsOf(options.rig, rig, options.seed);
    for (const Joint& joint : skeleton->joints) take.evidence.keypoint_names.push_back(joint.name);
    for (std::size_t c = 0; c < rig.size(); ++c) {
      const Motion delayed = DelayBy(take.truth, take.faults.clock_s[c]);
      KeypointView view;
      view.camera = rig[c];
      view.people = 1;
      for (int f = 0; f < delayed.frame_count(); ++f) {
        const Camera& real = f >= moved_from ? take.faults.real[c] : rig[c];
        view.time_s.push_back(delayed.rate.FrameTime(f));
        std::vector<ImagePoint> points;
        for (int k = 0; k < skeleton->joint_count(); ++k) {
          points.push_back({real.ProjectWorld(delayed.joints.at(f, k)), false});
        }
        const OpenPosePerson person =
            Detected(points, options.keypoints, options.seed, take.name + "/" + rig[c].name + "/" + std::to_string(f));
        for (const DetectedKeypoint& point : person.pose) {
          view.values.insert(view.values.end(), {point.u_px, point.v_px, point.confidence});
        }
      }
      take.evidence.keypoint_views.push_back(std::move(view));
    }
    takes.push_back(std::move(take));
  }
  return takes;
}

}  // namespace mocurate
