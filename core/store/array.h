#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/store/extra_field.h"

namespace mocurate {
class Sha256;
}

namespace mocurate::store {

/// Types a field may have in the file; the order is that of Array::values.
enum class FieldType { kFloat32, kFloat64, kInt32, kInt64, kUint8, kText };

/// "f4", "f8", "i4", "i8", "u1", "text".
std::string_view Name(FieldType type);

/// Values of one field, row-major. An empty shape is a scalar.
struct Array {
  std::vector<std::uint64_t> shape;
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::int64_t>,
               std::vector<std::uint8_t>, std::vector<std::string>>
      values;

  FieldType type() const { return static_cast<FieldType>(values.index()); }
  /// Number of values the shape announces.
  std::uint64_t count() const;
  /// Number of values held.
  std::uint64_t size() const;
  std::uint64_t rows() const { return shape.empty() ? 1 : shape[0]; }
  template <class T>
  const std::vector<T>& as() const {
    return std::get<std::vector<T>>(values);
  }
  /// "(120, 24, 3)".
  std::string ShapeText() const;
  /// SHA-256 of the values: little-endian numbers; of texts, each followed by a zero byte.
  std::string Sha256() const;
  void AddTo(mocurate::Sha256& hasher) const;
};

bool operator==(const Array& a, const Array& b);

template <class T>
Array MakeArray(std::vector<std::uint64_t> shape, std::vector<T> values) {
  return Array{std::move(shape), std::move(values)};
}
Array MakeText(std::string text);
/// Type and shape alone.
Array EmptyArray(FieldType type, std::vector<std::uint64_t> shape);

/// All fields of a file by path ("/frames/joints"; attributes of the root as "/@schema"), in byte order of the paths.
struct Content {
  std::map<std::string, Array> fields;
  std::set<std::string> splits;  ///< names that replace * in the paths of the table
  std::set<std::string> later;   ///< fields whose type and shape alone are here: their rows come later
  ExtraFields extra;             ///< beyond the table; rows of those without values come later

  const Array* Find(const std::string& path) const;
  bool Has(const std::string& path) const { return Find(path) != nullptr; }
  template <class T>
  const std::vector<T>& Values(const std::string& path) const {
    return fields.at(path).template as<T>();
  }
  /// A scalar text; empty when absent.
  std::string Text(const std::string& path) const;
  template <class T>
  void Put(const std::string& path, std::vector<std::uint64_t> shape, std::vector<T> values) {
    fields[path] = MakeArray(std::move(shape), std::move(values));
  }
  void PutText(const std::string& path, std::string text) { fields[path] = MakeText(std::move(text)); }
};

/// Identifies the whole content: SHA-256 over one line "path type shape sha256\n" per field in byte order of the
/// paths, without "/@content_sha256".
std::string ContentSha256(const std::map<std::string, std::string>& lines);
/// The line of one field, without its path: " f4 120,24,3 <64 digits>".
std::string FieldLine(const Array& array, const std::string& sha256);

}  // namespace mocurate::store
