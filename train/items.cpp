#include "train/items.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kMostIterations = 1e8;  // range of `iterations`
/// Rows of no network.
constexpr const char* kOtherRows[] = {"Real",      "Real-test",       "reference", "reference_test",
                                      "Retrieval", "Shuffled labels", "Mean pose"};

/// The item of a network with this seed, else with its first one, at its end; empty for an unknown name.
std::string ItemOf(const TrainOptions& options, const std::string& name, double seed) {
  for (const NetworkOptions& network : options.networks) {
    if (name.empty() || network.name != name) continue;
    const bool alike = std::find(network.seeds.begin(), network.seeds.end(), seed) != network.seeds.end();
    return EndItem(network, alike ? static_cast<std::uint64_t>(seed) : network.seed());
  }
  return {};
}

/// The last step of a training that ends before its `iterations`; 0: all of them.
std::int64_t EarlyEnd(const LearningOptions& learning) {
  return learning.until < learning.iterations ? learning.until : 0;
}

/// The generated set for training with this seed: from the generator of the same seed, else of its first.
std::optional<MadeSet> MadeFor(const NetworkOptions& network, double seed, const TrainOptions& options) {
  const std::optional<RemakeRule> rule = RuleOf(network.trained_on);
  if (!rule) return std::nullopt;
  return MadeSet{network.generator, ItemOf(options, network.generator, seed), *rule};
}

/// The items of one seed: the network after each step of `samples_at`, then after all.
void AddSeed(const NetworkOptions& network, std::size_t at, double seed, const StageInput& dataset,
             const std::string& from, const std::optional<MadeSet>& made, std::vector<TrainItem>& items) {
  NetworkOptions one = network;
  const bool mixed = made && network.made_share < 1.0;
  if (made && !mixed) {  // generated from the right clips already
    one.data.split.clear();
    one.data.all_clips = false;
    one.data.fraction = 1.0;
  }
  one.seeds = {seed};
  one.learning.samples_at.clear();
  one.learning.weights.clear();  // their content is an input; their path does not matter
  one.learning.start_from.clear();
  one.learning.start_from_network.clear();
  one.body().clear();
  const std::string item = network.name + "/" + std::to_string(one.seed());
  const std::string row = network.seeds.size() > 1 ? item : network.name;
  const std::int64_t early = EarlyEnd(network.learning);
  const std::int64_t end_of_all = early > 0 ? early : network.learning.iterations;
  std::string after;
  for (const double step : network.learning.samples_at) {
    one.learning.until = static_cast<std::int64_t>(step);
    if (one.learning.until >= end_of_all) continue;
    const std::string end = "@" + std::to_string(one.learning.until);
    items.push_back(
        {{item + end, OptionsToJson(one), {dataset}}, at, row + end, after, after.empty() ? from : "", made, mixed});
    after = item + end;
  }
  one.learning.until = network.learning.until;
  items.push_back({{EndItem(network, one.seed()), OptionsToJson(one), {dataset}},
                   at,
                   row,
                   after,
                   after.empty() ? from : "",
                   made,
                   mixed});
}

Status CheckSeeds(const NetworkOptions& network, const std::string& where) {
  std::set<double> seen;
  for (const double seed : network.seeds) {
    if (seed != std::floor(seed)) {
      return Fail(ErrorCode::kConfig, RoundedText(seed) + " is not a whole number", where);
    }
    if (!seen.insert(seed).second) {
      return Fail(ErrorCode::kConfig, "seed " + RoundedText(seed, 12) + " is listed twice", where,
                  "a network is named after its seed");
    }
  }
  if (!network.seeds.empty()) return {};
  return Fail(ErrorCode::kConfig, "the list is empty", where,
              "one network is trained per seed: list a seed, or remove the network");
}

/// Training requirements of networks beside their sizes.
Status CheckLosses(const NetworkOptions& network, const std::string& where) {
  if (network.enabled && network.NeedsBody() && network.body().empty()) {
    return Fail(ErrorCode::kConfig, "a loss on vertices needs a body",
                where + (network.kind == NetworkKind::kActor ? ".vertex_weight" : ".points"),
                "set body: to SMPL's file or body_cc0.h5, or MOCURATE_WEIGHTS to their folder");
  }
  if (network.kind == NetworkKind::kActor && network.data.longest_frames > 0 && network.data.include_last_start) {
    return Fail(ErrorCode::kConfig, "windows of random length use the released start", where + ".include_last_start",
                "remove it, or set longest_frames: 0");
  }
  return {};
}

