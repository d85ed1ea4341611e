#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/options.h"
#include "core/base/problem_list.h"
#include "core/base/text.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

using nlohmann::json;

std::string Shown(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// Reads every option it visits from the innermost open value; absent options keep what they hold.
class JsonReader final : public OptionVisitor {
 public:
  JsonReader(const json& root, const std::string& where) { Open(&root, where); }

  Status Finish() {
    Close();
    return problems_.Result();
  }

  void Bool(const char* name, bool& value, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    if (!found->is_boolean()) return Refuse(name, *found, "must be true or false");
    value = found->get<bool>();
  }

  void Integer(const char* name, std::int64_t& value, Range range, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    if (!found->is_number_integer()) return Refuse(name, *found, "must be a whole number");
    const bool fits = !found->is_number_unsigned() || found->get<std::uint64_t>() <= std::uint64_t{INT64_MAX};
    if (!fits || !IsInside(found->get<double>(), range)) return RefuseRange(name, *found, range, Unit::kNone);
    value = found->get<std::int64_t>();
  }

  void Number(const char* name, double& value, Unit unit, Range range, const char*) override {
    if (const json* found = Find(name)) ReadNumber(name, *found, unit, range, value);
  }

  void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range range, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    value.reset();
    double number = 0.0;
    if (!found->is_null() && ReadNumber(name, *found, unit, range, number)) value = number;
  }

  void Text(const char* name, std::string& value, const char*) override {
    if (const json* found = Find(name)) ReadText(name, *found, value);
  }

  void Path(const char* name, std::filesystem::path& value, const char*) override {
    std::string text;
    const json* found = Find(name);
    if (found != nullptr && ReadText(name, *found, text)) value = PathFromText(text);
  }

  void Numbers(const char* name, std::vector<double>& value, Unit unit, Range range, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    if (!found->is_array()) return Refuse(name, *found, "must be a list of numbers");
    std::vector<double> numbers(found->size());
    bool good = true;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      good = ReadNumber(Indexed(name, i), (*found)[i], unit, range, numbers[i]) && good;
    }
    if (good) value = std::move(numbers);
  }

  void Texts(const char* name, std::vector<std::string>& value, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    if (!found->is_array()) return Refuse(name, *found, "must be a list of texts");
    std::vector<std::string> texts(found->size());
    bool good = true;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      good = ReadText(Indexed(name, i), (*found)[i], texts[i]) && good;
    }
    if (good) value = std::move(texts);
  }

  void TextMap(const char* name, std::map<std::string, std::string>& value, const char*) override {
    const json* found = Find(name);
    if (found == nullptr) return;
    if (!found->is_object()) return Refuse(name, *found, "must be a mapping of texts");
    std::map<std::string, std::string> texts;
    bool good = true;
    for (const auto& [key, text] : found->items()) {
      good = ReadText(std::string(name) + "." + key, text, texts[key]) && good;
    }
    if (good) value = std::move(texts);
  }

  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names, const char*) override {
    std::string text;
    const json* found = Find(name);
    if (found == nullptr || !ReadText(name, *found, text)) return;
    const auto chosen = std::find(names.begin(), names.end(), text);
    if (chosen == names.end()) {
      return problems_.Add(Where(name), "unknown value '" + text + "'", HintFor(text, names));
    }
    index = static_cast<std::size_t>(chosen - names.begin());
  }

  void ChoiceList(const char* name, std::vector<std::string>& value, const std::vector<std::string>& names,
                  const char* help) override {
    std::vector<std::string> texts = value;
    Texts(name, texts, help);
    bool known = true;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (std::find(names.begin(), names.end(), texts[i]) != names.end()) continue;
      problems_.Add(Where(Indexed(name, i)), "unknown value '" + texts[i] + "'", HintFor(texts[i], names));
      known = false;
    }
    if (known) value = std::move(texts);
  }

  void BeginGroup(const char* name, const char*) override {
    const json* found = Find(name);
    Open(found, Where(name));
  }
  void EndGroup() override { Close(); }

  std::size_t BeginList(const char* name, std::size_t size, const char*) override {
    const json* found = Find(name);
    if (found != nullptr && !found->is_array()) {
      Refuse(name, *found, "must be a list");
      found = nullptr;
    }
    lists_.push_back({found, Where(name)});
    return found != nullptr ? found->size() : size;
  }
  bool ReplacesList() const override { return lists_.back().array != nullptr; }
  void BeginElement(std::size_t index) override {
    const List& list = lists_.back();
    Open(list.array != nullptr ? &(*list.array)[index] : nullptr, Indexed(list.where, index));
  }
  void EndElement() override { Close(); }
  void EndList() override { lists_.pop_back(); }

 private:
  struct Level {
    const json* object;  ///< null when absent
    std::string where;
    std::vector<std::string> names = {};  ///< options visited
  };
  struct List {
    const json* array;  ///< null when absent
    std::string where;
  };

  static std::string Indexed(const std::string& name, std::size_t index) {
    return name + "[" + std::to_string(index) + "]";
  }

  std::string Where(const std::string& name) const {
    const std::string& outer = levels_.back().where;
    return outer.empty() ? name : outer + "." + name;
  }

  void Open(const json* object, const std::string& where) {
    if (object != nullptr && !object->is_object()) {
      problems_.Add(where, Shown(*object) + " must be a mapping");
      object = nullptr;
    }
    levels_.push_back({object, where});
  }

  void Close() {
    const Level level = std::move(levels_.back());
    levels_.pop_back();
    if (level.object == nullptr) return;
    for (const auto& [key, ignored] : level.object->items()) {
      bool known = false;
      for (const std::string& name : level.names) known = known || name == key;
      if (!known) problems_.Add(level.where, "unknown option '" + key + "'", HintFor(key, level.names));
    }
  }

  const json* Find(const char* name) {
    Level& level = levels_.back();
    level.names.emplace_back(name);
    if (level.object == nullptr) return nullptr;
    const auto found = level.object->find(name);
    return found == level.object->end() ? nullptr : &*found;
  }

  void Refuse(const std::string& name, const json& value, const std::string& rule) {
    problems_.Add(Where(name), Shown(value) + " " + rule);
  }

  void RefuseRange(const std::string& name, const json& value, const Range& range, Unit unit) {
    const std::string rule = RangeText(range, unit);
    problems_.Add(Where(name), Shown(value) + " is out of range", rule.empty() ? "" : "allowed: " + rule);
  }

  bool ReadNumber(const std::string& name, const json& value, Unit unit, const Range& range, double& number) {
    if (!value.is_number()) {
      Refuse(name, value, "must be a number" + (unit == Unit::kNone ? "" : " in " + std::string(mocurate::Name(unit))));
      return false;
    }
    if (!IsInside(value.get<double>(), range)) {
      RefuseRange(name, value, range, unit);
      return false;
    }
    number = value.get<double>();
    return true;
  }

  bool ReadText(const std::string& name, const json& value, std::string& text) {
    if (!value.is_string()) {
      Refuse(name, value, "must be a text");
      return false;
    }
    text = value.get<std::string>();
    return true;
  }

  ProblemList problems_;
  std::vector<Level> levels_;
  std::vector<List> lists_;
};

}  // namespace

namespace internal {

Status FromJson(Declaration declaration, const json& json_value, const std::string& where) {
  JsonReader reader(json_value, where);
  declaration.declare(declaration.options, reader);
  return reader.Finish();
}

}  // namespace internal
}  // namespace mocurate
