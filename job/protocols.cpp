#include "job/protocols.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"
#include "core/motion/motion.h"
#include "eval/published/published.h"
#include "job/extractor_folder.h"
#include "job/named_configs.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<std::string> ProtocolNames() { return NamesIn("protocols/"); }

Expected<ProtocolOptions> LoadProtocol(const std::string& name, const std::vector<std::string>& assignments,
                                       const ConfigRules& rules) {
  const Expected<ConfigNode> node = LoadNamed("protocols/", "protocol", name, assignments, rules);
  if (!node) return Forward(node);
  return OptionsFromConfig<ProtocolOptions>(*node);
}

Expected<ExtractorOptions> LoadExtractor(const std::string& name, const std::vector<std::string>& assignments,
                                         const ConfigRules& rules) {
  fs::path path(name);
  std::string own_name = "own";
  std::error_code unknown;
  const std::vector<std::string> known = NamesIn("extractors/");
  const bool named = std::find(known.begin(), known.end(), name) != known.end();  // not a folder that is called so
  if (!named && fs::is_directory(path, unknown)) {
    const auto folder = OpenExtractorFolder(path);
    if (!folder) return Forward(folder);
    path = folder->weights;
    own_name = folder->name;
  }
  for (const char* ending : {".tar", ".pth", ".pt", ".pkl"}) {
    if (path.extension() != ending) continue;
    return Fail(ErrorCode::kUsage, "a weights file does not declare its input (joints, frames, axes)",
                DisplayPath(path),
                "give the name of its extractor in configs/extractors instead, and set MOCURATE_WEIGHTS to the folder "
                "of the weights");
  }
  if (path.extension() != ".h5" && path.extension() != ".safetensors") {
    const Expected<ConfigNode> node = LoadNamed("extractors/", "extractor", name, assignments, rules);
    if (!node) return Forward(node);
    return OptionsFromConfig<ExtractorOptions>(*node);
  }
  for (const std::string& assignment : assignments) {
    const std::string key = assignment.substr(0, assignment.find('='));
    if (key == "yaw" || key == "real_root" || key == "generated_root") continue;
    return Fail(ErrorCode::kUsage, "the option would contradict the checkpoint, which declares its own input",
                "--set extractor." + assignment,
                "remove the option; extractor.yaw, real_root and generated_root can be set");
  }
  const Expected<ConfigNode> turned = LoadConfig(ConfigSource{"", "extractor", {}}, assignments);
  if (!turned) return Forward(turned);
  const auto given = OptionsFromConfig<ExtractorOptions>(*turned);
  if (!given) return Forward(given);
  const auto checkpoint = DescribeCheckpoint(path);
  if (!checkpoint) return Forward(checkpoint);
  const bool graph = checkpoint->at("network") == "st_gcn";
  if (!graph && checkpoint->at("network") != "gru_recogniser") {
    return Fail(ErrorCode::kUsage,
                "the checkpoint is of network '" + checkpoint->at("network").get<std::string>() + "'",
                DisplayPath(path), "use a recogniser: checkpoints/recogniser_*.h5 of a run");
  }
  ExtractorOptions options;
  options.name = own_name;
  options.yaw_rad = given->yaw_rad;
  if (graph) {
    options.network = ExtractorNetwork::kStGcn;
    options.values = ExtractorValues::kRotation6DRows;
  }
  options.weights = path.string();
  options.classes = checkpoint->at("labels").get<std::vector<std::string>>();
  if (checkpoint->at("skeleton").is_object())
    options.skeleton = checkpoint->at("skeleton").at("name").get<std::string>();
  const nlohmann::json& trained = checkpoint->at("options");
  options.frames = trained.value("frames", options.frames);
  const auto rate = FrameRate::Parse(checkpoint->at("facts").value("rate", std::string()));
  if (rate) options.rate_hz = rate->hz();  // of arrays that state none
  options.length =
      trained.value("input", "crop") == std::string("resample") ? LengthRule::kResample : LengthRule::kCrop;
  options.real_root = given->real_root;
  options.generated_root = given->generated_root;
  return options;
}

Expected<fs::path> FindWeights(const ExtractorOptions& extractor) {
  std::error_code unknown;
  if (fs::is_regular_file(extractor.weights, unknown)) return fs::path(extractor.weights);
  const char* folder = std::getenv("MOCURATE_WEIGHTS");
  const std::string hint =
      "set MOCURATE_WEIGHTS to the folder that contains it; it is available from " + extractor.obtain;
  if (folder == nullptr || *folder == '\0') {
    return Fail(ErrorCode::kMissingOnHost,
                "the weights of extractor '" + extractor.name + "' were not found, and MOCURATE_WEIGHTS is not set",
                extractor.weights, hint);
  }
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator it(folder, unknown), end; !unknown && it != end; it.increment(unknown)) {
    std::error_code problem;
    if (it->path().filename() == extractor.weights && it->is_regular_file(problem)) found.push_back(it->path());
  }
  std::sort(found.begin(), found.end());
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    return Fail(
        ErrorCode::kInconsistent,
        Counted(static_cast<long long>(found.size()), "file") + " of that name were found below MOCURATE_WEIGHTS",
        DisplayPath(found[0]) + ", " + DisplayPath(found[1]), "keep one, or set extractor.weights to a path");
  }
  return Fail(ErrorCode::kMissingOnHost,
              "the weights of extractor '" + extractor.name + "' were not found below MOCURATE_WEIGHTS (" +
                  DisplayPath(fs::path(folder)) + ")",
              extractor.weights, hint);
}

Expected<nlohmann::json> PublishedNumbers(const std::string& paper, const std::string& dataset) {
  const auto csv = FindResource("published/tables.csv");
  if (!csv || dataset.empty()) return nlohmann::json::array();
  return PublishedOf(*csv, "published/tables.csv", paper, dataset);
}

}  // namespace mocurate
