#include "ingest/sources/pattern.h"

#include <algorithm>
#include <cctype>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kMatchBudget = 100000;  // steps of backtracking; far beyond any sensible pattern
constexpr std::string_view kFolderMark = "?/";

/// Removes the mark of an optional folder from a field's text.
bool TakeFolderMark(std::string& field) {
  const std::size_t mark = kFolderMark.size();
  if (field.size() < mark || field.compare(field.size() - mark, mark, kFolderMark) != 0) return false;
  field.resize(field.size() - mark);
  return true;
}

}  // namespace

Expected<NamePattern> NamePattern::Parse(const std::string& text, const std::string& where) {
  NamePattern pattern;
  pattern.text_ = text;
  pattern.depth_ = static_cast<int>(std::count(text.begin(), text.end(), '/'));
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find('{', at);
    const std::string literal = text.substr(at, open - at);
    if (literal.find('}') != std::string::npos) {
      return Fail(ErrorCode::kConfig, "pattern '" + text + "' closes a field that was not opened", where);
    }
    if (!literal.empty()) pattern.parts_.push_back({false, literal, 0, false});
    if (open == std::string::npos) break;
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) {
      return Fail(ErrorCode::kConfig, "pattern '" + text + "' has a '{' without '}'", where);
    }
    Part field{true, text.substr(open + 1, close - open - 1), 0, false};
    field.folder = TakeFolderMark(field.text);
    const std::size_t colon = field.text.find(':');
    if (colon != std::string::npos) {
      const std::optional<long long> width = ParseInteger(field.text.substr(colon + 1));
      if (!width || *width < 1 || *width > 1000) {
        return Fail(ErrorCode::kConfig, "field '{" + field.text + "}' has no width from 1 to 1000", where);
      }
      field.width = static_cast<std::size_t>(*width);
      field.text.resize(colon);
    }
    if (field.text.empty() || field.text.find('{') != std::string::npos) {
      return Fail(ErrorCode::kConfig, "pattern '" + text + "' has a field without a name", where);
    }
    const bool touches = !pattern.parts_.empty() && pattern.parts_.back().is_field && !pattern.parts_.back().folder;
    if (touches && pattern.parts_.back().width == 0 && field.width == 0) {
      return Fail(ErrorCode::kConfig,
                  "fields '" + pattern.parts_.back().text + "' and '" + field.text + "' cannot be separated", where,
                  "give one of them a width, e.g. {" + field.text + ":2}");
    }
    pattern.parts_.push_back(field);
    at = close + 1;
  }
  const auto missing =
      std::count_if(pattern.parts_.begin(), pattern.parts_.end(), [](const Part& p) { return p.folder; });
  pattern.least_depth_ = pattern.depth_ - static_cast<int>(missing);
  return pattern;
}

std::optional<NameFields> NamePattern::OtherMatch(std::string_view name, const FieldTest& differ) const {
  NameFields fields;
  int budget = kMatchBudget;
  if (!MatchFrom(0, name, fields, budget, differ)) return std::nullopt;
  return fields;
}

bool NamePattern::MatchFrom(std::size_t part, std::string_view rest, NameFields& fields, int& budget,
                            const FieldTest& accepted) const {
  if (part == parts_.size()) return rest.empty() && (!accepted || accepted(fields));
  if (--budget < 0) return false;
  const Part& p = parts_[part];
  if (!p.is_field) {
    return rest.substr(0, p.text.size()) == p.text &&
           MatchFrom(part + 1, rest.substr(p.text.size()), fields, budget, accepted);
  }
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  const std::size_t first = p.width > 0 ? p.width : 1;
  const std::size_t last = p.width > 0 ? p.width : slash;
  const auto known = fields.find(p.text);
  const std::optional<std::string> before =
      known == fields.end() ? std::nullopt : std::optional<std::string>(known->second);
  const bool has_folder = slash < rest.size();
  for (std::size_t length = first; length <= last && length <= slash && (has_folder || !p.folder); ++length) {
    const std::string value(rest.substr(0, length));
    if (before && *before != value) continue;
    if (p.folder && length != slash) continue;
    fields[p.text] = value;
    if (MatchFrom(part + 1, rest.substr(p.folder ? length + 1 : length), fields, budget, accepted)) return true;
  }
  if (before)
    fields[p.text] = *before;
  else
    fields.erase(p.text);
  return p.folder && MatchFrom(part + 1, rest, fields, budget, accepted);
}

std::vector<std::string> NamePattern::FieldNames() const {
  std::vector<std::string> names;
  for (const Part& part : parts_) {
    if (part.is_field && std::find(names.begin(), names.end(), part.text) == names.end()) names.push_back(part.text);
  }
  return names;
}

std::string LettersAndDigits(const std::string& text) {
  std::string kept;
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) kept += static_cast<char>(std::tolower(letter));
  }
  return kept;
}

std::vector<std::string> FieldsOf(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t open = text.find('{'); open != std::string::npos; open = text.find('{', open + 1)) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) break;
    std::string name = text.substr(open + 1, close - open - 1);
    TakeFolderMark(name);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

std::string FillFields(const std::string& text, const NameFields& fields) {
  std::string filled;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find('{', at);
    const std::size_t close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) return filled + text.substr(at);
    filled += text.substr(at, open - at);
    std::string name = text.substr(open + 1, close - open - 1);
    const bool folder = TakeFolderMark(name);
    const auto field = fields.find(name);
    if (field != fields.end()) filled += folder ? field->second + "/" : field->second;
    at = close + 1;
  }
  return filled;
}

}  // namespace mocurate
