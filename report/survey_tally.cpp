#include "report/survey_tally.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/random.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "report/charts.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr double kNormal95 = 1.959963984540054;  ///< 97.5th percentile of the standard normal distribution
constexpr std::size_t kFewestForBootstrap = 3;   ///< participants
constexpr std::size_t kFewestForTest = 2;
constexpr int kResamples = 2000;
constexpr std::size_t kMostForAllSigns = 12;  ///< participants; 4096 sign patterns
constexpr int kSignDraws = 10000;

using TableJson = nlohmann::ordered_json;  // columns of tables in this order
using Cells = std::vector<std::string>;

/// TallyRow::counts of one participant, or of all.
using Counts = std::vector<std::int64_t>;

std::int64_t SumOfFirst(const Counts& counts, std::size_t number) {
  return std::accumulate(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(number), std::int64_t{0});
}
void Add(const Counts& counts, Counts& sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
}
std::int64_t Sum(const Counts& counts) { return SumOfFirst(counts, counts.size()); }

double ShareOfFirst(const Counts& counts, std::size_t number) {
  return static_cast<double>(SumOfFirst(counts, number)) / static_cast<double>(std::max<std::int64_t>(1, Sum(counts)));
}

double MeanRank(const Counts& counts) {
  double mean = 0.0;
  for (std::size_t rank = 0; rank < counts.size(); ++rank) mean += 1.0 - ShareOfFirst(counts, rank);
  return mean;
}

/// Counts of each participant.
std::vector<Counts> CountsOf(const SurveyKey& key, const std::vector<SurveyAnswers>& answers, const TallyRow& row) {
  std::vector<Counts> people(answers.size(), Counts(key.real.empty() ? key.sources.size() : 2));
  for (std::size_t q = 0; q < key.questions.size(); ++q) {
    const SurveyQuestion& question = key.questions[q];
    if (!row.label.empty() && question.label != row.label) continue;
    for (std::size_t i = 0; i < question.shown.size(); ++i) {
      const std::string& source = question.shown[i].source;
      if (row.source == kAllGenerated ? source == key.real : source != row.source) continue;
      for (std::size_t person = 0; person < people.size(); ++person) {
        ++people[person][static_cast<std::size_t>(answers[person].values[q][i] - 1)];
      }
    }
  }
  return people;
}

std::optional<ShareInterval> BootstrapInterval(const std::vector<Counts>& people, std::size_t number, std::int64_t seed,
                                               const std::string& item) {
  if (people.size() < kFewestForBootstrap) return std::nullopt;
  Random random(static_cast<std::uint64_t>(seed), "survey bootstrap", item);
  std::vector<double> shares;
  for (int i = 0; i < kResamples; ++i) {
    Counts sum(people.front().size());
    for (std::size_t k = 0; k < people.size(); ++k) Add(people[random.Below(people.size())], sum);
    if (Sum(sum) == 0) return std::nullopt;
    shares.push_back(ShareOfFirst(sum, number));
  }
  return ShareInterval{Quantile(shares, 0.025), Quantile(shares, 0.975)};
}

/// Two-sided p of the sum of paired differences under exchange of signs.
std::optional<double> SignFlipTest(const std::vector<double>& differences, std::int64_t seed, const std::string& item) {
  const std::size_t people = differences.size();
  if (people < kFewestForTest) return std::nullopt;
  const bool all = people <= kMostForAllSigns;
  const int patterns = all ? 1 << people : kSignDraws;
  const double observed = std::fabs(std::accumulate(differences.begin(), differences.end(), 0.0));
  Random random(static_cast<std::uint64_t>(seed), "survey signs", item);
  int as_large = 0;
  for (int pattern = 0; pattern < patterns; ++pattern) {
    double sum = 0.0;
    for (std::size_t i = 0; i < people; ++i) {
      const bool negative = all ? (pattern >> i & 1) != 0 : random.Below(2) == 0;
      sum += negative ? -differences[i] : differences[i];
    }
    if (std::fabs(sum) >= observed - 1e-9) ++as_large;
  }
  return all ? static_cast<double>(as_large) / patterns : (as_large + 1.0) / (patterns + 1.0);
}

