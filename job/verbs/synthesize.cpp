#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "ingest/synthetic/studio_layouts.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

Expected<ConfigNode> Load(const SynthesizeArguments& arguments, const ConfigRules& rules) {
  std::vector<std::string> assignments = arguments.assignments;
  if (!arguments.layout.empty()) assignments.push_back("layout=" + arguments.layout);
  if (arguments.seed) assignments.push_back("seed=" + std::to_string(*arguments.seed));
  if (!arguments.config.empty()) return LoadConfig(arguments.config, assignments, rules);
  return LoadConfig(ConfigSource{"", "synthesize", std::filesystem::current_path()}, assignments);
}

/// Given values, by the names of their options.
void Collect(const ConfigNode& node, const std::string& name,
             std::vector<std::pair<std::string, const ConfigNode*>>& given) {
  if (node.kind != ConfigNode::Kind::kMapping) given.emplace_back(name, &node);
  for (const auto& [key, value] : node.mapping) {
    Collect(value, (name.empty() ? "" : name + ".") + key, given);
  }
}

nlohmann::json ValueOf(const nlohmann::json& options, std::string name) {
  std::replace(name.begin(), name.end(), '.', '/');
  return options.at(nlohmann::json::json_pointer("/" + name));
}

/// Refuses options that the layout ignores. In a file, an option's default value is accepted, so that the output of
/// --show is valid for every layout.
Status CheckUsed(const StudioOptions& options, const ConfigNode& node) {
  const nlohmann::json values = OptionsToJson(options), defaults = OptionsToJson(StudioOptions());
  const std::string layout = StudioLayoutName(options.layout);
  std::vector<std::pair<std::string, const ConfigNode*>> given;
  Collect(node, "", given);
  std::string unused, where;
  for (const auto& [name, value] : given) {
    const std::vector<std::string> users = LayoutsUsing(name);
    if (users.empty() || std::find(users.begin(), users.end(), layout) != users.end()) continue;
    if (value->origin.file != "--set" && ValueOf(values, name) == ValueOf(defaults, name)) continue;
    if (where.empty()) where = value->origin.Text();
    unused += (unused.empty() ? "" : "; ") + name + " is of";
    for (const std::string& user : users) unused += (user == users.front() ? " " : ", ") + user;
  }
  if (unused.empty()) return {};
  return Fail(ErrorCode::kConfig, "layout " + layout + " does not use all given options: " + unused, where,
              "remove the option, or choose a layout that uses it");
}

constexpr const char* kSmaller =
    "--set depth.every=10 renders each tenth frame, depth.enabled=false none; subjects, clips and actions select fewer "
    "takes";
constexpr double kWorthPrinting = 5.0;  // seconds
constexpr double kLarge = 1e8;          // bytes, always reported
constexpr double kRoomBeside = 1.1;     // factor on the size of the images, for other files
constexpr double kEverySeconds = 10.0;  // seconds between lines of progress without a terminal

std::string Megabytes(double bytes) {
  char text[32];
  if (bytes < 1e9)
    std::snprintf(text, sizeof(text), "%.0f MB", bytes / 1e6);
  else
    std::snprintf(text, sizeof(text), "%.1f GB", bytes / 1e9);
  return text;
}

std::string Minutes(double seconds) {
  char text[32];
  if (seconds < 90.0)
    std::snprintf(text, sizeof(text), "%.0f s", seconds);
  else
    std::snprintf(text, sizeof(text), "%.0f min", seconds / 60.0);
  return text;
}

/// Free bytes at the folder's place; empty where the system does not report it.
std::optional<double> FreeAt(std::filesystem::path folder) {
  std::error_code unknown;
  folder = std::filesystem::absolute(folder, unknown);
  while (!folder.empty() && !std::filesystem::exists(folder, unknown) && folder != folder.root_path()) {
    folder = folder.parent_path();
  }
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  if (unknown) return std::nullopt;
  return static_cast<double>(space.available);
}

/// Logs the size of the output, and refuses it without enough space.
Status Announce(const CommonArguments& common, const StudioEstimate& estimate, const std::filesystem::path& folder) {
  if (estimate.images == 0) return {};
  const double bytes = kRoomBeside * estimate.bytes;
  const std::optional<double> free = FreeAt(folder);
  if (free && bytes > *free) {
    return Fail(ErrorCode::kCannotWrite,
                "about " + Megabytes(bytes) + " in " + Counted(static_cast<long long>(estimate.images), "image") +
                    " would be written, " + Megabytes(*free) + " are free",
                DisplayPath(folder), kSmaller);
  }
  if (common.quiet || (estimate.seconds < kWorthPrinting && bytes < kLarge)) return {};
  LogInfo("about " + Counted(static_cast<long long>(estimate.images), "depth image") + ", " + Megabytes(bytes) + ", " +
          Minutes(estimate.seconds) + " (" + kSmaller + ")");
  return {};
}

