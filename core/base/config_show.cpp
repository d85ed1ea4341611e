#include "core/base/config_parts.h"
#include "core/base/file.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

using Kind = ConfigNode::Kind;

/// A text as YAML that reads back as itself: plain where that is safe, else in double quotes. `unset`: with a reference
/// to a variable that is not set.
std::string YamlText(const std::string& text, bool unset = false) {
  constexpr std::string_view kSafe = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/.+-";
  const bool plain = !text.empty() && text.find_first_not_of(kSafe) == std::string::npos && text[0] != '-' &&
                     text != "null" && text != "Null" && text != "NULL" && !ParseDouble(text);
  if (plain) return text;
  std::string quoted = YamlQuoted(text);
  for (std::size_t at = 0; unset && (at = quoted.find("$${", at)) != std::string::npos;) quoted.erase(at, 1);
  return quoted;
}

/// Writes options as YAML, one line per value.
class ConfigShower final : public OptionVisitor {
 public:
  ConfigShower(const ConfigNode& root, bool origins) : origins_(origins) { open_.push_back({&root, "", 0}); }
  std::string Result() { return std::move(text_); }

  void Bool(const char* name, bool& value, const char*) override { Put(name, value ? "true" : "false"); }
  void Integer(const char* name, std::int64_t& value, Range, const char*) override { Put(name, std::to_string(value)); }
  void Number(const char* name, double& value, Unit unit, Range, const char*) override {
    Put(name, QuantityText(value, unit));
  }
  void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range, const char*) override {
    Put(name, value ? QuantityText(*value, unit) : "null");
  }
  void Text(const char* name, std::string& value, const char*) override { PutText(name, value); }
  void Path(const char* name, std::filesystem::path& value, const char*) override { PutText(name, DisplayPath(value)); }
  void Numbers(const char* name, std::vector<double>& value, Unit unit, Range, const char*) override {
    std::string list;
    for (const double number : value) list += (list.empty() ? "" : ", ") + QuantityText(number, unit);
    Put(name, "[" + list + "]");
  }
  void Texts(const char* name, std::vector<std::string>& value, const char*) override {
    const ConfigNode* node = Below(name);
    std::string list;
    for (std::size_t i = 0; i < value.size(); ++i) {
      const bool unset = node != nullptr && i < node->sequence.size() && node->sequence[i].unset;
      list += (i == 0 ? "" : ", ") + YamlText(value[i], unset);
    }
    Put(name, "[" + list + "]");
  }
  void TextMap(const char* name, std::map<std::string, std::string>& value, const char*) override {
    if (value.empty()) return Put(name, "{}");
    const ConfigNode* node = Below(name);
    Line(name, "", node, false);
    open_.push_back({node, "", 0});
    for (const auto& [key, text] : value) PutText(key, text);
    open_.pop_back();
  }
  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names, const char*) override {
    Put(name, YamlText(names[index]));
  }

  void BeginGroup(const char* name, const char*) override {
    const ConfigNode* node = Below(name);
    Line(name, "", node, false);
    open_.push_back({node, "", 0});
  }
  void EndGroup() override { open_.pop_back(); }

  std::size_t BeginList(const char* name, std::size_t size, const char*) override {
    const ConfigNode* node = Below(name);
    Line(name, size == 0 ? "[]" : "", node, size == 0);
    open_.push_back({node, "", 0});
    return size;
  }
  void BeginElement(std::size_t index) override {
    const ConfigNode* list = open_.back().node;
    const bool has = list != nullptr && index < list->sequence.size();
    open_.push_back({has ? &list->sequence[index] : nullptr, "- ", 0});
  }
  void EndElement() override {
    if (open_.back().lines == 0) text_ += Indent(open_.size() - 1) + "- {}\n";
    open_.pop_back();
  }
  void EndList() override { open_.pop_back(); }

 private:
  struct Level {
    const ConfigNode* node;  ///< the configuration's value; null if not set
    std::string bullet;      ///< "- " before the first line of a list element
    int lines;
  };

  const ConfigNode* Below(const std::string& name) const {
    return open_.back().node == nullptr ? nullptr : open_.back().node->Find(name);
  }

  /// A list and its elements share one step of two blanks: the bullet takes the room of the inner one.
  std::string Indent(std::size_t depth) const { return std::string(2 * (depth - 1), ' '); }

  void Put(const std::string& name, const std::string& value) { Line(name, value, Below(name), true); }
  void PutText(const std::string& name, const std::string& text) {
    const ConfigNode* node = Below(name);
    Put(name, YamlText(text, node != nullptr && node->unset));
  }

  void Line(const std::string& name, const std::string& value, const ConfigNode* node, bool shows_origin) {
    Level& level = open_.back();
    std::string line = Indent(open_.size());
    if (!level.bullet.empty() && level.lines == 0) line.replace(line.size() - 2, 2, level.bullet);
    ++level.lines;
    line += YamlText(name) + ":" + (value.empty() ? "" : " " + value);
    if (origins_ && shows_origin) {
      line += "  # " + (node == nullptr || node->origin.file.empty() ? "default" : node->origin.Text());
    }
    text_ += line + "\n";
  }

  bool origins_;
  std::string text_;
  std::vector<Level> open_;
};

}  // namespace

namespace internal {

std::string ShowOf(Declaration declaration, const ConfigNode& node, bool origins) {
  ConfigShower shower(node, origins);
  declaration.declare(declaration.options, shower);
  return shower.Result();
}

}  // namespace internal
}  // namespace mocurate
