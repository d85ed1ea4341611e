#include "eval/survey/survey_tally.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/holm.h"
#include "core/base/median.h"
#include "core/base/random.h"
#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kNormal95 = 1.959963984540054;  ///< 97.5th percentile of the standard normal distribution
constexpr std::size_t kFewestForBootstrap = 3;   ///< participants
constexpr std::size_t kFewestForTest = 2;
constexpr int kResamples = 2000;
constexpr std::size_t kMostForAllSigns = 12;  ///< participants; 4096 sign patterns
constexpr int kSignDraws = 10000;

using TallyJson = nlohmann::ordered_json;  // columns of tables in this order
using Interval = std::optional<std::array<double, 2>>;
using Cells = std::vector<std::string>;

/// Votes of one participant, or of all: for the ranks 1 to N, or for real and generated.
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
std::vector<Counts> CountsOf(const SurveyKey& key, const std::vector<SurveyAnswers>& answers, const std::string& of,
                             const std::string& label) {
  std::vector<Counts> people(answers.size(), Counts(key.real.empty() ? key.sources.size() : 2));
  for (std::size_t q = 0; q < key.questions.size(); ++q) {
    const SurveyQuestion& question = key.questions[q];
    if (!label.empty() && question.label != label) continue;
    for (std::size_t i = 0; i < question.shown.size(); ++i) {
      const std::string& source = question.shown[i].source;
      if (of == kAllGenerated ? source == key.real : source != of) continue;
      for (std::size_t person = 0; person < people.size(); ++person) {
        ++people[person][static_cast<std::size_t>(answers[person].values[q][i] - 1)];
      }
    }
  }
  return people;
}

