#include "canon/values/merge.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Whether two skeletons are equal except for their rest offsets.
bool SameButRest(const Skeleton& a, const Skeleton& b) {
  const auto same_limits = [](const Joint& x, const Joint& y) {
    if (!x.limits || !y.limits) return x.limits.has_value() == y.limits.has_value();
    return x.limits->min == y.limits->min && x.limits->max == y.limits->max;
  };
  const bool same_lie = a.lie.has_value() == b.lie.has_value() &&
                        (!a.lie || (a.lie->chains == b.lie->chains && a.lie->raw_offsets == b.lie->raw_offsets));
  return a.name == b.name && same_lie && SameTree(a, b) &&
         std::equal(
             a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(), [&](const Joint& x, const Joint& y) {
               return x.mirror == y.mirror && x.radius == y.radius && x.landmark == y.landmark && same_limits(x, y);
             });
}

/// A clip that is incompatible with the others of a dataset.
Finding OtherSkeleton(const Clip& clip, double apart, const std::string& message) {
  return MakeFinding("other_skeleton", Severity::kError, apart, message, FindingAction::kExcluded, clip.id());
}

}  // namespace

void UniteSkeletons(Dataset& dataset, std::vector<Finding>& findings) {
  std::vector<std::pair<SkeletonPtr, int>> kinds;
  for (const Clip& clip : dataset.clips) {
    const SkeletonPtr& rest_pose = clip.motion->rest_pose();
    const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) {
      return SameTree(*kind.first, *rest_pose) &&
             (dataset.joints_only || RestPosesApart(*kind.first, *rest_pose) <= kSameRestPose);
    });
    if (known != kinds.end()) {
      ++known->second;
    } else {
      kinds.emplace_back(rest_pose, 1);
    }
  }
  dataset.skeleton = std::max_element(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
  const bool one_rest = std::all_of(dataset.clips.begin(), dataset.clips.end(), [&](const Clip& clip) {
    return SameRestOffsets(*clip.motion->rest_pose(), *dataset.skeleton);
  });
  const bool is_name = dataset.skeleton->name.find_first_of("/.") == std::string::npos;  // not a file's
  if (const auto built_in = one_rest || !is_name ? Expected<SkeletonPtr>() : LoadSkeleton(dataset.skeleton->name);
      built_in && *built_in && SameButRest(**built_in, *dataset.skeleton) &&
      RestPosesApart(**built_in, *dataset.skeleton) <= kSameRestPose) {
    dataset.skeleton = *built_in;
  }
  std::vector<Clip> kept;
  std::map<SkeletonPtr, SkeletonPtr> united;  // clips that share a skeleton share it afterwards
  for (Clip& clip : dataset.clips) {
    Motion& motion = *clip.motion;
    if (!SameTree(*dataset.skeleton, *motion.skeleton)) {
      findings.push_back(OtherSkeleton(
          clip, 0.0, "its joints differ from those of most clips, skeleton '" + dataset.skeleton->name + "'"));
      continue;
    }
    const double apart = dataset.joints_only ? 0.0 : RestPosesApart(*dataset.skeleton, *motion.rest_pose());
    if (apart > kSameRestPose) {
      findings.push_back(OtherSkeleton(
          clip, apart,
          "its rotations refer to another rest pose than those of most clips: a bone direction differs by " +
              FormatDouble(std::round(apart * 1800.0 / kPi) / 10.0) + " degrees"));
      continue;
    }
    const bool shared = dataset.joints_only || SameRestOffsets(*motion.skeleton, *dataset.skeleton);
    SkeletonPtr& own = united[motion.skeleton];
    if (!own) own = shared ? dataset.skeleton : WithRestOffsetsOf(*dataset.skeleton, *motion.skeleton);
    motion.skeleton = own;
    motion.rotation_reference = shared ? nullptr : dataset.skeleton;
    kept.push_back(std::move(clip));
  }
  dataset.clips = std::move(kept);
}

void FindMixedRates(const Dataset& dataset, std::vector<Finding>& findings) {
  std::map<double, int> rates;
  for (const Clip& clip : dataset.clips) ++rates[clip.rate.hz()];
  if (rates.size() < 2) return;
  std::string list;
  for (const auto& [rate, count] : rates) list += " " + RoundedText(rate, 6) + " Hz (" + std::to_string(count) + ")";
  findings.push_back(
      MakeFinding("mixed_rates", Severity::kWarning, static_cast<double>(rates.size()),
                  "the set mixes clips of" + list +
                      ": windows of equal frames have different durations; set canon.rate to resample them"));
}

}  // namespace mocurate
