#include <algorithm>
#include <utility>

#include "core/base/file.h"
#include "core/store/hdf5_file.h"
#include "core/store/hdf5_values.h"

namespace mocurate::store {
namespace {

tl::unexpected<Error> Broken(const std::string& path, const std::string& what) {
  return Fail(ErrorCode::kCannotWrite, what + " in the HDF5 file", path, "memory may be exhausted");
}

/// Properties of an object: no times, links and attributes in the object's own header.
Hdf5Id Untimed(hid_t kind) {
  Hdf5Id properties(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  H5Pset_attr_phase_change(properties.get(), 32, 16);
  return properties;
}

Hdf5Id TextType(std::size_t length) {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

/// Of numbers.
hid_t FileType(FieldType type) {
  const hid_t types[] = {H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_STD_I32LE, H5T_STD_I64LE, H5T_STD_U8LE};
  return types[static_cast<std::size_t>(type)];
}

struct Block {
  Hdf5Id text_type;
  std::string padded;
};

/// Texts side by side, zero-padded to the longest.
Block Pad(const std::vector<std::string>& texts) {
  Block block;
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  block.padded.assign(longest * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) {
    std::copy(texts[i].begin(), texts[i].end(), block.padded.begin() + static_cast<std::ptrdiff_t>(i * longest));
  }
  block.text_type = TextType(longest);
  return block;
}

}  // namespace

Expected<Hdf5Writer> Hdf5Writer::Create(const std::filesystem::path& path) {
  SilenceHdf5();
  auto file = PendingFile::CreateOutput(path);
  if (!file) return Forward(file);
  Hdf5Writer writer(path, std::move(*file));
  writer.driver_file_->descriptor = writer.file_.descriptor();
  const Hdf5Id access(DescriptorAccess(*writer.driver_file_), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const Hdf5Id creation = Untimed(H5P_FILE_CREATE);
  H5Pset_link_phase_change(creation.get(), 64, 48);
  writer.id_ = Hdf5Id(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  if (!writer.id_.ok()) return Broken("/", "no file can be made");
  return writer;
}

Status Hdf5Writer::MakeGroups(const std::string& path) {
  const Hdf5Id properties = Untimed(H5P_GROUP_CREATE);
  H5Pset_link_phase_change(properties.get(), 64, 48);
  for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    if (H5Lexists(id_.get(), part.c_str(), H5P_DEFAULT) > 0) continue;
    const Hdf5Id group(H5Gcreate2(id_.get(), part.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose);
    if (!group.ok()) return Broken(part, "the group cannot be made");
  }
  return {};
}

Status Hdf5Writer::PutAttribute(hid_t object, const std::string& name, const std::string& text,
                                const std::string& path) {
  if (text.size() > kLongestAttribute) {
    return Fail(ErrorCode::kInconsistent,
                "has " + std::to_string(text.size()) + " bytes; an attribute holds at most " +
                    std::to_string(kLongestAttribute),
                path);
  }
  const Block block = Pad({text});
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const bool known = H5Aexists(object, name.c_str()) > 0;
  const Hdf5Id attribute(
      known ? H5Aopen(object, name.c_str(), H5P_DEFAULT)
            : H5Acreate2(object, name.c_str(), block.text_type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (!attribute.ok() || H5Awrite(attribute.get(), block.text_type.get(), block.padded.data()) < 0) {
    return Broken(path, "the attribute cannot be written");
  }
  return {};
}

Expected<Hdf5Id> Hdf5Writer::MakeDataset(const std::string& path, hid_t type, const std::vector<std::uint64_t>& shape) {
  SilenceHdf5();
  if (Status made = MakeGroups(path); !made) return Forward(made);
  const Hdf5Id space = SpaceOf(shape);
  const Hdf5Id properties = Untimed(H5P_DATASET_CREATE);
  H5Pset_layout(properties.get(), H5D_CONTIGUOUS);
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  // HDF5 needs a defined first value of texts of variable length.
  if (H5Tis_variable_str(type) <= 0) H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);
  Hdf5Id dataset(H5Dcreate2(id_.get(), path.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                 H5Dclose);
  if (!dataset.ok()) return Broken(path, "the dataset cannot be made");
  return dataset;
}

Status Hdf5Writer::Write(const std::string& path, const Array& array) {
  SilenceHdf5();
  if (path.rfind("/@", 0) == 0) return PutAttribute(id_.get(), path.substr(2), array.as<std::string>().at(0), path);
  Block block;
  if (array.type() == FieldType::kText) block = Pad(array.as<std::string>());
  const void* data = std::visit([](const auto& held) { return static_cast<const void*>(held.data()); }, array.values);
  if (block.text_type.ok()) data = block.padded.data();
  const hid_t type = block.text_type.ok() ? block.text_type.get() : FileType(array.type());
  const auto dataset = MakeDataset(path, type, array.shape);
  if (!dataset) return Forward(dataset);
  if (array.size() > 0 && H5Dwrite(dataset->get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    return Broken(path, "the values cannot be written");
  }
  return Written();
}

Status Hdf5Writer::Make(const std::string& path, FieldType type, const std::vector<std::uint64_t>& shape) {
  auto dataset = MakeDataset(path, FileType(type), shape);
  if (!dataset) return Forward(dataset);
  made_[path] = std::move(*dataset);
  return Written();
}

Status Hdf5Writer::WriteRows(const std::string& path, std::uint64_t first, const Array& rows) {
  SilenceHdf5();
  if (rows.size() == 0) return {};
  const Hdf5Id& dataset = made_.at(path);
  const Hdf5Id memory = SpaceOf(rows.shape), space(H5Dget_space(dataset.get()), H5Sclose);
  const void* data = std::visit([](const auto& held) { return static_cast<const void*>(held.data()); }, rows.values);
  if (!SelectRows(space.get(), first, rows.shape) ||
      H5Dwrite(dataset.get(), FileType(rows.type()), memory.get(), space.get(), H5P_DEFAULT, data) < 0) {
    return Broken(path, "the values cannot be written");
  }
  return Written();
}

Status Hdf5Writer::AttributeOf(const std::string& path, const std::string& name, const std::string& text) {
  SilenceHdf5();
  const Hdf5Id object(H5Oopen(id_.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  return PutAttribute(object.get(), name, text, path);
}

Status Hdf5Writer::Written() const {
  return driver_file_->error == 0 ? Status() : CannotWriteFile(path_, driver_file_->error);
}

Status Hdf5Writer::Finish() {
  SilenceHdf5();
  made_.clear();
  if (H5Fflush(id_.get(), H5F_SCOPE_GLOBAL) < 0) return Broken("/", "the file cannot be finished");
  driver_file_->finished = true;  // what HDF5 writes when it closes is not part of the file
  if (Status written = Written(); !written) return written;
  return file_.Publish();
}

}  // namespace mocurate::store
