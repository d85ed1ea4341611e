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

/// The one skeleton beside a motion that does not name its own; that of the motion's name where there are several.
std::string SkeletonBeside(const fs::path& file) {
  std::vector<std::string> skeletons;
  for (const fs::path& entry : EntriesOf(file.has_parent_path() ? file.parent_path() : ".")) {
    if (entry.extension() == ".asf") skeletons.push_back(DisplayPath(entry.filename()));
  }
  return skeletons.size() == 1 ? skeletons[0] : "{file}.asf";
}

}  // namespace

std::string NameInSource(const fs::path& file, const NamePattern& pattern) {
  const fs::path whole = fs::absolute(file).lexically_normal();
  fs::path folder = whole.parent_path();
  for (int i = 0; i < pattern.least_depth(); ++i) folder = folder.parent_path();
  return DisplayPath(whole.lexically_relative(folder));
}

std::optional<std::string> RelaxFilePattern(IngestOptions& options) {
  SourceOptions& source = options.source;
  std::error_code unknown;
  const bool several = !source.container.empty() || DriverOf(source.format).gathered() || source.views.multi_view ||
                       !source.depth_files.empty();
  if (several || !fs::is_regular_file(options.path, unknown)) return std::nullopt;
  const Expected<NamePattern> declared = NamePattern::Parse(source.files, "ingest.source.files");
  const std::string files = "{recording}" + options.path.extension().string();
  if (!declared || !NamePattern::Parse(files, "ingest.source.files")) return std::nullopt;
  if (declared->Match(NameInSource(options.path, *declared))) return std::nullopt;
  std::string text = DisplayPath(options.path) + ": the name is not as '" + source.files +
                     "' has it, so that it declares neither who performs nor what: the recording is called as the file";
  // Only what stands in the fields of the pattern is not known.
  const auto lacks = [](const std::string& option) {
    const std::vector<std::string> fields = FieldsOf(option);
    return std::any_of(fields.begin(), fields.end(), [](const std::string& field) {
      return field != "file" && field != "recording" && field != "body";
    });
  };
  source.files = files;
  source.label_table.clear();
  if (lacks(source.recording)) source.recording = "{recording}";
  if (lacks(source.person)) {
    source.person = kUnknownPerson;
    source.bodies.clear();
  }
  if (lacks(source.label)) source.labels.clear();
  for (std::string* option :
       {&source.label, &source.fine_label, &source.session, &source.view, &source.style, &source.frames_in_name})
    if (lacks(*option)) option->clear();
  if (lacks(source.skeleton_files)) {
    source.skeleton_files = SkeletonBeside(options.path);
    text += ", its skeleton to be " + source.skeleton_files + " (or set ingest.source.skeleton_files)";
  }
  return text;
}

}  // namespace mocurate
