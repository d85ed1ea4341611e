#include "job/config_loading.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "core/base/file.h"
#include "core/base/problem_list.h"
#include "core/base/text.h"
#include "core/geometry/axes.h"
#include "core/motion/motion.h"
#include "ingest/formats/driver.h"
#include "job/named_configs.h"

namespace mocurate {

namespace {

/// A missing configuration is a wrong command line, not unusable input. Suggests a file beside it, or, for a text that
/// is not a path, a job's name.
Error NoConfig(const std::filesystem::path& config, const Error& reason) {
  std::vector<std::string> beside;
  std::error_code missing;
  const bool file = config.extension() == ".yaml" || config.extension() == ".yml";
  if (!file && !std::filesystem::exists(config, missing)) return NoJob(DisplayPath(config));
  const std::filesystem::path folder = config.has_parent_path() ? config.parent_path() : ".";
  for (std::filesystem::directory_iterator at(folder, missing), end; !missing && at != end; at.increment(missing)) {
    if (at->path().extension() == ".yaml") beside.push_back(DisplayPath(at->path().filename()));
  }
  std::sort(beside.begin(), beside.end());
  Error error{ErrorCode::kConfig, "the configuration cannot be read: " + reason.what, DisplayPath(config), reason.hint};
  if (const auto near = Nearest(DisplayPath(config.filename()), beside)) {
    error.hint = "did you mean '" + DisplayPath(config.parent_path() / *near) + "'?";
  }
  return error;
}

ConfigNode* FindIn(ConfigNode& node, const std::string& key) {
  for (auto& [name, value] : node.mapping) {
    if (name == key) return &value;
  }
  return nullptr;
}

/// A value that a group inherits has the origin of the original.
void Inherit(ConfigNode& root, const std::string& group, const std::string& key, const ConfigNode* from) {
  if (from == nullptr) return;
  const ConfigNode value = *from;
  ConfigNode* members = FindIn(root, group);
  if (members == nullptr) {
    ConfigNode made;
    made.kind = ConfigNode::Kind::kMapping;
    members = &root.mapping.emplace_back(group, made).second;
  }
  ConfigNode* given = FindIn(*members, key);
  if (given == nullptr) {
    members->mapping.emplace_back(key, value);
  } else if (given->scalar.empty()) {
    *given = value;
  }
}

/// Origins of the values that ResolveDefaults fills in.
void InheritOrigins(ConfigNode& root) {
  for (const char* group : {"proportions", "fitting", "canon"}) {
    Inherit(root, group, "skeleton", root.Find("skeleton"));
  }
  const ConfigNode* train = root.Find("train");
  const ConfigNode* recogniser = train == nullptr ? nullptr : train->Find("recogniser");
  Inherit(root, "evaluate", "split", recogniser == nullptr ? nullptr : recogniser->Find("split"));
}

/// The value of a dotted path; null where it is not given.
const ConfigNode* FindGiven(const ConfigNode& root, const std::string& option) {
  const ConfigNode* node = &root;
  for (const std::string_view key : SplitText(option, '.')) {
    node = node->Find(std::string(key));
    if (node == nullptr) return nullptr;
  }
  return node;
}

std::optional<std::string> PlaceOfOption(const ConfigNode& root, const std::string& option) {
  const ConfigNode* node = FindGiven(root, option);
  if (node == nullptr) return std::nullopt;
  return node->origin.Text();
}

/// Description and duration of the job apply to the configuration's own data, not to data of the command line.
void DropForeignWords(const ConfigNode& root, JobOptions& options) {
  const auto set = [&](const char* option) {
    const ConfigNode* node = FindGiven(root, option);
    return node != nullptr && node->origin.file == "--set";
  };
  if (!set("ingest.path")) return;
  if (!set("description")) options.description.clear();
  if (!set("takes")) options.takes.clear();
}

/// Reports all values at once that have the right type and are invalid by themselves.
class ValueCheck {
 public:
  explicit ValueCheck(const ConfigNode& node) : node_(node) {}

  void Refuse(const std::string& option, const std::string& what, const std::string& hint) {
    const auto place = PlaceOfOption(node_, option);
    if (place) problems_.Add(*place, option + ": " + what, hint);
  }

  template <class Value>
  void Needs(const std::string& option, const Expected<Value>& value) {
    if (!value) Refuse(option, value.error().what, value.error().hint);
  }

  Status Result() const { return problems_.Result(); }

