#include "job/evaluation.h"

#include <algorithm>

#include "core/base/text.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReal = "Real";
constexpr const char* kRealTest = "Real-test";  // where the test part is a reference as well
constexpr double kChance = 0.05;                // largest p of a significant difference

/// One evaluation: its items and their figures.
class EvaluationRun {
 public:
  EvaluationRun(const Evaluation& evaluation, StageRuns& runs) : evaluation_(evaluation), runs_(runs) {}

  Expected<EvaluationResult> Run() {
    if (Status done = ExtractFeatures(); !done) return Forward(done);
    if (Status done = ScoreRows(); !done) return Forward(done);
    if (Status done = CompareAllRows(); !done) return Forward(done);
    return std::move(result_);
  }

 private:
  /// Whether another pass over the same motions gives other features.
  bool PassesDiffer() const {
    const DrawOptions& draw = evaluation_.draw;
    const bool window = evaluation_.extractor.length == LengthRule::kCrop;
    return draw.hidden == HiddenDraw::kNormal || (window && draw.crop != CropDraw::kFirst);
  }

  /// Whether Real is a second pass over the reference, with its own draws.
  bool ReadAgain() const { return evaluation_.draw.repetitions > 1 && PassesDiffer(); }

  FeaturesOptions OptionsOf(const std::string& purpose, bool generated, bool generator, RealPart part) const {
    FeaturesOptions options;
    options.extractor = evaluation_.extractor;
    options.generated = generated;
    options.part = part;
    options.split = evaluation_.split;
    options.clip_part = evaluation_.part;
    options.measures = evaluation_.measures;
    options.hidden = evaluation_.draw.hidden;
    options.crop = evaluation_.draw.crop;
    if (!PassesDiffer() && !generator) return options;  // one pass, from which the stage score draws
    options.seed = evaluation_.seed;
    options.purpose = purpose;
    if (evaluation_.draw.repetitions == 1 && !generator) return options;
    options.passes = evaluation_.draw.repetitions;
    options.labels = evaluation_.draw.labels;
    options.motions = evaluation_.draw.motions;
    options.per_label = generator ? 0 : evaluation_.draw.per_label;
    options.replacement = evaluation_.draw.replacement && (!generated || generator);
    return options;
  }

  void AddItem(const std::string& key, const FeaturesOptions& options, const ScoredSet& set,
               std::vector<ItemSpec>& items) {
    FeaturesOptions of_set = options;
    of_set.padding = set.padding;
    ItemSpec item{"features/" + evaluation_.branch + key, OptionsToJson(of_set), {evaluation_.weights, set.motions}};
    item.inputs[0].role = "weights";
    item.inputs[1].role = "motions";
    std::error_code unknown;
    if (const fs::path skeleton = evaluation_.extractor.skeleton; fs::is_regular_file(skeleton, unknown)) {
      item.inputs.push_back({"skeleton", skeleton.filename().string(), skeleton, ""});
    }
    for (const auto& [role, network] :
         {std::pair("generator", &set.generator), std::pair("first", &set.first), std::pair("fill", &set.fill)}) {
      if (!*network) continue;
      item.inputs.push_back(**network);
      item.inputs.back().role = role;
    }
    items.push_back(std::move(item));
    keys_.push_back(key);
  }

