#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion/limbs.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

/// Joints of two trunks match within this share of the length from the pelvis to the chest.
constexpr double kSamePlace = 0.2;

class Matching {
 public:
  Matching(const Skeleton& source, const Skeleton& target)
      : source_(source),
        target_(target),
        match_(target.joints.size(), -1),
        used_(source.joints.size(), false),
        decided_(target.joints.size(), false) {}

  std::vector<int> Find() {
    const Limbs from = LimbsOf(source_), to = LimbsOf(target_);
    for (std::size_t side = 0; side < 2; ++side) {
      TakeLimb(from.arm[side], to.arm[side]);
      TakeLimb(from.leg[side], to.leg[side]);
    }
    if (from.chest > 0 && to.chest > 0 && from.pelvis >= 0 && to.pelvis >= 0) TakeTrunk(from, to);
    TakeNames();
    return std::move(match_);
  }

 private:
  void Take(int t, int s) {
    if (t < 0 || s < 0 || match_[t] >= 0 || used_[s]) return;
    match_[t] = s;
    used_[s] = true;
  }

  void TakeLimb(const Limb& from, const Limb& to) {
    if (!from.known() || !to.known()) return;
    Take(to.middle, from.middle);
    Take(to.root, from.root);
    Take(to.end, from.end);
    Take(to.tip, from.tip);
    Take(to.collar, from.collar);
    for (const int joint : {to.root, to.end}) {
      if (joint >= 0) decided_[joint] = true;
    }
    if (to.collar >= 0) decided_[to.collar] = true;
    // A collar that the target does not have is not its shoulder.
    if (from.collar >= 0) used_[from.collar] = true;
  }

  /// Position of each joint between pelvis and chest, as a share of that path.
  static std::vector<std::pair<int, double>> TrunkOf(const Skeleton& skeleton, const Limbs& limbs) {
    std::vector<std::pair<int, double>> joints;
    double length = 0.0;
    for (int j = limbs.chest; j >= 0 && j != limbs.pelvis; j = skeleton.joints[j].parent) {
      joints.emplace_back(j, length);
      length += skeleton.joints[j].rest_offset.norm();
    }
    for (auto& [joint, along] : joints) along = length > 0.0 ? 1.0 - along / length : 1.0;
    std::reverse(joints.begin(), joints.end());
    if (!joints.empty()) joints.pop_back();  // the chest itself
    return joints;
  }

  void TakeTrunk(const Limbs& from_limbs, const Limbs& to_limbs) {
    const auto from = TrunkOf(source_, from_limbs);
    const auto to = TrunkOf(target_, to_limbs);
    Take(to_limbs.pelvis, from_limbs.pelvis);
    Take(to_limbs.chest, from_limbs.chest);
    std::size_t first = 0;
    for (const auto& [t, along] : to) {
      decided_[t] = true;
      std::size_t best = from.size();
      for (std::size_t i = first; i < from.size(); ++i) {
        const double apart = std::abs(from[i].second - along);
        if (apart <= kSamePlace && (best == from.size() || apart < std::abs(from[best].second - along))) best = i;
      }
      if (best == from.size()) continue;
      Take(t, from[best].first);
      first = best + 1;
    }
    for (const auto& [s, along] : from) used_[s] = true;
  }

  /// By names, then by the synonyms of the source, then by those of the target, among the remaining joints.
  void TakeNames() {
    Skeleton source_names = source_;
    std::vector<std::string> names;
    for (const Joint& joint : source_.joints) names.push_back(joint.name);
    names = WithoutNamespace(std::move(names));
    for (std::size_t s = 0; s < names.size(); ++s) {
      source_names.joints[s].name = names[s];
      source_names.joints[s].synonyms.clear();
    }
    const auto take = [&](int t, const std::optional<int>& s) {
      if (s && !decided_[t]) Take(t, *s);
    };
    for (int t = 0; t < target_.joint_count(); ++t) take(t, source_names.FindJoint(target_.joints[t].name));
    for (int t = 0; t < target_.joint_count(); ++t) take(t, source_.FindJoint(target_.joints[t].name));
    for (int t = 0; t < target_.joint_count(); ++t) {
      for (const std::string& synonym : target_.joints[t].synonyms) take(t, source_names.FindJoint(synonym));
    }
  }

  const Skeleton& source_;
  const Skeleton& target_;
  std::vector<int> match_;
  std::vector<bool> used_;
  std::vector<bool> decided_;  ///< joints of the target that the tree decides, independent of names
};

}  // namespace

std::vector<int> MatchJoints(const Skeleton& source, const Skeleton& target) { return Matching(source, target).Find(); }

}  // namespace mocurate
