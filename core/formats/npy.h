#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One numpy array, of numbers or of texts, in C order whatever the file's order. Integers beyond 2^53 lose their last
/// digits. Numbers are passed on unchanged, NaN and infinity too.
struct NpyArray {
  std::vector<std::size_t> shape;  ///< empty for a single number
  std::string dtype;               ///< as in the file: "<f4", ">i8", "|b1", "<U6", "|S7", ...
  std::vector<double> values;
  std::vector<std::string> texts;  ///< of "<U" (as UTF-8) and "|S" arrays, which have no values

  std::size_t size() const { return values.size() + texts.size(); }
};

/// Format versions 1 to 3; bool, i1 to i8, u1 to u8, f2, f4, f8, <U and |S in both byte orders, C and Fortran order.
/// Error kMalformed for anything that contradicts itself or is cut off, kUnsupported for other types (complex numbers,
/// dates, records); arrays of Python objects are never executed,
/// and classes they name are reported as for a pickle. Memory is bounded by the size of `bytes`.
Expected<NpyArray> ParseNpy(std::string_view bytes, const std::string& name);

/// One entry along the first axis, without that axis: of an array (clips, frames, joints, 3) the clip (frames, joints,
/// 3). In C order nothing else is decoded. Errors as of ParseNpy; kInconsistent where the entry does not exist.
Expected<NpyArray> ParseNpyEntry(std::string_view bytes, std::size_t entry, const std::string& name);

/// The pickle of an array of Python objects, which ParsePickle reads as data. Errors kMalformed; kInconsistent where
/// the array is of another type.
Expected<std::string_view> PickleOfNpy(std::string_view bytes, const std::string& name);

/// Type and shape alone; "|O" for an array of Python objects.
Expected<NpyArray> ParseNpyHeader(std::string_view bytes, const std::string& name);

/// Version 1.0 in C order, of the type `array.dtype`. Errors kUnsupported (unknown type), kInconsistent
/// (shape and number of values), kMalformed (a value that the type cannot hold).
Expected<std::string> EncodeNpy(const NpyArray& array, const std::string& name);

/// The same for "<f4" and "<f8", which hold any value; every other type is written as "<f8".
std::string WriteNpy(const NpyArray& array);

}  // namespace mocurate
