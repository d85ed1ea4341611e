#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/pipeline/stage.h"
#include "report/survey.h"

namespace mocurate {

/// A question on the page: the label, and the data of the players (PlayerData), from left to right.
struct SurveyPageQuestion {
  std::string id;
  std::string label;
  std::vector<nlohmann::json> motions;
};

struct SurveyPageInput {
  SurveyKind kind = SurveyKind::kPreference;
  std::string survey;  ///< id
  std::vector<SurveyPageQuestion> questions;
};

/// One self-contained page, which asks one question at a time and saves answers_PARTICIPANT.json. It contains only its
/// input: no name of a source or clip.
std::string MakeSurveyPage(const SurveyPageInput& input);

/// Inputs of role "motions": datasets or MotionSets, each named by its source -> the page. The summary has the key
/// ("key"), what was shown and what may reveal sources ("notes"). Motions are shown at the lowest rate of all, for at
/// most options.seconds from their begin. Errors: those of DrawSurvey and of reading.
Expected<StageOutcome> SurveyStage(const StageRequest& request);

}  // namespace mocurate
