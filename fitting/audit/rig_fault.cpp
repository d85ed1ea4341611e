#include "fitting/audit/rig_fault.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

std::string_view Name(ConfidenceOf of) {
  switch (of) {
    case ConfidenceOf::kSpansOfOneTake:
      return "spans_of_one_take";
    case ConfidenceOf::kTakes:
      return "takes";
    case ConfidenceOf::kModel:
      return "model";
  }
  return "";
}

double RoundedConfidence(double confidence) { return std::floor(1e4 * confidence + 1e-6) / 1e4; }

std::string ConfidenceText(double confidence, ConfidenceOf of) {
  const std::string percent = "confidence " + RoundedText(100.0 * RoundedConfidence(confidence), 4) + " %";
  if (of == ConfidenceOf::kModel) return percent;
  return percent + (of == ConfidenceOf::kTakes ? " between takes" : " within this take");
}

RigFault MakeFault(std::string code, std::string camera, double value, std::string message) {
  RigFault fault;
  fault.code = std::move(code);
  fault.camera = std::move(camera);
  fault.value = value;
  fault.message = std::move(message);
  return fault;
}

Finding FindingOf(const RigFault& fault) {
  Finding finding = FrameFinding(fault.code.c_str(), fault.frame_begin, fault.frame_end, "", fault.value,
                                 fault.message + "; " + ConfidenceText(fault.confidence, fault.confidence_of));
  if (fault.corrected)
    finding.action = fault.code == kContradictingView ? FindingAction::kExcluded : FindingAction::kRepaired;
  return finding;
}

Finding ContradictionOfRig(const RigFault& fault) {
  Finding finding = FindingOf(fault);
  finding.code = kRigContradicted;
  finding.message = "this take contradicts the audited rig that it uses: " + finding.message +
                    "; nothing was corrected. Audit the rig again with this take and others of it: "
                    "mocurate rig audit CONFIG --clip THIS_TAKE --clip ANOTHER_TAKE -o rig.yaml";
  finding.action = FindingAction::kFlagged;
  return finding;
}

bool IsAmbiguous(const RigFault& fault) {
  return !fault.corrected && !fault.guessed && fault.code != kContradictingView;
}

nlohmann::json FaultsJson(const std::vector<RigFault>& faults) {
  nlohmann::json list = nlohmann::json::array();
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  for (const RigFault& fault : faults) {
    list.push_back({{"code", fault.code},
                    {"camera", fault.camera},
                    {"frames", {fault.frame_begin, fault.frame_end}},
                    {"value", rounded(fault.value)},
                    {"confidence", RoundedConfidence(fault.confidence)},
                    {"confidence_of", Name(fault.confidence_of)},
                    {"corrected", fault.corrected}});
    if (!fault.limb.empty()) list.back()["limb"] = fault.limb;
  }
  return list;
}

std::vector<std::vector<std::size_t>> FileExchanges(std::size_t views) {
  constexpr std::size_t kAllPermuted = 5;  ///< views up to which all permutations are tested (numerical)
  std::vector<std::size_t> source(views);
  std::iota(source.begin(), source.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> exchanges;
  if (views <= kAllPermuted) {
    while (std::next_permutation(source.begin(), source.end())) exchanges.push_back(source);
    return exchanges;
  }
  for (std::size_t a = 0; a < views; ++a) {
    for (std::size_t b = a + 1; b < views; ++b) {
      exchanges.push_back(source);
      std::swap(exchanges.back()[a], exchanges.back()[b]);
    }
  }
  return exchanges;
}

std::string FaultsText(const std::vector<RigFault>& faults) { return FaultsJson(faults).dump(); }

RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse) {
  const double late_ms = 1e3 * later_s;
  const std::string sigma = sigma_s ? " (standard deviation " + RoundedText(1e3 * *sigma_s, 2) + " ms)" : "";
  return MakeFault("camera_clock_off", camera, late_ms,
                   "camera " + camera + ": clock offset " + (late_ms > 0.0 ? "+" : "-") +
                       RoundedText(std::abs(late_ms), 3) + " ms relative to the other cameras" + sigma +
                       "; without it, the cost is " + RoundedText(100.0 * worse, 2) + " % higher");
}

RigFault SidesExchanged(const std::string& camera, int frames, double margin) {
  RigFault fault = MakeFault("view_swaps_sides", camera, margin,
                             "camera " + camera + " exchanges left and right in all " + Counted(frames, "frame"));
  fault.frame_end = frames;
  return fault;
}

