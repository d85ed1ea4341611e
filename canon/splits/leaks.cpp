#include "canon/splits/leaks.h"

#include <map>
#include <set>

#include "core/base/text.h"

namespace mocurate {

Leaks FindLeaks(const std::vector<int>& parts, const std::vector<std::string>& groups,
                const std::vector<std::string>& contents) {
  std::map<std::string, std::set<int>> of_groups, of_contents;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] < 0) continue;
    of_groups[groups[i]].insert(parts[i]);
    of_contents[contents[i]].insert(parts[i]);
  }
  Leaks leaks;
  for (const auto& [group, in] : of_groups) {
    if (in.size() > 1) leaks.groups.push_back(group);
  }
  for (const auto& [content, in] : of_contents) leaks.repeated += in.size() > 1 ? 1 : 0;
  return leaks;
}

std::string LeakText(const std::string& what, const Leaks& leaks) {
  if (leaks.empty()) return "ok: no " + (what.empty() ? "" : what + " and no ") + "equal clip in two parts";
  std::string names;
  for (const std::string& group : leaks.groups) names += (names.empty() ? "" : ", ") + group;
  std::string text = "leaks:";
  if (!names.empty()) text += " in two parts: " + names + ";";
  if (leaks.repeated > 0) {
    text += " " + Counted(static_cast<long long>(leaks.repeated), "clip") + " of equal content in two parts";
  }
  return text;
}

std::string PerformanceOf(const Clip& clip, bool sessions_together) {
  const ClipIdentity& identity = clip.identity;
  if (sessions_together && !identity.session.empty()) {
    return identity.source + "/" + identity.person + "/session " + identity.session;
  }
  const auto performance = clip.provenance.find("performance");
  if (performance != clip.provenance.end()) return identity.source + "/" + performance->second;
  return identity.source + "/" + identity.person + "/" + identity.recording;
}

std::string SourceContentOf(const Clip& clip) {
  if (clip.evidence_sha256.empty()) return "";
  return clip.evidence_sha256 + "#" + std::to_string(clip.identity.begin_frame) + "-" +
         std::to_string(clip.identity.end_frame);
}

}  // namespace mocurate
