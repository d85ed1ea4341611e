#include "fitting/clouds/rig_clocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

/// Share of the loss that a clock offset must remove.
constexpr double kLeastClockGain = 0.04;
constexpr double kBadLoss = 0.12;  ///< loss from which clocks are also searched farther away
/// Frames of delay, tried in turn while the loss falls (numerical).
constexpr std::array<int, 9> kClockSteps = {1, 2, 3, 4, 6, 8, 12, 16, 24};
/// Frames of delay from which the search starts again in either direction (numerical).
constexpr std::array<int, 8> kFarSteps = {2, 3, 4, 6, 8, 12, 16, 24};

/// Losses of one view's comparisons at other frame offsets.
class Shifts {
 public:
  Shifts(DepthRigSampler& sampler, const std::vector<int>& delays, const std::vector<Camera>& cameras, std::size_t view)
      : sampler_(sampler), delays_(delays), cameras_(cameras), view_(view) {}

  Status Load(int more) {
    if (losses_.count(more) != 0) return {};
    Expected<ObservedRig> rig = sampler_.SeenLater(delays_, view_, more);
    if (!rig) return Forward(rig);
    const auto is_others = [&](const auto& pair) { return pair.first != view_ && pair.second != view_; };
    rig->pairs.erase(std::remove_if(rig->pairs.begin(), rig->pairs.end(), is_others), rig->pairs.end());
    losses_[more] = LossOfSamples(*rig, cameras_);
    if (more == 0) rig_ = std::move(*rig);
    return {};
  }

  /// Mean losses at `from` and at `to`, over comparisons that both have. Both must be loaded, and 0.
  std::pair<std::vector<double>, std::vector<double>> Both(int from, int to) const {
    return OfView(rig_, view_, losses_.at(from), losses_.at(to));
  }

  /// Relative reduction of the loss at `to`.
  double Gain(int from, int to) const {
    const auto both = Both(from, to);
    const double was = MeanLoss(both.first);
    return both.first.size() < 2 || was <= 0.0 ? 0.0 : 1.0 - MeanLoss(both.second) / was;
  }

  double Confident(int from, int to) const {
    const auto both = Both(from, to);
    return ConfidenceOfSeparate(both.first, both.second);
  }

 private:
  DepthRigSampler& sampler_;
  const std::vector<int>& delays_;
  const std::vector<Camera>& cameras_;
  std::size_t view_;
  ObservedRig rig_;
  std::map<int, std::vector<double>> losses_;
};

/// Minimum of a parabola through three equidistant losses, within half a step, and its value.
std::pair<double, double> Least(double before, double at, double after) {
  const double bend = before - 2.0 * at + after;
  if (bend <= 0.0) return {0.0, at};
  const double where = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
  return {where, at - 0.5 * (before - after) * where + 0.5 * bend * where * where};
}

/// The best offset beyond and around `from`.
Expected<int> BestShift(Shifts& shifts, int from, int longest) {
  int best = from;
  const int way = from > 0 ? 1 : -1;
  for (const int step : kClockSteps) {
    if (step > longest) break;
    if (step <= std::abs(from)) continue;
    if (Status loaded = shifts.Load(way * step); !loaded) return Forward(loaded);
    if (shifts.Gain(best, way * step) <= 0.0) {
      if (step > 2) break;
      continue;
    }
    best = way * step;
  }
  bool better = true;
  for (int round = 0; better && round < longest; ++round) {
    better = false;
    for (const int beside : {best - 1, best + 1}) {
      if (beside == 0 || std::abs(beside) > longest) continue;
      if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
      if (shifts.Gain(best, beside) <= 0.0) continue;
      best = beside;
      better = true;
      break;
    }
  }
  return best;
}

