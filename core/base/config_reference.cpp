#include "core/base/config_parts.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

/// Text for a cell of a Markdown table.
std::string Cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

std::string Code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

/// Writes one row of a Markdown table per option.
class ReferenceWriter final : public OptionVisitor {
 public:
  std::string Result() { return std::move(rows_); }

  void Bool(const char* name, bool& value, const char* help) override {
    Row(name, "truth value", "", value ? "true" : "false", "", help);
  }
  void Integer(const char* name, std::int64_t& value, Range range, const char* help) override {
    Row(name, "whole number", "", std::to_string(value), RangeText(range, Unit::kNone), help);
  }
  void Number(const char* name, double& value, Unit unit, Range range, const char* help) override {
    Row(name, "number", mocurate::Name(unit), QuantityText(value, unit), RangeText(range, unit), help);
  }
  void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range range,
                      const char* help) override {
    Row(name, "number or null", mocurate::Name(unit), value ? QuantityText(*value, unit) : "null",
        RangeText(range, unit), help);
  }
  void Text(const char* name, std::string& value, const char* help) override {
    Row(name, "text", "", value.empty() ? "''" : value, "", help);
  }
  void Path(const char* name, std::filesystem::path& value, const char* help) override {
    Row(name, "path", "", value.empty() ? "''" : DisplayPath(value), "", help);
  }
  void Numbers(const char* name, std::vector<double>& value, Unit unit, Range range, const char* help) override {
    std::string list;
    for (const double number : value) list += (list.empty() ? "" : ", ") + QuantityText(number, unit);
    Row(name, "list of numbers", mocurate::Name(unit), "[" + list + "]", RangeText(range, unit), help);
  }
  void Texts(const char* name, std::vector<std::string>& value, const char* help) override {
    Row(name, "list of texts", "", "[" + JoinTexts(value) + "]", "", help);
  }
  void TextMap(const char* name, std::map<std::string, std::string>& value, const char* help) override {
    std::string map;
    for (const auto& [key, text] : value) map += (map.empty() ? "" : ", ") + key + ": " + text;
    Row(name, "mapping of texts", "", "{" + map + "}", "", help);
  }
  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names,
                   const char* help) override {
    Row(name, "choice", "", names[index], JoinTexts(names), help);
  }

  void ChoiceList(const char* name, std::vector<std::string>& value, const std::vector<std::string>& names,
                  const char* help) override {
    Row(name, "list of choices", "", "[" + JoinTexts(value) + "]", JoinTexts(names), help);
  }

  void BeginGroup(const char* name, const char* help) override {
    Row(name, "group", "", "", "", help);
    prefixes_.push_back(Prefix() + name + ".");
  }
  void EndGroup() override { prefixes_.pop_back(); }
  std::size_t BeginList(const char* name, std::size_t, const char* help) override {
    Row(name, "list of groups", "", "", "", help);
    prefixes_.push_back(Prefix() + name + "[].");
    return 1;
  }
  bool ReplacesList() const override { return true; }
  void BeginElement(std::size_t) override {}
  void EndElement() override {}
  void EndList() override { prefixes_.pop_back(); }

 private:
  std::string Prefix() const { return prefixes_.empty() ? "" : prefixes_.back(); }

  void Row(const std::string& name, std::string_view type, std::string_view unit, const std::string& value,
           const std::string& allowed, std::string_view help) {
    rows_ += "| " + Code(Prefix() + name) + " | " + std::string(type) + " | " + std::string(unit) + " | " +
             Cell(Code(value)) + " | " + Cell(allowed) + " | " + Cell(help) + " |\n";
  }

  std::vector<std::string> prefixes_;
  std::string rows_;
};

}  // namespace

namespace internal {

std::string ReferenceOf(Declaration declaration, const std::string& title) {
  ReferenceWriter writer;
  declaration.declare(declaration.options, writer);
  return "## " + title + "\n\n| Option | Type | Unit | Default | Allowed | Meaning |\n|---|---|---|---|---|---|\n" +
         writer.Result();
}

}  // namespace internal
}  // namespace mocurate
