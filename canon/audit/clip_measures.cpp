#include "canon/audit/audit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/contacts.h"
#include "core/quality/measures.h"

namespace mocurate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastClips = 8;  ///< smaller classes are compared with the whole set
constexpr double kSpeedShare = 0.99;    ///< percentile of the frame speeds that is the top speed

/// Speed of the fastest joint in m/s, the 99th percentile over frames: other checks find single jumps.
double TopSpeed(const Clip& clip) {
  const Motion& motion = *clip.motion;
  std::vector<double> speeds;
  for (int f = 1; f < motion.frame_count(); ++f) {
    double most = 0.0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      most = std::max(most, (motion.joints.at(f, j) - motion.joints.at(f - 1, j)).norm());
    }
    speeds.push_back(most * motion.rate.hz());
  }
  if (speeds.empty()) return kNone;
  std::sort(speeds.begin(), speeds.end());
  return speeds[static_cast<std::size_t>(kSpeedShare * static_cast<double>(speeds.size() - 1))];
}

double ObservedShare(const Clip& clip) {
  const std::vector<JointState>& state = clip.motion->state;
  if (state.empty()) return kNone;
  const auto seen = std::count_if(state.begin(), state.end(), [](JointState s) {
    return s == JointState::kObserved || s == JointState::kRepaired;
  });
  return static_cast<double>(seen) / static_cast<double>(state.size());
}

/// Lower bound of the standard deviation, for classes of equal clips. For logarithms, and for shares.
constexpr double kLeastSpread = 0.15;
constexpr double kLeastSpreadOfShares = 0.05;

struct Usual {
  double median = 0.0;
  double spread = 0.0;
};

Usual UsualOf(const std::vector<double>& values, double least_spread) {
  Usual usual{Median(values), 0.0};
  std::vector<double> apart;
  for (const double value : values) apart.push_back(std::abs(value - usual.median));
  usual.spread = std::max(least_spread, kMadToSigma * Median(apart));
  return usual;
}

}  // namespace

const std::vector<MeasureKind>& MeasuresOfClips() {
  static const std::vector<MeasureKind> kinds = {
      {"seconds", "s", 0, 0.1, [](const Clip& clip) { return clip.motion->duration(); }},
      {"jerk", "m/s3", 1, 10.0, [](const Clip& clip) { return MeasureMotion(*clip.motion).jerk; }},
      {"foot_skate", "m/s", 1, 0.02, [](const Clip& clip) { return MeasureMotion(*clip.motion).foot_skate; }},
      {"floor_penetration", "m", 1, 0.01,
       [](const Clip& clip) { return FloorPenetration(*clip.motion).value_or(kNone); }},
      {"bone_spread", "mm", 1, 1.0, [](const Clip& clip) { return MeasureMotion(*clip.motion).bone_spread_mm; }},
      {"limit_share", "", 1, 0.25, [](const Clip& clip) { return LimitViolations(*clip.motion).value_or(kNone); }},
      {"top_speed", "m/s", 1, 0.2, TopSpeed},
      {"observed_share", "", -1, 0.05, ObservedShare},
      {"fit_rms", "m", 1, 0.005, [](const Clip& clip) { return clip.fit_rms > 0.0 ? clip.fit_rms : kNone; }}};
  return kinds;
}

std::vector<std::vector<double>> MeasureClips(const Dataset& dataset) {
  std::vector<std::vector<double>> measures;
  for (const Clip& clip : dataset.clips) {
    std::vector<double>& own = measures.emplace_back();
    for (const MeasureKind& kind : MeasuresOfClips()) {
      own.push_back(clip.motion && clip.motion->frame_count() > 0 ? kind.value(clip) : kNone);
    }
  }
  return measures;
}

std::vector<AuditFinding> FindOutliers(const Dataset& dataset, const std::vector<std::vector<double>>& measures,
                                       const OutlierOptions& options) {
  std::vector<AuditFinding> findings;
  if (!options.enabled) return findings;
  std::vector<double> worst(dataset.clips.size(), options.deviations);
  std::vector<AuditFinding> of_clip(dataset.clips.size());
  for (std::size_t k = 0; k < MeasuresOfClips().size(); ++k) {
    const MeasureKind& kind = MeasuresOfClips()[k];
    const auto scaled = [&](double value) { return kind.side < 0 ? value : std::log(value + kind.grain); };
    const auto has = [](double value) { return std::isfinite(value); };
    std::map<std::string, std::vector<double>> of_class;
    std::vector<double> all;
    for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
      if (!has(measures[i][k])) continue;
      of_class[dataset.clips[i].label].push_back(scaled(measures[i][k]));
      all.push_back(scaled(measures[i][k]));
    }
    if (all.size() < kLeastClips) continue;
    const double least_spread = kind.side < 0 ? kLeastSpreadOfShares : kLeastSpread;
    const Usual of_set = UsualOf(all, least_spread);
    std::map<std::string, Usual> usual;
    for (const auto& [label, values] : of_class)
      usual[label] = values.size() < kLeastClips ? of_set : UsualOf(values, least_spread);
    for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
      const Clip& clip = dataset.clips[i];
      if (!has(measures[i][k])) continue;
      const Usual& own = usual.at(clip.label);
      const double by = (scaled(measures[i][k]) - own.median) / own.spread;
      const double away = kind.side == 0 ? std::abs(by) : kind.side * by;
      if (away <= worst[i]) continue;
      worst[i] = away;
      const double median = kind.side < 0 ? own.median : std::max(0.0, std::exp(own.median) - kind.grain);
      const bool by_class = of_class.at(clip.label).size() >= kLeastClips;
      const std::string unit = *kind.unit == '\0' ? "" : std::string(" ") + kind.unit;
      of_clip[i].finding = MakeFinding("outlier", Severity::kInfo, away,
                                       std::string(kind.name) + " is " + RoundedText(measures[i][k], 3) + unit +
                                           ", of " + (by_class ? "'" + clip.label + "'" : "all classes") +
                                           " the median is " + RoundedText(median, 3) + unit + ": " +
                                           RoundedText(away, 1) + " robust standard deviations apart",
                                       FindingAction::kFlagged, clip.id());
      of_clip[i].finding.frame_end = clip.motion->frame_count();
    }
  }
  for (AuditFinding& found : of_clip) {
    if (!found.finding.code.empty()) findings.push_back(std::move(found));
  }
  std::stable_sort(findings.begin(), findings.end(),
                   [](const AuditFinding& a, const AuditFinding& b) { return a.finding.value > b.finding.value; });
  return findings;
}

}  // namespace mocurate