/// Holm's step-down correction (Holm, 1979).
void CorrectForPairs(std::vector<TallyDifference>& differences) {
  std::vector<TallyDifference*> order;
  for (TallyDifference& one : differences) {
    if (one.p) order.push_back(&one);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return *a->p < *b->p; });
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(order.size() - i) * *order[i]->p);
    order[i]->holm = std::min(1.0, largest);
  }
}

TableJson IntervalJson(const std::optional<ShareInterval>& interval) {
  return {{"low", interval ? TableJson(interval->low) : TableJson()},
          {"high", interval ? TableJson(interval->high) : TableJson()}};
}

TableJson NumberJson(bool known, double value) { return known ? TableJson(value) : TableJson(); }

std::string CellOf(const TableJson& value, bool markdown) {
  if (value.is_null()) return markdown ? "-" : "";
  if (value.is_string()) return markdown ? MarkdownText(value.get<std::string>()) : CsvCell(value.get<std::string>());
  return value.is_number_float() ? FixedText(value.get<double>(), 4) : value.dump();
}

/// Columns of a row: a value in an object or a list has a name joined by '_'. An interval is one cell of Markdown.
void AddCells(const TableJson& value, const std::string& name, bool markdown, Cells& names, Cells& cells) {
  if (!value.is_structured() || (markdown && value.contains("low"))) {
    names.push_back(name);
    cells.push_back(!value.is_structured() ? CellOf(value, markdown)
                    : value.at("low").is_null()
                        ? "-"
                        : CellOf(value.at("low"), true) + " to " + CellOf(value.at("high"), true));
    return;
  }
  std::size_t number = 0;
  for (const auto& item : value.items()) {
    const std::string own = value.is_array() ? std::to_string(++number) : item.key();
    AddCells(item.value(), name.empty() ? own : name + "_" + own, markdown, names, cells);
  }
}

/// Rows of one shape as CSV or Markdown.
std::string TableText(const TableJson& rows, bool markdown) {
  std::string text;
  const auto add_line = [&](const Cells& cells) {
    text += markdown ? "| " + JoinTexts(cells, " | ") + " |\n" : JoinTexts(cells, ",") + "\n";
  };
  for (const TableJson& row : rows) {
    Cells names, cells;
    AddCells(row, "", markdown, names, cells);
    if (text.empty()) {
      add_line(names);
      if (markdown) add_line(Cells(names.size(), "---"));
    }
    add_line(cells);
  }
  return text;
}

TableJson RowsJson(const SurveyTally& tally) {
  TableJson rows = TableJson::array();
  const std::vector<std::string> names = ShareNames(tally.kind);
  for (const TallyRow& row : tally.rows) {
    TableJson one = {{"source", row.source},
                     {"label", row.label.empty() ? TableJson() : TableJson(row.label)},
                     {"votes", row.votes}};
    if (tally.kind == SurveyKind::kRanking) {
      one["ranks"] = row.counts;
      one["mean_rank"] = NumberJson(row.votes > 0, row.mean_rank);
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      one[names[k]] = {{"votes", row.shares[k].chosen},
                       {"share", NumberJson(row.votes > 0, row.shares[k].share)},
                       {"wilson_95", IntervalJson(row.shares[k].wilson)},
                       {"bootstrap_95", IntervalJson(row.shares[k].bootstrap)}};
    }
    rows.push_back(std::move(one));
  }
  return rows;
}

TableJson DifferencesJson(const SurveyTally& tally) {
  TableJson rows = TableJson::array();
  for (const TallyDifference& one : tally.differences) {
    rows.push_back({{"first", one.first},
                    {"second", one.second},
                    {"difference", NumberJson(!tally.participants.empty(), one.difference)},
                    {"participants", tally.participants.size()},
                    {"p", NumberJson(one.p.has_value(), one.p.value_or(0.0))},
                    {"p_holm", NumberJson(one.holm.has_value(), one.holm.value_or(0.0))}});
  }
  return rows;
}

