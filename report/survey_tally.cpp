#include "report/survey_tally.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "report/charts.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr double kNormal95 = 1.959963984540054;  ///< 97.5th percentile of the standard normal distribution
constexpr std::size_t kFewestForBootstrap = 3;   ///< participants
constexpr int kResamples = 2000;

/// One participant's votes in a row.
struct OwnVotes {
  std::int64_t chosen = 0;
  std::int64_t votes = 0;
};

/// Whether a question belongs to a row, and which answer counts for it.
std::optional<int> CountedAnswer(const SurveyQuestion& question, const TallyRow& row) {
  if (!row.label.empty() && question.label != row.label) return std::nullopt;
  if (row.second.empty()) return question.shown.front().source == row.first ? std::optional<int>(0) : std::nullopt;
  if (question.shown[0].source == row.first && question.shown[1].source == row.second) return 0;
  if (question.shown[0].source == row.second && question.shown[1].source == row.first) return 1;
  return std::nullopt;
}

std::optional<ShareInterval> BootstrapInterval(const std::vector<OwnVotes>& people, std::int64_t seed,
                                               const std::string& item) {
  if (people.size() < kFewestForBootstrap) return std::nullopt;
  Random random(static_cast<std::uint64_t>(seed), "survey bootstrap", item);
  std::vector<double> shares;
  for (int i = 0; i < kResamples; ++i) {
    OwnVotes sum;
    for (std::size_t k = 0; k < people.size(); ++k) {
      const OwnVotes& drawn = people[random.Below(people.size())];
      sum.chosen += drawn.chosen;
      sum.votes += drawn.votes;
    }
    if (sum.votes == 0) return std::nullopt;
    shares.push_back(static_cast<double>(sum.chosen) / static_cast<double>(sum.votes));
  }
  return ShareInterval{Quantile(shares, 0.025), Quantile(shares, 0.975)};
}

/// Pairs or sources, each with all labels and with each label.
std::vector<TallyRow> EmptyRows(const SurveyKey& key) {
  std::vector<TallyRow> heads;
  for (std::size_t a = 0; a < key.sources.size(); ++a) {
    TallyRow row;
    row.first = key.sources[a];
    if (key.kind == SurveyKind::kRealOrFake) heads.push_back(row);
    for (std::size_t b = a + 1; key.kind == SurveyKind::kPreference && b < key.sources.size(); ++b) {
      row.second = key.sources[b];
      heads.push_back(row);
    }
  }
  std::vector<TallyRow> rows;
  for (TallyRow& row : heads) {
    rows.push_back(row);
    for (const std::string& label : key.labels) {
      row.label = label;
      rows.push_back(row);
    }
  }
  return rows;
}

nlohmann::json IntervalJson(const std::optional<ShareInterval>& interval) {
  if (!interval) return nullptr;
  return {interval->low, interval->high};
}

std::string CsvNumbers(const std::optional<ShareInterval>& interval) {
  return interval ? FixedText(interval->low, 4) + "," + FixedText(interval->high, 4) : ",";
}

std::string PercentCell(const std::optional<ShareInterval>& interval) {
  if (!interval) return "-";
  return FixedText(100.0 * interval->low, 1) + " to " + FixedText(100.0 * interval->high, 1);
}

std::string MarkdownIntroduction(const SurveyTally& tally) {
  const bool preference = tally.kind == SurveyKind::kPreference;
  std::string text = "# Survey " + tally.survey + ": " + std::string(Name(tally.kind)) + "\n\n";
  if (tally.participants.empty()) {
    text += "There are no answers. No vote is counted, and none is simulated.\n\n";
  } else {
    text += Counted(static_cast<long long>(tally.participants.size()), "participant") + ", " +
            Counted(static_cast<long long>(tally.questions), "question") + " each. ";
  }
  text += preference ? "The share is that of votes for the first motion of a pair.\n\n"
                     : "The share is that of votes that a motion of the source is real; recordings are " +
                           MarkdownText(tally.real) + ".\n\n";
  text +=
      "Wilson's 95 % interval assumes independent votes. Votes of one participant are not: the bootstrap draws\n"
      "participants. ";
  text += tally.participants.size() < kFewestForBootstrap
              ? "It needs " + std::to_string(kFewestForBootstrap) + " participants and is omitted.\n\n"
              : "It has " + std::to_string(kResamples) + " resamples, seed " + std::to_string(tally.seed) + ".\n\n";
  return text;
}

}  // namespace

std::optional<ShareInterval> WilsonInterval(std::int64_t chosen, std::int64_t votes) {
  if (votes <= 0) return std::nullopt;
  const double n = static_cast<double>(votes), share = static_cast<double>(chosen) / n;
  const double z2 = kNormal95 * kNormal95, scale = 1.0 / (1.0 + z2 / n);
  const double centre = scale * (share + z2 / (2.0 * n));
  const double half = scale * kNormal95 * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
  return ShareInterval{chosen == 0 ? 0.0 : std::max(0.0, centre - half),
                       chosen == votes ? 1.0 : std::min(1.0, centre + half)};
}

