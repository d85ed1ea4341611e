#include "fitting/evidence/depth_files.h"

namespace mocurate {

std::map<std::string, std::filesystem::path> DepthFilesOf(const StageRequest& request) {
  std::map<std::string, std::filesystem::path> files;
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") files[input.name] = input.path;
  }
  return files;
}

}  // namespace mocurate
