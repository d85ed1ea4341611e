#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

using NameFields = std::map<std::string, std::string>;

/// A path pattern with fields: "a{action}_s{person}.txt". {name} takes one or more characters (as few as possible),
/// {name:4} exactly four; never a '/'. {name?/} is a folder that may be missing, "{take?/}seq.json": the field is not
/// there then. A field that stands twice must be the same both times.
class NamePattern {
 public:
  /// Error kConfig: braces that do not close, empty or doubled-up fields side by side without a width.
  static Expected<NamePattern> Parse(const std::string& text, const std::string& where);

  /// The fields of a name; empty when it does not match.
  std::optional<NameFields> Match(std::string_view name) const;

  /// Another way to read a name that matches; empty where there is one only. "old_female_punch" is of "{person}_{pose}"
  /// person `old` by Match, `old_female` by this.
  std::optional<NameFields> OtherMatch(std::string_view name) const;

  /// Number of folders in the pattern: with those that may be missing, and without.
  int depth() const { return depth_; }
  int least_depth() const { return least_depth_; }
  std::vector<std::string> FieldNames() const;
  const std::string& text() const { return text_; }

 private:
  struct Part {
    bool is_field = false;
    std::string text;       ///< literal text, or the name of the field
    std::size_t width = 0;  ///< of a field; 0: any
    bool folder = false;    ///< with its '/', and may be missing
  };
  /// Whether `rest` is read by the parts from `part` on, otherwise than as `other_than`.
  bool MatchFrom(std::size_t part, std::string_view rest, NameFields& fields, int& budget,
                 const NameFields* other_than = nullptr) const;
  std::vector<Part> parts_;
  std::string text_;
  int depth_ = 0;
  int least_depth_ = 0;
};

/// The {field}s of a text, each once.
std::vector<std::string> FieldsOf(const std::string& text);

/// Replaces {field} and {folder?/} in `text`; a field that is not there becomes empty, a folder with its '/'.
std::string FillFields(const std::string& text, const NameFields& fields);

}  // namespace mocurate
