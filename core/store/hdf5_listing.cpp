#include <algorithm>
#include <vector>

#include "core/store/hdf5_file.h"
#include "core/store/hdf5_values.h"

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

std::vector<std::string> AttributesOf(hid_t object) {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5A_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  if (object >= 0) H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit, &names);
  return names;
}

namespace {

constexpr std::size_t kDeepestGroup = 64;  // no format nests deeper; the walk keeps each of them open

/// A walk through the objects of a file.
struct Walker {
  const std::function<void(const std::string&, hid_t, H5O_type_t)>& visit;
  std::uint64_t left;              ///< bytes that more paths may take
  std::set<haddr_t> seen = {};     ///< objects: a group may hold itself
  std::vector<std::size_t> above;  ///< lengths of the paths of the groups around
  std::string path = {};
  std::string fault = {};

  /// 0, or that the walk ends.
  herr_t Object(hid_t file, haddr_t address) {
    if (!seen.insert(address).second) return 0;
    const Hdf5Id object(H5Oopen_by_addr(file, address), H5Oclose);
    H5O_info_t info{};
    if (!object.ok() || H5Oget_info2(object.get(), &info, H5O_INFO_BASIC) < 0) return 0;
    visit(path, object.get(), info.type);
    if (info.type != H5O_TYPE_GROUP) return 0;
    if (above.size() == kDeepestGroup) {
      fault = "holds groups inside each other, more than " + std::to_string(kDeepestGroup) + " deep";
      return 1;
    }
    above.push_back(path.size());
    const auto link = [](hid_t group, const char* name, const H5L_info_t* found, void* data) -> herr_t {
      auto& own = *static_cast<Walker*>(data);
      own.path.resize(own.above.back());
      own.path += "/" + std::string(name);
      if (own.path.size() > own.left) {
        own.fault = "holds objects whose paths take more memory than a file of its size may";
        return 1;
      }
      own.left -= own.path.size();
      if (found->type == H5L_TYPE_HARD) return own.Object(group, found->u.address);
      own.visit(own.path, -1, H5O_TYPE_UNKNOWN);
      return 0;
    };
    const herr_t ended = H5Literate(object.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, link, this);
    above.pop_back();
    return ended;
  }
};

}  // namespace

Status Hdf5Reader::Walk(const std::function<void(const std::string&, hid_t, H5O_type_t)>& visit) const {
  SilenceHdf5();
  H5O_info_t root{};
  if (H5Oget_info2(id_.get(), &root, H5O_INFO_BASIC) < 0) {
    return Fail(ErrorCode::kMalformed, "cannot be listed: " + Reason(), WhereOf("/"));
  }
  Walker walker{visit, MostUnpacked(bytes_), {}, {}, {}, {}};
  walker.Object(id_.get(), root.addr);
  if (walker.fault.empty()) return {};
  return Fail(ErrorCode::kMalformed, walker.fault, WhereOf(walker.path.substr(0, 200)), "remove the groups");
}

Expected<std::vector<std::string>> Hdf5Reader::AllPaths() const {
  std::vector<std::string> paths;
  const Status whole = Walk([&paths](const std::string& path, hid_t object, H5O_type_t type) {
    if (type == H5O_TYPE_DATASET) paths.push_back(path);
    if (!path.empty()) return;
    for (const std::string& name : AttributesOf(object)) paths.push_back("/@" + name);
  });
  if (!whole) return Forward(whole);
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace mocurate::store
