#include "fitting/repair/exchanges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kBoneWobble = 0.02;         ///< metres by which trackers vary bone lengths, beside noise
constexpr double kLimbChangeCost = 4.0;      ///< cost (negative log likelihood) of a change of state
constexpr double kExchangedLimbCost = 0.05;  ///< cost of an exchanged frame
constexpr double kBoneTime_s = 0.3;          ///< correlation time of a tracker's bone length errors

/// Pairs of arms or of legs, from the trunk outwards.
struct PairedLimb {
  std::vector<std::array<int, 2>> pairs;  ///< (left, right)
  std::vector<int> level;                 ///< bones between the pair and the limb's first
  std::vector<int> above;                 ///< index of the pair that is the parent; -1: the trunk
  int levels = 0;
};

std::vector<PairedLimb> PairedLimbsOf(const SkeletonTracks& tracks) {
  const Skeleton& skeleton = *tracks.skeleton;
  const std::vector<bool> seen = tracks.JointObservations();
  std::vector<PairedLimb> limbs;
  std::vector<std::array<int, 2>> place(skeleton.joints.size(), {-1, -1});  // limb, index in it
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[j];
    if (joint.mirror == j || joint.mirror < 0 || joint.parent < 0) continue;
    const bool left = place[joint.mirror][0] < 0;  // the side with the lower index gives the pair
    if (!left) continue;
    const int parent = joint.parent;
    std::array<int, 2> above = place[parent][0] >= 0 ? place[parent] : place[skeleton.joints[parent].mirror];
    if (above[0] < 0) {
      limbs.emplace_back();
      above = {static_cast<int>(limbs.size()) - 1, -1};
    }
    PairedLimb& limb = limbs[above[0]];
    place[j] = {above[0], static_cast<int>(limb.pairs.size())};
    limb.pairs.push_back({j, joint.mirror});
    limb.above.push_back(above[1]);
    limb.level.push_back(above[1] < 0 ? 0 : limb.level[above[1]] + 1);
  }
  for (PairedLimb& limb : limbs) {
    PairedLimb tracked;  // unobserved pairs only increase the level of those below
    std::vector<int> index(limb.pairs.size(), -1);
    for (std::size_t i = 0; i < limb.pairs.size(); ++i) {
      if (!seen[limb.pairs[i][0]] || !seen[limb.pairs[i][1]]) continue;
      index[i] = static_cast<int>(tracked.pairs.size());
      tracked.pairs.push_back(limb.pairs[i]);
      tracked.level.push_back(limb.level[i]);
      tracked.above.push_back(limb.above[i] < 0 ? -1 : index[limb.above[i]]);
      tracked.levels = std::max(tracked.levels, limb.level[i] + 1);
    }
    limb = tracked;
  }
  limbs.erase(std::remove_if(limbs.begin(), limbs.end(), [](const PairedLimb& limb) { return limb.pairs.size() < 2; }),
              limbs.end());
  return limbs;
}

double Capped(double square) { return std::min(0.5 * square, kMostSampleCost); }

/// States of a limb over time: 0 not exchanged, s exchanged from level s - 1 outwards.
class ExchangeSearch {
 public:
  ExchangeSearch(const SkeletonTracks& tracks, const PairedLimb& limb, const std::vector<double>& bone_length,
                 double sigma)
      : tracks_(tracks), limb_(limb), bone_length_(bone_length), sigma_(sigma) {
    for (int level = 0; level < limb.levels; ++level) {
      const auto outer = std::count_if(limb.level.begin(), limb.level.end(), [&](int l) { return l >= level; });
      if (outer >= 2) starts_.push_back(level);
    }
    Measure();
  }

  std::vector<LimbExchange> Exchanges(double least_margin) const {
    const std::vector<int> path = WithFewExchanged(BestPath(), least_margin);
    std::vector<LimbExchange> found;
    for (int begin = 0; begin < tracks_.frames(); ++begin) {
      if (path[begin] == 0) continue;
      int end = begin;
      while (end < tracks_.frames() && path[end] == path[begin]) ++end;
      LimbExchange exchange;
      exchange.frame_begin = begin;
      exchange.frame_end = end;
      exchange.margin = StepsOf(path, begin, end, false) - StepsOf(path, begin, end, true);
      for (std::size_t i = 0; i < limb_.pairs.size(); ++i) {
        if (Exchanged(path[begin], i)) exchange.pairs.push_back(limb_.pairs[i][0]);
      }
      if (exchange.margin >= least_margin) found.push_back(exchange);
      begin = end - 1;
    }
    return found;
  }