std::string MarkdownIntroduction(const SurveyTally& tally) {
  std::string text = "# Survey " + tally.survey + ": " + std::string(Name(tally.kind)) + "\n\n";
  if (tally.participants.empty()) {
    text += "There are no answers. No vote is counted, and none is simulated.\n\n";
  } else {
    text += Counted(static_cast<long long>(tally.participants.size()), "participant") + ", " +
            Counted(static_cast<long long>(tally.questions), "question") + " each. ";
  }
  text += tally.kind == SurveyKind::kRanking
              ? "Rank 1 is the best. The shares are of votes for rank 1, and for ranks 1 and 2. "
              : "The share is that of votes that a motion of the source is real; the recordings are those of " +
                    MarkdownText(tally.real) + ". ";
  text +=
      "Rows without a label are of all labels.\n\nWilson's 95 % interval assumes independent votes. Votes of one "
      "participant are not: the bootstrap draws\n"
      "participants. ";
  return text +
         (tally.participants.size() < kFewestForBootstrap
              ? "It needs " + std::to_string(kFewestForBootstrap) + " participants and is omitted.\n\n"
              : "It has " + std::to_string(kResamples) + " resamples, seed " + std::to_string(tally.seed) + ".\n\n");
}

std::string MarkdownDifferences(const SurveyTally& tally) {
  const std::size_t people = tally.participants.size();
  std::string text = "\nDifferences of " +
                     std::string(tally.kind == SurveyKind::kRanking ? "mean rank" : "the share judged real") +
                     ", mean over participants. ";
  if (people < kFewestForTest) return text + "The test needs 2 participants and is omitted.\n";
  text += "p: sign-flip permutation test over " + std::to_string(people) + " participants, " +
          (people <= kMostForAllSigns ? "all " + std::to_string(1 << people) + " sign patterns"
                                      : std::to_string(kSignDraws) + " drawn sign patterns") +
          ", two-sided; p (Holm) is corrected for " +
          Counted(static_cast<long long>(tally.differences.size()), "pair") + ".";
  if (people < 6) text += " With fewer than 6 participants no p is below 0.05.";
  return text + "\n\n" + TableText(DifferencesJson(tally), true);
}

}  // namespace

std::vector<std::string> ShareNames(SurveyKind kind) {
  if (kind == SurveyKind::kRanking) return {"first", "first_two"};
  return {"judged_real"};
}

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
  SurveyTally tally{key.kind, SurveyId(key), key.real, key.seed, key.questions.size(), {}, {}, {}, {}};
  for (const SurveyAnswers& one : answers) tally.participants.push_back(one.participant);
  std::vector<std::string> sources = key.sources, labels = key.labels;
  if (!key.real.empty() && key.sources.size() > 2) sources.emplace_back(kAllGenerated);
  labels.insert(labels.begin(), "");
  std::map<std::string, std::vector<double>> scores;  // of each participant over all labels
  std::map<std::string, std::int64_t> votes;
  for (const std::string& source : sources) {
    for (const std::string& label : labels) {
      TallyRow row;
      row.source = source;
      row.label = label;
      const std::vector<Counts> people = CountsOf(key, answers, row);
      row.counts.resize(key.real.empty() ? key.sources.size() : 2);
      for (const Counts& counts : people) {
        Add(counts, row.counts);
        if (label.empty()) scores[source].push_back(key.real.empty() ? MeanRank(counts) : ShareOfFirst(counts, 1));
      }
      row.votes = Sum(row.counts);
      if (label.empty()) votes[source] = row.votes;
      row.mean_rank = MeanRank(row.counts);
      for (std::size_t number = 1; number <= ShareNames(key.kind).size(); ++number) {
        const std::int64_t chosen = SumOfFirst(row.counts, number);
        row.shares.push_back(
            {chosen, ShareOfFirst(row.counts, number), WilsonInterval(chosen, row.votes),
             BootstrapInterval(people, number, key.seed, source + "\n" + label + "\n" + std::to_string(number))});
      }
      tally.rows.push_back(std::move(row));
    }
  }
  for (std::size_t a = 0; a < sources.size(); ++a) {
    for (std::size_t b = a + 1; b < sources.size(); ++b) {
      if (sources[b] == kAllGenerated && sources[a] != key.real) continue;
      const bool shown = votes[sources[a]] > 0 && votes[sources[b]] > 0;
      if (!shown && !answers.empty()) continue;  // a source that no question shows
      TallyDifference one{sources[a], sources[b], 0.0, {}, {}};
      std::vector<double> differences;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        differences.push_back(scores[one.first][i] - scores[one.second][i]);
        one.difference += differences.back() / static_cast<double>(answers.size());
      }
      one.p = SignFlipTest(differences, key.seed, one.first + "\n" + one.second);
      tally.differences.push_back(std::move(one));
    }
  }
  CorrectForPairs(tally.differences);
  return tally;
}