/// Whether two networks have the same training clips.
bool SameClips(const NetworkOptions& a, const NetworkOptions& b) {
  return a.data.split == b.data.split && a.data.all_clips == b.data.all_clips && a.data.fraction == b.data.fraction &&
         a.trained_on == b.trained_on;
}

/// A generator makes training motions from its own training clips, so that both networks must have the same clips.
Status CheckMade(const NetworkOptions& network, const TrainOptions& options, const std::string& where) {
  if (!network.enabled) return {};
  if (!RuleOf(network.trained_on)) {
    if (network.generator.empty() && network.made_share == 1.0) return {};
    return Fail(ErrorCode::kConfig, "the network is not trained on generated motions",
                where + (network.generator.empty() ? ".made_share" : ".generator"),
                "set trained_on: denoised, interpolated or generated");
  }
  if (network.NeedsParts() || network.data.part != ClipPart::kWhole) {
    return Fail(ErrorCode::kConfig, "generated motions have no parts of samples", where + ".trained_on",
                "set trained_on: dataset");
  }
  const auto found = std::find_if(options.networks.begin(), options.networks.end(),
                                  [&](const NetworkOptions& one) { return one.name == network.generator; });
  if (found == options.networks.end() || found->kind != NetworkKind::kActor || !found->enabled) {
    return Fail(ErrorCode::kConfig,
                network.generator.empty() ? std::string("no generator is declared for the motions")
                                          : "no trained actor network is named '" + network.generator + "'",
                where + ".generator", "name one of train.networks of kind actor");
  }
  NetworkOptions as_generator = network;
  as_generator.trained_on = TrainingSetChoice::kDataset;
  if (!SameClips(*found, as_generator)) {
    return Fail(ErrorCode::kConfig, "'" + network.generator + "' has other training clips than the network",
                where + ".generator",
                "set the same split, all_clips and fraction for both, and trained_on: dataset for the generator");
  }
  if (network.made_share < 1.0 && network.learning.batch < 2) {
    return Fail(ErrorCode::kConfig, "a batch of one clip cannot mix recorded and generated clips", where + ".batch",
                "set 2 or more");
  }
  return {};
}

/// Whether the parameters of two networks of one kind have the same shapes, according to their options.
bool SameSizes(const NetworkOptions& a, const NetworkOptions& b) {
  const auto sizes = [](const NetworkOptions& network) {
    const ActorOptions& actor = network.actor;
    const bool one_length = actor.coders == ActorCoders::kFullyConnected;
    return std::tuple(actor.coders, actor.distribution, actor.condition, actor.pose, actor.translation, actor.latent,
                      actor.layers, actor.feed_forward, one_length ? network.data.frames : 0, network.action2motion.lie,
                      network.action2motion.hidden, network.action2motion.latent, network.macvae.protocol,
                      network.macvae.backbone, network.macvae.width, network.macvae.layers, network.macvae.feed_forward,
                      network.macvae.vocabulary, network.macvae.previous_frames, network.macvae.whole_previous,
                      network.macvae.separate_latents, network.macvae.postprocessor, network.ssmct.width,
                      network.ssmct.layers, network.ssmct.feed_forward, network.NeedsParts() ? network.data.frames : 0);
  };
  return sizes(a) == sizes(b);
}

/// The network whose weights another one starts from has its kind and size, the same training clips, and is listed
/// before it.
Status CheckStart(const TrainOptions& options, std::size_t at, const std::string& where) {
  const NetworkOptions& network = options.networks[at];
  const std::string& name = network.learning.start_from_network;
  if (name.empty() || !network.enabled) return {};
  const auto refused = [&](const std::string& what, const char* hint) {
    return Fail(ErrorCode::kConfig, what, where + ".start_from_network", hint);
  };
  if (!network.learning.start_from.empty() || !network.learning.weights.empty()) {
    return refused("the network also starts from the weights of a file", "remove start_from and weights");
  }
  const auto end = options.networks.begin() + static_cast<std::ptrdiff_t>(at);
  const auto found =
      std::find_if(options.networks.begin(), end, [&](const NetworkOptions& one) { return one.name == name; });
  if (found == end || !found->enabled || found->kind != network.kind) {
    return refused("no trained network '" + name + "' of the same kind is listed before it", "name one that is");
  }
  if (!SameClips(*found, network)) {
    return refused("'" + name + "' has other training clips: test clips of this network may be among them",
                   "set the same split, all_clips, fraction and trained_on for both");
  }
  if (!SameSizes(*found, network)) {
    return refused("'" + name + "' has parameters of other sizes", "set the same sizes, coders and pose for both");
  }
  return {};
}

