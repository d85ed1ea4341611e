#include "core/quality/checks.h"

#include <algorithm>
#include <map>
#include <tuple>

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

}  // namespace mocurate
