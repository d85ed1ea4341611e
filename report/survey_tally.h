#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
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

/// Votes of which some count.
struct VoteShare {
  std::int64_t chosen = 0;
  double share = 0.0;  ///< 0 without votes
  std::optional<ShareInterval> wilson;
  std::optional<ShareInterval> bootstrap;  ///< over participants; nothing for fewer than three
};

/// Votes about the motions of a source: all of them, or those about one label.
struct TallyRow {
  std::string source;  ///< or kAllGenerated
  std::string label;   ///< empty: all labels
  std::int64_t votes = 0;
  std::vector<std::int64_t> counts;  ///< of votes: for the ranks 1 to N, or for real and generated
  double mean_rank = 0.0;
  std::vector<VoteShare> shares;  ///< of each of ShareNames
};

/// What the shares of a row count: votes for the first place and for the first two places, or for "real".
std::vector<std::string> ShareNames(SurveyKind kind);

/// Test of two sources over all labels.
struct TallyDifference {
  std::string first, second;
  double difference = 0.0;  ///< mean over participants: mean rank, or share judged real, of the first less the second
  std::optional<double> p;  ///< two-sided; nothing for fewer than two participants
  std::optional<double> holm;  ///< the same, corrected for the number of pairs
};

/// A file whose answers do not count.
struct SkippedAnswers {
  std::string file;
  std::string reason;
};

struct SurveyTally {
  SurveyKind kind = SurveyKind::kRanking;
  std::string survey;  ///< id
  std::string real;    ///< source of recordings, or empty
  std::int64_t seed = 1;
  std::size_t questions = 0;
  std::vector<std::string> participants;
  std::vector<TallyRow> rows;                ///< source by source: all labels, then each label
  std::vector<TallyDifference> differences;  ///< of each pair of sources
  std::vector<SkippedAnswers> skipped;
};

/// Counts answers to the questions of `key`. The bootstrap draws the participants with replacement, 2000 times; its
/// ends are the 2.5th and 97.5th percentile of the share. Differences are tested by exchanging the two sources of each
/// participant at random (sign-flip permutation test): all exchanges for at most 12 participants, else 10,000 draws,
/// and corrected by Holm's method. Draws are keyed by the seed of the key.
SurveyTally TallySurvey(const SurveyKey& key, const std::vector<SurveyAnswers>& answers);

nlohmann::json TallyToJson(const SurveyTally& tally);
/// The rows, and the differences.
std::string TallyToCsv(const SurveyTally& tally);
std::string DifferencesToCsv(const SurveyTally& tally);
/// Explanation of the values, and their tables.
std::string TallyToMarkdown(const SurveyTally& tally);
/// An SVG file: for each source a bar of the shares of its ranks, or of the share judged real with Wilson's interval as
/// a whisker; without answers a note.
std::string TallyToSvg(const SurveyTally& tally, const std::string& corner = "");

}  // namespace mocurate
