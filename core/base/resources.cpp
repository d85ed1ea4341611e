#include "core/base/resources.h"

namespace mocurate {
namespace {

struct Resource {
  std::string_view path;
  std::string_view text;
};

constexpr Resource kResources[] = {
#include "resource_table.inc"
};

}  // namespace

std::optional<std::string_view> FindResource(std::string_view path) {
  for (const Resource& resource : kResources) {
    if (resource.path == path) return resource.text;
  }
  return std::nullopt;
}

std::vector<std::string> ResourcePaths() {
  std::vector<std::string> paths;
  for (const Resource& resource : kResources) paths.emplace_back(resource.path);
  return paths;
}

}  // namespace mocurate