 private:
  const ConfigNode& node_;
  ProblemList problems_;
};

/// A script of Slurm has an option a line, as one word; commands (`program`, `prologue`) are shell text.
void CheckWordsOfScripts(const SlurmOptions& slurm, ValueCheck& check) {
  const auto refuse = [&check](const std::string& option, const std::string& text, unsigned char last) {
    const bool holds = std::any_of(text.begin(), text.end(),
                                   [last](char c) { return static_cast<unsigned char>(c) <= last || c == 0x7F; });
    if (holds)
      check.Refuse("slurm." + option,
                   "'" + DisplayPath(text) + "' has a line end or another character that no script holds", "remove it");
  };
  refuse("partition", slurm.tasks.partition, ' ');
  refuse("step.partition", slurm.step.partition, ' ');
  refuse("last.partition", slurm.last.partition, ' ');
  refuse("account", slurm.account, ' ');
  refuse("scratch", slurm.scratch, 0x1F);
  for (const std::string& option : slurm.sbatch) refuse("sbatch", option, 0x1F);
}

Status CheckValues(const JobOptions& options, const ConfigNode& node) {
  const SourceOptions& source = options.ingest.source;
  ValueCheck check(node);
  if (!source.units.empty()) check.Needs("ingest.source.units", MetresPerUnit(source.units));
  const bool open = source.axes.rfind(kFillIn, 0) == 0;  // CheckSource reports it, with all others
  if (!source.axes.empty() && !open) check.Needs("ingest.source.axes", AxisConvention::Parse(source.axes));
  const std::vector<std::string> roles = {"train", "validation", "test"};
  for (const auto& [person, role] : source.roles) {
    if (std::find(roles.begin(), roles.end(), role) != roles.end()) continue;
    check.Refuse("ingest.source.roles." + person, "there is no role '" + role + "'", HintFor(role, roles));
  }
  if (!options.canon.rate.empty()) check.Needs("canon.rate", FrameRate::Parse(options.canon.rate));
  const bool own_tree =
      DriverOf(source.format).gives == EvidenceKind::kMotion && options.fitting.method == FitMethod::kNone;
  const bool same = options.skeleton == source.skeleton ||
                    (source.skeleton.empty() && options.skeleton == DriverOf(source.format).tree);
  if (own_tree && !same) {
    check.Refuse("skeleton",
                 "motion of format " + source.format +
                     " is kept on the skeleton of its files; no stage retargets it to '" + options.skeleton + "'",
                 "remove `skeleton`, or set ingest.source.skeleton where the files have that tree");
  }
  CheckWordsOfScripts(options.slurm, check);
  return check.Result();
}

Expected<LoadedJob> JobOf(Expected<ConfigNode> node, std::string config, const ConfigRules& rules) {
  if (!node) return Forward(node);
  auto options = OptionsFromConfig<JobOptions>(*node);
  if (!options) return Forward(options);
  if (Status networks = ResolveNetworks(*options); !networks) return Forward(networks);
  if (Status values = CheckValues(*options, *node); !values) return Forward(values);
  DropForeignWords(*node, *options);
  options->allow_include = rules.allow_include;
  BoundTraining(options->train);
  ResolveDefaults(*options);
  InheritOrigins(*node);
  return LoadedJob{std::move(*node), std::move(*options), std::move(config)};
}

}  // namespace

std::filesystem::path FindBody() {
  std::error_code unknown;
  for (const char* variable : {"MOCURATE_WEIGHTS", "MOCURATE_DATA"}) {
    const char* folder = std::getenv(variable);
    if (folder == nullptr || *folder == '\0') continue;
    for (const char* name : {"SMPL_NEUTRAL.pkl", "SMPL_NEUTRAL.npz", "basicModel_neutral_lbs_10_207_0_v1.0.0.pkl",
                             "body_cc0.h5", "body_cc0/body_cc0.h5"}) {
      const std::filesystem::path file = std::filesystem::path(folder) / name;
      if (std::filesystem::is_regular_file(file, unknown)) return file;
    }
  }
  return {};
}

Status ResolveNetworks(JobOptions& job) {
  for (NetworkOptions& network : job.train.networks) {
    if (network.NeedsBody() && network.body().empty()) network.body() = FindBody();
  }
  return CheckNetworks(job.train, job.assemble.splits.empty() ? "" : job.assemble.splits.front().name);
}

Expected<LoadedJob> LoadJob(const ConfigSource& source, const std::vector<std::string>& assignments,
                            const ConfigRules& rules) {
  return JobOf(LoadConfig(source, assignments, rules), JobNameOf(source), rules);
}

Expected<LoadedJob> LoadJob(const std::filesystem::path& config, const std::vector<std::string>& assignments,
                            const ConfigRules& rules) {
  if (const auto named = NamedJob(config.empty() ? "demo" : config.string())) {
    return LoadJob(*named, assignments, rules);
  }
  std::error_code problem;
  auto node = LoadConfig(config, assignments, rules);
  if (!node && (node.error().code == ErrorCode::kNotFound || node.error().code == ErrorCode::kUnreadable)) {
    return tl::unexpected<Error>(NoConfig(config, node.error()));
  }
  return JobOf(std::move(node), DisplayPath(std::filesystem::absolute(config, problem).lexically_normal()), rules);
}

}  // namespace mocurate
