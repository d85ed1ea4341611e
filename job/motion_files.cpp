#include "job/motion_files.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/median.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "ingest/checks/finding_table.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/sources/array_clips.h"
#include "job/config_loading.h"
#include "job/named_configs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Regular files below a folder, sorted; or the single file.
std::vector<fs::path> FilesOf(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) return {path};
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator it(path, problem), end; !problem && it != end; it.increment(problem)) {
    std::error_code unknown;
    const bool hidden = it->path().filename().string().front() == '.';
    if (!hidden && it->is_regular_file(unknown)) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Expected<IngestOptions> IngestOf(const ConfigSource& config, const fs::path& path, const ConfigRules& rules) {
  Expected<LoadedJob> job = LoadJob(config, {"ingest.path=."}, rules);
  if (!job) return Forward(job);
  IngestOptions options = std::move(job->options.ingest);
  std::error_code unknown;
  options.path = fs::absolute(path, unknown).lexically_normal();
  return options;
}

/// Unusable files of an inspection: a finding of severity error, and no clip.
std::vector<RefusedClip> UnreadableOf(const Inspection& inspection) {
  std::vector<RefusedClip> unreadable;
  for (const Finding& finding : inspection.findings) {
    const std::string& where = finding.clip;
    const bool of_a_clip =
        std::any_of(inspection.clips.begin(), inspection.clips.end(),
                    [&](const InspectedClip& clip) { return where.compare(0, clip.file.size(), clip.file) == 0; });
    if (finding.severity != Severity::kError || of_a_clip) continue;
    unreadable.push_back({where, {ErrorCode::kMalformed, finding.message, where, ""}});
  }
  return unreadable;
}

}  // namespace

std::optional<fs::path> DeclarationBeside(const fs::path& path) {
  std::error_code unknown;
  const fs::path file = path / "source.yaml";
  if (!fs::is_directory(path, unknown) || !fs::is_regular_file(file, unknown)) return std::nullopt;
  const Expected<std::string> text = ReadFile(file);
  if (!text || text->rfind("# Written by `mocurate export", 0) != 0) return std::nullopt;
  return file;
}

Status CheckTolerated(const std::vector<std::string>& codes) {
  std::vector<std::string> known;
  for (const FindingKind& kind : FindingKinds()) known.emplace_back(kind.code);
  for (const std::string& code : codes) {
    if (FindFindingKind(code) != nullptr) continue;
    return Fail(ErrorCode::kUsage, "no finding has the code '" + code + "'", "--tolerate",
                DidYouMean(code, known, "docs/inspect.md lists them"));
  }
  return {};
}

bool IsMotionStore(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown) && IsStoreFile(path);
}

ConfigSource MotionStoreConfig(const fs::path& path) {
  const std::string text =
      "ingest:\n  source:\n    name: motions\n    format: motions\n    container: the file that is named\n"
      "    files: '{source}/{person}/{recording}#{begin}-{end}'\n    person: '{person}'\n"
      "    recording: '{recording}'\n    label: ''\n    axes: '+x +y +z'\n";
  return {text, DisplayPath(path), fs::current_path()};
}

bool AreBareArrays(const fs::path& path) {
  const std::set<std::string> beside = {".csv", ".txt", ".md", ".json", ".yaml", ".png", ".gif", ".mp4", ".log"};
  const std::vector<fs::path> files = FilesOf(path);
  const auto array = [](const fs::path& file) { return file.extension() == ".npy"; };
  return std::any_of(files.begin(), files.end(), array) &&
         std::all_of(files.begin(), files.end(),
                     [&](const fs::path& file) { return array(file) || beside.count(file.extension().string()) > 0; });
}

Expected<IngestOptions> DeclareArrays(const fs::path& path, const ExtractorOptions& extractor) {
  std::error_code unknown;
  const bool folder = fs::is_directory(path, unknown);
  std::map<std::ptrdiff_t, fs::path> depths;  // folders above an array -> the first such array
  for (const fs::path& file : FilesOf(path)) {
    const fs::path below = file.lexically_relative(path);
    if (file.extension() == ".npy") depths.emplace(folder ? std::distance(below.begin(), below.end()) : 1, below);
  }
  if (depths.size() > 1) {
    return Fail(ErrorCode::kInconsistent,
                "'" + depths.begin()->second.generic_string() + "' and '" + depths.rbegin()->second.generic_string() +
                    "' are in folders of different depth",
                DisplayPath(path), "put all arrays at one depth, or score the folders one by one");
  }
  const std::ptrdiff_t depth = depths.empty() ? 1 : depths.begin()->first;
  IngestOptions options;
  options.path = fs::absolute(path, unknown).lexically_normal();
  SourceOptions& source = options.source;
  source.name = "motions";
  source.format = "npy";
  source.other_files = OtherFiles::kIgnore;  // labels and notes beside the arrays
  source.files = "{recording}.npy";
  for (std::ptrdiff_t i = 1; i < depth; ++i) source.files = "{folder" + std::to_string(i) + "}/" + source.files;
  source.recording = "{file}";
  source.person = kUnknownPerson;
  source.label = "";
  source.units = FormatDouble(extractor.metres_per_unit) + " m";
  source.axes = extractor.axes;
  source.rate_hz = extractor.rate_hz > 0.0 ? extractor.rate_hz : 30.0;
  source.skeleton = extractor.skeleton;
  source.damaged_rows = DamagedRows::kRefuse;
  // Metrics measure a generator's faults: no clip is refused or repaired for them.
  source.checks.IgnoreAll();
  return options;
}