SurveyTally TallySurvey(const SurveyKey& key, const std::vector<SurveyAnswers>& answers) {
  SurveyTally tally{key.kind, SurveyId(key), key.real, key.seed, key.questions.size(), {}, EmptyRows(key), {}};
  for (const SurveyAnswers& one : answers) tally.participants.push_back(one.participant);
  for (TallyRow& row : tally.rows) {
    std::vector<OwnVotes> people(answers.size());
    for (std::size_t q = 0; q < key.questions.size(); ++q) {
      const std::optional<int> counted = CountedAnswer(key.questions[q], row);
      if (!counted) continue;
      for (std::size_t person = 0; person < answers.size(); ++person) {
        ++people[person].votes;
        if (answers[person].choice[q] == *counted) ++people[person].chosen;
      }
    }
    for (const OwnVotes& own : people) {
      row.chosen += own.chosen;
      row.votes += own.votes;
    }
    row.wilson = WilsonInterval(row.chosen, row.votes);
    row.bootstrap = BootstrapInterval(people, key.seed, row.first + "\n" + row.second + "\n" + row.label);
  }
  return tally;
}

nlohmann::json TallyToJson(const SurveyTally& tally) {
  nlohmann::json json = {{"survey", tally.survey},
                         {"kind", Name(tally.kind)},
                         {"questions", tally.questions},
                         {"participants", tally.participants},
                         {"rows", nlohmann::json::array()},
                         {"skipped", nlohmann::json::array()},
                         {"bootstrap", {{"resamples", kResamples}, {"seed", tally.seed}}}};
  if (!tally.real.empty()) json["real"] = tally.real;
  const bool preference = tally.kind == SurveyKind::kPreference;
  for (const TallyRow& row : tally.rows) {
    nlohmann::json one = {{"label", row.label.empty() ? nlohmann::json() : nlohmann::json(row.label)},
                          {"votes", row.votes},
                          {"share", row.votes > 0 ? nlohmann::json(row.share()) : nlohmann::json()},
                          {"wilson_95", IntervalJson(row.wilson)},
                          {"bootstrap_95", IntervalJson(row.bootstrap)}};
    one[preference ? "first" : "source"] = row.first;
    if (preference) one["second"] = row.second;
    one[preference ? "preferred_first" : "judged_real"] = row.chosen;
    json["rows"].push_back(std::move(one));
  }
  for (const SkippedAnswers& file : tally.skipped) {
    json["skipped"].push_back({{"file", file.file}, {"reason", file.reason}});
  }
  return json;
}

std::string TallyToCsv(const SurveyTally& tally) {
  const bool preference = tally.kind == SurveyKind::kPreference;
  std::string csv = preference ? "first,second,label,preferred_first" : "source,label,judged_real";
  csv += ",votes,share,wilson_low,wilson_high,bootstrap_low,bootstrap_high\n";
  for (const TallyRow& row : tally.rows) {
    csv += CsvCell(row.first) + "," + (preference ? CsvCell(row.second) + "," : "") + CsvCell(row.label) + "," +
           std::to_string(row.chosen) + "," + std::to_string(row.votes) + "," +
           (row.votes > 0 ? FixedText(row.share(), 4) : "") + "," + CsvNumbers(row.wilson) + "," +
           CsvNumbers(row.bootstrap) + "\n";
  }
  return csv;
}

std::string TallyToMarkdown(const SurveyTally& tally) {
  const bool preference = tally.kind == SurveyKind::kPreference;
  std::string text = MarkdownIntroduction(tally);
  text +=
      preference ? "| first | second | label | preferred first | votes |" : "| source | label | judged real | votes |";
  text += " share, % | Wilson 95 %, % | bootstrap 95 %, % |\n";
  text += std::string(preference ? "|---|---|---|" : "|---|---|") + "---:|---:|---:|---:|---:|\n";
  for (const TallyRow& row : tally.rows) {
    text += "| " + MarkdownText(row.first) + (preference ? " | " + MarkdownText(row.second) : "") + " | " +
            (row.label.empty() ? "all" : MarkdownText(row.label)) + " | " + std::to_string(row.chosen) + " | " +
            std::to_string(row.votes) + " | " + (row.votes > 0 ? FixedText(100.0 * row.share(), 1) : "-") + " | " +
            PercentCell(row.wilson) + " | " + PercentCell(row.bootstrap) + " |\n";
  }
  if (!tally.skipped.empty()) text += "\nFiles that are not counted (--skip-bad):\n\n";
  for (const SkippedAnswers& file : tally.skipped) text += "- " + MarkdownText(file.reason) + "\n";
  return text;
}

std::string TallyToSvg(const SurveyTally& tally) {
  const bool preference = tally.kind == SurveyKind::kPreference;
  BarChart chart;
  chart.title = preference ? "Share of votes for the first of two sources" : "Share of votes that a motion is real";
  chart.full = 1.0;
  for (const TallyRow& row : tally.rows) {
    if (!row.label.empty()) continue;
    chart.rows.push_back({row.first + (preference ? " over " + row.second : ""),
                          {{row.share(), kAfterColour, "share"}},
                          row.votes == 0 ? "no answers" : FixedText(100.0 * row.share(), 0) + " %"});
    if (row.wilson) chart.rows.back().interval = {row.wilson->low, row.wilson->high};
  }
  return ToSvg(chart.Draw());
}

}  // namespace mocurate
