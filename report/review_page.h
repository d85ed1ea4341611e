#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "report/options.h"

namespace mocurate {

/// One finding with its clips: the first, and the other of a pair.
struct ReviewCard {
  nlohmann::json finding;  ///< of audit.json
  std::vector<Clip> clips;
};

/// Input of the review page.
struct ReviewPageInput {
  std::string dataset;  ///< its file
  std::vector<std::string> labels;
  std::vector<ReviewCard> cards;
  std::vector<std::string> about_set;  ///< messages of findings about the set as a whole
  std::size_t not_shown = 0;           ///< findings beyond those
  nlohmann::json decisions;            ///< earlier decisions: a list of objects as in the page's saved file
  ReviewOptions options;
};

/// One self-contained page: a card per finding with filmstrips and players, keys to keep, drop, relabel or cut a clip,
/// and the decisions as the YAML that canon.review reads (canon/review/review.h).
std::string MakeReviewPage(const ReviewPageInput& input);

/// Inputs: roles "dataset", "audit" (its audit.json) and, after earlier decisions, "decisions" (a JSON list) -> the
/// page. Clips are read one at a time. Error kMalformed for an audit.json of another program; findings about unknown
/// clips are skipped and counted.
Expected<StageOutcome> ReviewStage(const StageRequest& request);

}  // namespace mocurate
