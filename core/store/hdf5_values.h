#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/store/hdf5_file.h"

/// What the readers of values share; defined in hdf5_reader.cpp and hdf5_listing.cpp.
namespace mocurate::store {

/// Calls `work` with a value of the type; no texts.
template <class Work>
auto WithNumber(FieldType type, const Work& work) {
  switch (type) {
    case FieldType::kFloat32:
      return work(float(), H5T_NATIVE_FLOAT);
    case FieldType::kFloat64:
      return work(double(), H5T_NATIVE_DOUBLE);
    case FieldType::kInt32:
      return work(std::int32_t(), H5T_NATIVE_INT32);
    case FieldType::kInt64:
      return work(std::int64_t(), H5T_NATIVE_INT64);
    default:
      return work(std::uint8_t(), H5T_NATIVE_UINT8);
  }
}

/// An attribute must fit an object header of 64 kB.
inline constexpr std::size_t kLongestAttribute = 60000;

/// The innermost reason HDF5 gives for the last failure on this thread.
std::string Reason();
/// Product of the extents; empty on overflow.
std::optional<std::uint64_t> Product(const std::vector<hsize_t>& extents, std::uint64_t start = 1);
/// Names of the attributes of an object; none of -1.
std::vector<std::string> AttributesOf(hid_t object);
/// Without their ends.
std::uint64_t BytesOf(const std::vector<std::string>& texts);
Hdf5Id SpaceOf(const std::vector<std::uint64_t>& shape);
/// Rows [first, first + shape[0]) of a dataset's space.
bool SelectRows(hid_t space, std::uint64_t first, const std::vector<std::uint64_t>& shape);
/// Empty: no usable shape.
std::optional<std::vector<hsize_t>> ShapeOf(hid_t space);
/// Text up to the padding; empty when it contains a zero byte.
std::optional<std::string> Unpad(const char* text, std::size_t size, H5T_str_t padding);

}  // namespace mocurate::store
