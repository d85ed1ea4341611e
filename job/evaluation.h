#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/options.h"
#include "job/stage_runs.h"

namespace mocurate {

/// A set of motions to score: a dataset or MotionSet, or a generator's answers to requests drawn from one.
struct ScoredSet {
  std::string name;
  StageInput motions;
  std::optional<StageInput> generator;
  bool bare_array = false;  ///< read in the extractor's frame, unit, joints and rate
  std::int64_t frames = 0;  ///< frames requested of the generator; 0: as many as the extractor reads
  // Of generators that answer scripts (MultiAct): script, scored step, and other networks involved.
  ScriptDraw script = ScriptDraw::kNone;
  std::int64_t steps = 1, step = 1;
  bool align = false;
  std::optional<StageInput> first = {}, fill = {};
  Yardstick yardstick = Yardstick::kNone;        ///< answers in the place of a generator
  OneEuro filter = {};                           ///< of a generator's motions
  PaddingAction padding = PaddingAction::kNone;  ///< of a dataset or MotionSet that the stage `motions` has not read

  /// Whether requests are answered, by a generator or a yardstick; else the motions are scored.
  bool answers() const { return generator.has_value() || yardstick != Yardstick::kNone; }
};

/// Sets to score and how.
struct Evaluation {
  ExtractorOptions extractor;
  StageInput weights;
  DrawOptions draw;
  MetricOptions metrics;
  MeasureSet measures = MeasureSet::kOwn;
  std::map<std::string, std::string> equivalent;
  std::int64_t seed = 1;
  RealPart real_part = RealPart::kAll;
  bool requests_of_test = false;  ///< requests to generators are drawn from the test part, not from `real_part`
  ClipPart part = ClipPart::kWhole;
  std::string split;
  std::int64_t protocol_motions = 0;  ///< number that the paper scores; 0: not a paper's protocol
  bool test_reference = false;  ///< the training part is the reference of FID_train, the test part that of FID_test
  bool compare_rows = true;     ///< pairwise, for equal duration and step
  std::string branch;           ///< of the items' names, where one run scores by two extractors: "published/"
  std::optional<ScoredSet> real;
  std::vector<ScoredSet> rows;
};

/// Results of an evaluation. A row that fails does not stop the others.
struct EvaluationResult {
  nlohmann::json rows = nlohmann::json::array();  ///< as of ScoreRow, Real first
  nlohmann::json comparisons = nlohmann::json::array();
  nlohmann::json warnings = nlohmann::json::array();
  std::map<std::string, std::filesystem::path> features;  ///< feature file of each row
  std::map<std::string, Error> failed;                    ///< reasons for missing rows
  double real_clips = 0.0;                                ///< of the set of real motions
};

/// The warning of a row whose motions end in padding, "padding_cut" or "padding_kept", by the summary of the stage that
/// looked for it; nothing without any.
std::optional<nlohmann::json> PaddingWarning(const std::string& row, const nlohmann::json& summary,
                                             PaddingAction padding);

/// Stages features, score and compare over the runner's workers. Errors: those of the runner.
Expected<EvaluationResult> Evaluate(const Evaluation& evaluation, StageRuns& runs);

}  // namespace mocurate
