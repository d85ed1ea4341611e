#include <map>

#include "core/store/table.h"

namespace mocurate::store {
namespace {

using Extents = std::map<std::string, std::pair<std::uint64_t, std::string>>;  // symbol -> extent, path that set it

bool GroupIsThere(const Content& content, const std::string& group) {
  const std::string below = group + "/";
  const auto first = content.fields.lower_bound(below);
  return first != content.fields.end() && first->first.compare(0, below.size(), below) == 0;
}

std::optional<std::string> PresenceProblem(const Field& field, const Content& content) {
  const bool there = content.Has(field.path);
  const std::string kinematics = content.Text("/@kinematics");
  const std::string condition = " while /@kinematics is '" + kinematics + "'";
  switch (field.presence) {
    case Presence::kAlways:
      return there ? std::nullopt : std::optional<std::string>("is missing");
    case Presence::kOptional:
      return std::nullopt;
    case Presence::kGroup: {
      const bool split = field.path.rfind("/splits/", 0) == 0;
      if (there || !(split || GroupIsThere(content, field.group))) return std::nullopt;
      return split ? "is missing" : "is missing, though its group " + field.group + " is there";
    }
    case Presence::kMotion:
    case Presence::kTree: {
      const bool wanted = field.presence == Presence::kTree ? kinematics == "tree" : kinematics != "none";
      if (there == wanted) return std::nullopt;
      return (wanted ? "is missing" : "must be absent") + condition;
    }
  }
  return std::nullopt;
}

std::string ShapeInSymbols(const Field& field) {
  std::string text = "(";
  for (std::size_t i = 0; i < field.shape.size(); ++i) text += (i == 0 ? "" : ", ") + field.shape[i];
  return text + ")";
}

std::optional<std::string> ShapeProblem(const Field& field, const Array& array, bool has_values, Extents& extents) {
  const std::string expected = "has shape " + array.ShapeText() + "; the format asks for " + ShapeInSymbols(field);
  if (array.shape.size() != field.shape.size()) return expected;
  for (std::size_t i = 0; i < field.shape.size(); ++i) {
    const std::string& symbol = field.shape[i];
    if (symbol == "*") continue;
    if (symbol[0] >= '0' && symbol[0] <= '9') {
      if (std::to_string(array.shape[i]) != symbol) return expected;
      continue;
    }
    const auto [entry, fresh] = extents.emplace(symbol, std::make_pair(array.shape[i], field.path));
    if (!fresh && entry->second.first != array.shape[i]) {
      return expected + " with " + symbol + " = " + std::to_string(entry->second.first) + " as in " +
             entry->second.second;
    }
  }
  if (has_values && array.count() != array.size()) {
    return "holds " + std::to_string(array.size()) + " values; shape " + array.ShapeText() + " needs " +
           std::to_string(array.count());
  }
  return std::nullopt;
}

std::optional<std::string> ZeroByte(const Array& array) {
  if (array.type() != FieldType::kText) return std::nullopt;
  const auto& texts = array.as<std::string>();
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i].find('\0') != std::string::npos) return "text " + std::to_string(i) + " has a zero byte inside";
  }
  return std::nullopt;
}

Status CheckRules(const std::vector<Field>& fields, const Schema& schema, const Content& content, ErrorCode code,
                  const std::function<std::string(const std::string&)>& where) {
  for (const Field& field : fields) {
    const Array* array = content.Find(field.path);
    if (array == nullptr || !field.rule.check || content.later.count(field.path) > 0) continue;
    if (auto problem = field.rule.check(RuleContext{*array, content, field.path, schema.prefix})) {
      return Fail(code, *problem, where(field.path), "rule: " + field.rule.words);
    }
  }
  return {};
}

}  // namespace

const Array* RuleContext::Sibling(const std::string& name) const {
  return content.Find(path.substr(0, path.rfind('/') + 1) + name);
}

bool AreVersions(const std::string& a, const std::string& b) {
  return a != b && a.substr(0, a.rfind('/')) == b.substr(0, b.rfind('/'));
}

std::vector<Field> ConcreteFields(const Schema& schema, const Content& content) {
  std::vector<Field> fields;
  for (const Field& field : schema.fields) {
    const std::size_t star = field.path.find('*');
    if (star == std::string::npos) {
      fields.push_back(field);
      continue;
    }
    for (const std::string& name : content.splits) {
      fields.push_back(field);
      fields.back().path.replace(star, 1, name);
      fields.back().group.replace(star, 1, name);
    }
  }
  return fields;
}

Status CheckFields(const Schema& schema, const Content& content, ErrorCode code,
                   const std::function<std::string(const std::string&)>& where) {
  Extents extents;
  for (const Field& field : ConcreteFields(schema, content)) {
    const Array* array = content.Find(field.path);
    auto problem = PresenceProblem(field, content);
    if (!problem && array != nullptr && array->type() != field.type) {
      problem =
          "is of type " + std::string(Name(array->type())) + "; the format asks for " + std::string(Name(field.type));
    }
    if (!problem && array != nullptr)
      problem = ShapeProblem(field, *array, content.later.count(field.path) == 0, extents);
    const bool read = code == ErrorCode::kMalformed;  // its texts end at a zero byte
    if (!problem && array != nullptr && !read) problem = ZeroByte(*array);
    if (!problem) continue;
    const bool read_without = array == nullptr && read;
    return Fail(code, *problem, where(field.path),
                "docs/store_format.md: " + field.meaning + (read_without ? "; " + schema.MakeAgain() : ""));
  }
  return {};
}

Status CheckContent(const Schema& schema, const Content& content, ErrorCode code,
                    const std::function<std::string(const std::string&)>& where) {
  if (Status fields = CheckFields(schema, content, code, where); !fields) return fields;
  return CheckRules(ConcreteFields(schema, content), schema, content, code, where);
}

Status CheckRulesBelow(const std::string& group, const Schema& schema, const Content& content, ErrorCode code,
                       const std::function<std::string(const std::string&)>& where) {
  std::vector<Field> fields;
  for (const Field& field : schema.fields) {
    if (field.path.rfind(group, 0) == 0) fields.push_back(field);
  }
  return CheckRules(fields, schema, content, code, where);
}

}  // namespace mocurate::store
