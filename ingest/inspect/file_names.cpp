#include "ingest/inspect/file_names.h"

#include <algorithm>

#include "core/base/text.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// A name in pieces; `joints` are the characters between them.
struct Pieces {
  std::vector<std::string> parts;
  std::string joints;
  std::string ending;
};

Pieces PiecesOf(const std::string& name, std::string_view separators = "_/") {
  Pieces pieces;
  const std::size_t dot = name.rfind('.');
  const bool has_ending = dot != std::string::npos && name.find('/', dot) == std::string::npos;
  pieces.ending = has_ending ? name.substr(dot) : "";
  pieces.parts.emplace_back();
  for (const char c : name.substr(0, name.size() - pieces.ending.size())) {
    if (separators.find(c) != std::string_view::npos) {
      pieces.joints += c;
      pieces.parts.emplace_back();
    } else {
      pieces.parts.back() += c;
    }
  }
  return pieces;
}

/// Letters before digits that end the part; nothing for other parts.
std::optional<std::string> LettersBeforeDigits(const std::string& part) {
  std::size_t letters = 0;
  while (letters < part.size() && IsLetter(part[letters])) ++letters;
  if (letters == part.size() || !std::all_of(part.begin() + static_cast<std::ptrdiff_t>(letters), part.end(), IsDigit))
    return std::nullopt;
  return part.substr(0, letters);
}

NamePatternEstimate Unlike(const Pieces& first) {
  NamePatternEstimate estimate;
  const auto folders = std::count(first.joints.begin(), first.joints.end(), '/');
  for (std::ptrdiff_t i = 0; i <= folders; ++i) {
    estimate.fields.push_back("part" + std::to_string(i + 1));
    estimate.pattern += (i > 0 ? "/{" : "{") + estimate.fields.back() + "}";
  }
  estimate.pattern += first.ending;
  return estimate;
}

/// "cam01.0000.json" as "cam01.", "0000", ".json".
struct FrameSplit {
  std::string before;
  std::string after;
};

std::optional<FrameSplit> AtFrame(const std::string& file) {
  const std::size_t dot = std::min(file.rfind('.'), file.size());
  std::size_t end = dot;
  while (end > 0 && !IsDigit(file[end - 1])) --end;
  if (end == 0) return std::nullopt;
  std::size_t begin = end;
  while (begin > 0 && IsDigit(file[begin - 1])) --begin;
  return FrameSplit{file.substr(0, begin), file.substr(end)};
}

/// The beginning that folder and file share, up to its last letter or digit.
std::string Shared(const std::string& folder, const std::string& file) {
  std::size_t length = 0;
  while (length < folder.size() && length < file.size() && folder[length] == file[length]) ++length;
  while (length > 0 && !IsAlnum(folder[length - 1])) --length;
  return folder.substr(0, length);
}

std::string GroupedPattern(const std::string& name, bool cameras) {
  const std::vector<std::string_view> parts = SplitText(name, '/');
  const std::optional<FrameSplit> split = AtFrame(std::string(parts.back()));
  if (!split) return {};
  const std::string folder(parts.size() > 1 ? parts[parts.size() - 2] : "");
  const std::size_t above = parts.size() < 2 ? 0 : parts.size() - 2;
  std::string last = folder.empty() ? "" : "{recording}/";
  std::string before = split->before;
  if (cameras && !folder.empty()) {
    const std::string camera = Shared(folder, before);
    last = camera.empty() ? "{camera}/" : "{camera}" + folder.substr(camera.size()) + "/";
    if (!camera.empty()) before = "{camera}" + before.substr(camera.size());
  }
  std::string pattern;
  for (std::size_t i = 0; i < above; ++i) {
    const bool nearest = i + 1 == above && cameras;
    pattern += nearest ? "{recording}/" : "{group" + (above > 2 ? std::to_string(i) : std::string()) + "}/";
  }
  return pattern + last + before + "{frame}" + split->after;
}

}  // namespace

