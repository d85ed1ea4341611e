#include "ingest/relaxed_pattern.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/file.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The name of a file as the pattern sees it: with the folders above that the pattern has.
std::string NameFor(const fs::path& file, const NamePattern& pattern) {
  const fs::path whole = fs::absolute(file).lexically_normal();
  fs::path folder = whole.parent_path();
  for (int i = 0; i < pattern.least_depth(); ++i) folder = folder.parent_path();
  return DisplayPath(whole.lexically_relative(folder));
}

/// The ending that files of any name must have; nothing where names are as declared, or nothing can be taken.
std::optional<std::string> EndingToTake(const fs::path& path, const NamePattern& pattern) {
  std::error_code unknown;
  if (fs::is_regular_file(path, unknown)) {
    if (pattern.Match(NameFor(path, pattern))) return std::nullopt;
    return path.extension().string();
  }
  const Expected<FolderListing> listing = ListFiles(path, pattern.depth());
  if (!listing) return std::nullopt;
  const std::string ending = fs::path(pattern.text()).extension().string();
  bool any = false;
  for (const FolderFile& file : listing->files) {
    if (pattern.Match(file.name)) return std::nullopt;
    any = any || (DepthOf(file.name) == 0 && fs::path(file.name).extension() == ending);
  }
  return any ? std::optional<std::string>(ending) : std::nullopt;
}

/// Whether a text names a clip by a field that the pattern does not have.
bool LacksField(const NamePattern& pattern, const std::string& text) {
  std::vector<std::string> known = pattern.FieldNames();
  known.insert(known.end(), {"file", "body"});
  const std::vector<std::string> fields = FieldsOf(text);
  return std::any_of(fields.begin(), fields.end(), [&](const std::string& field) {
    return std::find(known.begin(), known.end(), field) == known.end();
  });
}

/// The one skeleton beside motions that do not say theirs; that of the motion's name where there are several or none.
std::string SkeletonOfUnnamed(const fs::path& path) {
  std::error_code unknown;
  const Expected<FolderListing> listing = ListFiles(fs::is_directory(path, unknown) ? path : path.parent_path(), 0);
  std::vector<std::string> skeletons;
  for (const FolderFile& file : listing ? listing->files : std::vector<FolderFile>()) {
    if (fs::path(file.name).extension() == ".asf" && DepthOf(file.name) == 0) skeletons.push_back(file.name);
  }
  return skeletons.size() == 1 ? skeletons[0] : "{file}.asf";
}

}  // namespace

std::optional<std::string> RelaxFilePattern(bool for_these_files, IngestOptions& options) {
  SourceOptions& source = options.source;
  if (!source.container.empty() || DriverOf(source.format).gathered() || source.views.multi_view ||
      !source.depth_files.empty()) {
    return std::nullopt;
  }
  Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return std::nullopt;
  const std::optional<std::string> ending = EndingToTake(options.path, *pattern);
  if (!ending && !for_these_files) return std::nullopt;
  const std::string declared = source.files;
  if (ending) {
    pattern = NamePattern::Parse("{recording}" + *ending, "ingest.source.files");
    if (!pattern) return std::nullopt;  // braces in the ending
    source.files = pattern->text();
    source.recording = "{recording}";
    source.label_table.clear();
  }
  std::vector<std::string> lacking;
  if (LacksField(*pattern, source.person)) {
    source.person = kUnknownPerson;
    source.bodies.clear();
    lacking.emplace_back("who performs");
  }
  if (LacksField(*pattern, source.label)) {
    source.label.clear();
    source.labels.clear();
    lacking.emplace_back("what");
  }
  if (LacksField(*pattern, source.recording)) source.recording = SourceOptions().recording;
  for (std::string* text : {&source.fine_label, &source.session, &source.view, &source.style, &source.frames_in_name}) {
    if (LacksField(*pattern, *text)) text->clear();
  }
  std::string skeleton;
  if (LacksField(*pattern, source.skeleton_files)) {
    source.skeleton_files = SkeletonOfUnnamed(options.path);
    skeleton = ", its skeleton to be " + source.skeleton_files + " (or set ingest.source.skeleton_files)";
  }
  if (lacking.empty()) return std::nullopt;
  const std::string defaults = lacking.size() == 2 ? "neither who performs nor what" : "not " + lacking[0];
  return DisplayPath(options.path) + ": " +
         (ending ? "the name is not as '" + declared + "' has it" : "by '" + declared + "'") + ", so that it tells " +
         defaults + ": the recording is taken to be the file" + skeleton;
}

}  // namespace mocurate
