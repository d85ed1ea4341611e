#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// A JSON value with the path that leads to it ("calib.json:/cameras/3/K"), for messages. Borrows the document and the
/// file's name. Every accessor fails with kMalformed at its path.
struct JsonPlace {
  const nlohmann::json* value = nullptr;
  std::string path;
  const std::string* file = nullptr;

  std::string Where() const { return *file + ":" + path; }
  tl::unexpected<Error> Bad(const std::string& rule, const std::string& hint = {}) const;

  bool Has(const std::string& key) const { return value->is_object() && value->contains(key); }
  Expected<JsonPlace> Key(const std::string& key) const;
  JsonPlace Item(std::size_t i) const { return {&(*value)[i], path + "/" + std::to_string(i), file}; }
  /// A non-empty list.
  Expected<std::vector<JsonPlace>> Items() const;

  /// Finite.
  Expected<double> Number() const;
  Expected<int> Integer(int min, int max) const;
  Expected<std::string> Text() const;
  Expected<std::vector<double>> Numbers(std::size_t count) const;
  /// `rows` lists of `columns` numbers, or, for one column, `rows` numbers as well. Row-major.
  Expected<std::vector<double>> Table(std::size_t rows, std::size_t columns) const;
  Expected<Vector3d> Vector() const;
  /// 3 x 3 that is a rotation by RotationFault, as written in the file. Error kInconsistent.
  Expected<Matrix3d> Rotation() const;
};

/// ParseJson of files of other programs: a byte order mark is skipped, and NaN, Infinity and -Infinity, which Python's
/// json writes, are read as texts of that name.
Expected<nlohmann::json> ParseLenientJson(std::string_view bytes, const std::string& name);

/// NaN or an infinity as ParseLenientJson reads them, or null, which others write in their place.
bool IsNonFinite(const nlohmann::json& value);

/// How far a matrix is from being a rotation, as words; empty when it is one to 1e-3.
std::string RotationFault(const Matrix3d& matrix);

/// place.Key(key)->X() in one step.
Expected<std::vector<double>> NumbersAt(const JsonPlace& place, const std::string& key, std::size_t count);
Expected<std::vector<double>> TableAt(const JsonPlace& place, const std::string& key, std::size_t rows,
                                      std::size_t columns);
Expected<int> IntegerAt(const JsonPlace& place, const std::string& key, int min, int max);
Expected<double> NumberAt(const JsonPlace& place, const std::string& key);
Expected<Vector3d> VectorAt(const JsonPlace& place, const std::string& key);

}  // namespace mocurate
