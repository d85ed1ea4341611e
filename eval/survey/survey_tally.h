#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/survey_files.h"

namespace mocurate {

/// Wilson's score interval (Wilson, JASA 1927) of `chosen` out of `votes` independent votes, 95 %; nothing without a
/// vote.
std::optional<std::array<double, 2>> WilsonInterval(std::int64_t chosen, std::int64_t votes);

/// Counts answers to the questions of `key`: the content of tally.json.
///
/// {"survey": its id, "kind", "real": for real_or_fake, "questions", "participants": [names], "rows", "differences",
/// "skipped": [{"file", "reason"}], empty here, "bootstrap": {"resamples", "seed"}, "sign_patterns"}. What is unknown
/// is null.
///
/// Rows, source by source, over all labels and then for each: {"source": or kAllGenerated, "label": null for all,
/// "votes", "ranks": votes for ranks 1 to N, "mean_rank", "first", "first_two"} of a ranking, or {.., "judged_real"}.
/// These three are {"votes", "share", "wilson_95": {"low", "high"}, "bootstrap_95": likewise}. The bootstrap draws the
/// participants with replacement, 2000 times; its ends are the 2.5th and 97.5th percentile of the share, and it needs
/// three of them.
///
/// Differences of each pair of sources over all labels: {"first", "second", "difference": mean over participants of the
/// first's mean rank, or share judged real, less the second's, "participants", "p", "p_holm"}. p is that of exchanging
/// the two sources of each participant at random (sign-flip permutation test), two-sided: all exchanges for at most 12
/// participants, else 10,000 draws; it needs two. p_holm is corrected for the number of pairs (Holm, 1979). Draws are
/// keyed by the seed of the key.
nlohmann::ordered_json TallySurvey(const SurveyKey& key, const std::vector<SurveyAnswers>& answers);

/// Rows of the tally, "rows" or "differences", as CSV.
std::string TallyToCsv(const nlohmann::ordered_json& rows);
/// Explanation of the values, and their tables.
std::string TallyToMarkdown(const nlohmann::ordered_json& tally);

}  // namespace mocurate
