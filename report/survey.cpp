#include "report/survey.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::size_t kUsualQuestions = 40;

/// One item of a round: a pair of sources or one source, with a label.
struct SurveyCell {
  std::vector<std::size_t> sources;  ///< indices of the sources
  std::string sources_name;          ///< theirs, one a line
  std::string label;                 ///< what is asked about
  std::vector<std::vector<std::string>>
      motions;                ///< of each of the sources, clips in the order in which they are shown
  std::size_t questions = 0;  ///< maximum that the motions allow
};

void Shuffle(Random random, std::vector<std::size_t>& values) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.Below(i)]);
}

std::vector<std::size_t> Counting(std::size_t count) {
  std::vector<std::size_t> values(count);
  std::iota(values.begin(), values.end(), std::size_t{0});
  return values;
}

Status CheckSources(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  std::vector<std::string> names;
  for (const SurveySource& source : sources) {
    if (std::find(names.begin(), names.end(), source.name) != names.end()) {
      return Fail(ErrorCode::kUsage, "two sources have the name '" + source.name + "'", "--motions",
                  "give each its own name: --motions NAME=FILE");
    }
    names.push_back(source.name);
  }
  if (names.size() < 2) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(names.size()), "source") + ", at least 2 are required", "--motions",
                "--motions NAME=FILE --motions NAME=FILE");
  }
  if (options.kind == SurveyKind::kRealOrFake && std::find(names.begin(), names.end(), options.real) == names.end()) {
    return Fail(ErrorCode::kUsage, "no source has the name '" + options.real + "' of the recordings", "--real",
                "the sources are: " + JoinTexts(names) + "; set --real to that of the recordings");
  }
  return {};
}

/// Labels that every source has, in the order of their names, or those of `options` among them.
Expected<std::vector<std::string>> LabelsToAsk(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  std::map<std::string, std::size_t> sources_with;
  for (const SurveySource& source : sources) {
    std::set<std::string> labels;
    for (const SurveySource::Motion& motion : source.motions) labels.insert(motion.label);
    labels.erase("");
    if (labels.empty()) {
      return Fail(ErrorCode::kInconsistent,
                  "none of its " + Counted(static_cast<long long>(source.motions.size()), "motion") + " has a label",
                  source.name, "use motions with labels: a dataset, or --labels FILE");
    }
    for (const std::string& label : labels) ++sources_with[label];
  }
  std::vector<std::string> common;
  for (const auto& [label, count] : sources_with) {
    if (count == sources.size()) common.push_back(label);
  }
  if (common.empty()) {
    return Fail(ErrorCode::kInconsistent, "the sources have no label in common", "--motions",
                "unify the labels with `mocurate dataset relabel`");
  }
  if (options.labels.empty()) return common;
  std::vector<std::string> chosen;
  for (const std::string& label : options.labels) {
    if (std::find(common.begin(), common.end(), label) == common.end()) {
      return Fail(ErrorCode::kUsage, "not every source has motions of the label '" + label + "'", "--label",
                  NearestOfAll(label, common, "all have: "));
    }
    if (std::find(chosen.begin(), chosen.end(), label) == chosen.end()) chosen.push_back(label);
  }
  return chosen;
}

std::vector<SurveyCell> CellsOf(const SurveyOptions& options, const std::vector<SurveySource>& sources,
                                const std::vector<std::string>& labels) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t a = 0; a < sources.size(); ++a) {
    if (options.kind == SurveyKind::kRealOrFake) groups.push_back({a});
    for (std::size_t b = a + 1; options.kind == SurveyKind::kPreference && b < sources.size(); ++b) {
      groups.push_back({a, b});
    }
  }
  std::vector<SurveyCell> cells;
  for (const std::vector<std::size_t>& group : groups) {
    for (const std::string& label : labels) {
      SurveyCell cell{group, "", label, {}, 0};
      for (const std::size_t place : group) cell.sources_name += sources[place].name + "\n";
      for (const std::size_t place : group) {
        std::vector<std::string> clips;
        for (const SurveySource::Motion& motion : sources[place].motions) {
          if (motion.label == label) clips.push_back(motion.clip);
        }
        std::vector<std::size_t> order = Counting(clips.size());
        Shuffle(Random(static_cast<std::uint64_t>(options.seed), "survey motions",
                       cell.sources_name + sources[place].name + "\n" + label),
                order);
        std::vector<std::string> drawn;
        for (const std::size_t i : order) drawn.push_back(clips[i]);
        cell.questions = cell.motions.empty() ? drawn.size() : std::min(cell.questions, drawn.size());
        cell.motions.push_back(std::move(drawn));
      }
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

/// Which of a pair is on the left in its n-th question: each once in the questions 2k and 2k+1.
bool IsExchanged(const SurveyOptions& options, const std::string& pair, std::size_t n) {
  Random side(static_cast<std::uint64_t>(options.seed), "survey sides", pair + std::to_string(n / 2));
  return (side.Below(2) + n) % 2 == 1;
}

}  // namespace

std::string_view Name(SurveyKind kind) { return kind == SurveyKind::kPreference ? "preference" : "real_or_fake"; }

std::array<std::string, 2> AnswersOf(SurveyKind kind) {
  return kind == SurveyKind::kPreference ? std::array<std::string, 2>{"left", "right"}
                                         : std::array<std::string, 2>{"real", "generated"};
}

Expected<SurveyKey> DrawSurvey(const SurveyOptions& options, const std::vector<SurveySource>& sources) {
  if (Status sound = CheckSources(options, sources); !sound) return Forward(sound);
  auto labels = LabelsToAsk(options, sources);
  if (!labels) return Forward(labels);
  const std::vector<SurveyCell> cells = CellsOf(options, sources, *labels);
  std::size_t most = 0;
  for (const SurveyCell& cell : cells) most += cell.questions;
  const std::size_t wanted =
      options.questions == 0 ? std::min(most, kUsualQuestions) : static_cast<std::size_t>(options.questions);
  if (wanted > most) {
    return Fail(ErrorCode::kUsage,
                Counted(options.questions, "question") + " are requested, the motions suffice for " +
                    std::to_string(most) + ", because none is shown twice",
                "--questions", "--questions " + std::to_string(most) + ", or add motions");
  }
  SurveyKey key;
  key.kind = options.kind;
  key.real = options.kind == SurveyKind::kRealOrFake ? options.real : "";
  key.seed = options.seed;
  key.labels = std::move(*labels);
  for (const SurveySource& source : sources) key.sources.push_back(source.name);
  std::map<std::string, std::size_t> asked;  // of each pair
  for (std::size_t round = 0; key.questions.size() < wanted; ++round) {
    std::vector<std::size_t> order = Counting(cells.size());
    Shuffle(Random(static_cast<std::uint64_t>(options.seed), "survey order", std::to_string(round)), order);
    for (const std::size_t i : order) {
      const SurveyCell& cell = cells[i];
      if (cell.questions <= round || key.questions.size() == wanted) continue;
      const int number = static_cast<int>(key.questions.size()) + 1;
      SurveyQuestion question{"q" + ZeroPadded(number, 3), cell.label, {}};
      for (std::size_t s = 0; s < cell.sources.size(); ++s) {
        question.shown.push_back({sources[cell.sources[s]].name, cell.motions[s][round], ""});
      }
      if (question.shown.size() == 2 && IsExchanged(options, cell.sources_name, asked[cell.sources_name]++)) {
        std::swap(question.shown[0], question.shown[1]);
      }
      key.questions.push_back(std::move(question));
    }
  }
  return key;
}

}  // namespace mocurate
