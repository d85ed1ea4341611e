#include "report/survey.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "report/charts.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostRanked = 9;         // one digit key each
constexpr std::size_t kUsualRankings = 40;     // at most, without a number
constexpr std::size_t kUsualPagesOfReal = 12;  // Action2Motion, figure 5: 72 motions

/// Motions of one label, by their sources.
struct PlannedPage {
  std::string label;
  std::vector<std::size_t> sources;
};

template <class T>
void Shuffle(Random random, std::vector<T>& values) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.Below(i)]);
}

Status CheckSources(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  std::vector<std::string> names;
  for (const SurveySource& source : sources) {
    if (std::find(names.begin(), names.end(), source.name) != names.end()) {
      return Fail(ErrorCode::kUsage, "two sources have the name '" + source.name + "'", "--motions",
                  "give each its own name: --motions NAME=FILE");
    }
    if (source.name == kAllGenerated) {
      return Fail(ErrorCode::kUsage, "a source has the name '" + source.name + "' of a row of the tally", "--motions",
                  "give it another name");
    }
    names.push_back(source.name);
  }
  const bool ranking = options.kind == SurveyKind::kRanking;
  if (names.size() < 2 || (ranking && names.size() > kMostRanked)) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(names.size()), "source") +
                    (ranking ? ", a ranking has 2 to 9" : ", at least 2 are required"),
                "--motions", "--motions NAME=FILE --motions NAME=FILE");
  }
  if (!ranking && std::find(names.begin(), names.end(), options.real) == names.end()) {
    return Fail(ErrorCode::kUsage, "no source has the name '" + options.real + "' of the recordings", "--real",
                "the sources are: " + JoinTexts(names) + "; set --real to that of the recordings");
  }
  return {};
}

/// Labels that every source has, in the order of their names, or those of `options`.
Expected<std::vector<std::string>> LabelsToAsk(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  std::map<std::string, std::set<std::string>> sources_with;
  for (const SurveySource& source : sources) {
    for (const SurveySource::Motion& motion : source.motions) sources_with[motion.label].insert(source.name);
    if (std::any_of(source.motions.begin(), source.motions.end(), [](const auto& m) { return !m.label.empty(); })) {
      continue;
    }
    return Fail(ErrorCode::kInconsistent,
                "none of its " + Counted(static_cast<long long>(source.motions.size()), "motion") + " has a label",
                source.name, "use motions with labels: a dataset, or --labels FILE");
  }
  sources_with.erase("");
  std::vector<std::string> common;
  for (const auto& [label, names] : sources_with) {
    if (names.size() == sources.size()) common.push_back(label);
  }
  if (common.empty()) {
    return Fail(ErrorCode::kInconsistent, "the sources have no label in common", "--motions",
                "unify the labels with `mocurate dataset relabel`");
  }
  if (options.labels.empty()) return common;
  std::vector<std::string> chosen;
  for (const std::string& label : options.labels) {
    for (const SurveySource& source : sources) {
      if (sources_with[label].count(source.name) > 0) continue;
      return Fail(ErrorCode::kUsage, "source '" + source.name + "' has no motions of the label '" + label + "'",
                  "--label", NearestOfAll(label, common, "all sources have: "));
    }
    if (std::find(chosen.begin(), chosen.end(), label) == chosen.end()) chosen.push_back(label);
  }
  return chosen;
}

/// Sources of each page of real or fake: half of all motions are real, the other sources take turns.
void PlanRealOrFake(const SurveyOptions& options, const std::vector<SurveySource>& sources,
                    std::vector<PlannedPage>& pages) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const auto clips = static_cast<std::size_t>(options.clips), least = clips / 3;
  std::vector<std::size_t> real_count;  // k and clips - k, for pairs of pages
  while (real_count.size() < pages.size()) {
    const std::size_t drawn =
        least + Random(seed, "survey real motions", std::to_string(real_count.size())).Below(clips - 2 * least + 1);
    real_count.push_back(real_count.size() + 1 == pages.size() ? clips / 2 : drawn);
    if (real_count.size() < pages.size()) real_count.push_back(clips - drawn);
  }
  Shuffle(Random(seed, "survey real motions", "order"), real_count);
  std::size_t real = 0;
  std::vector<std::size_t> generated, turn;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    if (sources[s].name == options.real) real = s;
    if (sources[s].name != options.real) generated.push_back(s);
  }
  std::size_t turns = 0;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    pages[p].sources.assign(real_count[p], real);
    while (pages[p].sources.size() < clips) {
      if (turn.empty()) {
        turn = generated;
        Shuffle(Random(seed, "survey generated motions", std::to_string(turns++)), turn);
      }
      pages[p].sources.push_back(turn.back());
      turn.pop_back();
    }
  }
}

