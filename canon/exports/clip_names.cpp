#include "canon/exports/clip_names.h"

#include <algorithm>
#include <cctype>

#include "core/base/file.h"

namespace mocurate {
namespace {

std::string LowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// `name`, with a number appended where it is used already.
std::string Untaken(const std::string& name, std::set<std::string>& taken) {
  std::string free = name;
  for (int copy = 2; !taken.insert(LowerCase(free)).second; ++copy) free = name + "~" + std::to_string(copy);
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
  std::string name(text);
  for (auto bad = FirstNotUtf8(name); bad; bad = FirstNotUtf8(name)) name[*bad] = '_';
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F || std::string_view("/\\:*?\"<>|#{},").find(c) != std::string_view::npos) c = '_';
  }
  if (name.empty()) return "_";
  if (name.front() == '.' || name.front() == ' ') name.front() = '_';
  if (name.back() == '.' || name.back() == ' ') name.back() = '_';
  return name;
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

bool FileNames::Plain() const {
  return std::all_of(names_.begin(), names_.end(), [](const auto& named) { return named.first == named.second; });
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
  std::map<std::string, std::set<std::string>> taken;  // by person; all under "" with kOfSet
  for (const ClipIdParts& part : parts) {
    const std::string& person = persons.Of(sources.size() == 1 ? part.person : part.source + "." + part.person);
    std::string name = NameForFile(part.recording);
    const bool met = unique == RecordingNames::kOfSet && persons_of_name[LowerCase(name)].size() > 1;
    if (met) name = person + "_" + name;
    if (clips_of_recording[recording_of(part)] > 1) name += "." + part.span;
    name = Untaken(name, taken[unique == RecordingNames::kOfSet ? "" : person]);
    persons_.push_back(person);
    recordings_.push_back(name);
    renamed_ += name != part.recording ? 1 : 0;
  }
}

}  // namespace mocurate
