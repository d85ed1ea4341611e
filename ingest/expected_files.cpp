#include "ingest/expected_files.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/base/file.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// Everything that the declaration names below its folder.
std::vector<ExpectedFile> Named(const IngestOptions& ingest) {
  const SourceOptions& source = ingest.source;
  std::vector<ExpectedFile> wanted;
  std::set<std::string> reported;
  const auto want = [&](const std::string& pattern, const std::string& what) {
    if (pattern.empty()) return;
    const auto explained = ingest.expected.find(pattern);
    if (!reported.insert(pattern).second) return;
    ExpectedFile file;
    file.pattern = pattern;
    file.what = explained != ingest.expected.end() ? explained->second : what;
    wanted.push_back(std::move(file));
  };
  if (source.container.empty()) {
    want(source.files,
         DriverOf(source.format).gathered() ? "a clip together, but for {camera} and {frame}" : "a clip each");
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

/// The part of a path's name that the pattern matches, once folders are taken off its front, or those above put there.
void CountElsewhere(const NamePattern& pattern, const std::filesystem::path& folder, const std::string& name,
                    ExpectedFile& wanted) {
  const auto take = [&](const std::filesystem::path& root) {
    if (wanted.elsewhere.empty()) wanted.elsewhere = root;
    wanted.found_elsewhere += wanted.elsewhere == root ? 1 : 0;
  };
  for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1)) {
    if (pattern.Match(name.substr(slash + 1))) return take(folder / name.substr(0, slash));
  }
  std::string longer = name;
  for (std::filesystem::path root = folder; root.has_relative_path() && root != root.parent_path();) {
    longer = DisplayPath(root.filename()) + "/" + longer;
    root = root.parent_path();
    if (std::count(longer.begin(), longer.end(), '/') > pattern.depth()) return;
    if (pattern.Match(longer)) return take(root);
  }
}

void CountWanted(const NamePattern& pattern, const std::filesystem::path& folder, const std::string& name,
                 ExpectedFile& wanted) {
  if (pattern.Match(name)) {
    ++wanted.found;
    return;
  }
  CountElsewhere(pattern, folder, name, wanted);
  const std::string ending = std::filesystem::path(wanted.pattern).extension().string();
  if (ending.empty() || std::filesystem::path(name).extension() != ending) return;
  if (wanted.others++ == 0) wanted.other = name;
}

Status CountFiles(const std::filesystem::path& folder, std::vector<ExpectedFile>& wanted) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return {};
  std::vector<NamePattern> patterns;
  for (const ExpectedFile& file : wanted) {
    Expected<NamePattern> pattern = NamePattern::Parse(file.pattern, "ingest.source");
    if (!pattern) return Forward(pattern);
    patterns.push_back(std::move(*pattern));
  }
  const fs::path whole = fs::absolute(folder, error).lexically_normal();
  const fs::path root = whole.filename().empty() ? whole.parent_path() : whole;
  for (const fs::path& file : FilesBelow(folder)) {
    const std::string name = DisplayPath(file.lexically_relative(folder));
    for (std::size_t i = 0; i < patterns.size(); ++i) CountWanted(patterns[i], root, name, wanted[i]);
  }
  return {};
}

}  // namespace

Expected<std::vector<ExpectedFile>> ExpectedFiles(const IngestOptions& ingest, bool count) {
  std::vector<ExpectedFile> wanted = Named(ingest);
  if (!count) return wanted;
  if (Status counted = CountFiles(ingest.path, wanted); !counted) return Forward(counted);
  return wanted;
}

}  // namespace mocurate
