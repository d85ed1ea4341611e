#pragma once

#include <regex.h>

#include <memory>
#include <string>
#include <vector>

#include "canon/values/where.h"

/// What where_parse.cpp makes of a condition and where.cpp carries out.
namespace mocurate {

/// A field of a clip that a condition may ask for.
struct ConditionField {
  const char* name;
  bool is_text;          ///< else a number
  const char* argument;  ///< what stands in the brackets after it; null: there are none
};

const std::vector<ConditionField>& ConditionFields();

struct Condition::Node {
  enum class Kind { kOr, kAnd, kNot, kTest };
  enum class Test { kEqual, kNotEqual, kLess, kLessEqual, kGreater, kGreaterEqual, kMatches, kIn, kNotIn };

  Kind kind = Kind::kTest;
  std::vector<Node> parts;  ///< of or, and, not
  Test test = Test::kEqual;
  const ConditionField* field = nullptr;
  std::string argument;
  std::vector<std::string> texts;          ///< what a text is compared with
  std::vector<double> numbers;             ///< what a number is compared with
  std::shared_ptr<const regex_t> pattern;  ///< of kMatches
  std::size_t begin = 0, end = 0;          ///< bytes of the condition's text that a test takes
};

/// A POSIX extended regular expression. Error kUsage without a place: what is none, and what might take time or memory
/// without bounds, which are back references and large or nested counts.
Expected<std::shared_ptr<const regex_t>> CompilePattern(const std::string& text);

/// Column of a byte, counted from 1 in characters.
std::size_t ColumnOf(const std::string& text, std::size_t byte);

}  // namespace mocurate
