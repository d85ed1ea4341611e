#pragma once

#include <regex.h>

#include <memory>
#include <string>
#include <vector>

#include "canon/values/where.h"

/// The tree that where_parse.cpp makes of a condition and where.cpp evaluates.
namespace mocurate {

/// A field of a clip that a condition may use.
struct ConditionField {
  const char* name;
  bool is_text;          ///< else a number
  const char* argument;  ///< name of the argument in brackets; null: no argument
};

struct Condition::Node {
  enum class Kind { kOr, kAnd, kNot, kTest };
  enum class Test { kEqual, kNotEqual, kLess, kLessEqual, kGreater, kGreaterEqual, kMatches, kIn, kNotIn };

  Kind kind = Kind::kTest;
  std::vector<Node> parts;  ///< of or, and, not
  Test test = Test::kEqual;
  const ConditionField* field = nullptr;
  std::string argument;
  std::vector<std::string> texts;          ///< operands of a text comparison
  std::vector<double> numbers;             ///< operands of a number comparison
  std::shared_ptr<const regex_t> pattern;  ///< of kMatches
  std::size_t begin = 0, end = 0;          ///< byte range of the test in the condition's text
};

/// Column of a byte, counted from 1 in characters.
std::size_t ColumnOf(const std::string& text, std::size_t byte);

}  // namespace mocurate
