#include <algorithm>
#include <vector>

#include "core/store/hdf5_file.h"

namespace mocurate::store {

std::optional<std::string> Hdf5Reader::AttributeOf(const std::string& path, const std::string& name) const {
  SilenceHdf5();
  if (H5Aexists_by_name(id_.get(), path.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  const Hdf5Id attribute(H5Aopen_by_name(id_.get(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const Hdf5Id type(attribute.ok() ? H5Aget_type(attribute.get()) : -1, H5Tclose);
  const Hdf5Id space(attribute.ok() ? H5Aget_space(attribute.get()) : -1, H5Sclose);
  if (!type.ok() || !space.ok() || H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Sget_simple_extent_npoints(space.get()) != 1 || H5Tget_size(type.get()) > bytes_) {
    return std::string();
  }
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0) return std::string();
  return text.substr(0, text.find('\0'));
}

std::vector<std::string> Hdf5Reader::GroupsBelow(const std::string& group) const {
  std::vector<std::string> names;
  if (!Has(group)) return names;
  SilenceHdf5();
  const Hdf5Id id(H5Gopen2(id_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!id.ok()) return names;
  const auto visit = [](hid_t parent, const char* name, const H5L_info_t* link, void* data) -> herr_t {
    if (link->type != H5L_TYPE_HARD) return 0;
    const Hdf5Id child(H5Gopen2(parent, name, H5P_DEFAULT), H5Gclose);
    if (child.ok()) static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  H5Literate(id.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit, &names);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Hdf5Reader::AllPaths() const {
  SilenceHdf5();
  std::vector<std::string> paths;
  const auto visit_object = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    if (info->type == H5O_TYPE_DATASET)
      static_cast<std::vector<std::string>*>(data)->push_back("/" + std::string(name));
    return 0;
  };
  H5Ovisit2(id_.get(), H5_INDEX_NAME, H5_ITER_NATIVE, visit_object, &paths, H5O_INFO_BASIC);
  const auto visit_attribute = [](hid_t, const char* name, const H5A_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->push_back("/@" + std::string(name));
    return 0;
  };
  H5Aiterate_by_name(id_.get(), "/", H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit_attribute, &paths, H5P_DEFAULT);
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace mocurate::store