/// Each row of the table belongs to one network, and none has the name of another row.
Status CheckRowNames(const TrainOptions& options) {
  std::set<std::string> seen(std::begin(kOtherRows), std::end(kOtherRows));
  for (std::size_t i = 0; i < options.networks.size(); ++i) {
    std::vector<TrainItem> items;
    for (const double seed : options.networks[i].seeds)
      AddSeed(options.networks[i], i, seed, {}, "", std::nullopt, items);
    if (!GeneratesMotions(options.networks[i].kind)) continue;
    for (const TrainItem& item : items) {
      if (seen.insert(item.row).second) continue;
      return Fail(ErrorCode::kConfig, "the row '" + item.row + "' exists already",
                  "train.networks[" + std::to_string(i) + "].name",
                  "rename the network; with several seeds its rows are NAME/SEED");
    }
  }
  return {};
}

}  // namespace

std::string MadeSet::item() const { return generator_item + " " + Name(rule); }

std::uint64_t MadeSet::seed() const {
  return static_cast<std::uint64_t>(ParseInteger(SeedOfItem(generator_item)).value_or(1));
}

std::string SeedOfItem(const std::string& item) {
  const std::string seed = item.substr(item.rfind('/') + 1);
  return seed.substr(0, seed.find('@'));
}

std::string FileNameOf(std::string item) {
  std::replace(item.begin(), item.end(), '/', '_');
  return item;
}

void TrainOptions::Declare(OptionVisitor& v) {
  v.Integer("most_iterations", most_iterations, {0.0, 1e8}, "maximum iterations of every generator; 0: no limit");
  v.Integer("most_epochs", most_epochs, {0.0, 100000.0}, "maximum epochs of every recogniser; 0: no limit");
  v.List("networks", networks, "networks to train; generators become rows of the table");
}

void BoundTraining(TrainOptions& options) {
  for (NetworkOptions& network : options.networks) {
    std::int64_t& iterations = network.learning.iterations;
    std::int64_t& epochs = network.recogniser.epochs;
    if (options.most_iterations > 0 && iterations > options.most_iterations) {
      network.learning.planned = iterations;
      iterations = options.most_iterations;
    }
    if (options.most_epochs > 0) epochs = std::min(epochs, options.most_epochs);
  }
}

std::string EndItem(const NetworkOptions& network, std::uint64_t seed) {
  const std::int64_t early = EarlyEnd(network.learning);
  return network.name + "/" + std::to_string(seed) + (early > 0 ? "@" + std::to_string(early) : "");
}

bool TrainOptions::NeedsUnfitted() const {
  return std::any_of(networks.begin(), networks.end(),
                     [](const NetworkOptions& network) { return network.trained_on == TrainingSetChoice::kUnfitted; });
}

std::vector<TrainItem> TrainItems(const TrainOptions& options, const TrainingInputs& inputs) {
  std::vector<TrainItem> items;
  for (const bool generators : {true, false}) {
    for (std::size_t i = 0; i < options.networks.size(); ++i) {
      const NetworkOptions& network = options.networks[i];
      const bool unfitted = network.trained_on == TrainingSetChoice::kUnfitted;
      if (!network.enabled || GeneratesMotions(network.kind) != generators || (unfitted && !inputs.unfitted)) continue;
      for (const double seed : network.seeds) {
        AddSeed(network, i, seed, unfitted ? *inputs.unfitted : inputs.dataset,
                ItemOf(options, network.learning.start_from_network, seed), MadeFor(network, seed, options), items);
      }
    }
  }
  return items;
}

