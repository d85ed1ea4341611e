#include "canon/splits/leaks.h"

#include <iterator>

#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {

std::vector<int> PartsOf(const Split& split, std::size_t clips) {
  std::vector<int> parts(clips, -1);
  const std::vector<int>* rows[] = {&split.train, &split.validation, &split.test};
  for (int part = 0; part < 3; ++part) {
    for (const int row : *rows[part]) parts.at(static_cast<std::size_t>(row)) = part;
  }
  return parts;
}

const char* NameOfPart(int part) {
  constexpr const char* kNames[] = {"train", "validation", "test"};
  return kNames[part];
}

std::map<std::string, RowsByPart> InTwoParts(const std::vector<int>& parts, const std::vector<std::string>& groups) {
  std::map<std::string, RowsByPart> found;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] >= 0 && !groups[i].empty()) found[groups[i]][parts[i]].push_back(i);
  }
  for (auto at = found.begin(); at != found.end();) at = at->second.size() > 1 ? std::next(at) : found.erase(at);
  return found;
}

Leaks FindLeaks(const std::vector<int>& parts, const std::vector<std::string>& groups,
                const std::vector<std::string>& contents) {
  Leaks leaks;
  for (const auto& [group, rows] : InTwoParts(parts, groups)) leaks.groups.push_back(group);
  leaks.repeated = InTwoParts(parts, contents).size();
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

std::vector<std::string> ContentsOf(const std::vector<Clip>& clips, const std::vector<std::string>& motions) {
  std::vector<std::string> contents;
  std::map<std::string, int> of_file;  // clips of a content and file so far
  for (std::size_t i = 0; i < clips.size(); ++i) {
    std::string content = SourceContentOf(clips[i]);
    const auto file = clips[i].provenance.find("file");
    if (!content.empty() && file != clips[i].provenance.end()) {
      const int before = of_file[content + "\n" + clips[i].identity.source + "\n" + file->second]++;
      if (before > 0) content += "/" + std::to_string(before);
    }
    if (content.empty() && i < motions.size()) content = motions[i];
    if (content.empty() && clips[i].motion) {
      const std::vector<double>& xyz = clips[i].motion->joints.xyz;
      content = Sha256().Add(xyz.data(), xyz.size() * sizeof(double)).Hex();
    }
    contents.push_back(std::move(content));
  }
  return contents;
}

}  // namespace mocurate
