#include "fitting/repair/coincident_limbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "fitting/repair/limb_steps.h"

namespace mocurate {
namespace {

constexpr double kMergedNear = 0.03;  ///< metres between both sides, beside noise
/// m at most: knees of a crouching person come as near as 8 cm. Source: 1,205 recorded clips (docs/fitting.md)
constexpr double kMergedNearest = 0.06;
constexpr int kFewestMergedFrames = 5;      ///< limbs that pass each other are near for fewer frames
constexpr double kShortestMerged_s = 0.15;  ///< shortest time in which limbs coincide
constexpr double kMergedGap_s = 0.1;        ///< longest interruption by noise
constexpr double kWentOver = 0.1;           ///< metres that a side jumps farther than the other
constexpr double kWentOverSigmas = 4.0;     ///< standard deviations of the noise that it jumps farther, at least

using Sides = std::array<int, 2>;  ///< joint indices, left and right

class MergeSearch {
 public:
  MergeSearch(const SkeletonTracks& tracks, const Sides& upper, const Sides& lower, double sigma)
      : tracks_(tracks),
        upper_(upper),
        lower_(lower),
        near_(std::min(kMergedNearest, kMergedNear + 2.0 * sigma)),
        jump_(std::max(kWentOver, kWentOverSigmas * sigma)) {}

  std::vector<CoincidentLimbs> Find() const {
    std::vector<CoincidentLimbs> found;
    for (int f = 0; f < tracks_.frames(); ++f) {
      if (!Near(f, near_)) continue;
      int last = f;
      std::vector<double> apart;
      for (int g = f; g < tracks_.frames() && tracks_.time_s[g] - tracks_.time_s[last] <= kMergedGap_s; ++g) {
        if (!Near(g, near_)) continue;
        apart.push_back(std::max(Apart(g, upper_), Apart(g, lower_)));
        last = g;
      }
      const bool lasts = tracks_.time_s[last] - tracks_.time_s[f] >= kShortestMerged_s;
      if (lasts && static_cast<int>(apart.size()) >= kFewestMergedFrames)
        found.push_back(Merged(f, last + 1, found.empty() ? 0 : found.back().frame_end, Median(std::move(apart))));
      f = lasts && !found.empty() ? std::max(last, found.back().frame_end - 1) : last;
    }
    return found;
  }

 private:
  bool Seen(int f, int side) const { return tracks_.seen(f, upper_[side]) && tracks_.seen(f, lower_[side]); }

  double Apart(int f, const Sides& joints) const {
    return (tracks_.positions.at(f, joints[0]) - tracks_.positions.at(f, joints[1])).norm();
  }

  bool Near(int f, double limit) const {
    return Seen(f, 0) && Seen(f, 1) && Apart(f, upper_) <= limit && Apart(f, lower_) <= limit;
  }

  /// Extends the span at its ends by frames in which noise alone separates the sides; not before frame `first`.
  CoincidentLimbs Merged(int begin, int end, int first, double apart) const {
    const double from_s = tracks_.time_s[begin] - kMergedGap_s, to_s = tracks_.time_s[end - 1] + kMergedGap_s;
    while (begin > first && tracks_.time_s[begin - 1] >= from_s && Near(begin - 1, 2.0 * near_)) --begin;
    while (end < tracks_.frames() && tracks_.time_s[end] <= to_s && Near(end, 2.0 * near_)) ++end;
    const double there = JumpsFarther(begin, -1), back = JumpsFarther(end - 1, 1);
    const bool left_went = std::max(there, back) > jump_ && std::min(there, back) > -jump_;
    const bool right_went = std::min(there, back) < -jump_ && std::max(there, back) < jump_;
    CoincidentLimbs merged{begin, end, {}, apart};
    if (!right_went) AddChain(upper_[0], merged.joints);
    if (!left_went) AddChain(upper_[1], merged.joints);
    return merged;
  }

  /// Metres by which the left joints step farther than the right ones between frame f and the next frame in direction
  /// `way` that observes both; 0 without such a frame.
  double JumpsFarther(int f, int way) const {
    int other = f + way;
    while (other >= 0 && other < tracks_.frames() && !(Seen(other, 0) && Seen(other, 1))) other += way;
    if (other < 0 || other >= tracks_.frames()) return 0.0;
    if (std::abs(tracks_.time_s[other] - tracks_.time_s[f]) > kStepGap_s) return 0.0;
    const auto step = [&](int joint) {
      return (tracks_.positions.at(f, joint) - tracks_.positions.at(other, joint)).norm();
    };
    return 0.5 * (step(upper_[0]) + step(lower_[0]) - step(upper_[1]) - step(lower_[1]));
  }

  void AddChain(int joint, std::vector<int>& joints) const {
    const std::size_t first = joints.size();
    joints.push_back(joint);
    for (int j = joint + 1; j < tracks_.joints(); ++j) {  // parents come first
      if (std::find(joints.begin() + static_cast<std::ptrdiff_t>(first), joints.end(),
                    tracks_.skeleton->joints[j].parent) != joints.end())
        joints.push_back(j);
    }
  }

  const SkeletonTracks& tracks_;
  Sides upper_;
  Sides lower_;
  double near_;
  double jump_;
};

/// The pair below a pair; empty without one.
std::optional<Sides> Below(const Skeleton& skeleton, const Sides& upper) {
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int mirror = skeleton.joints[j].mirror;
    if (skeleton.joints[j].parent == upper[0] && mirror >= 0 && skeleton.joints[mirror].parent == upper[1])
      return Sides{j, mirror};
  }
  return {};
}

}  // namespace

std::vector<CoincidentLimbs> FindMergedLimbs(const SkeletonTracks& tracks, double noise_sigma) {
  std::vector<CoincidentLimbs> found;
  for (const char* name : {"left_knee", "left_elbow"}) {
    const auto left = tracks.skeleton->FindJoint(name);
    if (!left || tracks.skeleton->joints[*left].mirror < 0) continue;
    const Sides upper = {*left, tracks.skeleton->joints[*left].mirror};
    const auto lower = Below(*tracks.skeleton, upper);
    if (!lower) continue;
    for (CoincidentLimbs& merged : MergeSearch(tracks, upper, *lower, noise_sigma).Find())
      found.push_back(std::move(merged));
  }
  return found;
}

}  // namespace mocurate
