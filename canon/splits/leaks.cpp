#include "canon/splits/leaks.h"

#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// The given hash, else that of the clip's joints; empty without both.
std::string JointsHash(const Clip& clip, const std::string& given) {
  if (!given.empty() || !clip.motion) return given;
  const std::vector<double>& xyz = clip.motion->joints.xyz;
  return Sha256().Add(xyz.data(), xyz.size() * sizeof(double)).Hex();
}

}  // namespace

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
  return part < 0 ? "" : kNames[part];
}

void MoveRows(const std::vector<int>& new_rows, Split& split) {
  for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) {
    std::vector<int> moved;
    for (const int row : *part) {
      if (const int to = new_rows[static_cast<std::size_t>(row)]; to >= 0) moved.push_back(to);
    }
    *part = std::move(moved);
  }
}

nlohmann::json SplitSummary(const Split& split) {
  return {{"name", split.name},        {"train", split.train.size()}, {"validation", split.validation.size()},
          {"test", split.test.size()}, {"rule", split.rule},          {"leak_check", split.leak_check}};
}

std::map<std::string, RowsByPart> InTwoParts(const std::vector<int>& parts, const std::vector<std::string>& groups) {
  std::map<std::string, RowsByPart> found;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] >= 0 && !groups[i].empty()) found[groups[i]][parts[i]].push_back(i);
  }
  for (auto at = found.begin(); at != found.end();) at = at->second.size() > 1 ? std::next(at) : found.erase(at);
  return found;
}

std::string LeakText(const std::string& what, const std::vector<std::string>& groups, std::size_t repeated) {
  if (groups.empty() && repeated == 0) {
    return "ok: no " + (what.empty() ? "" : what + " and no ") + "equal clip in two parts";
  }
  std::string text = "leaks:";
  if (!groups.empty()) text += " in two parts: " + JoinTexts(groups) + ";";
  if (repeated > 0) text += " " + Counted(static_cast<long long>(repeated), "clip") + " of equal content in two parts";
  return text;
}

std::string GroupOf(SplitBy by, const Clip& clip, bool sessions_together) {
  const ClipIdentity& identity = clip.identity;
  if (by == SplitBy::kPerson) return identity.person;
  if (by == SplitBy::kStyle) return clip.Noted("style");
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

std::vector<bool> DistinguishedByMotion(const std::vector<Clip>& clips) {
  std::map<std::string, int> clips_of;
  for (const Clip& clip : clips) ++clips_of[SourceContentOf(clip)];
  std::vector<bool> needed;
  for (const Clip& clip : clips) {
    const std::string content = SourceContentOf(clip);
    needed.push_back(content.empty() || clips_of[content] > 1);
  }
  return needed;
}

std::vector<std::string> ContentsOf(const std::vector<Clip>& clips, const std::vector<std::string>& motions,
                                    const std::vector<std::size_t>& sets) {
  const std::vector<bool> needed = DistinguishedByMotion(clips);
  std::vector<std::string> contents;
  // Rows of each content, by the set and file that they come from.
  std::map<std::string, std::map<std::pair<std::size_t, std::string>, std::vector<std::size_t>>> of_file;
  std::vector<std::string> joints(clips.size());
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (needed[i]) joints[i] = JointsHash(clips[i], i < motions.size() ? motions[i] : std::string());
    contents.push_back(SourceContentOf(clips[i]));
    if (contents[i].empty()) contents[i] = joints[i];
    const auto file = clips[i].provenance.find("file");
    if (!needed[i] || contents[i] == joints[i] || file == clips[i].provenance.end()) continue;
    const std::size_t set = i < sets.size() ? sets[i] : 0;
    of_file[contents[i]][{set, clips[i].identity.source + "\n" + file->second}].push_back(i);
  }
  for (const auto& [content, files] : of_file) {
    std::map<std::string, int> body_of;  // by joints
    for (const auto& [file, rows] : files) {
      std::set<int> taken;
      for (const std::size_t row : rows) {
        if (body_of.count(joints[row]) > 0) taken.insert(body_of[joints[row]]);
      }
      int free = 0;
      for (const std::size_t row : rows) {
        if (body_of.count(joints[row]) == 0) {
          while (taken.count(free) > 0) ++free;
          body_of[joints[row]] = free;
          taken.insert(free);
        }
        if (const int body = body_of[joints[row]]; body > 0) contents[row] += "/" + std::to_string(body);
      }
    }
  }
  return contents;
}

}  // namespace mocurate
