#include "ingest/inspect/source_root.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/inspect.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestCalibration = 1 << 20;

/// The skeleton's name below the root: beside the motion, else in the nearest folder above; nothing where it is higher.
std::optional<std::string> SkeletonBelow(const fs::path& root, const std::string& motion, const std::string& skeleton) {
  for (std::string folder = FolderOf(motion);; folder = FolderOf(folder)) {
    std::error_code unknown;
    if (fs::is_regular_file(root / folder / skeleton, unknown)) {
      return folder.empty() ? skeleton : folder + "/" + skeleton;
    }
    if (folder.empty()) return std::nullopt;
  }
}

SourceRoot Above(const fs::path& folder) {
  std::error_code unknown;
  const fs::path whole = fs::absolute(folder, unknown).lexically_normal();
  const fs::path plain = whole.filename().empty() ? whole.parent_path() : whole;
  return {plain.parent_path(), DisplayPath(plain.filename()) + "/"};
}

}  // namespace

SourceRoot RootOfSkeletons(const ClipConsensus& source, const fs::path& folder) {
  const std::vector<std::string> skeletons = source.Facts("skeleton_file");
  const SourceRoot above = Above(folder);
  bool higher = false;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const std::string motion = source.clips()[i]->file;
    if (skeletons[i].empty() || SkeletonBelow(folder, motion, skeletons[i])) continue;
    higher = higher || SkeletonBelow(above.folder, above.prefix + motion, skeletons[i]).has_value();
  }
  return higher ? above : SourceRoot{folder, ""};
}

SourceRoot RootOfCameras(const fs::path& folder, Inspection& inspection) {
  if (!inspection.cameras.empty()) return {folder, ""};
  const SourceRoot above = Above(folder);
  const std::set<std::string> endings = {".toml", ".json", ".xml", ".yml", ".yaml", ".txt"};
  std::set<std::pair<std::string, std::string>> known_cameras;
  for (const fs::path& file : EntriesOf(above.folder)) {
    std::error_code unknown;
    const bool small = fs::is_regular_file(file, unknown) && fs::file_size(file, unknown) <= kLargestCalibration;
    if (!small || endings.count(file.extension().string()) == 0) continue;
    const Inspection found = InspectPath(file, std::nullopt);
    // A file of a rig shows the cameras of the file beside it too.
    for (const InspectedCamera& camera : found.cameras) {
      if (known_cameras.emplace(camera.format, camera.id).second) inspection.cameras.push_back(camera);
    }
  }
  return inspection.cameras.empty() ? SourceRoot{folder, ""} : above;
}

std::optional<std::string> EstimateSkeletonFiles(const ClipConsensus& source, const SourceRoot& root,
                                                 const NamePatternEstimate& guessed) {
  const std::vector<std::string> skeletons = source.Facts("skeleton_file");
  std::vector<std::string> motions, below;
  std::set<std::string> places;
  bool beside = true, top = true;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const std::string motion = source.clips()[i]->file;
    motions.push_back(motion);
    const auto place = skeletons[i].empty() ? std::optional<std::string>()
                                            : SkeletonBelow(root.folder, root.prefix + motion, skeletons[i]);
    if (!place) continue;
    places.insert(*place);
    beside = beside && FolderOf(*place) == FolderOf(root.prefix + motion);
    top = top && FolderOf(*place).empty();
  }
  if (places.empty()) return std::nullopt;
  const std::optional<std::string> by_fields = EstimateCompanionPattern(guessed, motions, skeletons);
  if (by_fields && top) return by_fields;
  const std::string folder = FolderOf(root.prefix + guessed.pattern);
  if (by_fields && beside) return folder + "/" + *by_fields;
  if (places.size() == 1) return *places.begin();
  return std::nullopt;
}

}  // namespace mocurate