  Status ExtractFeatures() {
    std::vector<ItemSpec> items;
    if (evaluation_.real) {
      const RealPart train = evaluation_.test_reference ? RealPart::kTrain : evaluation_.real_part;
      AddItem("reference", OptionsOf("reference", false, false, train), *evaluation_.real, items);
      if (ReadAgain()) AddItem(kReal, OptionsOf("real", false, false, train), *evaluation_.real, items);
      if (evaluation_.test_reference) {
        const ScoredSet& real = *evaluation_.real;
        AddItem("reference_test", OptionsOf("reference_test", false, false, RealPart::kTest), real, items);
        if (ReadAgain()) AddItem(kRealTest, OptionsOf("real_test", false, false, RealPart::kTest), real, items);
      }
    }
    for (const ScoredSet& row : evaluation_.rows) {
      const RealPart asked = evaluation_.requests_of_test ? RealPart::kTest : evaluation_.real_part;
      const RealPart part = row.answers() ? asked : RealPart::kAll;
      FeaturesOptions options = OptionsOf("generated", true, row.answers(), part);
      options.generated = row.yardstick == Yardstick::kNone;  // yardsticks are real clips, read as those
      options.yardstick = row.yardstick;
      options.frames = row.frames;
      options.script = row.script;
      options.steps = row.steps;
      options.step = row.step;
      options.align = row.align;
      options.filter = row.filter;
      AddItem(row.name, options, row, items);
    }
    const auto report = runs_.Run(FeaturesDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) {
      const ItemResult& item = report->items[i];
      if (item.artifact.empty()) {
        result_.failed[keys_[i] == "reference" ? kReal : keys_[i]] = item.outcome.error;
        continue;
      }
      const bool of_test = keys_[i] == "reference_test" || keys_[i] == kRealTest;
      if (of_test && item.summary.value("no_parts", false)) {
        Warn("", "no_test_part",
             "the real motions have no split, so there is no test part and no FID_test; give a dataset with a split");
        continue;
      }
      features_[keys_[i]] = item;
      if (keys_[i] == "reference") result_.real_clips = item.summary.value("clips", 0.0);
      const bool real = keys_[i] == "reference";
      if (real || RowOf(keys_[i]) != nullptr) {
        const ScoredSet& set = real ? *evaluation_.real : *RowOf(keys_[i]);
        auto padding = PaddingWarning(real ? kReal : keys_[i], item.summary, set.padding);
        if (padding) result_.warnings.push_back(*std::move(padding));
        if (const auto zero = item.summary.value("all_zero", std::int64_t{0}); zero > 0) {
          Warn(real ? kReal : keys_[i], "clip_refused",
               Counted(zero, "motion") + " of zeros only " + (zero == 1 ? "is" : "are") + " not scored");
        }
      }
      if (keys_[i] != "reference_test") {
        result_.features[keys_[i] == "reference" ? kReal : keys_[i]] = item.artifact;
        if (!Answers(keys_[i])) WarnOfMotions(keys_[i] == "reference" ? kReal : keys_[i], item.summary);
      }
    }
    if (ReadAgain()) return {};
    for (const auto& [row, reference] : {std::pair(kReal, "reference"), std::pair(kRealTest, "reference_test")}) {
      if (features_.count(reference) > 0) features_[row] = features_[reference];
    }
    return {};
  }

  void Warn(const std::string& row, const char* code, const std::string& message) {
    for (const nlohmann::json& known : result_.warnings) {
      if (known.at("row") == row && known.at("code") == code) return;
    }
    result_.warnings.push_back({{"code", code}, {"row", row}, {"message", message}});
  }

  /// Warns where the set differs from the protocol.
  void WarnOfMotions(const std::string& row, const nlohmann::json& summary) {
    const auto count = [&](const char* key) { return summary.value(key, 0LL); };
    const std::string frames = Counted(count("frames"), "frame");
    if (count("labels_by_index") > 0) {
      const auto& classes = summary.at("classes");
      Warn(row, "labels_by_index",
           Counted(count("labels_by_index"), "label") +
               " are numbers, read as positions among the extractor's classes: 0 is " +
               classes.front().get<std::string>() + ", " + std::to_string(classes.size() - 1) + " is " +
               classes.back().get<std::string>() + "; if they count the classes of another list, give names");
    }
    if (count("with_inferred") > 0) {
      const std::string skipped = count("all_inferred") > 0
                                      ? "; " + Counted(count("all_inferred"), "motion") + " without any are not scored"
                                      : "";
      Warn(row, "inferred_frames",
           Counted(count("inferred_frames"), "frame") + " of " + Counted(count("with_inferred"), "motion") +
               " are left out: the longest stretch between gaps without an observation is scored" + skipped);
    }
    if (count("longer") > 0) {
      Warn(row, "longer_than_window",
           Counted(count("longer"), "motion") + " longer than the " + frames +
               " of the extractor: only a window is read");
    }
    if (count("shorter") > 0) {
      Warn(row, "shorter_than_window",
           Counted(count("shorter"), "motion") + " shorter than the " + frames + " of the extractor: padded");
    }
    if (count("other_rate") > 0) {
      Warn(row, "other_rate",
           Counted(count("other_rate"), "motion") + " of another rate (" +
               RoundedText(summary.value("rate_hz", 0.0), 6) + " Hz); the extractor was trained at " +
               RoundedText(summary.value("rate_of_extractor", 0.0), 6) +
               " Hz. Resample them with `mocurate run` and canon.rate, or in your program");
    }
    if (count("clips") > 0 && summary.value("rate_of_extractor", 0.0) == 0.0) {
      Warn(row, "rate_not_known", "the extractor does not state its training frame rate, so rates are not checked");
    }
    if (!evaluation_.extractor.obtain.empty() && count("facing_away") > count("clips") / 2) {
      Warn(row, "facing_away",
           Counted(count("facing_away"), "motion") +
               " face away from the extractor's training motions, by their hips in the first frame: they are rotated "
               "by "
               "180 degrees, or left and right are exchanged; give --source with the axes");
    }
    if (count("far") > 0) {
      Warn(row, "far_from_origin",
           Counted(count("far"), "motion") +
               " begin more than 0.5 m from the origin, but the extractor's training motions begin there: "
               "--set extractor.generated_root=first_frame moves them");
    }
    if (row == kReal && summary.value("is_training_set", false)) {
      Warn(row, "real_is_training_set",
           "the extractor was trained on the real motions, so the accuracy of Real is not held out; score a test part");
    }
  }