Expected<DeclaredMotions> DeclareMotions(const fs::path& path, const std::string& source, const ConfigRules& rules) {
  const auto declared = [&](const Expected<ConfigSource>& config, const fs::path& folder,
                            std::vector<RefusedClip> unreadable) -> Expected<DeclaredMotions> {
    if (!config) return Forward(config);
    Expected<IngestOptions> ingest = IngestOf(*config, folder, rules);
    if (!ingest) return Forward(ingest);
    return DeclaredMotions{std::move(*ingest), std::move(unreadable)};
  };
  if (!source.empty()) return declared(SourceOf(source), path, {});
  if (const auto beside = DeclarationBeside(path)) {
    LogInfo("read by the declaration beside the files, " + DisplayPath(*beside));
    return declared(SourceOf(beside->string()), path, {});
  }
  if (IsMotionStore(path)) return declared(MotionStoreConfig(path), path, {});
  const Inspection inspection = InspectPath(path, std::nullopt);
  const Expected<WrittenDeclaration> written = DeclareSource(inspection, path, "motions", NamesOfClips::kNone);
  if (!written) return Forward(written);
  if (!written->unknown.empty()) {
    return Fail(ErrorCode::kUsage, "the files do not declare " + JoinTexts(written->unknown), DisplayPath(path),
                "give --source with a source declaration; `mocurate config init " + DisplayPath(path) +
                    " -o source.yaml` writes its known part");
  }
  std::vector<RefusedClip> unreadable = UnreadableOf(inspection);
  for (const std::string& other : written->others) {
    const std::string where = DisplayPath(path);
    unreadable.push_back({where,
                          {ErrorCode::kInconsistent, other + " are not of the source that is read", where,
                           "put them into a folder of their own, or declare all with --source"}});
  }
  return declared(ConfigSource{written->yaml, "what the files show", fs::current_path()}, path, std::move(unreadable));
}

Expected<MotionsItem> MakeMotionsItem(const std::string& name, const MotionFiles& files,
                                      const ExtractorOptions& extractor) {
  DeclaredMotions motions;
  if (files.source.empty() && AreBareArrays(files.path) && !DeclarationBeside(files.path)) {
    Expected<IngestOptions> arrays = DeclareArrays(files.path, extractor);
    if (!arrays) return Forward(arrays);
    motions.ingest = std::move(*arrays);
  } else {
    Expected<DeclaredMotions> declared = DeclareMotions(files.path, files.source, files.rules);
    if (!declared) return Forward(declared);
    motions = std::move(*declared);
  }
  if (!files.lie_bone_lengths.empty() && !DriverOf(motions.ingest.source.format).HasOption("lie_bone_lengths")) {
    return Fail(ErrorCode::kUsage, "the file is not a bare array, so its values cannot be Lie parameters",
                DisplayPath(files.path), "remove --values and --bone-lengths");
  }
  motions.ingest.source.lie_bone_lengths = files.lie_bone_lengths;
  MotionsOptions options{motions.ingest, extractor.classes, files.padding, files.tolerate};
  options.ingest.path.clear();
  ItemSpec item{"motions/" + name, OptionsToJson(options), {}};
  std::error_code unknown;
  const fs::path root = motions.ingest.path;
  for (const fs::path& file : FilesOf(root)) {
    const std::string below =
        fs::is_directory(root, unknown) ? file.lexically_relative(root).generic_string() : file.filename().string();
    item.inputs.push_back({"source", below, file, ""});
  }
  if (const fs::path skeleton = motions.ingest.source.skeleton; fs::is_regular_file(skeleton, unknown)) {
    item.inputs.push_back({"skeleton", skeleton.filename().string(), skeleton, ""});
  }
  for (const auto& [role, file] : {std::pair("labels", &files.labels), std::pair("lengths", &files.lengths)}) {
    if (!file->empty()) item.inputs.push_back({role, file->filename().string(), *file, ""});
  }
  return MotionsItem{std::move(item), std::move(motions.unreadable)};
}

Expected<std::vector<double>> MedianBoneLengths(const fs::path& path, const ExtractorOptions& extractor) {
  Expected<IngestOptions> ingest = DeclareArrays(path, extractor);
  if (!ingest) return Forward(ingest);
  ingest->source.axes = "+x +y +z";  // only lengths are read
  ingest->source.units = "m";
  const Expected<ReadMotions> read = ReadAllMotions({*ingest, {}});
  if (!read) return Forward(read);
  const Skeleton& skeleton = *read->set.skeleton;
  const std::vector<int> parents = skeleton.lie ? skeleton.LieParents() : std::vector<int>();
  std::vector<double> lengths(static_cast<std::size_t>(skeleton.joint_count()), 0.0);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const int parent =
        parents.empty() ? skeleton.joints[static_cast<std::size_t>(j)].parent : parents[static_cast<std::size_t>(j)];
    std::vector<double> values;
    for (const Clip& clip : read->set.clips) {
      for (int f = 0; f < clip.motion->frame_count(); ++f) {
        values.push_back((clip.motion->joints.at(f, j) - clip.motion->joints.at(f, parent)).norm());
      }
    }
    lengths[static_cast<std::size_t>(j)] = MeanMedian(std::move(values));  // as numpy's median
  }
  return lengths;
}

}  // namespace mocurate
