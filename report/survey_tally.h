#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/survey.h"

namespace mocurate {

/// 95 % interval of a share.
struct ShareInterval {
  double low = 0.0;
  double high = 1.0;
};

/// Wilson's score interval (Wilson, JASA 1927) of `chosen` out of `votes` independent votes; nothing without a vote.
std::optional<ShareInterval> WilsonInterval(std::int64_t chosen, std::int64_t votes);

/// Votes about a pair or a source: all of them, or those about one label.
struct TallyRow {
  std::string first;        ///< preference: the source that `chosen` counts; real_or_fake: the source
  std::string second;       ///< preference: the other one; else empty
  std::string label;        ///< empty: all labels
  std::int64_t chosen = 0;  ///< votes for `first`, or votes that it is real
  std::int64_t votes = 0;
  std::optional<ShareInterval> wilson;
  std::optional<ShareInterval> bootstrap;  ///< over participants; nothing for fewer than three

  double share() const { return votes > 0 ? static_cast<double>(chosen) / static_cast<double>(votes) : 0.0; }
};

/// A file whose answers do not count.
struct SkippedAnswers {
  std::string file;
  std::string reason;
};

struct SurveyTally {
  SurveyKind kind = SurveyKind::kPreference;
  std::string survey;  ///< id
  std::string real;    ///< source of recordings, or empty
  std::int64_t seed = 1;
  std::size_t questions = 0;
  std::vector<std::string> participants;
  std::vector<TallyRow> rows;  ///< pair by pair or source by source: all labels, then each label
  std::vector<SkippedAnswers> skipped;
};

/// Counts the votes of answers to the questions of `key`. The bootstrap draws the participants with replacement, 2000
/// times, keyed by the seed of the key and the row; its ends are the 2.5th and 97.5th percentile of the share.
SurveyTally TallySurvey(const SurveyKey& key, const std::vector<SurveyAnswers>& answers);

nlohmann::json TallyToJson(const SurveyTally& tally);
std::string TallyToCsv(const SurveyTally& tally);
/// Explanation of the values, and their table.
std::string TallyToMarkdown(const SurveyTally& tally);
/// An SVG file: one bar per row, Wilson's interval as a whisker; without answers a note.
std::string TallyToSvg(const SurveyTally& tally);

}  // namespace mocurate