 private:
  int states() const { return static_cast<int>(starts_.size()) + 1; }
  bool Exchanged(int state, std::size_t pair) const { return state > 0 && limb_.level[pair] >= starts_[state - 1]; }
  /// Costs of each pair in each frame: of the step, with the state kept or changed, and of the bones, with the state of
  /// the parent pair or the other one.
  void Measure() {
    const std::size_t pairs = limb_.pairs.size();
    step_.assign(pairs * tracks_.frames(), {0.0, 0.0});
    bone_.assign(pairs * tracks_.frames(), {0.0, 0.0});
    std::vector<std::array<int, 2>> last(pairs, {-1, -1});  // last frame that observes each side
    for (int f = 0; f < tracks_.frames(); ++f) {
      for (std::size_t i = 0; i < pairs; ++i) {
        for (const int side : {0, 1}) {
          if (tracks_.seen(f, limb_.pairs[i][side])) StepCost(f, i, side, last[i]);
        }
        for (const int side : {0, 1}) {
          if (tracks_.seen(f, limb_.pairs[i][side])) last[i][side] = f;
        }
        if (limb_.above[i] >= 0) BoneCost(f, i);
      }
    }
  }

  /// Step cost of one joint from the last observation of each side, whose variance grows with time. A side that was
  /// never observed has the largest cost.
  void StepCost(int f, std::size_t i, int side, const std::array<int, 2>& last) {
    const auto variance = [&](int before) {
      const double way = kLimbSpeed * (tracks_.time_s[f] - tracks_.time_s[before]);
      return 2.0 * sigma_ * sigma_ + way * way;
    };
    const int latest = std::max(last[0], last[1]);
    if (latest < 0 || tracks_.time_s[f] - tracks_.time_s[latest] > kStepGap_s) return;
    for (const int from : {0, 1}) {
      const int before = last[from];
      double cost = kMostSampleCost;
      if (before >= 0 && tracks_.time_s[f] - tracks_.time_s[before] <= kStepGap_s) {
        const Vector3d now = tracks_.positions.at(f, limb_.pairs[i][side]) - Moved(before, f);
        const Vector3d then = tracks_.positions.at(before, limb_.pairs[i][from]);
        const double wider = 1.5 * std::log(variance(before) / variance(latest));
        cost = std::min(wider + Capped((now - then).squaredNorm() / variance(before)), kMostSampleCost);
      }
      step_[At(f, i)][side == from ? 0 : 1] += cost;
    }
  }

  /// Translation of the whole person between two frames, independent of exchanged sides. Median per coordinate over
  /// middle joints and midpoints of pairs that both frames observe; zero for fewer than three.
  Vector3d Moved(int from, int to) {
    if (moved_to_ != to) moved_.clear();
    moved_to_ = to;
    const auto known = moved_.find(from);
    if (known != moved_.end()) return known->second;
    std::vector<double> ways[3];
    for (int j = 0; j < tracks_.joints(); ++j) {
      const int mirror = tracks_.skeleton->joints[j].mirror < 0 ? j : tracks_.skeleton->joints[j].mirror;
      const auto seen = [&](int f) { return tracks_.seen(f, j) && tracks_.seen(f, mirror); };
      if (mirror < j || !seen(from) || !seen(to)) continue;
      const auto middle = [&](int f) {
        return Vector3d(0.5 * (tracks_.positions.at(f, j) + tracks_.positions.at(f, mirror)));
      };
      const Vector3d way = middle(to) - middle(from);
      for (int i = 0; i < 3; ++i) ways[i].push_back(way[i]);
    }
    Vector3d moved = Vector3d::Zero();
    if (ways[0].size() >= 3)
      moved = Vector3d(Median(std::move(ways[0])), Median(std::move(ways[1])), Median(std::move(ways[2])));
    return moved_.emplace(from, moved).first->second;
  }

  /// Consecutive frames share the tracker's bone length error: together they count once per kBoneTime_s. Three of the
  /// four joints must be observed, so that both states compare the same bones.
  void BoneCost(int f, std::size_t i) {
    const std::array<int, 2>& joints = limb_.pairs[i];
    const std::array<int, 2>& parents = limb_.pairs[limb_.above[i]];
    const auto seen = [&](int joint) { return tracks_.seen(f, joint); };
    if (std::count_if(joints.begin(), joints.end(), seen) + std::count_if(parents.begin(), parents.end(), seen) < 3)
      return;
    const double frame_s = f > 0 ? tracks_.time_s[f] - tracks_.time_s[f - 1] : 0.0;
    const double share = std::min(1.0, frame_s / kBoneTime_s);
    const double variance = 2.0 * sigma_ * sigma_ + kBoneWobble * kBoneWobble;
    for (const int side : {0, 1}) {
      for (const int from : {0, 1}) {
        if (!seen(joints[side]) || !seen(parents[from])) continue;
        const double length = (tracks_.positions.at(f, joints[side]) - tracks_.positions.at(f, parents[from])).norm();
        const double away = length - bone_length_[joints[side]];
        bone_[At(f, i)][side == from ? 0 : 1] += share * Capped(away * away / variance);
      }
    }
  }

