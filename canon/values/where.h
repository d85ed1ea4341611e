#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// A condition about the clips of a dataset: `label in [walk, run] and frames >= 60 and not person == P12`.
///
///     condition := both ('or' both)*        both := one ('and' one)*        one := 'not' one | '(' condition ')' |
///     test test := field ('==' | '!=' | '<' | '<=' | '>' | '>=') value | field '=~' regex | field ['not'] 'in' '['
///     values ']'
///
/// Fields that are texts: id, label, fine_label, person, recording, session, view, source, role, licence, part('SPLIT')
/// (train, validation, test, or '' for none), provenance('KEY'). Numbers: frames, seconds, rate (Hz), fit_rms (m),
/// confidence (of estimated cuts), findings('CODE') and segments('LABEL'), both counts. Values are numbers, fractions
/// (30000/1001), words, or texts in single or double quotes. `=~` looks for a POSIX extended regular expression
/// anywhere in a text.
class Condition {
 public:
  /// A value that no clip has, so that its test never matches: most often a typing error.
  struct UnknownValue {
    std::string field;
    std::string value;
    std::optional<std::string> nearest;  ///< nearest value of a clip
  };

  /// Error kUsage; its place is `place` and the column, counted from 1 in characters: "--where:12".
  static Expected<Condition> Parse(const std::string& text, const std::string& place = "--where");

  /// For each clip whether it matches; of motions only frame_count() and rate are used. Error kUsage for a split that
  /// the dataset lacks.
  Expected<std::vector<bool>> Holds(const Dataset& dataset) const;

  /// Every test as it is written, and the number of clips that it matches. Error as Holds.
  Expected<std::vector<std::pair<std::string, std::size_t>>> CountTests(const Dataset& dataset) const;

  /// Number of tests.
  std::size_t tests() const;

  /// Values of ==, != and in that no clip of a non-empty dataset has; the first ten with the nearest.
  std::vector<UnknownValue> FindUnknownValues(const Dataset& dataset) const;

  const std::string& text() const { return text_; }

  struct Node;

 private:
  Condition(std::string text, std::string place, std::shared_ptr<const Node> root)
      : text_(std::move(text)), place_(std::move(place)), root_(std::move(root)) {}

  std::string text_, place_;
  std::shared_ptr<const Node> root_;
};

}  // namespace mocurate