std::vector<PlannedPage> PlanPages(const SurveyOptions& options, const std::vector<SurveySource>& sources,
                                   const std::vector<std::string>& labels) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const bool ranking = options.kind == SurveyKind::kRanking;
  const std::size_t wanted = options.questions > 0 ? static_cast<std::size_t>(options.questions)
                             : ranking             ? std::min(labels.size(), kUsualRankings)
                                                   : kUsualPagesOfReal;
  std::vector<PlannedPage> pages;
  for (std::size_t round = 0; pages.size() < wanted; ++round) {
    std::vector<std::string> order = labels;
    Shuffle(Random(seed, "survey order", std::to_string(round)), order);
    for (std::size_t i = 0; i < order.size() && pages.size() < wanted; ++i) pages.push_back({order[i], {}});
  }
  if (!ranking) PlanRealOrFake(options, sources, pages);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    if (ranking) {
      pages[p].sources.resize(sources.size());
      std::iota(pages[p].sources.begin(), pages[p].sources.end(), std::size_t{0});
    }
    Shuffle(Random(seed, "survey places", std::to_string(p)), pages[p].sources);
  }
  return pages;
}

}  // namespace

Expected<SurveyKey> DrawSurvey(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  if (Status sound = CheckSources(options, sources); !sound) return Forward(sound);
  const auto labels = LabelsToAsk(options, sources);
  if (!labels) return Forward(labels);
  const std::vector<PlannedPage> pages = PlanPages(options, sources, *labels);
  std::map<std::pair<std::size_t, std::string>, std::size_t> needed;
  for (const PlannedPage& page : pages) {
    for (const std::size_t s : page.sources) ++needed[{s, page.label}];
  }
  std::map<std::pair<std::size_t, std::string>, std::vector<std::string>> left;  // clips that are not yet shown
  for (const auto& [place, count] : needed) {
    const SurveySource& source = sources[place.first];
    std::vector<std::string>& clips = left[place];
    for (const SurveySource::Motion& motion : source.motions) {
      if (motion.label == place.second) clips.push_back(motion.clip);
    }
    if (clips.size() < count) {
      return Fail(ErrorCode::kUsage,
                  "source '" + source.name + "' has " + Counted(static_cast<long long>(clips.size()), "motion") +
                      " of the label '" + place.second + "', " + std::to_string(count) +
                      " are needed, because none is shown twice",
                  "--motions", "set fewer --questions, choose other labels with --label, or add motions");
    }
    Shuffle(Random(static_cast<std::uint64_t>(options.seed), "survey motions", source.name + "\n" + place.second),
            clips);
  }
  SurveyKey key;
  key.kind = options.kind;
  key.real = options.kind == SurveyKind::kRealOrFake ? options.real : "";
  key.seed = options.seed;
  for (const SurveySource& source : sources) key.sources.push_back(source.name);
  std::set<std::string> asked;
  for (const PlannedPage& page : pages) {
    asked.insert(page.label);
    SurveyQuestion question{"q" + ZeroPadded(static_cast<int>(key.questions.size()) + 1, 3), page.label, {}};
    for (const std::size_t s : page.sources) {
      std::vector<std::string>& clips = left[{s, page.label}];
      question.shown.push_back({sources[s].name, clips.back(), ""});
      clips.pop_back();
    }
    key.questions.push_back(std::move(question));
  }
  key.labels.assign(asked.begin(), asked.end());
  return key;
}

std::string TallyToSvg(const nlohmann::ordered_json& tally, const std::string& corner) {
  const bool ranking = !tally.contains("real");
  BarChart chart{ranking ? "Shares of ranks" : "Share of votes that a motion is real"};
  chart.full = 1.0;
  chart.corner = corner;
  for (const nlohmann::ordered_json& row : tally.at("rows")) {
    if (!row.at("label").is_null()) continue;
    BarChart::Row bar{row.at("source").get<std::string>(), {}, row.at("votes") == 0 ? "no answers" : ""};
    const double votes = std::max(1.0, row.at("votes").get<double>());
    const std::vector<double> counts = ranking ? row.at("ranks").get<std::vector<double>>()
                                               : std::vector{row.at("judged_real").at("votes").get<double>()};
    for (std::size_t rank = 0; rank < counts.size(); ++rank) {  // the best rank is the darkest
      const double lighter = 0.85 * static_cast<double>(rank) / static_cast<double>(counts.size());
      bar.parts.push_back({counts[rank] / votes, Lightened(kAfterColour, lighter),
                           ranking ? "rank " + std::to_string(rank + 1) : "judged real"});
    }
    if (row.at("votes") > 0) {
      const auto percent = [&](const char* name) {
        return FixedText(100.0 * row.at(name).at("share").get<double>(), 0) + " %";
      };
      bar.value_text =
          ranking ? percent("first") + " first, " + percent("first_two") + " in the first two" : percent("judged_real");
      if (!ranking) {
        const nlohmann::ordered_json& wilson = row.at("judged_real").at("wilson_95");
        bar.interval = {wilson.at("low").get<double>(), wilson.at("high").get<double>()};
      }
    }
    chart.legend = bar.parts;
    chart.rows.push_back(std::move(bar));
  }
  const auto people = static_cast<long long>(tally.at("participants").size());
  chart.note = people == 0 ? "There are no answers." : Counted(people, "participant") + ".";
  if (const auto skipped = static_cast<long long>(tally.at("skipped").size()); skipped > 0) {
    chart.note += " " + Counted(skipped, "file") + " not counted.";
  }
  if (people > 0 && !ranking) chart.note += " Whiskers: 95 % (Wilson), assuming independent votes.";
  return ToSvg(chart.Draw());
}

}  // namespace mocurate
