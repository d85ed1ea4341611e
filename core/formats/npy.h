#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One numpy array. `values` are in C order whatever the file's order; integers beyond 2^53 lose their last digits.
struct NpyArray {
  std::vector<std::size_t> shape;  ///< empty for a single number
  std::string dtype;               ///< as in the file: "<f4", ">i8", ...
  std::vector<double> values;

  std::size_t size() const { return values.size(); }
};

/// Format versions 1 to 3; f4, f8, i4, i8 in both byte orders, C and Fortran order. Error kMalformed for anything that
/// contradicts itself or is cut off, kUnsupported for other types; arrays of Python objects are never executed. What is
/// allocated is bounded by the size of `bytes`.
Expected<NpyArray> ParseNpy(std::string_view bytes, const std::string& name);

/// Version 1.0, little-endian "<f8" or "<f4", C order.
std::string WriteNpy(const NpyArray& array);

}  // namespace mocurate