  std::size_t At(int f, std::size_t pair) const { return static_cast<std::size_t>(f) * limb_.pairs.size() + pair; }

  double StateCost(int f, int state) const {
    double cost = state == 0 ? 0.0 : kExchangedLimbCost;
    for (std::size_t i = 0; i < limb_.pairs.size(); ++i) {
      const bool mixed = limb_.above[i] >= 0 && Exchanged(state, i) != Exchanged(state, limb_.above[i]);
      cost += bone_[At(f, i)][mixed ? 1 : 0];
    }
    return cost;
  }

  /// Cost of a change of state into frame f. A pair that the frame before does not observe keeps that frame's state.
  double ChangeCost(int f, int from, int to) const {
    double cost = from == to ? 0.0 : kLimbChangeCost;
    for (std::size_t i = 0; i < limb_.pairs.size(); ++i) {
      cost += step_[At(f, i)][Exchanged(from, i) == Exchanged(to, i) ? 0 : 1];
    }
    return cost;
  }

  std::vector<int> BestPath() const {
    const int frames = tracks_.frames();
    std::vector<double> cost(states());
    std::vector<std::vector<int>> came(frames, std::vector<int>(states(), 0));
    // No change cost at the first frame: a clip may begin within an exchange.
    for (int s = 0; s < states(); ++s) cost[s] = StateCost(0, s);
    for (int f = 1; f < frames; ++f) {
      std::vector<double> next(states(), std::numeric_limits<double>::infinity());
      for (int to = 0; to < states(); ++to) {
        for (int from = 0; from < states(); ++from) {
          // No direct change between exchanges: noise of joints near the trunk would make the exchanged state cheaper.
          if (from != to && from != 0 && to != 0) continue;
          const double through = cost[from] + ChangeCost(f, from, to);
          if (through >= next[to]) continue;
          next[to] = through;
          came[f][to] = from;
        }
        next[to] += StateCost(f, to);
      }
      cost = next;
    }
    std::vector<int> path(frames, 0);
    if (frames == 0) return path;
    path.back() = static_cast<int>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (int f = frames - 1; f > 0; --f) path[f - 1] = came[f][path[f]];
    return path;
  }

  double CostOf(const std::vector<int>& path) const {
    double cost = StateCost(0, path[0]);
    for (int f = 1; f < tracks_.frames(); ++f) cost += ChangeCost(f, path[f - 1], path[f]) + StateCost(f, path[f]);
    return cost;
  }

  /// Of the path and its complements (exchanged and other frames swapped, with the same steps) the cheapest. A path
  /// with most frames exchanged must be cheaper by `margin`.
  std::vector<int> WithFewExchanged(std::vector<int> path, double margin) const {
    const auto exchanged = std::count_if(path.begin(), path.end(), [](int state) { return state != 0; });
    if (2 * exchanged <= tracks_.frames()) return path;
    double least = CostOf(path) + margin;
    std::vector<int> best = path;
    for (int s = 1; s < states(); ++s) {
      std::vector<int> others = path;
      for (int& state : others) state = state == 0 ? s : 0;
      const double cost = CostOf(others);
      if (cost >= least) continue;
      least = cost;
      best = std::move(others);
    }
    return best;
  }

  /// Cost of the steps into and out of frames [begin, end), as in the path, or with these frames not exchanged.
  double StepsOf(const std::vector<int>& path, int begin, int end, bool exchanged) const {
    const auto state = [&](int f) { return exchanged || f < begin || f >= end ? path[f] : 0; };
    double cost = 0.0;
    for (int f = std::max(begin, 1); f <= end && f < tracks_.frames(); ++f)
      cost += ChangeCost(f, state(f - 1), state(f));
    return cost;
  }

  const SkeletonTracks& tracks_;
  const PairedLimb& limb_;
  const std::vector<double>& bone_length_;
  double sigma_;
  std::vector<int> starts_;  ///< level of the innermost exchanged pair of states 1, 2, ...
  std::vector<std::array<double, 2>> step_;
  std::vector<std::array<double, 2>> bone_;
  std::map<int, Vector3d> moved_;  ///< translation from earlier frames to frame moved_to_
  int moved_to_ = -1;
};

}  // namespace

std::vector<LimbExchange> FindExchanges(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                        double noise_sigma, double least_margin) {
  std::vector<LimbExchange> all;
  for (const PairedLimb& limb : PairedLimbsOf(tracks)) {
    const auto found = ExchangeSearch(tracks, limb, bone_length, noise_sigma).Exchanges(least_margin);
    all.insert(all.end(), found.begin(), found.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const LimbExchange& a, const LimbExchange& b) { return a.frame_begin < b.frame_begin; });
  return all;
}

}  // namespace mocurate
