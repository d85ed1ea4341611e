#include "canon/exports/clip_names.h"

#include <algorithm>
#include <cctype>

#include "core/base/text.h"

namespace mocurate {
namespace {

std::string LowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

constexpr std::size_t kLongestName = 200;  // bytes; with a span, a number and an ending a file system's 255 suffice

std::string Shortened(std::string name) {
  if (name.size() <= kLongestName) return name;
  std::size_t end = kLongestName;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
  return name.substr(0, end);
}

/// `text` with '_' for what is no plain character and for those of `refused`.
std::string Replaced(std::string_view text, std::string_view refused) {
  std::string name;
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    const bool plain = character.kind == CharacterKind::kPlain && refused.find(text[0]) == std::string_view::npos;
    name += plain ? text.substr(0, character.bytes) : "_";
    text.remove_prefix(character.bytes);
  }
  return name;
}

/// Whether Windows takes the name for a device, with or without an ending: "con", "Aux.txt", "COM1".
bool IsDevice(const std::string& name) {
  const std::string base = LowerCase(name.substr(0, name.find('.')));
  if (base == "con" || base == "prn" || base == "aux" || base == "nul") return true;
  return base.size() == 4 && (base.substr(0, 3) == "com" || base.substr(0, 3) == "lpt") && base[3] >= '1' &&
         base[3] <= '9';
}

/// `name`, with a number appended where it is used already; `taken`: names in lower case, and the next number of each.
std::string Untaken(const std::string& name, std::map<std::string, int>& taken) {
  const auto [at, fresh] = taken.emplace(LowerCase(name), 2);
  std::string free = name;
  for (bool found = fresh; !found; found = taken.emplace(LowerCase(free), 2).second)
    free = name + "~" + std::to_string(at->second++);
  return free;
}

}  // namespace

ClipIdParts PartsOfClipId(std::string_view id) {
  ClipIdParts parts;
  const std::size_t hash = std::min(id.rfind('#'), id.size());
  if (hash < id.size()) parts.span = id.substr(hash + 1);
  std::string_view rest = id.substr(0, hash);
  for (std::string* part : {&parts.source, &parts.person}) {
    const std::size_t slash = rest.find('/');
    if (slash == std::string_view::npos) break;
    *part = rest.substr(0, slash);
    rest.remove_prefix(slash + 1);
  }
  parts.recording = rest;
  return parts;
}

std::string NameForFile(std::string_view text) {
  std::string name = Shortened(Replaced(text, "/\\:*?\"<>|#{},"));
  if (name.empty()) return "_";
  if (std::string_view(". -=+@").find(name.front()) != std::string_view::npos) name.front() = '_';
  if (name.back() == '.' || name.back() == ' ') name.back() = '_';
  return IsDevice(name) ? "_" + name : name;
}

std::vector<std::string> JointNamesForFile(const Skeleton& skeleton, std::string_view refused) {
  std::vector<std::string> names;
  std::map<std::string, int> taken;  // names, and the next number of each
  for (const Joint& joint : skeleton.joints) {
    const std::string name = joint.name.empty() ? "_" : Replaced(joint.name, refused);
    const auto [at, fresh] = taken.emplace(name, 1);
    std::string free = name;
    for (bool found = fresh; !found; found = taken.emplace(free, 1).second) {
      free = name + "_" + (at->second > 1 ? std::to_string(at->second) : "");
      ++at->second;
    }
    names.push_back(std::move(free));
  }
  return names;
}

FileNames::FileNames(const std::vector<std::string>& taken) {
  for (const std::string& name : taken) taken_.emplace(LowerCase(name), 2);
}

const std::string& FileNames::Of(const std::string& text) {
  const auto known = names_.find(text);
  if (known != names_.end()) return known->second;
  return names_.emplace(text, Untaken(NameForFile(text), taken_)).first->second;
}

std::map<std::string, std::string> FileNames::Texts() const {
  std::map<std::string, std::string> texts;
  for (const auto& [text, name] : names_) texts.emplace(name, text);
  return texts;
}

std::size_t FileNames::renamed() const {
  return static_cast<std::size_t>(
      std::count_if(names_.begin(), names_.end(), [](const auto& named) { return named.first != named.second; }));
}

ClipNames::ClipNames(const std::vector<std::string>& ids, RecordingNames unique) {
  std::vector<ClipIdParts> parts;
  std::set<std::string> sources;
  std::map<std::string, int> clips_of_recording;                 // by source/person/recording
  std::map<std::string, std::set<std::string>> persons_of_name;  // by the recording's name
  const auto recording_of = [](const ClipIdParts& part) {
    return part.source + "/" + part.person + "/" + part.recording;
  };
  for (const std::string& id : ids) {
    parts.push_back(PartsOfClipId(id));
    const ClipIdParts& part = parts.back();
    sources.insert(part.source);
    ++clips_of_recording[recording_of(part)];
    persons_of_name[LowerCase(NameForFile(part.recording))].insert(part.source + "/" + part.person);
  }
  source_ = sources.size() == 1 ? NameForFile(*sources.begin()) : "export";
  FileNames persons;
  std::map<std::string, std::map<std::string, int>> taken;  // by person; all under "" with kOfSet
  for (const ClipIdParts& part : parts) {
    const std::string& person = persons.Of(sources.size() == 1 ? part.person : part.source + "." + part.person);
    std::string name = NameForFile(part.recording);
    const bool met = unique == RecordingNames::kOfSet && persons_of_name[LowerCase(name)].size() > 1;
    if (met) name = Shortened(person + "_" + name);
    if (clips_of_recording[recording_of(part)] > 1) name += "." + part.span;
    name = Untaken(name, taken[unique == RecordingNames::kOfSet ? "" : person]);
    persons_.push_back(person);
    recordings_.push_back(name);
    renamed_ += name != part.recording ? 1 : 0;
  }
  renamed_persons_ = persons.renamed();
}

}  // namespace mocurate