  StageInput FeaturesInput(const std::string& role, const std::string& key) const {
    const ItemResult& item = features_.at(key);
    return {role, item.item, item.artifact, item.sha256};
  }

  ScoreOptions OptionsOfScore(const std::string& name) const {
    ScoreOptions options;
    options.name = name;
    options.real = name == kReal ? RealRow::kTrain : name == kRealTest ? RealRow::kTest : RealRow::kNone;
    options.seed = evaluation_.seed;
    options.draw = evaluation_.draw;
    options.metrics = evaluation_.metrics;
    options.equivalent = evaluation_.equivalent;
    return options;
  }

  void AddReferences(std::vector<StageInput>& inputs) const {
    if (features_.count("reference") > 0) inputs.push_back(FeaturesInput("reference_train", "reference"));
    if (features_.count("reference_test") > 0) inputs.push_back(FeaturesInput("reference_test", "reference_test"));
  }

  Status ScoreRows() {
    std::vector<ItemSpec> items;
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
      if (features_.count(name) == 0) return;
      items.push_back(
          {"score/" + evaluation_.branch + name, OptionsToJson(OptionsOfScore(name)), {FeaturesInput("row", name)}});
      AddReferences(items.back().inputs);
      names.push_back(name);
    };
    if (evaluation_.real) add(kReal);
    if (evaluation_.real && evaluation_.test_reference) add(kRealTest);
    for (const ScoredSet& row : evaluation_.rows) add(row.name);
    const auto report = runs_.Run(ScoreDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) {
      const ItemResult& item = report->items[i];
      if (item.artifact.empty()) {
        result_.failed[names[i]] = item.outcome.error;
        continue;
      }
      nlohmann::json row = item.summary;
      const ScoredSet* set = RowOf(names[i]);
      const bool yardstick = set != nullptr && set->yardstick != Yardstick::kNone;  // copies, or still, by design
      for (const nlohmann::json& warning : row.at("warnings")) {
        if (!yardstick) result_.warnings.push_back(warning);
      }
      row.erase("warnings");
      if (evaluation_.extractor.body == BodyRule::kMeanShape) NoteOfBody(row);
      if (IsBareArray(names[i])) row["assumed"].push_back("array_in_extractor_frame");
      if (!row.at("real").get<bool>() && !Answers(names[i])) NoteOfFiles(row);
      result_.rows.push_back(std::move(row));
    }
    return {};
  }

  /// Joints of the papers' mean body need SMPL files; without them motions are scored on their own bones.
  void NoteOfBody(nlohmann::json& row) {
    row["assumed"].push_back("own_bones_without_smpl_files");
    const std::string name = row.at("name").get<std::string>();
    if (!features_.at(name).summary.value("rotations", false)) return;
    Warn(name, "smpl_files_missing",
         "the protocol scores joints of SMPL's mean body for motions with rotations. Its files are missing, so "
         "joints are scored as given; see `mocurate doctor --protocol NAME`");
  }

  /// Notes what the protocol draws and motions from files do not provide.
  void NoteOfFiles(nlohmann::json& row) {
    const DrawOptions& draw = evaluation_.draw;
    if (draw.repetitions > 1) row["assumed"].push_back("same_motions_in_every_repetition");
    if (draw.motions > 0) row["assumed"].push_back("labels_as_in_the_files");
    const std::string name = row.at("name").get<std::string>();
    const auto motions = row.at("motions").get<std::int64_t>();
    if (motions < evaluation_.protocol_motions) {
      Warn(name, "fewer_than_protocol",
           Counted(motions, "motion") + ", the paper scores " + std::to_string(evaluation_.protocol_motions) +
               ": figures are not comparable with its tables; FID of fewer motions is biased upwards, diversity "
               "downwards");
    }
    const StageInput& own = RowOf(name)->motions;
    if (evaluation_.real && (own.path == evaluation_.real->motions.path ||
                             (!own.sha256.empty() && own.sha256 == evaluation_.real->motions.sha256))) {
      Warn(name, "motions_are_the_real_ones", "the set equals the set of real motions; give generated motions");
    }
  }

  /// Null for the sets of real motions.
  const ScoredSet* RowOf(const std::string& name) const {
    const auto row = std::find_if(evaluation_.rows.begin(), evaluation_.rows.end(),
                                  [&](const ScoredSet& one) { return one.name == name; });
    return row == evaluation_.rows.end() ? nullptr : &*row;
  }

  bool IsBareArray(const std::string& name) const {
    if (name == kReal || name == kRealTest) return evaluation_.real && evaluation_.real->bare_array;
    const ScoredSet* row = RowOf(name);
    return row != nullptr && row->bare_array;
  }

  bool Answers(const std::string& name) const {
    const ScoredSet* row = RowOf(name);
    return row != nullptr && row->answers();
  }

  Status CompareAllRows() {
    if (features_.count("reference") == 0 || !evaluation_.compare_rows) return {};
    std::vector<ItemSpec> items;
    std::vector<std::pair<std::string, std::string>> pairs;
    for (std::size_t i = 0; i < evaluation_.rows.size(); ++i) {
      for (std::size_t j = i + 1; j < evaluation_.rows.size(); ++j) {
        const std::string &a = evaluation_.rows[i].name, &b = evaluation_.rows[j].name;
        const ScoredSet &one = evaluation_.rows[i], &other = evaluation_.rows[j];
        const bool alike = one.frames == other.frames && one.step == other.step;  // of equal duration and step
        if (one.yardstick != Yardstick::kNone || other.yardstick != Yardstick::kNone) continue;
        if (!alike || features_.count(a) == 0 || features_.count(b) == 0) continue;
        items.push_back(
            {"compare/" + evaluation_.branch + a + "/" + b,
             OptionsToJson(OptionsOfScore("")),
             {FeaturesInput("a", a), FeaturesInput("b", b), FeaturesInput("reference_train", "reference")}});
        pairs.emplace_back(a, b);
      }
    }
    if (items.empty()) return {};
    const auto report = runs_.Run(CompareDeclaration(), std::move(items));
    if (!report) return Forward(report);
    for (std::size_t i = 0; i < report->items.size(); ++i) {
      if (report->items[i].artifact.empty()) continue;
      const auto& [a, b] = pairs[i];
      result_.comparisons.push_back({{"a", a}, {"b", b}, {"metrics", report->items[i].summary}});
      NoteNoise(a, b, report->items[i].summary);
    }
    return {};
  }

  /// Notes a difference that is not significant in a permutation test.
  void NoteNoise(const std::string& a, const std::string& b, const nlohmann::json& compared) {
    const nlohmann::json& fid = compared.value("FID_train", nlohmann::json());
    if (!fid.is_object()) {
      return Warn(a, "not_compared",
                  a + " and " + b + " are not tested for a difference: too few motions, or too many features");
    }
    const double p = fid.at("p").get<double>();
    if (p <= kChance) return;
    result_.warnings.push_back(
        {{"code", "difference_is_noise"},
         {"row", a},
         {"message", a + " and " + b + ": FID of " + fid.at("motions").dump() + " motions each differs by " +
                         RoundedText(std::abs(fid.at("difference").get<double>()), 3) +
                         ", and exchanging their motions changes it as much (p " + RoundedText(p, 2) + ")"}});
  }

  const Evaluation& evaluation_;
  StageRuns& runs_;
  EvaluationResult result_;
  std::vector<std::string> keys_;
  std::map<std::string, ItemResult> features_;
};

}  // namespace

std::optional<nlohmann::json> PaddingWarning(const std::string& row, const nlohmann::json& summary,
                                             PaddingAction padding) {
  const std::int64_t motions = summary.value("padded", std::int64_t{0});
  if (motions == 0) return std::nullopt;
  const std::int64_t frames = summary.value("padding_frames", std::int64_t{0});
  const bool keep = padding == PaddingAction::kKeep;
  const std::string found = Counted(motions, "motion") + (motions == 1 ? " ends" : " end") + " in padding, " +
                            Counted(frames, "frame") + ", e.g. '" + summary.value("first_padded", std::string()) + "'";
  return nlohmann::json{{"code", keep ? "padding_kept" : "padding_cut"},
                        {"row", row},
                        {"count", motions},
                        {"frames", frames},
                        {"message", found + (keep ? ": scored as motion; --padding cut removes them"
                                                  : ": cut; --padding keep scores them")}};
}

Expected<EvaluationResult> Evaluate(const Evaluation& evaluation, StageRuns& runs) {
  return EvaluationRun(evaluation, runs).Run();
}

}  // namespace mocurate