namespace {

/// Sizes of MACVAE.
Status CheckMacvae(const NetworkOptions& network, const std::string& where) {
  const MacvaeOptions& macvae = network.macvae;
  const auto refused = [&](const char* option, const std::string& what, const char* hint) {
    return Fail(ErrorCode::kConfig, what, where + "." + option, hint);
  };
  const bool attends = macvae.backbone == MacvaeBackbone::kTransformer;
  if ((attends && macvae.width % macvae.heads != 0) || macvae.width % 2 != 0) {
    return refused(
        "width",
        std::to_string(macvae.width) + " is odd or not a multiple of " + std::to_string(macvae.heads) + " heads",
        "choose another width");
  }
  if (network.data.frames < macvae.previous_frames + 6) {
    return refused("frames",
                   std::to_string(network.data.frames) + " are too few for a sample whose previous motion has " +
                       Counted(macvae.previous_frames, "frame"),
                   "set frames to 120, as published");
  }
  return {};
}

}  // namespace

Status CheckSizes(const NetworkOptions& network, const std::string& where) {
  if (network.kind == NetworkKind::kMacvae) return CheckMacvae(network, where);
  if (network.kind == NetworkKind::kSsmct && network.ssmct.width % network.ssmct.heads != 0) {
    return Fail(
        ErrorCode::kConfig,
        std::to_string(network.ssmct.width) + " is not a multiple of " + std::to_string(network.ssmct.heads) + " heads",
        where + ".width", "choose another width");
  }
  if (network.kind != NetworkKind::kActor) return {};
  const ActorOptions& actor = network.actor;
  const auto refused = [&](const char* option, const std::string& what, const char* hint) {
    return Fail(ErrorCode::kConfig, what, where + "." + option, hint);
  };
  const bool attends = actor.coders == ActorCoders::kTransformer || actor.coders == ActorCoders::kAutoregressive;
  if (attends && (actor.latent % actor.heads != 0 || actor.latent % 2 != 0)) {
    return refused(
        "latent",
        std::to_string(actor.latent) + " is odd or not a multiple of " + std::to_string(actor.heads) + " heads",
        "choose another width");
  }
  if (actor.pose == PoseChoice::kJoints && actor.vertex_weight > 0.0) {
    return refused("vertex_weight", "a pose of joints cannot drive a body", "choose a pose of rotations");
  }
  const std::int64_t longest = network.data.longest_frames;
  if (longest > 0 && longest < network.data.frames) {
    return refused("longest_frames", std::to_string(longest) + " is less than frames", "set 0, or at least `frames`");
  }
  if (longest > 0 && actor.coders == ActorCoders::kFullyConnected) {
    return refused("longest_frames", "the fully connected coder has one length", "set longest_frames: 0");
  }
  if (longest > 0 && actor.pose == PoseChoice::kJoints) {
    return refused("longest_frames", "windows of random length need rotations", "choose a pose of rotations");
  }
  return {};
}

Status CheckNetworks(const TrainOptions& given, const std::string& first_split) {
  TrainOptions options = given;
  for (NetworkOptions& network : options.networks) {
    if (network.data.split.empty()) network.data.split = first_split;
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < options.networks.size(); ++i) {
    const NetworkOptions& network = options.networks[i];
    const std::string where = "train.networks[" + std::to_string(i) + "]";
    const bool of_a_file = !network.name.empty() && network.name.front() != '.' &&
                           network.name.find_first_of("@\\\n") == std::string::npos;
    if (!of_a_file) {
      return Fail(ErrorCode::kConfig, "'" + network.name + "' is not a valid network name", where + ".name",
                  "use a name without '@' and '\\'; it names rows and, with '_' for '/', files");
    }
    if (!names.insert(FileNameOf(network.name)).second) {
      return Fail(ErrorCode::kConfig, "two networks have the name '" + network.name + "'", where + ".name",
                  "give each a name of its own");
    }
    if (Status seeds = CheckSeeds(network, where + ".seeds"); !seeds) return seeds;
    if (!network.learning.weights.empty() && (network.seeds.size() > 1 || !network.learning.samples_at.empty())) {
      return Fail(ErrorCode::kConfig, "a file of weights is one network at one step", where + ".weights",
                  "remove samples_at, and list one seed");
    }
    if (Status sizes = CheckSizes(network, where); !sizes) return sizes;
    if (Status start = CheckStart(options, i, where); !start) return start;
    if (Status made = CheckMade(network, options, where); !made) return made;
    if (Status training = CheckLosses(network, where); !training) return training;
    const std::vector<double>& steps = network.learning.samples_at;
    if (std::adjacent_find(steps.begin(), steps.end(), std::greater_equal<double>()) != steps.end()) {
      return Fail(ErrorCode::kConfig, "the steps do not rise", where + ".samples_at", "write them in order");
    }
    const bool bounded = network.learning.planned > 0;
    if (!bounded && network.learning.until > network.learning.iterations) {
      return Fail(ErrorCode::kConfig,
                  "step " + std::to_string(network.learning.until) + " is beyond the " +
                      Counted(network.learning.iterations, "iteration") + " of the network",
                  where + ".until", "remove it, or train longer");
    }
    const std::int64_t early = EarlyEnd(network.learning);
    const std::int64_t end = early > 0 ? early : network.learning.iterations;
    if (!steps.empty() && !bounded && steps.back() > static_cast<double>(end)) {
      return Fail(
          ErrorCode::kConfig,
          "step " + RoundedText(steps.back(), 12) + " is beyond the last step of the network, " + std::to_string(end),
          where + ".samples_at", "remove it, or train longer");
    }
    for (const double step : steps) {
      if (step == std::floor(step)) continue;
      return Fail(ErrorCode::kConfig, RoundedText(step) + " is not a whole number of steps", where + ".samples_at");
    }
  }
  return CheckRowNames(options);
}

