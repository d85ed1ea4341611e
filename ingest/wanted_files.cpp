#include "ingest/wanted_files.h"

#include <filesystem>
#include <set>

#include "core/base/file.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// Everything that the declaration names below its folder.
std::vector<WantedFile> Named(const IngestOptions& ingest) {
  const SourceOptions& source = ingest.source;
  std::vector<WantedFile> wanted;
  std::set<std::string> told;
  const auto want = [&](const std::string& pattern, const std::string& what) {
    if (pattern.empty()) return;
    const auto explained = ingest.expected.find(pattern);
    if (told.insert(pattern).second)
      wanted.push_back({pattern, explained != ingest.expected.end() ? explained->second : what, 0});
  };
  if (source.container.empty()) {
    want(source.files, IsGathered(source.format) ? "a clip together, but for {camera} and {frame}" : "a clip each");
  }
  for (const std::string& file : source.calibration) want(file, "calibration of the cameras");
  want(source.mask_files, "masks of the person");
  want(source.container, "all clips");
  want(source.skeleton_files, "skeletons of the motions");
  want(source.depth_files, "depth images");
  want(source.label_table, "the table of labels");
  for (const std::string& file : source.annotations) want(file, "annotations");
  for (const auto& [pattern, what] : ingest.expected) want(pattern, what);
  return wanted;
}

Status CountFiles(const std::filesystem::path& folder, std::vector<WantedFile>& wanted) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return {};
  std::vector<NamePattern> patterns;
  for (const WantedFile& file : wanted) {
    Expected<NamePattern> pattern = NamePattern::Parse(file.pattern, "ingest.source");
    if (!pattern) return Forward(pattern);
    patterns.push_back(std::move(*pattern));
  }
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (!at->is_regular_file(unknown)) continue;
    const std::string name = DisplayPath(at->path().lexically_relative(folder));
    for (std::size_t i = 0; i < patterns.size(); ++i) wanted[i].found += patterns[i].Match(name) ? 1 : 0;
  }
  return {};
}

}  // namespace

Expected<std::vector<WantedFile>> WantedFiles(const IngestOptions& ingest, bool count) {
  std::vector<WantedFile> wanted = Named(ingest);
  if (!count) return wanted;
  if (Status counted = CountFiles(ingest.path, wanted); !counted) return Forward(counted);
  return wanted;
}

}  // namespace mocurate