RigFault CameraMoved(const Camera& was, const Camera& is, const std::string& reference, int begin, int end,
                     int frames) {
  const double moved_mm = 1e3 * (is.Centre() - was.Centre()).norm();
  const double angle = is.camera_from_world.rotation.angularDistance(was.camera_from_world.rotation);
  RigFault fault = MakeFault("camera_moved", was.name, moved_mm,
                             "camera " + was.name + " stands " + RoundedText(moved_mm, 3) + " mm and " +
                                 RoundedText(kDegrees * angle, 2) + " degrees from the pose of " + reference);
  if (begin == 0 && end == frames) return fault;
  fault.frame_begin = begin;
  fault.frame_end = end;
  fault.message += begin == 0 ? " until frame " + std::to_string(end) : " from frame " + std::to_string(begin) + " on";
  return fault;
}

namespace {

constexpr double kSame = 1e-9;  ///< share of two losses; differences below this are rounding (numerical)

/// Cumulative distribution of Student's t (Wallace's approximation, to 0.002).
double StudentShare(double t, double freedom) {
  const double z = std::sqrt(freedom * std::log1p(t * t / freedom)) * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
  return NormalShare(std::copysign(z, t));
}

/// Fewest spans of samples: of more than kMomentsOfTake, those of the takes that they must be from.
std::size_t FewestSpansOf(std::size_t samples) {
  const std::size_t takes = (samples + kMomentsOfTake - 1) / kMomentsOfTake;
  return kFewestSpans * std::max<std::size_t>(1, takes);
}

/// Confidence that the mean is above 0, from the variation of the means of `spans` parts of equal length.
double ConfidenceBySpans(const std::vector<double>& gain, std::size_t spans) {
  std::vector<double> means;
  for (std::size_t s = 0; s < spans; ++s) {
    const std::size_t begin = s * gain.size() / spans, end = (s + 1) * gain.size() / spans;
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += gain[i];
    means.push_back(sum / static_cast<double>(end - begin));
  }
  const auto n = static_cast<double>(spans);
  double mean = 0.0;
  for (const double value : means) mean += value / n;
  double square = 0.0;
  for (const double value : means) square += (value - mean) * (value - mean);
  const double error = std::sqrt(square / (n * (n - 1.0)));
  if (error <= 0.0) return mean > 0.0 ? 1.0 : 0.0;
  return StudentShare(mean / error, n - 1.0);
}

/// Differences, as shares of the sums.
std::vector<double> Gains(const std::vector<double>& worse, const std::vector<double>& better) {
  std::vector<double> gain;
  for (std::size_t i = 0; i < worse.size(); ++i) {
    const double more = worse[i] - better[i];
    const bool same = std::abs(more) <= kSame * (std::abs(worse[i]) + std::abs(better[i]));
    gain.push_back(same ? 0.0 : more / (std::abs(worse[i]) + std::abs(better[i])));
  }
  return gain;
}

}  // namespace

double ConfidenceAboveZero(const std::vector<double>& numbers) {
  return numbers.size() < 2 ? 0.0 : ConfidenceBySpans(numbers, numbers.size());
}

double ConfidenceOfSeparate(const std::vector<double>& worse, const std::vector<double>& better) {
  return ConfidenceAboveZero(Gains(worse, better));
}

double Confidence(const std::vector<double>& worse, const std::vector<double>& better) {
  const std::vector<double> gain = Gains(worse, better);
  double least = ConfidenceAboveZero(gain);
  for (std::size_t spans = 2 * gain.size() / 3; spans >= FewestSpansOf(gain.size()); spans = 2 * spans / 3) {
    least = std::min(least, ConfidenceBySpans(gain, spans));
  }
  return least;
}

double SpanConfidence(double sigmas, std::size_t spans) {
  return 2.0 * StudentShare(sigmas, static_cast<double>(spans) - 1.0) - 1.0;
}

std::vector<int> HalvesOf(std::size_t count) {
  std::vector<int> halves;
  for (std::size_t i = 0; i < count; ++i) halves.push_back(static_cast<int>(i * 2 * FewestSpansOf(count) / count % 2));
  return halves;
}

std::vector<int> FirstAndSecondHalf(std::size_t count) {
  std::vector<int> halves(count, 0);
  std::fill(halves.begin() + static_cast<std::ptrdiff_t>(count / 2), halves.end(), 1);
  return halves;
}