Expected<std::optional<ClockOffsetOfView>> FindShift(DepthRigSampler& sampler, const std::vector<int>& delays,
                                                     const std::vector<Camera>& cameras, std::size_t view, int longest,
                                                     double sure) {
  Shifts shifts(sampler, delays, cameras, view);
  for (const int beside : {0, -1, 1}) {
    if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
  }
  std::vector<int> ways;
  if (shifts.Gain(0, -1) > 0.0 && shifts.Confident(0, -1) >= sure) ways.push_back(-1);
  if (shifts.Gain(0, 1) > 0.0 && shifts.Confident(0, 1) >= sure) ways.push_back(1);
  if (ways.empty() && MeanLoss(shifts.Both(0, 0).first) > kBadLoss) {
    for (const int step : kFarSteps) {
      for (const int way : {-1, 1}) {
        if (step > longest) continue;
        if (Status loaded = shifts.Load(way * step); !loaded) return Forward(loaded);
        if (shifts.Gain(0, way * step) > kLeastClockGain && shifts.Confident(0, way * step) >= sure)
          ways.push_back(way * step);
      }
      if (!ways.empty()) break;
    }
  }
  std::optional<ClockOffsetOfView> best;
  for (const int way : ways) {
    const Expected<int> shift = BestShift(shifts, way, longest);
    if (!shift) return Forward(shift);
    const double gain = shifts.Gain(0, *shift), confidence = shifts.Confident(0, *shift);
    if (gain < kLeastClockGain || confidence < sure || (best && gain <= best->gain)) continue;
    for (const int beside : {*shift - 1, *shift + 1}) {
      if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
    }
    const double before = 1.0 - shifts.Gain(*shift, *shift - 1), after = 1.0 - shifts.Gain(*shift, *shift + 1);
    best = ClockOffsetOfView{view, *shift, *shift + Least(before, 1.0, after).first, confidence, gain};
  }
  return best;
}

}  // namespace

Expected<std::optional<ClockOffsetOfView>> FindClockOffset(DepthRigSampler& sampler, const std::vector<int>& delays,
                                                           const std::vector<Camera>& cameras, int longest,
                                                           double sure) {
  std::optional<ClockOffsetOfView> best;
  if (longest < 1 || sampler.together() < 2) return best;
  for (std::size_t v = 0; v < delays.size(); ++v) {
    const auto found = FindShift(sampler, delays, cameras, v, longest, sure);
    if (!found) return Forward(found);
    if (*found && (!best || (*found)->gain >= best->gain)) best = **found;
  }
  return best;
}

Expected<double> LeastLossBetweenFrames(DepthRigSampler& sampler, const std::vector<int>& delays,
                                        const std::vector<Camera>& cameras, std::size_t view) {
  Shifts shifts(sampler, delays, cameras, view);
  for (const int beside : {0, -1, 1}) {
    if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
  }
  const double at = MeanLoss(shifts.Both(0, 0).first);
  const double before = 1.0 - shifts.Gain(0, -1), after = 1.0 - shifts.Gain(0, 1);
  return at * std::min({before, after, Least(before, 1.0, after).second});
}

DepthView DelayBy(const DepthView& view, int frames) {
  DepthView later = view;
  const auto shift = [&](auto& list, const auto& from) {
    for (std::size_t f = 0; f < list.size(); ++f) {
      const auto at = static_cast<std::ptrdiff_t>(f) + frames;
      const bool known = at >= 0 && at < static_cast<std::ptrdiff_t>(from.size());
      if (known) {
        list[f] = from[static_cast<std::size_t>(at)];
      } else {
        list[f].clear();
      }
    }
  };
  shift(later.files, view.files), shift(later.sha256, view.sha256);
  shift(later.masks, view.masks), shift(later.mask_sha256, view.mask_sha256);
  return later;
}

RigFault DepthClockOff(const std::string& camera, double off_ms, int frames) {
  return MakeFault("camera_clock_off", camera, off_ms,
                   "depth camera " + camera + ": clock offset " + (off_ms > 0.0 ? "+" : "-") +
                       RoundedText(std::abs(off_ms), 3) + " ms relative to the other cameras; its nearest image is " +
                       Counted(std::abs(frames), "frame") + (frames > 0 ? " later" : " earlier"));
}

}  // namespace mocurate
