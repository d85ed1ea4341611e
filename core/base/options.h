#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Unit an option is kept in. A config may write any unit of the same dimension ("30 mm" for kMetre); a plain number is
/// taken in this unit.
enum class Unit {
  kNone,
  kMetre,
  kSecond,
  kRadian,
  kHertz,
  kMetrePerSecond,
  kRadianPerSecond,
  kPixel,
  kByte,
};

/// Allowed range of a number, both ends included; absent means unbounded.
struct Range {
  std::optional<double> min;
  std::optional<double> max;
};

/// Visits the options of a struct one by one, in declaration order. An options struct declares itself once, in
///
///     void TrimOptions::Declare(OptionVisitor& v) {
///       v.Bool("enabled", enabled, "cut still frames from both ends");
///       v.Number("still_speed", still_speed, Unit::kMetrePerSecond, {0.0, 10.0}, "joints slower than this are still");
///     }
///
/// and from that come strict YAML reading, JSON writing and reading, `config show`, the JSON Schema and the reference.
/// The value a member holds when the visitor arrives is its default.
class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;

  virtual void Bool(const char* name, bool& value, const char* help) = 0;
  virtual void Integer(const char* name, std::int64_t& value, Range range, const char* help) = 0;
  virtual void Number(const char* name, double& value, Unit unit, Range range, const char* help) = 0;
  virtual void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range range,
                              const char* help) = 0;
  virtual void Text(const char* name, std::string& value, const char* help) = 0;
  /// A file or folder; relative paths are relative to the config file that sets them.
  virtual void Path(const char* name, std::filesystem::path& value, const char* help) = 0;
  virtual void Numbers(const char* name, std::vector<double>& value, Unit unit, Range range, const char* help) = 0;
  virtual void Texts(const char* name, std::vector<std::string>& value, const char* help) = 0;
  /// A mapping with keys chosen by the user, e.g. activity code -> label.
  virtual void TextMap(const char* name, std::map<std::string, std::string>& value, const char* help) = 0;
  /// One of `names`; `index` is the position of the chosen one.
  virtual void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names,
                           const char* help) = 0;

  /// An option that had this name: readers refuse it with its name now, to all else it does not exist.
  virtual void Renamed(const char* name, const char* now) { static_cast<void>(name), static_cast<void>(now); }

  virtual void BeginGroup(const char* name, const char* help) = 0;
  virtual void EndGroup() = 0;

  /// A list of groups: returns the number of elements to visit (a reader returns the number found, a writer `size`).
  virtual std::size_t BeginList(const char* name, std::size_t size, const char* help) = 0;
  virtual void BeginElement(std::size_t index) = 0;
  virtual void EndElement() = 0;
  virtual void EndList() = 0;
  /// A list of texts, each one of `names`. Readers refuse others; to all else it is a list of texts.
  virtual void ChoiceList(const char* name, std::vector<std::string>& value, const std::vector<std::string>& names,
                          const char* help) {
    static_cast<void>(names);
    Texts(name, value, help);
  }
  /// Whether the list just begun is replaced: its elements start from the defaults of their struct.
  virtual bool ReplacesList() const { return false; }

  /// An enumeration: `v.Choice("loss", loss, {{"mse", Loss::kMse}, {"huber", Loss::kHuber}}, "...")`.
  template <class E>
  void Choice(const char* name, E& value, const std::vector<std::pair<std::string, E>>& choices, const char* help) {
    std::vector<std::string> names;
    std::size_t index = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      names.push_back(choices[i].first);
      if (choices[i].second == value) index = i;
    }
    ChoiceIndex(name, index, names, help);
    value = choices[index].second;
  }

  /// The same for names stored as text; an unknown name becomes the first.
  void OneOf(const char* name, std::string& value, const std::vector<std::string>& names, const char* help) {
    std::size_t index = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == value) index = i;
    }
    ChoiceIndex(name, index, names, help);
    value = names[index];
  }

  /// A nested options struct (anything with Declare).
  template <class Options>
  void Group(const char* name, Options& options, const char* help) {
    BeginGroup(name, help);
    options.Declare(*this);
    EndGroup();
  }

  template <class Options>
  void List(const char* name, std::vector<Options>& options, const char* help) {
    const std::size_t count = BeginList(name, options.size(), help);
    if (ReplacesList()) options.clear();
    options.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      BeginElement(i);
      options[i].Declare(*this);
      EndElement();
    }
    EndList();
  }
};

namespace internal {
struct Declaration {
  void* options;
  void (*declare)(void* options, OptionVisitor& visitor);
};
nlohmann::json ToJson(Declaration declaration);
Status FromJson(Declaration declaration, const nlohmann::json& json, const std::string& where);
template <class Options>
Declaration DeclarationOf(Options& options) {
  return {&options, [](void* o, OptionVisitor& v) { static_cast<Options*>(o)->Declare(v); }};
}
}  // namespace internal

/// All options with their values, defaults included: the canonical form that cache keys are made from.
/// Returns nlohmann::json, which the caller includes.
template <class Options>
auto OptionsToJson(const Options& options) {
  Options copy = options;
  return internal::ToJson(internal::DeclarationOf(copy));
}

/// Strict: unknown keys, wrong types and values out of range are errors, all reported at once. Missing keys keep their
/// defaults; a list that is given replaces the default list.
template <class Options>
Expected<Options> OptionsFromJson(const nlohmann::json& json, const std::string& where = "options") {
  Options options;
  if (Status read = internal::FromJson(internal::DeclarationOf(options), json, where); !read) {
    return tl::unexpected<Error>(read.error());
  }
  return options;
}

}  // namespace mocurate
