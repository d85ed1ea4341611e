#include <algorithm>

#include "core/base/sha256.h"
#include "core/store/hdf5_file.h"
#include "core/store/hdf5_values.h"

namespace mocurate::store {

Expected<const Hdf5Reader::Rows*> Hdf5Reader::OpenRows(const std::string& path, FieldType type) const {
  SilenceHdf5();
  const auto open = rows_.find(path);
  if (open != rows_.end() && open->second.type == type) return &open->second;
  const std::string where = WhereOf(path);
  Hdf5Id dataset(H5Dopen2(id_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.ok()) return Fail(ErrorCode::kMalformed, "cannot be opened as a dataset", where);
  const Hdf5Id space(H5Dget_space(dataset.get()), H5Sclose);
  const Hdf5Id stored(H5Dget_type(dataset.get()), H5Tclose);
  const bool fits = WithNumber(type, [&](auto number, hid_t native) {
    return H5Tget_class(stored.get()) == H5Tget_class(native) && H5Tget_size(stored.get()) == sizeof(number) &&
           (H5Tget_class(native) == H5T_FLOAT || H5Tget_sign(stored.get()) == H5Tget_sign(native));
  });
  if (type == FieldType::kText || !fits) {
    return Fail(ErrorCode::kMalformed, "is of another type; the format asks for " + std::string(Name(type)), where);
  }
  const auto extents = ShapeOf(space.get());
  if (!extents || extents->empty()) return Fail(ErrorCode::kMalformed, "has no rows", where);
  const auto count = Product(*extents);
  if (!count) return Fail(ErrorCode::kMalformed, "has no usable shape", where);
  if (Status whole = CheckStorage(dataset.get(), *count, H5Tget_size(stored.get()), path); !whole)
    return Forward(whole);
  // Rows are read a clip at a time: HDF5 keeps the chunks that the last ones were in.
  const Hdf5Id creation(H5Dget_create_plist(dataset.get()), H5Pclose);
  std::vector<hsize_t> chunk(extents->size());
  if (*count > 0 && H5Pget_layout(creation.get()) == H5D_CHUNKED &&
      H5Pget_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data()) > 0) {
    std::uint64_t bytes = chunk[0] * H5Tget_size(stored.get());  // at most about those of the dataset
    for (std::size_t axis = 1; axis < chunk.size(); ++axis) {
      bytes *= ((*extents)[axis] + chunk[axis] - 1) / chunk[axis] * chunk[axis];
    }
    const Hdf5Id access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access.get(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, std::max<std::size_t>(bytes, 1 << 20), 1.0);
    dataset = Hdf5Id(H5Dopen2(id_.get(), path.c_str(), access.get()), H5Dclose);
  }
  Rows rows{type, std::move(dataset), {extents->begin(), extents->end()}};
  return &rows_.emplace(path, std::move(rows)).first->second;
}

Expected<std::vector<std::uint64_t>> Hdf5Reader::ShapeOfRows(const std::string& path, FieldType type) const {
  const auto rows = OpenRows(path, type);
  if (!rows) return Forward(rows);
  return (*rows)->shape;
}

Expected<Array> Hdf5Reader::ReadRows(const std::string& path, FieldType type, std::uint64_t first,
                                     std::uint64_t count) const {
  const auto rows = OpenRows(path, type);
  if (!rows) return Forward(rows);
  const std::string where = WhereOf(path);
  const std::vector<std::uint64_t>& shape = (*rows)->shape;
  if (first > shape.front() || count > shape.front() - first) {
    return Fail(
        ErrorCode::kMalformed,
        "has " + std::to_string(shape.front()) + " rows; those from " + std::to_string(first) + " on were requested",
        where);
  }
  const hid_t dataset = (*rows)->dataset.get();
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
  std::vector<std::uint64_t> extent = shape;
  extent[0] = count;
  std::uint64_t values = 1;
  for (const std::uint64_t size : extent) values *= size;
  const Hdf5Id memory = SpaceOf(extent);
  return WithNumber(type, [&](auto number, hid_t native) -> Expected<Array> {
    std::vector<decltype(number)> held(values);
    const bool read =
        values == 0 || (SelectRows(space.get(), first, extent) &&
                        H5Dread(dataset, native, memory.get(), space.get(), H5P_DEFAULT, held.data()) >= 0);
    if (!read) return Fail(ErrorCode::kMalformed, "values cannot be read", where);
    return MakeArray(std::move(extent), std::move(held));
  });
}

Expected<std::string> Hdf5Reader::HashOfRows(const std::string& path, FieldType type, std::uint64_t block) const {
  const auto shape = ShapeOfRows(path, type);
  if (!shape) return Forward(shape);
  std::uint64_t width = WithNumber(type, [](auto number, hid_t) { return std::uint64_t{sizeof(number)}; });
  for (std::size_t d = 1; d < shape->size(); ++d) width *= (*shape)[d];
  const std::uint64_t rows = std::max<std::uint64_t>(1, block / std::max<std::uint64_t>(1, width));
  Sha256 hasher;
  for (std::uint64_t first = 0; first < shape->front(); first += rows) {
    const auto array = ReadRows(path, type, first, std::min(rows, shape->front() - first));
    if (!array) return Forward(array);
    array->AddTo(hasher);
  }
  return hasher.Hex();
}

}  // namespace mocurate::store