nlohmann::json TallyToJson(const SurveyTally& tally) {
  const std::size_t people = tally.participants.size();
  nlohmann::json json = {{"survey", tally.survey},
                         {"kind", Name(tally.kind)},
                         {"questions", tally.questions},
                         {"participants", tally.participants},
                         {"rows", RowsJson(tally)},
                         {"differences", DifferencesJson(tally)},
                         {"skipped", nlohmann::json::array()},
                         {"bootstrap", {{"resamples", kResamples}, {"seed", tally.seed}}},
                         {"sign_patterns", people <= kMostForAllSigns ? 1 << people : kSignDraws}};
  if (!tally.real.empty()) json["real"] = tally.real;
  for (const SkippedAnswers& file : tally.skipped) {
    json["skipped"].push_back({{"file", file.file}, {"reason", file.reason}});
  }
  return json;
}

std::string TallyToCsv(const SurveyTally& tally) { return TableText(RowsJson(tally), false); }

std::string DifferencesToCsv(const SurveyTally& tally) { return TableText(DifferencesJson(tally), false); }

std::string TallyToMarkdown(const SurveyTally& tally) {
  std::string text = MarkdownIntroduction(tally) + TableText(RowsJson(tally), true) + MarkdownDifferences(tally);
  if (!tally.skipped.empty()) text += "\nFiles that are not counted (--skip-bad):\n\n";
  for (const SkippedAnswers& file : tally.skipped) text += "- " + MarkdownText(file.reason) + "\n";
  return text;
}

std::string TallyToSvg(const SurveyTally& tally, const std::string& corner) {
  const bool ranking = tally.kind == SurveyKind::kRanking;
  BarChart chart{ranking ? "Shares of ranks" : "Share of votes that a motion is real"};
  chart.full = 1.0;
  chart.corner = corner;
  for (const TallyRow& row : tally.rows) {
    if (!row.label.empty()) continue;
    const VoteShare& best = row.shares.back();  // of the first two places, or judged real
    const std::string first = ranking ? FixedText(100.0 * row.shares.front().share, 0) + " % first, " : "";
    const std::string share = first + FixedText(100.0 * best.share, 0) + (ranking ? " % in the first two" : " %");
    BarChart::Row bar{row.source, {}, row.votes == 0 ? "no answers" : share};
    const std::size_t parts = ranking ? row.counts.size() : 1;  // the best rank is the darkest
    for (std::size_t rank = 0; rank < parts; ++rank) {
      const double lighter = 0.85 * static_cast<double>(rank) / static_cast<double>(parts);
      bar.parts.push_back({static_cast<double>(row.counts[rank]) / std::max(1.0, static_cast<double>(row.votes)),
                           Lightened(kAfterColour, lighter),
                           ranking ? "rank " + std::to_string(rank + 1) : "judged real"});
    }
    if (best.wilson && !ranking) bar.interval = {best.wilson->low, best.wilson->high};
    chart.legend = bar.parts;
    chart.rows.push_back(std::move(bar));
  }
  const auto people = static_cast<long long>(tally.participants.size());
  chart.note = people == 0 ? "There are no answers." : Counted(people, "participant") + ".";
  if (!tally.skipped.empty()) {
    chart.note += " " + Counted(static_cast<long long>(tally.skipped.size()), "file") + " not counted.";
  }
  if (people > 0 && !ranking) chart.note += " Whiskers: 95 % (Wilson), assuming independent votes.";
  return ToSvg(chart.Draw());
}

}  // namespace mocurate
