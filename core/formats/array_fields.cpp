#include "core/formats/array_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/formats/array_elements.h"
#include "core/formats/file_rules.h"

namespace mocurate {
namespace {

std::string PlaceText(std::size_t position, const std::vector<std::size_t>& shape) {
  std::vector<std::size_t> index(shape.size());
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    index[axis] = position % shape[axis];
    position /= shape[axis];
  }
  std::string text = "[";
  for (std::size_t axis = 0; axis < index.size(); ++axis) text += (axis > 0 ? ", " : "") + std::to_string(index[axis]);
  return text + "]";
}

}  // namespace

Status CheckField(const NpyArray& array, const std::vector<std::size_t>& wanted, const std::string& where) {
  bool fits = array.texts.empty() && array.shape.size() == wanted.size();
  for (std::size_t axis = 0; fits && axis < wanted.size(); ++axis) {
    fits = wanted[axis] == kAnyExtent || array.shape[axis] == wanted[axis];
  }
  if (!fits) {
    std::string text;
    for (const std::size_t extent : wanted) {
      text += (text.empty() ? "" : ", ") + (extent == kAnyExtent ? std::string("any") : std::to_string(extent));
    }
    return Fail(ErrorCode::kMalformed,
                (array.texts.empty() ? "numbers of shape " + ShapeText(array.shape) : std::string("texts")) +
                    " where numbers of shape (" + text + ") are expected",
                where, "check that this is the intended file, or export it again in that shape");
  }
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    if (!std::isfinite(array.values[i])) {
      return Fail(ErrorCode::kMalformed,
                  "the value at " + PlaceText(i, array.shape) + " is not finite (" +
                      (std::isnan(array.values[i]) ? "NaN" : "infinite") + ")",
                  where, "keep only the frames before or after it, interpolate it, or exclude the file");
    }
    if (std::abs(array.values[i]) > kLargestNumber) {
      return Fail(ErrorCode::kMalformed,
                  "the value at " + PlaceText(i, array.shape) + ", " + FormatDouble(array.values[i]) +
                      ", is not a plausible value",
                  where,
                  "the largest allowed number is " + FormatDouble(kLargestNumber) +
                      ": correct or remove it, or exclude the file");
    }
  }
  return {};
}

Expected<std::vector<std::int64_t>> WholeNumbers(const NpyArray& array, std::int64_t low, std::int64_t high,
                                                 const std::string& where) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(array.values.size());
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const double value = array.values[i];
    if (!(value == std::floor(value) && value >= static_cast<double>(low) && value <= static_cast<double>(high))) {
      return Fail(ErrorCode::kMalformed,
                  "the value at " + PlaceText(i, array.shape) + " is " + FormatDouble(value) +
                      ", a whole number from " + std::to_string(low) + " to " + std::to_string(high) + " is expected",
                  where);
    }
    numbers.push_back(static_cast<std::int64_t>(value));
  }
  return numbers;
}

NpyArray MakeArray(std::vector<std::size_t> shape, std::vector<double> values, const std::string& dtype) {
  NpyArray array;
  array.shape = std::move(shape);
  array.dtype = dtype;
  array.values = std::move(values);
  return array;
}

NpyArray MakeTextArray(const std::string& text) {
  NpyArray array;
  array.dtype =
      "<U" + std::to_string(std::max<std::size_t>(CodePoints(text).value_or(std::vector<std::uint32_t>()).size(), 1));
  array.texts = {text};
  return array;
}

}  // namespace mocurate
