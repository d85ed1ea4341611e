#include "core/formats/json_place.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {

using nlohmann::json;

namespace {

/// "'R', 'T'": the keys that are there where one is missing.
std::string KeysOf(const json& value) {
  constexpr std::size_t kMost = 8;
  std::string keys;
  std::size_t count = 0;
  for (const auto& item : value.items()) {
    if (++count > kMost) return keys + ", ...";
    keys += (keys.empty() ? "'" : ", '") + Shown(item.key()) + "'";
  }
  return keys;
}

/// The words that Python and JavaScript write for non-finite numbers, which JSON does not have.
constexpr std::string_view kNonFiniteWords[] = {"NaN", "Infinity", "-Infinity"};

/// JSON with these words in quotes, where they are outside of texts.
std::string QuoteNonFiniteWords(std::string_view bytes) {
  std::string text;
  bool quoted = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::string_view rest = bytes.substr(i);
    const auto* word = quoted ? std::end(kNonFiniteWords)
                              : std::find_if(std::begin(kNonFiniteWords), std::end(kNonFiniteWords),
                                             [&](std::string_view any) { return rest.substr(0, any.size()) == any; });
    if (word != std::end(kNonFiniteWords)) {
      text += '"' + std::string(*word) + '"';
      i += word->size() - 1;
      continue;
    }
    text += bytes[i];
    if (quoted && bytes[i] == '\\' && i + 1 < bytes.size())
      text += bytes[++i];
    else if (bytes[i] == '"')
      quoted = !quoted;
  }
  return text;
}

}  // namespace

bool IsNonFinite(const json& value) {
  if (value.is_null()) return true;
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return std::find(std::begin(kNonFiniteWords), std::end(kNonFiniteWords), text) != std::end(kNonFiniteWords);
}

tl::unexpected<Error> JsonPlace::Bad(const std::string& rule, const std::string& hint) const {
  return Fail(ErrorCode::kMalformed, rule, Where(), hint);
}

Expected<JsonPlace> JsonPlace::Key(const std::string& key) const {
  if (!Has(key)) {
    const bool keyed = value->is_object() && !value->empty();
    return Bad("the key '" + key + "' is missing",
               (keyed ? "there are " + KeysOf(*value) + ": " : "") + "add it, or copy the file again");
  }
  return JsonPlace{&(*value)[key], path + "/" + key, file};
}

Expected<std::vector<JsonPlace>> JsonPlace::Items() const {
  if (!value->is_array() || value->empty()) return Bad("a list that is not empty is expected");
  std::vector<JsonPlace> items;
  for (std::size_t i = 0; i < value->size(); ++i) items.push_back(Item(i));
  return items;
}

Expected<double> JsonPlace::Number() const {
  if (IsNonFinite(*value)) {
    return Bad("a finite number is expected, not " + (value->is_null() ? "null" : value->get<std::string>()),
               "write the correct number");
  }
  if (!value->is_number()) return Bad("a number is expected");
  const double number = value->get<double>();
  if (!std::isfinite(number)) return Bad("a finite number is expected");
  return number;
}

Expected<int> JsonPlace::Integer(int min, int max) const {
  const Expected<double> number = Number();
  if (!number) return Forward(number);
  if (*number < min || *number > max || *number != std::floor(*number)) {
    return Bad("a whole number from " + std::to_string(min) + " to " + std::to_string(max) + " is expected, not " +
               FormatDouble(*number));
  }
  return static_cast<int>(*number);
}

Expected<std::string> JsonPlace::Text() const {
  if (!value->is_string()) return Bad("a text is expected");
  return value->get<std::string>();
}

Expected<std::vector<double>> JsonPlace::Numbers(std::size_t count) const {
  if (!value->is_array() || value->size() != count) return Bad(std::to_string(count) + " numbers are expected");
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const Expected<double> number = Item(i).Number();
    if (!number) return Forward(number);
    numbers.push_back(*number);
  }
  return numbers;
}

Expected<std::vector<double>> JsonPlace::Table(std::size_t rows, std::size_t columns) const {
  if (!value->is_array() || value->size() != rows) {
    return Bad(std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers are expected" +
                   (value->is_array() ? ", there are " + std::to_string(value->size()) : ""),
               "correct it, or copy the file again");
  }
  std::vector<double> table;
  for (std::size_t r = 0; r < rows; ++r) {
    const JsonPlace row = Item(r);
    if (columns == 1 && (row.value->is_number() || IsNonFinite(*row.value))) {
      const Expected<double> number = row.Number();
      if (!number) return Forward(number);
      table.push_back(*number);
      continue;
    }
    const Expected<std::vector<double>> numbers = row.Numbers(columns);
    if (!numbers) return Forward(numbers);
    table.insert(table.end(), numbers->begin(), numbers->end());
  }
  return table;
}

Expected<Vector3d> JsonPlace::Vector() const {
  const Expected<std::vector<double>> numbers = Numbers(3);
  if (!numbers) return Forward(numbers);
  return Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

Expected<Matrix3d> JsonPlace::Rotation() const {
  const Expected<std::vector<double>> numbers = Table(3, 3);
  if (!numbers) return Forward(numbers);
  const Matrix3d matrix(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers->data()));
  const std::string fault = RotationFault(matrix);
  if (fault.empty()) return matrix;
  return Fail(ErrorCode::kInconsistent, fault, Where(),
              "its rows must be orthonormal: correct the number that is wrong, or copy the file again");
}

std::string RotationFault(const Matrix3d& matrix) {
  const double deviation = (matrix * matrix.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const double determinant = matrix.determinant();
  if (deviation < 1e-3 && determinant > 0.0) return {};
  return "the matrix is not a rotation (deviation " + FormatDouble(deviation) + ", determinant " +
         FormatDouble(determinant) + ")";
}

Expected<json> ParseLenientJson(std::string_view bytes, const std::string& name) {
  bytes = WithoutByteOrderMark(bytes);
  Expected<json> value = ParseJson(bytes, name);
  if (value) return value;
  Expected<json> with_words = ParseJson(QuoteNonFiniteWords(bytes), name);
  return with_words ? with_words : value;
}

Expected<std::vector<double>> NumbersAt(const JsonPlace& place, const std::string& key, std::size_t count) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Numbers(count);
}

Expected<std::vector<double>> TableAt(const JsonPlace& place, const std::string& key, std::size_t rows,
                                      std::size_t columns) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Table(rows, columns);
}

Expected<int> IntegerAt(const JsonPlace& place, const std::string& key, int min, int max) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Integer(min, max);
}

Expected<double> NumberAt(const JsonPlace& place, const std::string& key) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Number();
}

Expected<Vector3d> VectorAt(const JsonPlace& place, const std::string& key) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Vector();
}

}  // namespace mocurate
