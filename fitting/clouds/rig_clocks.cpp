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

  /// Decrease of the loss at `to`, summed over comparisons that both have: the rig's, since no other view changes.
  double Decrease(int from, int to) const {
    const auto both = Both(from, to);
    return static_cast<double>(both.first.size()) * (MeanLoss(both.first) - MeanLoss(both.second));
  }

  /// Confidence that a clock offset of `offset` frames, by the parabola through the losses beside `at`, is not 0. Its
  /// standard error is the larger of those from single comparisons and from groups of moments. Of one number, the
  /// search favours no sign, so nothing is held out. The losses beside `at` must be loaded.
  double Confident(int at, double offset) const {
    std::vector<double> single, groups;
    double bend = 0.0;
    std::size_t group = 0;
    const std::vector<double>&before = losses_.at(at - 1), &here = losses_.at(at), &after = losses_.at(at + 1);
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (before[i] < 0.0 || here[i] < 0.0 || after[i] < 0.0) continue;
      if (groups.empty() || i / rig_.pairs.size() != group) groups.push_back(0.0);
      group = i / rig_.pairs.size();
      const double bend_here = before[i] - 2.0 * here[i] + after[i];
      single.push_back(0.5 * (after[i] - before[i]) + bend_here * (offset - at));
      groups.back() += single.back();
      bend += bend_here;
    }
    const auto confidence = [&](const std::vector<double>& slopes) {
      if (slopes.size() < 2 || bend <= 0.0) return 0.0;
      double square = 0.0;
      for (const double slope : slopes) square += slope * slope;
      const auto n = static_cast<double>(slopes.size());
      return SpanConfidence(std::abs(offset) * bend / std::sqrt(square * n / (n - 1.0)), slopes.size());
    };
    return groups.size() == 1 ? confidence(single) : std::min(confidence(single), confidence(groups));
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

/// The offset of a view that decreases the loss most, whatever its confidence.
Expected<std::optional<ClockOffsetOfView>> FindShift(DepthRigSampler& sampler, const std::vector<int>& delays,
                                                     const std::vector<Camera>& cameras, std::size_t view,
                                                     int longest) {
  Shifts shifts(sampler, delays, cameras, view);
  for (const int beside : {0, -1, 1}) {
    if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
  }
  std::vector<int> ways;
  for (const int way : {-1, 1}) {
    if (shifts.Gain(0, way) > kLeastClockGain) ways.push_back(way);
  }
  if (ways.empty() && MeanLoss(shifts.Both(0, 0).first) > kBadLoss) {
    for (const int step : kFarSteps) {
      for (const int way : {-1, 1}) {
        if (step > longest) continue;
        if (Status loaded = shifts.Load(way * step); !loaded) return Forward(loaded);
        if (shifts.Gain(0, way * step) > kLeastClockGain) ways.push_back(way * step);
      }
      if (!ways.empty()) break;
    }
  }
  std::optional<ClockOffsetOfView> best;
  for (const int way : ways) {
    const Expected<int> shift = BestShift(shifts, way, longest);
    if (!shift) return Forward(shift);
    const double decrease = shifts.Decrease(0, *shift);
    if (shifts.Gain(0, *shift) < kLeastClockGain || (best && decrease <= best->decrease)) continue;
    for (const int beside : {*shift - 1, *shift + 1}) {
      if (Status loaded = shifts.Load(beside); !loaded) return Forward(loaded);
    }
    const double before = 1.0 - shifts.Gain(*shift, *shift - 1), after = 1.0 - shifts.Gain(*shift, *shift + 1);
    const double offset = *shift + Least(before, 1.0, after).first;
    const double confidence = ConfidenceOfTests(shifts.Confident(*shift, offset), kTestsOfView * delays.size());
    best = ClockOffsetOfView{view, *shift, offset, confidence, decrease};
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
    const auto found = FindShift(sampler, delays, cameras, v, longest);
    if (!found) return Forward(found);
    const bool is_sure = *found && (*found)->confidence >= sure;
    if (is_sure && (!best || (*found)->decrease >= best->decrease)) best = **found;
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
