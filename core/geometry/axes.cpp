#include "core/geometry/axes.h"

#include <vector>

#include "core/base/text.h"

namespace mocurate {

Handedness AxisConvention::handedness() const {
  return canonical_from_source.determinant() > 0.0 ? Handedness::kRight : Handedness::kLeft;
}

std::string AxisConvention::Text() const {
  std::string text;
  for (int column = 0; column < 3; ++column) {
    int axis = 0;
    canonical_from_source.col(column).cwiseAbs().maxCoeff(&axis);
    if (column > 0) text += ' ';
    text += canonical_from_source(axis, column) < 0.0 ? '-' : '+';
    text += "xyz"[axis];
  }
  return text;
}

Expected<AxisConvention> AxisConvention::Parse(std::string_view text) {
  const std::string quoted = "axis convention '" + std::string(text) + "'";
  const std::string hint =
      "write the directions of the source's x, y and z, e.g. \"+x +y +z\" (y up, right-handed) or \"+x -y -z\" (y "
      "down)";
  const std::vector<std::string_view> words = SplitBlanks(Trim(text));
  if (words.size() != 3) {
    return Fail(ErrorCode::kConfig, quoted + " has " + std::to_string(words.size()) + " axes, not 3", {}, hint);
  }
  AxisConvention convention;
  convention.canonical_from_source.setZero();
  for (int column = 0; column < 3; ++column) {
    const std::string_view word = words[column];
    const bool is_axis = word.size() == 2 && (word[0] == '+' || word[0] == '-') && word[1] >= 'x' && word[1] <= 'z';
    if (!is_axis) {
      return Fail(ErrorCode::kConfig, quoted + ": '" + std::string(word) + "' is not one of +x -x +y -y +z -z", {},
                  hint);
    }
    const int axis = word[1] - 'x';
    if (!convention.canonical_from_source.row(axis).isZero()) {
      return Fail(ErrorCode::kConfig, quoted + " names " + std::string(1, word[1]) + " twice", {}, hint);
    }
    convention.canonical_from_source(axis, column) = word[0] == '-' ? -1.0 : 1.0;
  }
  return convention;
}

bool operator==(const AxisConvention& a, const AxisConvention& b) {
  return a.canonical_from_source == b.canonical_from_source;
}

}  // namespace mocurate
