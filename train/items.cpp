#include "train/items.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kMostIterations = 1e8;  // range of generator.iterations

void AddRecognisers(const std::string& role, RecogniserOptions recogniser, const std::vector<double>& seeds,
                    const StageInput& dataset, std::vector<TrainItem>& items) {
  for (const double seed : seeds) {
    recogniser.seed = static_cast<std::int64_t>(seed);
    const NetworkOptions options{NetworkKind::kRecogniser, recogniser, {}};
    items.push_back({{role + "/" + std::to_string(recogniser.seed), OptionsToJson(options), {dataset}}, role});
  }
}

}  // namespace

void TrainOptions::Declare(OptionVisitor& v) {
  v.Group("recogniser", recogniser, "the GRU that gives features and accuracy");
  v.Numbers("seeds", seeds, Unit::kNone, {0.0, 1e9}, "one recogniser per seed; the first gives the features");
  v.Bool("baseline", baseline, "train the same recogniser on the unfitted tracks, to compare");
  v.Bool("crop", crop, "train the same recogniser on windows of consecutive frames, as the papers do");
  v.Bool("generator_enabled", generator_enabled, "train Action2Motion");
  v.Group("generator", generator, "Action2Motion");
}

void NetworkOptions::Declare(OptionVisitor& v) {
  v.Choice("network", network,
           {{"recogniser", NetworkKind::kRecogniser}, {"action2motion", NetworkKind::kAction2Motion}},
           "which network is trained");
  switch (network) {
    case NetworkKind::kRecogniser:
      return v.Group("recogniser", recogniser, "the GRU that gives features and accuracy");
    case NetworkKind::kAction2Motion:
      return v.Group("generator", generator, "Action2Motion");
  }
}

std::vector<TrainItem> TrainItems(const TrainOptions& options, const TrainingInputs& inputs) {
  std::vector<TrainItem> items;
  if (options.generator_enabled) {
    const NetworkOptions generator{NetworkKind::kAction2Motion, {}, options.generator};
    items.push_back({{"Action2Motion", OptionsToJson(generator), {inputs.dataset}}, "generator"});
  }
  AddRecognisers("recogniser", options.recogniser, options.seeds, inputs.dataset, items);
  if (options.baseline && inputs.baseline) {
    AddRecognisers("baseline_recogniser", options.recogniser, options.seeds, *inputs.baseline, items);
  }
  if (options.crop) {
    RecogniserOptions crop = options.recogniser;
    crop.input = RecogniserInputKind::kCrop;
    AddRecognisers("crop_recogniser", crop, options.seeds, inputs.dataset, items);
  }
  return items;
}

Status CheckSeeds(const TrainOptions& options) {
  const std::vector<double>& seeds = options.seeds;
  for (auto seed = seeds.begin(); seed != seeds.end(); ++seed) {
    if (std::floor(*seed) != *seed) {
      return Fail(ErrorCode::kConfig, FormatDouble(*seed) + " is not a whole number", "train.seeds",
                  "each seed is a whole number and stands once, as in [1, 2, 3]");
    }
    if (std::find(seeds.begin(), seed, *seed) != seed) {
      return Fail(ErrorCode::kConfig, "seed " + FormatDouble(*seed) + " stands there twice", "train.seeds",
                  "each seed is a whole number and stands once, as in [1, 2, 3]");
    }
  }
  return {};
}

Status ScaleTraining(double budget, TrainOptions& options) {
  const double iterations = std::max(1.0, std::round(budget * static_cast<double>(options.generator.iterations)));
  if (!(iterations <= kMostIterations)) {
    return Fail(ErrorCode::kUsage,
                RoundedText(budget) + " times " + Counted(options.generator.iterations, "iteration") +
                    " is more than a generator can be trained (1e8)",
                "--budget", "choose a smaller budget");
  }
  options.generator.iterations = static_cast<std::int64_t>(iterations);
  return {};
}

std::vector<std::string> TrainingNotes(const TrainOptions& options) {
  std::vector<std::string> notes;
  if (!options.seeds.empty()) {
    const RecogniserOptions& recogniser = options.recogniser;
    const std::string epochs = Counted(recogniser.epochs, "epoch");
    const std::string all = " on all training clips, after as many without the validation part";
    const std::string chosen = "at most " + epochs;
    notes.push_back("Recogniser: " +
                    (recogniser.anneal
                         ? epochs + (recogniser.refit ? all : "")
                         : chosen + (recogniser.refit ? " to select and as many as were best to refit" : "")) +
                    ", in batches of " + Counted(recogniser.batch, "clip") + ".");
  }
  if (!options.generator_enabled) return notes;
  const GeneratorOptions& generator = options.generator;
  notes.push_back("Action2Motion: " + Counted(generator.iterations, "iteration") + " of " +
                  Counted(generator.batch, "clip") + " on " +
                  (generator.all_clips ? "all clips, test clips included, as published." : "training clips only."));
  if (generator.input != options.recogniser.input) {
    notes.emplace_back(
        "The generator learns windows and the recogniser sees whole clips (or the reverse): FID and accuracy of the "
        "two rows are not like for like; set train.generator.input and train.recogniser.input alike.");
  }
  return notes;
}

}  // namespace mocurate
