#include "job/verbs/fit_answer.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Findings of ingest about the clip, then those of its fit.
std::vector<Finding> FindingsOf(const ClipRecord& clip) {
  std::vector<Finding> findings;
  if (clip.evidence.sha256 != clip.motion.sha256) findings = clip.evidence.outcome.findings;
  findings.insert(findings.end(), clip.motion.outcome.findings.begin(), clip.motion.outcome.findings.end());
  return findings;
}

/// Repairs and exclusions before the fit, with their number of frames; the clip's findings have the places.
void PrintRepairs(const ItemResult& item) {
  std::map<std::string, std::set<int>> frames;
  for (const Finding& finding : item.outcome.findings) {
    if (finding.action != FindingAction::kRepaired && finding.action != FindingAction::kMissing) continue;
    for (int f = finding.frame_begin; f < finding.frame_end; ++f) frames[finding.code].insert(f);
  }
  std::string text;
  for (const auto& [code, of_code] : frames) {
    if (of_code.empty()) continue;
    text += (text.empty() ? "" : ", ") + code + " in " + Counted(static_cast<long long>(of_code.size()), "frame");
  }
  if (!text.empty()) Print("  repaired: %s (places: see the clip's findings)\n", text.c_str());
}

/// Clips fitted as one body: the body's name and their number, for several clips.
std::map<std::string, int> SharedBodies(const JobResult& result) {
  std::map<std::string, int> shared;
  for (const auto& [body, item] : result.bodies) {
    const int clips = item.summary.value("clips", 0);
    if (clips > 1) shared[body] = clips;
  }
  return shared;
}

}  // namespace

bool IsFitted(const ClipRecord& clip) { return !clip.motion.artifact.empty(); }

void PrintFit(const ClipRecord& clip) {
  const nlohmann::json fit = clip.motion.summary;
  Print("%s\n", clip.item.c_str());
  const auto number = [](const nlohmann::json& from, const char* key) {
    return from.is_object() && from.contains(key) && from[key].is_number() ? from[key].get<double>() : 0.0;
  };
  if (fit.value("method", "none") != "none") {
    Print("  residual %.1f mm RMS, %.1f mm 95 %%, %.1f %% rejected\n", number(fit, "residual_rms_mm"),
          number(fit, "residual_p95_mm"), 100.0 * number(fit, "rejected_share"));
  }
  if (fit.contains("before")) {
    const nlohmann::json& before = fit["before"];
    const nlohmann::json& after = fit["after"];
    Print("  bones change by %.1f -> %.1f mm, jerk %.0f -> %.0f m/s3\n", number(before, "bone_spread_mm"),
          number(after, "bone_spread_mm"), number(before, "jerk"), number(after, "jerk"));
  }
  if (fit.contains("contacts")) {
    const nlohmann::json& contacts = fit["contacts"];
    Print(
        "  standing feet slide %.3f -> %.3f m/s, the fastest %.2f -> %.2f (they stand %.0f %% of the time); the "
        "largest change is %.0f mm (%s, "
        "frame %d), %.1f degrees\n",
        number(contacts, "sliding_before"), number(contacts, "sliding_after"), number(contacts, "fastest_before"),
        number(contacts, "fastest_after"), 100.0 * number(contacts, "contact_share"),
        number(contacts, "largest_shift_mm"), contacts.value("joint", "").c_str(), contacts.value("frame", 0),
        number(contacts, "largest_turn_deg"));
  }
  PrintRepairs(clip.motion);
  for (const Finding& finding : FindingsOf(clip)) {
    if (finding.severity == Severity::kInfo) continue;
    const char* mark = finding.severity == Severity::kError ? "error: " : "";
    Print("  %s%s: %s\n", mark, finding.code.c_str(), finding.message.c_str());
  }
}

void PrintSharedBodies(const JobResult& result) {
  for (const auto& [body, clips] : SharedBodies(result)) {
    Print("%s were measured as one body, %s (--set proportions.body_of=recording measures each separately)\n",
          Counted(clips, "clip").c_str(), body.c_str());
  }
}

nlohmann::json AnswerOf(const JobResult& result, const std::filesystem::path& output,
                        const std::vector<Finding>& of_set) {
  nlohmann::json clips = nlohmann::json::array();
  for (const ClipRecord& clip : result.clips) {
    if (clip.motion.item.empty()) continue;
    nlohmann::json findings = nlohmann::json::array();
    for (const Finding& finding : FindingsOf(clip)) {
      findings.push_back({{"code", finding.code},
                          {"severity", std::string(Name(finding.severity))},
                          {"message", finding.message},
                          {"value", finding.value}});
    }
    clips.push_back({{"clip", clip.item},
                     {"fitted", IsFitted(clip)},
                     {"error", IsFitted(clip) ? std::string() : clip.motion.outcome.error.Message()},
                     {"fit", clip.motion.summary},
                     {"findings", findings}});
  }
  return {{"output", DisplayPath(output)},
          {"clips", clips},
          {"findings", of_set},
          {"shared_bodies", SharedBodies(result)},
          {"failed", result.counts.failed}};
}

}  // namespace mocurate