std::string FolderOf(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

std::string FormOf(const std::string& name) {
  const Pieces pieces = PiecesOf(name);
  return pieces.joints + pieces.ending;
}

namespace {

std::optional<NamePatternEstimate> EstimateCutAt(std::string_view separators, const std::vector<std::string>& names) {
  std::vector<Pieces> all;
  for (const std::string& name : names) all.push_back(PiecesOf(name, separators));
  const Pieces& first = all.front();
  const bool alike = std::all_of(all.begin(), all.end(), [&](const Pieces& pieces) {
    return pieces.joints == first.joints && pieces.ending == first.ending &&
           std::none_of(pieces.parts.begin(), pieces.parts.end(), [](const std::string& part) { return part.empty(); });
  });
  if (names.size() == 1 || !alike) return std::nullopt;
  NamePatternEstimate estimate;
  estimate.common = true;
  for (std::size_t i = 0; i < first.parts.size(); ++i) {
    if (i > 0) estimate.pattern += first.joints[i - 1];
    const auto of_all = [&](const auto& test) {
      return std::all_of(all.begin(), all.end(), [&](const Pieces& pieces) { return test(pieces.parts[i]); });
    };
    if (of_all([&](const std::string& part) { return part == first.parts[i]; })) {
      estimate.pattern += first.parts[i];
      continue;
    }
    const std::optional<std::string> letters = LettersBeforeDigits(first.parts[i]);
    if (letters && of_all([&](const std::string& part) { return LettersBeforeDigits(part) == letters; }))
      estimate.pattern += *letters;
    estimate.fields.push_back("part" + std::to_string(estimate.fields.size() + 1));
    estimate.pattern += "{" + estimate.fields.back() + "}";
  }
  estimate.pattern += first.ending;
  return estimate.fields.empty() ? std::nullopt : std::optional(estimate);
}

}  // namespace

NamePatternEstimate EstimateNamePattern(const std::vector<std::string>& names) {
  if (names.empty()) return {};
  for (const char* separators : {"_/- ", "_/"}) {
    if (auto estimate = EstimateCutAt(separators, names)) return *std::move(estimate);
  }
  return Unlike(PiecesOf(names.front()));
}

std::optional<std::string> EstimateCompanionPattern(const NamePatternEstimate& estimate,
                                                    const std::vector<std::string>& names,
                                                    const std::vector<std::string>& belonging) {
  const Expected<NamePattern> pattern = NamePattern::Parse(estimate.pattern, "files");
  if (!pattern) return std::nullopt;
  const std::size_t slash = estimate.pattern.rfind('/');
  const std::string stem = estimate.pattern.substr(slash == std::string::npos ? 0 : slash + 1);
  for (std::size_t end = stem.find_first_of("_."); end != std::string::npos; end = stem.find_first_of("_.", end + 1)) {
    std::string text;
    bool fits = true, asked = false;
    for (std::size_t i = 0; i < names.size() && fits; ++i) {
      if (belonging[i].empty()) continue;
      const std::optional<NameFields> fields = pattern->Match(names[i]);
      const std::size_t dot = belonging[i].rfind('.');
      text = stem.substr(0, end) + (dot == std::string::npos ? "" : belonging[i].substr(dot));
      fits = fields && FillFields(text, *fields) == belonging[i];
      asked = true;
    }
    if (fits && asked) return text;
  }
  return std::nullopt;
}

CameraNames NamesOfCameras(const std::vector<std::string>& all) {
  CameraNames names;
  std::vector<std::string> files;
  for (const std::string& file : all) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  }
  if (files.empty()) return names;
  std::size_t before = files[0].size(), after = files[0].size(), shortest = files[0].size();
  for (const std::string& file : files) {
    shortest = std::min(shortest, file.size());
    std::size_t same = 0;
    while (same < std::min(before, file.size()) && file[same] == files[0][same]) ++same;
    before = same;
    same = 0;
    while (same < std::min(after, file.size()) &&
           file[file.size() - 1 - same] == files[0][files[0].size() - 1 - same]) {
      ++same;
    }
    after = same;
  }
  // A number or word belongs to the camera as a whole.
  while (before > 0 && IsAlnum(files[0][before - 1])) --before;
  after = std::min(after, shortest - before);
  while (after > 0 && IsAlnum(files[0][files[0].size() - after])) --after;
  if (files.size() == 1) before = 0, after = files[0].size() - std::min(files[0].find_last_of('.'), files[0].size());
  names.before = files[0].substr(0, before);
  names.after = files[0].substr(files[0].size() - after);
  for (const std::string& file : files) names.cameras.push_back(file.substr(before, file.size() - before - after));
  return names;
}

std::optional<FramePattern> EstimateFramePattern(const std::vector<std::string>& files, bool cameras) {
  FramePattern best;
  for (const std::string& file : files) {
    const std::string text = GroupedPattern(file, cameras);
    if (text.empty() || text == best.pattern) continue;
    const auto pattern = NamePattern::Parse(text, "ingest.source.files");
    if (!pattern) continue;
    const auto matching = static_cast<std::size_t>(std::count_if(
        files.begin(), files.end(), [&](const std::string& name) { return pattern->Match(name).has_value(); }));
    if (matching <= best.matching) continue;
    best = {text, text.find("{recording}") != std::string::npos, matching};
  }
  if (2 * best.matching < files.size() || best.matching == 0) return std::nullopt;
  return best;
}

}  // namespace mocurate
