#include "ingest/checks/check_options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ingest/checks/finding_table.h"

namespace mocurate {
namespace {

std::string LimitKey(const FindingKind& kind, const CheckLimit& limit) {
  return std::string(kind.code) + '.' + limit.name;
}

/// What may be done about a finding, by name.
std::vector<std::pair<std::string, OnFinding>> ActionsOf(Checked check) {
  std::vector<std::pair<std::string, OnFinding>> actions = {{"ignore", OnFinding::kIgnore},
                                                            {"report", OnFinding::kReport}};
  if (check == Checked::kSamples) actions.emplace_back("missing", OnFinding::kMissing);
  actions.emplace_back("drop", OnFinding::kDrop);
  if (check == Checked::kSamples || check == Checked::kClip)
    actions.emplace_back("drop_recorded", OnFinding::kDropRecorded);
  return actions;
}

/// Keeps what differs from the table.
template <class T>
void Keep(std::map<std::string, T>& said, const std::string& key, T value, T by_default) {
  if (value == by_default)
    said.erase(key);
  else
    said[key] = value;
}

}  // namespace

const std::vector<std::string>& CheckCodes() {
  static const std::vector<std::string> codes = [] {
    std::vector<std::string> checks;
    for (const FindingKind& kind : FindingKinds()) {
      if (kind.check != Checked::kNothing) checks.emplace_back(kind.code);
    }
    return checks;
  }();
  return codes;
}

void CheckOptions::Declare(OptionVisitor& v) {
  for (const FindingKind& kind : FindingKinds()) {
    if (kind.check == Checked::kNothing) continue;
    v.BeginGroup(kind.code, kind.help);
    for (const CheckLimit& limit : kind.limits) {
      double value = Limit(kind.code, limit.name);
      if (limit.whole) {
        std::int64_t whole = std::llround(value);
        v.Integer(limit.name, whole, limit.range, limit.help);
        value = static_cast<double>(whole);
      } else {
        v.Number(limit.name, value, limit.unit, limit.range, limit.help);
      }
      Keep(limits, LimitKey(kind, limit), value, limit.value);
    }
    OnFinding action = ActionFor(kind.code);
    v.Choice("action", action, ActionsOf(kind.check),
             "ignore it, report it, set the samples of tracks to missing, drop the clip, or drop clips of tracks only");
    Keep(actions, std::string(kind.code), action, kind.by_default);
    v.EndGroup();
  }
}

OnFinding CheckOptions::ActionFor(const std::string& code) const {
  if (const auto said = actions.find(code); said != actions.end()) return said->second;
  const FindingKind* kind = FindFindingKind(code);
  return kind == nullptr ? OnFinding::kReport : kind->by_default;
}

bool CheckOptions::IgnoresAll() const {
  const auto& codes = CheckCodes();
  return std::all_of(codes.begin(), codes.end(),
                     [&](const std::string& code) { return ActionFor(code) == OnFinding::kIgnore; });
}

void CheckOptions::IgnoreAll() {
  for (const std::string& code : CheckCodes()) actions[code] = OnFinding::kIgnore;
}

double CheckOptions::Limit(const std::string& code, const std::string& name) const {
  const FindingKind* kind = FindFindingKind(code);
  for (std::size_t i = 0; kind != nullptr && i < kind->limits.size(); ++i) {
    const CheckLimit& limit = kind->limits[i];
    if (limit.name != name) continue;
    const auto said = limits.find(LimitKey(*kind, limit));
    return said == limits.end() ? limit.value : said->second;
  }
  throw std::logic_error("the check '" + code + "' has no limit '" + name + "'");
}

double CheckOptions::Threshold(const std::string& code) const {
  const FindingKind* kind = FindFindingKind(code);
  return kind == nullptr || kind->limits.empty() ? 0.0 : Limit(code, kind->limits[0].name);
}

}  // namespace mocurate