Interval BootstrapInterval(const std::vector<Counts>& people, std::size_t number, std::int64_t seed,
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
  return {{Quantile(shares, 0.025), Quantile(shares, 0.975)}};
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

/// Adds "p_holm".
void CorrectForPairs(TallyJson& differences) {
  std::vector<TallyJson*> tested;
  std::vector<double> p;
  for (TallyJson& one : differences) {
    one["p_holm"] = nullptr;
    if (one.at("p").is_null()) continue;
    tested.push_back(&one);
    p.push_back(one.at("p").get<double>());
  }
  const std::vector<double> corrected = HolmCorrected(p);
  for (std::size_t i = 0; i < tested.size(); ++i) (*tested[i])["p_holm"] = corrected[i];
}

TallyJson IntervalJson(const Interval& interval) {
  return {{"low", interval ? TallyJson((*interval)[0]) : TallyJson()},
          {"high", interval ? TallyJson((*interval)[1]) : TallyJson()}};
}

TallyJson NumberJson(bool known, double value) { return known ? TallyJson(value) : TallyJson(); }

std::string CellOf(const TallyJson& value, bool markdown) {
  if (value.is_null()) return markdown ? "-" : "";
  if (value.is_string()) return markdown ? MarkdownText(value.get<std::string>()) : CsvCell(value.get<std::string>());
  return value.is_number_float() ? FixedText(value.get<double>(), 4) : value.dump();
}

/// Columns of a row: a value in an object or a list has a name joined by '_'. An interval is one cell of Markdown.
void AddCells(const TallyJson& value, const std::string& name, bool markdown, Cells& names, Cells& cells) {
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
std::string TableText(const TallyJson& rows, bool markdown) {
  std::string text;
  const auto add_line = [&](const Cells& cells) {
    text += markdown ? "| " + JoinTexts(cells, " | ") + " |\n" : JoinTexts(cells, ",") + "\n";
  };
  for (const TallyJson& row : rows) {
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

/// What the shares of a row count: votes for the first place and for the first two places, or for "real".
std::vector<const char*> ShareNames(bool ranking) {
  return ranking ? std::vector{"first", "first_two"} : std::vector{"judged_real"};
}

TallyJson RowOf(const SurveyKey& key, const std::string& source, const std::string& label,
                const std::vector<Counts>& people) {
  const bool ranking = key.kind == SurveyKind::kRanking;
  Counts counts(ranking ? key.sources.size() : 2);
  for (const Counts& own : people) Add(own, counts);
  const std::int64_t votes = Sum(counts);
  TallyJson row = {{"source", source}, {"label", label.empty() ? TallyJson() : TallyJson(label)}, {"votes", votes}};
  if (ranking) {
    row["ranks"] = counts;
    row["mean_rank"] = NumberJson(votes > 0, MeanRank(counts));
  }
  std::size_t places = 0;
  for (const char* name : ShareNames(ranking)) {
    const std::int64_t chosen = SumOfFirst(counts, ++places);
    const std::string item = source + "\n" + label + "\n" + std::to_string(places);
    row[name] = {{"votes", chosen},
                 {"share", NumberJson(votes > 0, ShareOfFirst(counts, places))},
                 {"wilson_95", IntervalJson(WilsonInterval(chosen, votes))},
                 {"bootstrap_95", IntervalJson(BootstrapInterval(people, places, key.seed, item))}};
  }
  return row;
}

std::string MarkdownIntroduction(const TallyJson& tally) {
  const std::size_t people = tally.at("participants").size();
  std::string text =
      "# Survey " + tally.at("survey").get<std::string>() + ": " + tally.at("kind").get<std::string>() + "\n\n";
  if (people == 0) {
    text += "There are no answers. No vote is counted, and none is simulated.\n\n";
  } else {
    text += Counted(static_cast<long long>(people), "participant") + ", " +
            Counted(tally.at("questions").get<long long>(), "question") + " each. ";
  }
  text += !tally.contains("real")
              ? "Rank 1 is the best. The shares are of votes for rank 1, and for ranks 1 and 2. "
              : "The share is that of votes that a motion of the source is real; the recordings are those of " +
                    MarkdownText(tally.at("real").get<std::string>()) + ". ";
  text +=
      "Rows without a label are of all labels.\n\nWilson's 95 % interval assumes independent votes. Votes of one "
      "participant are not: the bootstrap draws\n"
      "participants. ";
  return text + (people < kFewestForBootstrap
                     ? "It needs " + std::to_string(kFewestForBootstrap) + " participants and is omitted.\n\n"
                     : "It has " + std::to_string(kResamples) + " resamples, seed " +
                           tally.at("bootstrap").at("seed").dump() + ".\n\n");
}

std::string MarkdownDifferences(const TallyJson& tally) {
  const std::size_t people = tally.at("participants").size();
  std::string text = "\nDifferences of " + std::string(tally.contains("real") ? "the share judged real" : "mean rank") +
                     ", mean over participants. ";
  if (people < kFewestForTest) return text + "The test needs 2 participants and is omitted.\n";
  text += "p: sign-flip permutation test over " + std::to_string(people) + " participants, " +
          (people <= kMostForAllSigns ? "all " : "") + tally.at("sign_patterns").dump() +
          (people <= kMostForAllSigns ? "" : " drawn") + " sign patterns, two-sided; p (Holm) is corrected for " +
          Counted(static_cast<long long>(tally.at("differences").size()), "pair") + ".";
  if (people < 6) text += " With fewer than 6 participants no p is below 0.05.";
  return text + "\n\n" + TableText(tally.at("differences"), true);
}

}  // namespace

Interval WilsonInterval(std::int64_t chosen, std::int64_t votes) {
  if (votes <= 0) return std::nullopt;
  const double n = static_cast<double>(votes), share = static_cast<double>(chosen) / n;
  const double z2 = kNormal95 * kNormal95, scale = 1.0 / (1.0 + z2 / n);
  const double centre = scale * (share + z2 / (2.0 * n));
  const double half = scale * kNormal95 * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
  return {{chosen == 0 ? 0.0 : std::max(0.0, centre - half), chosen == votes ? 1.0 : std::min(1.0, centre + half)}};
}

TallyJson TallySurvey(const SurveyKey& key, const std::vector<SurveyAnswers>& answers) {
  const bool ranking = key.kind == SurveyKind::kRanking;
  TallyJson tally = {{"survey", SurveyId(key)}, {"kind", Name(key.kind)}, {"questions", key.questions.size()}};
  if (!ranking) tally["real"] = key.real;
  for (const char* list : {"participants", "rows", "differences", "skipped"}) tally[list] = TallyJson::array();
  tally["bootstrap"] = {{"resamples", kResamples}, {"seed", key.seed}};
  tally["sign_patterns"] = answers.size() <= kMostForAllSigns ? 1 << answers.size() : kSignDraws;
  for (const SurveyAnswers& one : answers) tally["participants"].push_back(one.participant);
  std::vector<std::string> sources = key.sources, labels = key.labels;
  if (!ranking && key.sources.size() > 2) sources.emplace_back(kAllGenerated);
  labels.insert(labels.begin(), "");
  std::map<std::string, std::vector<double>> scores;  // of each participant over all labels
  std::map<std::string, bool> shown;
  for (const std::string& source : sources) {
    for (const std::string& label : labels) {
      const std::vector<Counts> people = CountsOf(key, answers, source, label);
      tally["rows"].push_back(RowOf(key, source, label, people));
      if (!label.empty()) continue;
      for (const Counts& counts : people)
        scores[source].push_back(ranking ? MeanRank(counts) : ShareOfFirst(counts, 1));
      shown[source] = answers.empty() || tally["rows"].back().at("votes") > 0;
    }
  }
  for (std::size_t a = 0; a < sources.size(); ++a) {
    for (std::size_t b = a + 1; b < sources.size(); ++b) {
      if (sources[b] == kAllGenerated && sources[a] != key.real) continue;
      if (!shown[sources[a]] || !shown[sources[b]]) continue;
      std::vector<double> differences;
      double mean = 0.0;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        differences.push_back(scores[sources[a]][i] - scores[sources[b]][i]);
        mean += differences.back() / static_cast<double>(answers.size());
      }
      const auto p = SignFlipTest(differences, key.seed, sources[a] + "\n" + sources[b]);
      tally["differences"].push_back({{"first", sources[a]},
                                      {"second", sources[b]},
                                      {"difference", NumberJson(!answers.empty(), mean)},
                                      {"participants", answers.size()},
                                      {"p", NumberJson(p.has_value(), p.value_or(0.0))}});
    }
  }
  CorrectForPairs(tally["differences"]);
  return tally;
}

std::string TallyToCsv(const TallyJson& rows) { return TableText(rows, false); }

std::string TallyToMarkdown(const TallyJson& tally) {
  std::string text = MarkdownIntroduction(tally) + TableText(tally.at("rows"), true) + MarkdownDifferences(tally);
  if (!tally.at("skipped").empty()) text += "\nFiles that are not counted (--skip-bad):\n\n";
  for (const TallyJson& file : tally.at("skipped"))
    text += "- " + MarkdownText(file.at("reason").get<std::string>()) + "\n";
  return text;
}

}  // namespace mocurate
