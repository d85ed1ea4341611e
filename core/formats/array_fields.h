#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/formats/npy.h"

namespace mocurate {

/// Extent that may be anything.
inline constexpr std::size_t kAnyExtent = static_cast<std::size_t>(-1);

/// Whether a named field of a file is an array of finite numbers of the wanted shape. `where` names file and field.
/// Error kMalformed with the shape, or with the place of the first value that is not finite.
Status CheckField(const NpyArray& array, const std::vector<std::size_t>& wanted, const std::string& where);

/// Whole numbers of a checked field. Error kMalformed with the place of the first value that is not whole or not in
/// [low, high].
Expected<std::vector<std::int64_t>> WholeNumbers(const NpyArray& array, std::int64_t low, std::int64_t high,
                                                 const std::string& where);

/// An array of doubles, "<f8" by default.
NpyArray MakeArray(std::vector<std::size_t> shape, std::vector<double> values, const std::string& dtype = "<f8");
/// A text without axes, "<U".
NpyArray MakeTextArray(const std::string& text);

}  // namespace mocurate