std::vector<double> HeldOutCosts(const std::vector<std::vector<double>>& candidates, const std::vector<int>& halves) {
  std::vector<double> costs(halves.size());
  for (int half = 0; half < 2; ++half) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      double sum = 0.0, count = 0.0;
      for (std::size_t i = 0; i < halves.size(); ++i) {
        if (halves[i] == half || candidates[c][i] < 0.0) continue;
        sum += candidates[c][i];
        count += 1.0;
      }
      if (count == 0.0 || sum / count >= least) continue;
      least = sum / count;
      best = c;
    }
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (halves[i] == half) costs[i] = candidates[best][i];
    }
  }
  return costs;
}

double ConfidenceOfTests(double confidence, std::size_t tests) {
  return std::max(0.0, 1.0 - static_cast<double>(tests) * (1.0 - confidence));
}

double NormalShare(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

namespace {

/// Rad, and metres per metre (and metre of distance from the origin): rounding error of a copied pose. Lenses of two
/// cameras are centimetres apart; thousandths of that when millimetres were read as kilometres (numerical).
constexpr double kSamePose = 1e-6;
/// Share of equal samples from which two views count as one: files of one sensor differ by a filter or a delay of a
/// frame. Synthetic depth views from different sides share up to 0.05, views of one camera a frame apart 0.66 to 0.94
/// (one jump 0.1). Source: synthetic depth views (0.05, and 0.66 to 0.94)
constexpr double kSameView = 0.6;

bool StandInOnePlace(const Camera& a, const Camera& b) {
  const RigidTransform &one = a.camera_from_world, &other = b.camera_from_world;
  return (one.translation - other.translation).norm() <= kSamePose * (1.0 + one.translation.norm()) &&
         one.rotation.angularDistance(other.rotation) <= kSamePose;
}

RigFault InOnePlace(const std::vector<Camera>& cameras, const std::vector<std::size_t>& group, double share) {
  std::vector<std::string> names;
  for (const std::size_t v : group) names.push_back(cameras[v].name);
  RigFault fault =
      MakeFault(kOnePlace, JoinTexts(names), share,
                "cameras " + JoinTexts(names) + " stand in one place with one orientation by their calibrations, ");
  fault.confidence = 1.0;
  fault.confidence_of = ConfidenceOf::kModel;
  const std::string equal = RoundedText(100.0 * share, 2) + " % of their content is equal";
  if (share < 0.0) {
    fault.message += "and their views are empty: check whether one calibration was copied";
  } else if (share < kSameView) {
    fault.message += "but only " + equal + ": one camera's calibration was given for all of them";
  } else {
    fault.message += "and " + equal + ": one camera's files were given twice; exclude the copy";
  }
  return fault;
}

}  // namespace

std::vector<std::vector<std::size_t>> CamerasInOnePlace(const std::vector<Camera>& cameras) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<bool> taken(cameras.size(), false);
  for (std::size_t a = 0; a < cameras.size(); ++a) {
    if (taken[a]) continue;
    std::vector<std::size_t> group = {a};
    for (std::size_t b = a + 1; b < cameras.size(); ++b) {
      if (taken[b] || !StandInOnePlace(cameras[a], cameras[b])) continue;
      taken[b] = true;
      group.push_back(b);
    }
    if (group.size() > 1) groups.push_back(std::move(group));
  }
  return groups;
}

Expected<std::vector<RigFault>> FaultsOfSharedPlaces(const std::vector<Camera>& cameras, const Similarity& alike,
                                                     AuditAction action, const RigWords& kind) {
  std::vector<RigFault> faults;
  if (action == AuditAction::kOff) return faults;
  for (const std::vector<std::size_t>& group : CamerasInOnePlace(cameras)) {
    double least = 1.0;
    for (std::size_t i = 1; i < group.size(); ++i) {
      const Expected<double> share = alike(group[0], group[i]);
      if (!share) return Forward(share);
      least = std::min(least, *share);
    }
    RigFault fault = InOnePlace(cameras, group, least);
    if (action == AuditAction::kCorrect && least >= 0.0 && least < kSameView) {
      return Fail(ErrorCode::kInconsistent, fault.message, kind.views,
                  "give each camera its own calibration (is one file copied, or read for all cameras?), or set " +
                      kind.option + ": report to use them as given");
    }
    faults.push_back(std::move(fault));
  }
  return faults;
}

bool PlacesAreCopied(const std::vector<RigFault>& faults) {
  return std::any_of(faults.begin(), faults.end(), [](const RigFault& fault) {
    return fault.code == kOnePlace && fault.value >= 0.0 && fault.value < kSameView;
  });
}

}  // namespace mocurate
