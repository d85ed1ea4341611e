#include "core/quality/checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/quality/rate.h"

namespace mocurate {
namespace {

void Append(std::vector<Finding> more, std::vector<Finding>& findings) {
  findings.insert(findings.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// The longest findings of each code, and one with the number of the others.
std::vector<Finding> Fewer(std::vector<Finding> findings, std::size_t most) {
  std::map<std::string, std::vector<Finding>> by_code;
  for (Finding& finding : findings) by_code[finding.code].push_back(std::move(finding));
  std::vector<Finding> kept;
  for (auto& [code, list] : by_code) {
    const auto length = [](const Finding& finding) { return finding.frame_end - finding.frame_begin; };
    std::stable_sort(list.begin(), list.end(),
                     [&](const Finding& a, const Finding& b) { return length(a) > length(b); });
    const std::size_t count = list.size();
    if (count > most) {
      int begin = list[most].frame_begin, end = 0;
      for (std::size_t i = most; i < count; ++i) {
        begin = std::min(begin, list[i].frame_begin);
        end = std::max(end, list[i].frame_end);
      }
      const std::size_t rest = count - most;
      Finding more = FrameFinding(code.c_str(), begin, end, "", static_cast<double>(rest),
                                  std::to_string(rest) + " more of this code, the longest of " +
                                      std::to_string(length(list[most])) + " frames");
      more.severity = list[0].severity;
      list.resize(most);
      list.push_back(std::move(more));
    }
    std::stable_sort(list.begin(), list.end(), [](const Finding& a, const Finding& b) {
      return std::tie(a.frame_begin, a.joint) < std::tie(b.frame_begin, b.joint);
    });
    Append(std::move(list), kept);
  }
  return kept;
}

/// Confidences with the samples found by FindBlanks set to missing: each defect is reported once.
std::vector<double> WithoutBlanks(const TrackedPoints& points, const std::vector<Finding>& blanks) {
  std::vector<double> confidence = points.confidence;
  if (confidence.empty()) confidence.assign(static_cast<std::size_t>(points.frames()) * points.count(), 1.0);
  for (const Finding& blank : blanks) {
    for (int k = 0; k < points.count(); ++k) {
      if (!blank.joint.empty() && blank.joint != points.name(k)) continue;
      for (int f = blank.frame_begin; f < blank.frame_end; ++f)
        confidence[static_cast<std::size_t>(f) * points.count() + static_cast<std::size_t>(k)] = 0.0;
    }
  }
  return confidence;
}

constexpr int kFewestBoneFrames = 8;
constexpr std::size_t kFewestBones = 3;
constexpr double kShortestBone = 1e-3;  // metres; a joint on its parent is ignored
constexpr double kShortestRest = 0.03;  // of the rest pose: of shorter ones trackers disagree

/// One bone over the frames that show it; medians, as single frames may be far off.
struct BoneLength {
  double length = 0.0;
  double spread = 0.0;  ///< standard deviation over length, from the median distance
  int frames = 0;
};

std::optional<BoneLength> Measure(const TrackedPoints& points, int point, int parent) {
  std::vector<double> lengths;
  for (int f = 0; f < points.frames(); ++f) {
    if (points.sees(f, point) && points.sees(f, parent)) {
      lengths.push_back((points.at(f, point) - points.at(f, parent)).norm());
    }
  }
  if (lengths.empty()) return std::nullopt;
  BoneLength bone{Median(lengths), 0.0, static_cast<int>(lengths.size())};
  if (bone.length < kShortestBone) return std::nullopt;
  for (double& length : lengths) length = std::abs(length - bone.length);
  bone.spread = kMadToSigma * Median(lengths) / bone.length;
  return bone;
}

/// All but the root within pi: as axis-angle vectors are.
bool LooksLikeRotations(const TrackedPoints& points) {
  for (int k = 0; k < points.count(); ++k) {
    if (points.parents[static_cast<std::size_t>(k)] < 0) continue;
    for (int f = 0; f < points.frames(); ++f) {
      if (points.sees(f, k) && points.at(f, k).cwiseAbs().maxCoeff() > kPi) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<Finding> CheckPoints(const TrackedPoints& given, double rate_hz, const CheckLimits& limits) {
  std::vector<Finding> findings = FindBlanks(given);
  if (!limits.metres) {  // how small a body may be is not known
    const auto collapsed = [](const Finding& finding) { return finding.code == "collapsed_frames"; };
    findings.erase(std::remove_if(findings.begin(), findings.end(), collapsed), findings.end());
  }
  const std::vector<double> confidence = WithoutBlanks(given, findings);
  const TrackedPoints points{given.positions, confidence,         given.time_s, given.names,
                             given.parents,   given.rest_lengths, given.body};
  Append(FindRepeats(points, limits.repeats), findings);
  std::vector<Finding> no_body = FindNonRigidBody(points, limits.rigidity);
  if (no_body.empty() && limits.metres) {
    Append(FindPositionJumps(points, limits.position_jumps), findings);
    Append(FindSwaps(points, limits.swaps), findings);
    if (rate_hz > 0.0) Append(FindWrongRate(points, rate_hz), findings);
  }
  Append(std::move(no_body), findings);
  return Fewer(std::move(findings), static_cast<std::size_t>(std::max(1, limits.most_per_code)));
}

double CoveredShare(const std::vector<Finding>& findings, const std::string& code, int frames) {
  if (frames <= 0) return 0.0;
  std::vector<char> covered(static_cast<std::size_t>(frames), 0);
  for (const Finding& finding : findings) {
    if (finding.code != code) continue;
    for (int f = std::max(0, finding.frame_begin); f < std::min(frames, finding.frame_end); ++f)
      covered[static_cast<std::size_t>(f)] = 1;
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) / frames;
}

std::vector<Finding> FindNonRigidBody(const TrackedPoints& points, const RigidityLimits& limits) {
  if (points.parents.empty()) return {};
  std::vector<double> spreads, ratios;
  for (int k = 0; k < points.count(); ++k) {
    const int parent = points.parents[static_cast<std::size_t>(k)];
    if (parent < 0) continue;
    const auto bone = Measure(points, k, parent);
    if (!bone) continue;
    if (bone->frames >= kFewestBoneFrames) spreads.push_back(bone->spread);
    const double rest = points.rest_lengths.empty() ? 0.0 : points.rest_lengths[static_cast<std::size_t>(k)];
    if (rest > kShortestRest) ratios.push_back(std::log(bone->length / rest));
  }
  double proportion = 0.0;
  if (ratios.size() >= kFewestBones) {
    const double scale = Median(ratios);
    for (const double ratio : ratios) proportion += std::abs(ratio - scale) / static_cast<double>(ratios.size());
  }
  const double spread = spreads.size() >= kFewestBones ? Median(spreads) : 0.0;
  if (proportion <= limits.proportion && spread <= limits.spread) return {};
  const std::string why = proportion > limits.proportion
                              ? "bone lengths differ from the skeleton's proportions by a factor of " +
                                    Digits(std::exp(proportion)) + " (mean), a person's by at most " +
                                    Digits(std::exp(limits.proportion))
                              : "bones change their length by " + Digits(spread) +
                                    " of it (median), a person's at most " + Digits(limits.spread);
  Finding finding =
      FrameFinding("not_joint_positions", 0, 0, "", proportion > limits.proportion ? std::exp(proportion) : spread,
                   why + (LooksLikeRotations(points)
                              ? ": joints in another order, or rotations such as Lie parameters in their place"
                              : ": joints in another order, or not joint positions"));
  finding.severity = Severity::kError;
  finding.limit = proportion > limits.proportion ? std::exp(limits.proportion) : limits.spread;
  return {finding};
}

}  // namespace mocurate