/// Logs progress: the number of files, and the remaining time of the images, which take most of it.
class WrittenProgress {
 public:
  WrittenProgress(std::size_t images, bool quiet) : images_(images), quiet_(quiet) {}
  void operator()(const StudioFolder::Counts& counts) {
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || std::chrono::duration<double>(now - printed_).count() < kEverySeconds) return;
    printed_ = now;
    std::string line = Counted(static_cast<long long>(counts.files), "file");
    if (images_ > 0) line += ", " + std::to_string(counts.images) + " of about " + std::to_string(images_) + " images";
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    const double share = images_ > 0 ? static_cast<double>(counts.images) / static_cast<double>(images_) : 0.0;
    if (share > 0.0 && share < 1.0) line += ", " + Minutes(seconds * (1.0 - share) / share) + " to go";
    LogInfo(line + ", " + Megabytes(static_cast<double>(counts.bytes)));
  }

 private:
  std::size_t images_;
  bool quiet_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point printed_ = begin_;
};

/// The file of a source declaration, below this folder or the installed share/mocurate beside the program's folder, as
/// a run needs a file. Empty where there is none.
std::string SourceFileOf(const std::string& source) {
  std::error_code unknown;
  const std::filesystem::path below = "configs/sources/" + source + ".yaml";
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  for (const std::filesystem::path& file : {below, (self / "../share/mocurate" / below).lexically_normal()}) {
    if (std::filesystem::is_regular_file(file, unknown)) return DisplayPath(file);
  }
  return "";
}

/// Commands to read a written folder.
std::string ReadAsText(const WrittenSource& source, const std::filesystem::path& written) {
  const std::string files = DisplayPath(source.folder == "." ? written : written / source.folder);
  std::string words = "read it with: mocurate inspect " + files + " --source " + source.name;
  if (const std::string config = SourceFileOf(source.name); !config.empty())
    words += ", or mocurate run " + config + " --set ingest.path=" + files;
  return words + "\n";
}

}  // namespace

Status SynthesizeVerb(CommonArguments& common, const SynthesizeArguments& arguments) {
  const Expected<ConfigNode> node = Load(arguments, {common.allow_include});
  if (!node) return Forward(node);
  const auto options = OptionsFromConfig<StudioOptions>(*node);
  if (!options) return Forward(options);
  if (Status used = CheckUsed(*options, *node); !used) return used;
  if (arguments.show) {
    if (AnswersInText(common, OptionsToJson(*options))) Print("%s", ShowOptions(*options, *node, false).c_str());
    return {};
  }
  if (arguments.output.empty()) {
    return Fail(ErrorCode::kUsage, "no output folder is given", "-o",
                "write e.g. mocurate synthesize --layout ntu -o DIR");
  }
  const auto begin = std::chrono::steady_clock::now();
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int jobs = arguments.jobs > 0 ? arguments.jobs : cores;
  const auto estimate = EstimateStudioLayout(*options, jobs);
  if (!estimate) return Forward(estimate);
  if (Status room = Announce(common, *estimate, arguments.output); !room) return room;
  const auto counts =
      WriteStudioLayout(*options, arguments.output, jobs, WrittenProgress(estimate->images, common.quiet));
  if (!counts) return Forward(counts);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::string folder = DisplayPath(arguments.output);
  if (AnswersInText(common, {{"folder", folder},
                             {"files", counts->files},
                             {"bytes", counts->bytes},
                             {"clips", counts->clips},
                             {"frames", counts->frames},
                             {"seconds", seconds},
                             {"options", OptionsToJson(*options)}})) {
    std::string read;
    for (const WrittenSource& source : SourcesOf(options->layout, options->depth.enabled))
      read += ReadAsText(source, arguments.output);
    Print("%s: %zu clips, %zu frames, %zu files, %.1f MB, %.1f s\n", folder.c_str(), counts->clips, counts->frames,
          counts->files, static_cast<double>(counts->bytes) / 1e6, seconds);
    Print("%s", read.c_str());
  }
  return {};
}

}  // namespace mocurate