Status ScaleTraining(double budget, TrainOptions& options) {
  TrainOptions scaled = options;
  for (NetworkOptions& network : scaled.networks) {
    if (!GeneratesMotions(network.kind)) continue;
    const double iterations = std::max(1.0, std::round(budget * static_cast<double>(network.learning.iterations)));
    if (!(iterations <= kMostIterations)) {
      return Fail(ErrorCode::kUsage,
                  RoundedText(budget) + " times " + Counted(network.learning.iterations, "iteration") +
                      " exceeds the maximum of '" + network.name + "' (1e8)",
                  "--budget", "choose a smaller budget");
    }
    LearningOptions& learning = network.learning;
    if (budget < 1.0) learning.planned = std::max(learning.planned, learning.iterations);
    learning.iterations = static_cast<std::int64_t>(iterations);
  }
  options = std::move(scaled);
  return {};
}

std::vector<std::string> TrainingNotes(const TrainOptions& options, const std::string& recogniser) {
  std::vector<std::string> notes;
  const auto features = std::find_if(options.networks.begin(), options.networks.end(),
                                     [&](const NetworkOptions& network) { return network.name == recogniser; });
  for (const NetworkOptions& network : options.networks) {
    if (!network.enabled) continue;
    const std::string on =
        network.data.all_clips ? "all clips, test clips included, as published" : "training clips only";
    if (!network.learning.weights.empty()) {
      notes.push_back(network.name + ": weights of " + DisplayPath(network.learning.weights.filename()) +
                      ", trained elsewhere.");
      continue;
    }
    const std::string batches = "up to " + Counted(network.learning.batch, "clip");
    if (!GeneratesMotions(network.kind)) {
      const GruRecogniserOptions& rules = network.recogniser;
      const std::string epochs = Counted(rules.epochs, "epoch");
      const std::string all = " on all training clips, after as many without the validation part";
      const std::string length =
          rules.released ? epochs + " on all training clips, the last one kept"
          : rules.anneal ? epochs + (rules.refit ? all : "")
                         : "at most " + epochs + (rules.refit ? " to select and as many as were best to refit" : "");
      std::string of_made;
      if (const auto rule = RuleOf(network.trained_on)) {
        of_made = std::string("; ") +
                  (network.made_share < 1.0 ? RoundedText(100.0 * network.made_share, 3) + " % of each batch are "
                                            : "its motions are ") +
                  Name(*rule) + " by " + network.generator;
      }
      notes.push_back(network.name + ": " + length + ", in batches of " + batches + of_made + ".");
      continue;
    }
    const std::int64_t early = EarlyEnd(network.learning);
    const std::string steps = (early > 0 ? std::to_string(early) + " of " : std::string()) +
                              Counted(network.learning.iterations, "iteration");
    notes.push_back(network.name + ": " + steps + " of " + batches + " on " + on +
                    (network.NeedsBody() ? ", vertices of " + DisplayPath(network.body().filename()) : std::string()) +
                    ".");
    if (features == options.networks.end() || network.NeedsParts() || features->data.input == network.data.input) {
      continue;
    }
    notes.push_back(
        network.name +
        " is trained on windows and the recogniser reads whole clips (or the reverse): its FID and accuracy are not "
        "comparable with Real; set the same `input` for both.");
  }
  return notes;
}

}  // namespace mocurate
