#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace mocurate::golden {

/// An array of a golden file, row-major.
template <class T>
struct Array {
  std::vector<hsize_t> shape;
  std::vector<T> values;

  std::size_t rows() const { return shape.empty() ? 0 : static_cast<std::size_t>(shape[0]); }
  /// Numbers per row (product of all extents but the first).
  std::size_t row_size() const { return rows() == 0 ? 0 : values.size() / rows(); }
  const T* row(std::size_t index) const { return values.data() + index * row_size(); }
  const T& operator[](std::size_t index) const { return values[index]; }
};

namespace internal {

/// An HDF5 handle that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: stands in for the C handle
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Keeps HDF5 from printing its own error stack: the exception carries our message.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

inline std::vector<hsize_t> ShapeOf(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> shape(rank > 0 ? static_cast<std::size_t>(rank) : 0);
  if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

inline std::size_t CountOf(const std::vector<hsize_t>& shape) {
  std::size_t count = 1;
  for (const hsize_t extent : shape) count *= static_cast<std::size_t>(extent);
  return count;
}

/// Texts of a dataset or attribute. `read` fills a buffer of a memory type.
template <class Read>
std::vector<std::string> ReadTexts(hid_t type, hid_t space, std::size_t count, Read read) {
  std::vector<std::string> texts(count);
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> pointers(count, nullptr);
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory, H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type));
    if (read(memory, static_cast<void*>(pointers.data())) < 0) throw std::runtime_error("text cannot be read");
    for (std::size_t i = 0; i < count; ++i) texts[i] = pointers[i] == nullptr ? "" : pointers[i];
    H5Dvlen_reclaim(memory, space, H5P_DEFAULT, pointers.data());
    return texts;
  }
  const std::size_t size = H5Tget_size(type);
  std::vector<char> bytes(size * count);
  if (read(type, static_cast<void*>(bytes.data())) < 0) throw std::runtime_error("text cannot be read");
  for (std::size_t i = 0; i < count; ++i) {
    texts[i].assign(bytes.data() + i * size, size);
    texts[i].resize(std::min(texts[i].find('\0'), texts[i].size()));
  }
  return texts;
}

}  // namespace internal

/// A file of reference numbers. Throws std::runtime_error naming file and path of what is missing (a test fails with
/// that message).
class File {
 public:
  explicit File(const std::string& path) : path_(path), file_(Open(path), H5Fclose) {
    if (!file_.valid()) throw std::runtime_error("golden file " + path + " cannot be opened");
  }

