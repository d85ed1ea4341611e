#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/config_parts.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

using Kind = ConfigNode::Kind;
using internal::Quoted;

std::string KindText(const ConfigNode& node) {
  switch (node.kind) {
    case Kind::kNull:
      return "no value";
    case Kind::kScalar:
      return Quoted(node.scalar);
    case Kind::kSequence:
      return "a list";
    case Kind::kMapping:
      return "a mapping";
  }
  return {};
}

/// Digits with or without a sign.
bool IsLongWhole(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

ConfigNode NodeOf(const nlohmann::json& value) {
  ConfigNode node;
  if (value.is_object()) {
    node.kind = Kind::kMapping;
    for (const auto& [key, element] : value.items()) node.mapping.emplace_back(key, NodeOf(element));
  } else if (value.is_array()) {
    node.kind = Kind::kSequence;
    for (const nlohmann::json& element : value) node.sequence.push_back(NodeOf(element));
  } else if (!value.is_null()) {
    node.kind = Kind::kScalar;
    node.quoted = value.is_string();
    node.scalar = node.quoted ? value.get<std::string>() : value.dump();
  }
  return node;
}

enum class Written {
  kByHand,  ///< an empty group, list or mapping counts as absent; errors name the place in the file
  kAsJson   ///< by OptionsToJson: types are exact, paths final; errors name the option only
};

/// Reads every option it visits; absent ones keep what they hold.
class OptionReader final : public OptionVisitor {
 public:
  OptionReader(const ConfigNode& root, const std::string& name, Written written) : written_(written) {
    Open(&root, name);
  }

  Status Finish() {
    Close();
    return problems_.Result();
  }

  void Bool(const char* name, bool& value, const char*) override {
    const ConfigNode* node = Find(name);
    if (node == nullptr) return;
    if (node->kind != Kind::kScalar || node->quoted || (node->scalar != "true" && node->scalar != "false")) {
      return Refuse(*node, Name(name), KindText(*node) + " must be true or false");
    }
    value = node->scalar == "true";
  }

  void Integer(const char* name, std::int64_t& value, Range range, const char*) override {
    const ConfigNode* node = Find(name);
    if (node == nullptr) return;
    const bool plain = node->kind == Kind::kScalar && !node->quoted;
    const std::optional<long long> number = plain ? ParseInteger(Trim(node->scalar)) : std::nullopt;
    if (!number && plain && IsLongWhole(Trim(node->scalar))) {
      return Refuse(*node, Name(name), KindText(*node) + " does not fit 64 bits",
                    "whole numbers reach from -9223372036854775808 to 9223372036854775807");
    }
    if (!number) return Refuse(*node, Name(name), KindText(*node) + " must be a whole number", QuoteHint(*node));
    if (!IsInside(static_cast<double>(*number), range)) return RefuseRange(*node, Name(name), range, Unit::kNone);
    value = *number;
  }

  void Number(const char* name, double& value, Unit unit, Range range, const char*) override {
    if (const ConfigNode* node = Find(name)) ReadNumber(*node, Name(name), unit, range, value);
  }

  void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range range, const char*) override {
    const ConfigNode* node = Find(name);
    if (node == nullptr) return;
    double number = 0.0;
    if (node->kind == Kind::kNull) {
      value.reset();
    } else if (ReadNumber(*node, Name(name), unit, range, number)) {
      value = number;
    }
  }

  void Text(const char* name, std::string& value, const char*) override {
    if (const ConfigNode* node = Find(name)) ReadText(*node, Name(name), value);
  }

  void Path(const char* name, std::filesystem::path& value, const char*) override {
    std::string text;
    const ConfigNode* node = Find(name);
    if (node == nullptr || !ReadText(*node, Name(name), text)) return;
    if (written_ == Written::kAsJson) {
      value = PathFromText(text);
      return;
    }
    if (text == "~" || text.substr(0, 2) == "~/") {
      return Refuse(*node, Name(name), Quoted(text) + ": '~' has no meaning here", "write ${HOME}");
    }
    value = text.empty() ? std::filesystem::path() : (node->base_folder / PathFromText(text)).lexically_normal();
  }

  void Numbers(const char* name, std::vector<double>& value, Unit unit, Range range, const char*) override {
    const ConfigNode* node = FindList(name, "must be a list of numbers");
    if (node == nullptr) return;
    std::vector<double> numbers(node->sequence.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      ReadNumber(node->sequence[i], Indexed(Name(name), i), unit, range, numbers[i]);
    }
    value = std::move(numbers);
  }

  void Texts(const char* name, std::vector<std::string>& value, const char*) override {
    ChoiceList(name, value, {}, "");
  }

  void TextMap(const char* name, std::map<std::string, std::string>& value, const char*) override {
    const ConfigNode* node = Find(name);
    if (node == nullptr || IsEmpty(*node)) return;
    if (node->kind != Kind::kMapping) {
      return Refuse(*node, Name(name), KindText(*node) + " must be a mapping of texts");
    }
    std::map<std::string, std::string> texts;
    for (const auto& [key, text] : node->mapping) ReadText(text, Name(name) + "." + key, texts[key]);
    value = std::move(texts);
  }

  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names, const char*) override {
    std::string text;
    const ConfigNode* node = Find(name);
    if (node == nullptr || !ReadText(*node, Name(name), text)) return;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) return RefuseChoice(*node, Name(name), text, names);
    index = static_cast<std::size_t>(found - names.begin());
  }

  /// Without `names`: of any texts.
  void ChoiceList(const char* name, std::vector<std::string>& value, const std::vector<std::string>& names,
                  const char*) override {
    const ConfigNode* node = FindList(name, "must be a list of texts");
    if (node == nullptr) return;
    std::vector<std::string> texts(node->sequence.size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const std::string element = Indexed(Name(name), i);
      if (!ReadText(node->sequence[i], element, texts[i])) continue;
      const bool known = names.empty() || std::find(names.begin(), names.end(), texts[i]) != names.end();
      if (!known) RefuseChoice(node->sequence[i], element, texts[i], names);
    }
    value = std::move(texts);
  }

  void Renamed(const char* name, const char* now) override { levels_.back().renamed.emplace(name, now); }

  void BeginGroup(const char* name, const char*) override {
    const ConfigNode* node = Find(name);
    Open(node, Name(name));
  }
  void EndGroup() override { Close(); }

  std::size_t BeginList(const char* name, std::size_t size, const char*) override {
    const ConfigNode* node = FindList(name, "must be a list of mappings");
    lists_.push_back({node, Name(name)});
    return node != nullptr ? node->sequence.size() : size;
  }
  bool ReplacesList() const override { return lists_.back().node != nullptr; }
  void BeginElement(std::size_t index) override {
    const List& list = lists_.back();
    Open(list.node != nullptr ? &list.node->sequence[index] : nullptr, Indexed(list.name, index));
  }
  void EndElement() override { Close(); }
  void EndList() override { lists_.pop_back(); }

 private:
  struct Level {
    const ConfigNode* node;  ///< null when absent
    std::string name;
    std::vector<std::string> options = {};            ///< visited
    std::map<std::string, std::string> renamed = {};  ///< old name -> name now
  };
  struct List {
    const ConfigNode* node;
    std::string name;
  };

  static std::string Indexed(const std::string& name, std::size_t index) { return name + "." + std::to_string(index); }

  static std::string QuoteHint(const ConfigNode& node) {
    if (node.scalar.rfind(kPlaceholder, 0) == 0) return "replace the placeholder by a number, without quotes";
    return node.kind == Kind::kScalar && node.quoted ? "a value in quotes is text, remove the quotes" : "";
  }

  /// Prefix of a placeholder for a value that must be filled in.
  static constexpr const char* kPlaceholder = "FILL_IN";

  static std::string ExampleOf(Unit unit) {
    const std::string text(mocurate::Name(unit));
    return unit == Unit::kNone ? "1" : (unit == Unit::kHertz ? "30 " : "1 ") + text;
  }

  std::string Name(const std::string& option) const {
    const std::string& outer = levels_.back().name;
    return outer.empty() ? option : outer + "." + option;
  }

  void Open(const ConfigNode* node, const std::string& name) {
    if (node != nullptr && node->kind != Kind::kMapping) {
      if (!IsEmpty(*node)) Refuse(*node, name, KindText(*node) + " must be a mapping");
      node = nullptr;
    }
    levels_.push_back({node, name});
  }

  void Close() {
    const Level level = std::move(levels_.back());
    levels_.pop_back();
    if (level.node == nullptr) return;
    for (const auto& [key, value] : level.node->mapping) {
      bool known = false;
      for (const std::string& option : level.options) known = known || option == key;
      const std::string name = level.name.empty() ? key : level.name + "." + key;
      if (known) continue;
      if (const auto now = level.renamed.find(key); now != level.renamed.end()) {
        Refuse(value, name, "this option has another name", "write " + now->second);
        continue;
      }
      problems_.Add(written_ == Written::kAsJson ? level.name : value.key_origin.Text(),
                    "unknown option " + Quoted(name), [&, &option = key] { return HintFor(option, level.options); });
    }
  }

  const ConfigNode* Find(const char* name) {
    Level& level = levels_.back();
    level.options.emplace_back(name);
    return level.node == nullptr ? nullptr : level.node->Find(name);
  }

  const ConfigNode* FindList(const char* name, const char* rule) {
    const ConfigNode* node = Find(name);
    if (node == nullptr || IsEmpty(*node)) return nullptr;
    if (node->kind == Kind::kSequence) return node;
    Refuse(*node, Name(name), KindText(*node) + " " + rule, node->kind == Kind::kScalar ? "write [a, b]" : "");
    return nullptr;
  }

  bool IsEmpty(const ConfigNode& node) const { return node.kind == Kind::kNull && written_ == Written::kByHand; }

  void Refuse(const ConfigNode& node, const std::string& name, const std::string& what, const std::string& hint = {}) {
    Refuse(node, name, what, [&hint] { return hint; });
  }

  void Refuse(const ConfigNode& node, const std::string& name, const std::string& what,
              const std::function<std::string()>& hint) {
    if (written_ == Written::kAsJson) return problems_.Add(name, what, hint);
    problems_.Add(node.origin.Text(), name.empty() ? what : name + ": " + what, hint);
  }

  void RefuseRange(const ConfigNode& node, const std::string& name, const Range& range, Unit unit) {
    Refuse(node, name, KindText(node) + " is out of range", "allowed: " + RangeText(range, unit));
  }

  bool ReadNumber(const ConfigNode& node, const std::string& name, Unit unit, const Range& range, double& value) {
    if (node.kind != Kind::kScalar || node.quoted) {
      const std::string in_unit = unit == Unit::kNone ? "" : " in " + std::string(mocurate::Name(unit));
      if (node.scalar.rfind(kPlaceholder, 0) == 0) {
        const std::string key = name.substr(name.rfind('.') + 1);
        Refuse(node, name, KindText(node) + " is still to be filled in",
               "write a number" + in_unit + " without quotes, e.g. `" + key + ": " + ExampleOf(unit) + "`");
        return false;
      }
      Refuse(node, name, KindText(node) + " must be a number" + in_unit, QuoteHint(node));
      return false;
    }
    const Expected<double> number = ParseQuantity(node.scalar, unit);
    if (!number) {
      Refuse(node, name, number.error().what, number.error().hint);
      return false;
    }
    if (!IsInside(*number, range)) {
      RefuseRange(node, name, range, unit);
      return false;
    }
    value = *number;
    return true;
  }

  void RefuseChoice(const ConfigNode& node, const std::string& name, const std::string& text,
                    const std::vector<std::string>& names) {
    Refuse(node, name, Quoted(text) + " must be one of " + JoinTexts(names),
           [&] { return DidYouMean(text, names, ""); });
  }

  bool ReadText(const ConfigNode& node, const std::string& name, std::string& text) {
    if (node.kind != Kind::kScalar || (written_ == Written::kAsJson && !node.quoted)) {
      Refuse(node, name, KindText(node) + " must be a text", node.kind == Kind::kNull ? "write '' for none" : "");
      return false;
    }
    text = node.scalar;
    return true;
  }

  Written written_;
  ProblemList problems_;
  std::vector<Level> levels_;
  std::vector<List> lists_;
};

}  // namespace

std::string Origin::Text() const {
  if (line == 0) return file;
  return file + ":" + std::to_string(line) + ":" + std::to_string(column);
}

const ConfigNode* ConfigNode::Find(const std::string& key) const {
  for (const auto& [name, value] : mapping) {
    if (name == key) return &value;
  }
  return nullptr;
}

namespace internal {

std::string Quoted(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  const std::string shown = DisplayPath(std::string(text.substr(0, kLongest)));
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

Status FromConfig(Declaration declaration, const ConfigNode& node) {
  OptionReader reader(node, "", Written::kByHand);
  declaration.declare(declaration.options, reader);
  return reader.Finish();
}

Status FromJson(Declaration declaration, const nlohmann::json& json, const std::string& where) {
  const ConfigNode node = NodeOf(json);
  OptionReader reader(node, where, Written::kAsJson);
  declaration.declare(declaration.options, reader);
  return reader.Finish();
}

}  // namespace internal
}  // namespace mocurate
