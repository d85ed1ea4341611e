#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/stage_runs.h"
#include "eval/options.h"

namespace mocurate {

/// A set of motions that is scored: a dataset or MotionSet, or what a generator answers to requests drawn from one.
struct ScoredSet {
  std::string name;
  StageInput motions;
  std::optional<StageInput> generator;
  bool bare_array = false;  ///< taken in the extractor's frame, unit, joints and rate
  std::int64_t frames = 0;  ///< that are asked of the generator; 0: as many as the extractor reads
  // Of generators that answer scripts (MultiAct): what they are asked, which step is scored, who else answers.
  ScriptDraw script = ScriptDraw::kNone;
  std::int64_t steps = 1, step = 1;
  bool align = false;
  std::optional<StageInput> first = {}, fill = {};
  OneEuro filter = {};  ///< of a generator's motions
};

/// What is scored, and how.
struct Evaluation {
  ExtractorOptions extractor;
  StageInput weights;
  DrawOptions draw;
  MetricOptions metrics;
  std::map<std::string, std::string> equivalent;
  std::int64_t seed = 1;
  RealPart real_part = RealPart::kAll;
  bool requests_of_test = false;  ///< what generators are asked is drawn from the test part, not from `real_part`
  ClipPart part = ClipPart::kWhole;
  std::string split;
  std::int64_t protocol_motions = 0;  ///< that the paper scores; 0: no paper's protocol
  bool test_reference = false;        ///< the training part is FID_train's reference, the test part FID_test's
  bool compare_rows = true;           ///< pair by pair, those of one duration and step
  std::optional<ScoredSet> real;
  std::vector<ScoredSet> rows;
};

/// What became of an evaluation. A row that fails costs itself.
struct EvaluationResult {
  nlohmann::json rows = nlohmann::json::array();  ///< as of ScoreRow, Real first
  nlohmann::json comparisons = nlohmann::json::array();
  nlohmann::json warnings = nlohmann::json::array();
  std::map<std::string, std::filesystem::path> features;  ///< feature file of each row
  std::map<std::string, Error> failed;                    ///< why a row is not there
  double real_clips = 0.0;                                ///< of the set of real motions
};

/// Stages features, score and compare over the runner's workers. Errors: those of the runner.
Expected<EvaluationResult> Evaluate(const Evaluation& evaluation, StageRuns& runs);

}  // namespace mocurate