  bool Has(const std::string& name) const {
    const internal::Quiet quiet;
    for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1)) {
      if (slash > 0 && H5Lexists(file_, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    }
    return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
  }

  Array<double> Doubles(const std::string& name) const { return Read<double>(name, H5T_NATIVE_DOUBLE); }
  Array<float> Floats(const std::string& name) const { return Read<float>(name, H5T_NATIVE_FLOAT); }
  Array<std::int64_t> Integers(const std::string& name) const { return Read<std::int64_t>(name, H5T_NATIVE_INT64); }

  std::vector<std::string> Strings(const std::string& name) const {
    const internal::Handle dataset = OpenDataset(name);
    const internal::Handle space(H5Dget_space(dataset), H5Sclose);
    const internal::Handle type(H5Dget_type(dataset), H5Tclose);
    if (H5Tget_class(type) != H5T_STRING) throw std::runtime_error(Place(name) + " holds no text");
    const std::size_t count = internal::CountOf(internal::ShapeOf(space));
    return internal::ReadTexts(type, space, count, [&](hid_t memory, void* buffer) {
      return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
    });
  }

  /// Names of the members of a group, sorted. "/" is the file itself.
  std::vector<std::string> Children(const std::string& name) const {
    const internal::Handle group = OpenObject(name);
    H5G_info_t info{};
    if (H5Gget_info(group, &info) < 0) throw std::runtime_error(Place(name) + " is not a group");
    std::vector<std::string> names;
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      const ssize_t size = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
      std::vector<char> text(static_cast<std::size_t>(size) + 1);
      H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text.data(), text.size(), H5P_DEFAULT);
      names.emplace_back(text.data());
    }
    return names;
  }

  bool HasAttribute(const std::string& name, const std::string& attribute) const {
    const internal::Handle object = OpenObject(name);
    return H5Aexists(object, attribute.c_str()) > 0;
  }

  std::vector<std::string> AttributeTexts(const std::string& name, const std::string& attribute) const {
    const internal::Handle object = OpenObject(name);
    const internal::Handle handle = OpenAttribute(object, name, attribute);
    const internal::Handle space(H5Aget_space(handle), H5Sclose);
    const internal::Handle type(H5Aget_type(handle), H5Tclose);
    if (H5Tget_class(type) != H5T_STRING) throw std::runtime_error(Place(name) + "@" + attribute + " holds no text");
    const std::size_t count = internal::CountOf(internal::ShapeOf(space));
    return internal::ReadTexts(type, space, count,
                               [&](hid_t memory, void* buffer) { return H5Aread(handle, memory, buffer); });
  }

  std::string AttributeText(const std::string& name, const std::string& attribute) const {
    const std::vector<std::string> texts = AttributeTexts(name, attribute);
    return texts.empty() ? std::string() : texts.front();
  }

  std::vector<double> AttributeDoubles(const std::string& name, const std::string& attribute) const {
    const internal::Handle object = OpenObject(name);
    const internal::Handle handle = OpenAttribute(object, name, attribute);
    const internal::Handle space(H5Aget_space(handle), H5Sclose);
    std::vector<double> values(internal::CountOf(internal::ShapeOf(space)));
    if (H5Aread(handle, H5T_NATIVE_DOUBLE, values.data()) < 0) {
      throw std::runtime_error(Place(name) + "@" + attribute + " holds no numbers");
    }
    return values;
  }

 private:
  static hid_t Open(const std::string& path) {
    const internal::Quiet quiet;
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }

  std::string Place(const std::string& name) const { return path_ + ":" + name; }

  internal::Handle OpenDataset(const std::string& name) const {
    const internal::Quiet quiet;
    internal::Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) throw std::runtime_error(Place(name) + ": the dataset does not exist");
    return dataset;
  }

  internal::Handle OpenObject(const std::string& name) const {
    const internal::Quiet quiet;
    internal::Handle object(H5Oopen(file_, name.empty() ? "/" : name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.valid()) throw std::runtime_error(Place(name) + ": the object does not exist");
    return object;
  }

  internal::Handle OpenAttribute(hid_t object, const std::string& name, const std::string& attribute) const {
    const internal::Quiet quiet;
    internal::Handle handle(H5Aopen(object, attribute.c_str(), H5P_DEFAULT), H5Aclose);
    if (!handle.valid()) throw std::runtime_error(Place(name) + "@" + attribute + ": the attribute does not exist");
    return handle;
  }

  template <class T>
  Array<T> Read(const std::string& name, hid_t memory_type) const {
    const internal::Handle dataset = OpenDataset(name);
    const internal::Handle space(H5Dget_space(dataset), H5Sclose);
    Array<T> array;
    array.shape = internal::ShapeOf(space);
    array.values.resize(internal::CountOf(array.shape));
    if (array.values.empty()) return array;
    const internal::Quiet quiet;
    if (H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0) {
      throw std::runtime_error(Place(name) + " cannot be read as numbers");
    }
    return array;
  }

  std::string path_;
  internal::Handle file_;
};

/// Folder of the goldens, or null when MOCURATE_GOLDENS is not set.
inline const char* Folder() { return std::getenv("MOCURATE_GOLDENS"); }

inline std::string PathOf(const std::string& file) { return std::string(Folder()) + "/" + file; }

}  // namespace mocurate::golden

namespace mocurate {
using Golden = golden::File;
}  // namespace mocurate

/// Ends the test as skipped unless MOCURATE_GOLDENS names the folder of reference numbers.
#define MOCURATE_NEEDS_GOLDENS()                                           \
  if (::mocurate::golden::Folder() == nullptr) {                           \
    GTEST_SKIP() << "MOCURATE_GOLDENS (folder of the goldens) is not set"; \
  }                                                                        \
  static_assert(true, "")
