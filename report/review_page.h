#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "report/options.h"

namespace mocurate {

/// One finding with the clips that it is about: the first, and the other of a pair.
struct ReviewCard {
  nlohmann::json finding;  ///< of audit.json
  std::vector<Clip> clips;
};

/// What the page that asks a person is made from.
struct ReviewPageInput {
  std::string dataset;  ///< its file
  std::vector<std::string> labels;
  std::vector<ReviewCard> cards;
  std::vector<std::string> about_set;  ///< messages of findings about the set as a whole
  std::size_t not_shown = 0;           ///< findings beyond those
  nlohmann::json decisions;            ///< made earlier: a list of objects as in the file that the page saves
  ReviewOptions options;
};

/// One page without addresses outside it: a card per finding with filmstrips and players, keys to keep, drop, relabel
/// or cut a clip, and the decisions as the YAML that canon.review reads (canon/review/review.h).
std::string MakeReviewPage(const ReviewPageInput& input);

/// Inputs: roles "dataset", "audit" (audit.json of it) and, if decisions were made before, "decisions" (a JSON list) ->
/// the page. Clips are read one at a time. Error kMalformed for an audit.json of another program; findings about clips
/// that the dataset has not are left out and counted.
Expected<StageOutcome> ReviewStage(const StageRequest& request);

}  // namespace mocurate
