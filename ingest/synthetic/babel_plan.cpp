#include "ingest/synthetic/babel_plan.h"

#include <algorithm>
#include <cmath>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

/// An action of the studio with BABEL's labels, and how often it is repeated.
struct BabelAction {
  const char* action;
  const char* proc_label;
  std::vector<std::string> categories;
  double least_cycles, most_cycles;
};

const std::vector<BabelAction>& BabelActions() {
  static const std::vector<BabelAction> actions = {{"walk", "walk", {"walk"}, 1.0, 2.5},
                                                   {"run", "run", {"run"}, 1.5, 3.5},
                                                   {"run_on_the_spot", "jog", {"jog"}, 1.5, 3.5},
                                                   {"turn", "turn around", {"turn"}, 1.0, 2.0},
                                                   {"jump", "jump", {"jump"}, 1.0, 1.0},
                                                   {"kick", "kick", {"kick", "foot movements"}, 1.0, 1.0},
                                                   {"sit", "sit down", {"sit"}, 1.0, 1.0},
                                                   {"stand_up", "stand up", {"stand up"}, 1.0, 1.0},
                                                   {"squat", "squat", {"squat"}, 1.0, 1.0},
                                                   {"throw", "throw", {"throw", "arm movements"}, 1.0, 1.0},
                                                   {"pick_up", "pick up", {"take/pick something up"}, 1.0, 1.0},
                                                   {"warm_up_bow_right", "bend over", {"bend"}, 1.0, 1.0},
                                                   {"wave", "wave", {"wave", "gesture"}, 1.5, 3.5},
                                                   {"punch", "punch", {"punch", "martial art"}, 1.0, 2.5},
                                                   {"clap", "clap", {"clap"}, 1.5, 3.5},
                                                   {"salute", "salute", {"gesture", "greet"}, 1.0, 1.0}};
  return actions;
}

constexpr int kLeastActions = 5, kMostActions = 9;
constexpr double kTransition_s = 0.7;

}  // namespace

AnnotatedSequence PlanBabelSequence(const StudioOptions& options, int subject, int number, double rate_hz) {
  AnnotatedSequence annotated{{subject, number, {}, {}}, {}};
  PlannedSequence& sequence = annotated.sequence;
  Random random(static_cast<std::uint64_t>(options.seed), "studio.babel_sequence", sequence.Key());
  std::vector<const BabelAction*> choice;
  for (const BabelAction& action : BabelActions()) {
    const auto& only = options.actions;
    const bool wanted = only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& name) {
                          return name == action.proc_label || name == action.action;
                        });
    if (wanted) choice.push_back(&action);
  }
  Script& script = sequence.script;
  script.transition_s = kTransition_s;
  const auto frames = [&](double seconds) { return static_cast<int>(std::lround(seconds * rate_hz)); };
  int frame = frames(random.Uniform(0.6, 2.0));
  const int count = kLeastActions + static_cast<int>(random.Below(kMostActions - kLeastActions + 1));
  for (int k = 0; k < count; ++k) {
    const BabelAction& action = *choice[random.Below(choice.size())];
    Manner manner = NaturalManner(action.action, 0.0, random);
    const bool repeats = NaturalPeriod(action.action) > 0.0;
    manner.cycles = random.Uniform(action.least_cycles, action.most_cycles);
    manner.active_s = NaturalDuration(action.action, repeats ? manner.cycles : 0.0) / random.Uniform(0.9, 1.25);
    const int end = frame + std::max(2, frames(manner.active_s));
    script.actions.push_back({action.action, frame, end, manner});
    annotated.words.push_back({action.proc_label, action.categories});
    // Half of the actions follow each other directly: the transition fills the time between them.
    const bool rests = random.Uniform() < 0.5;
    frame = end + frames(rests ? random.Uniform(1.8, 3.5) : kTransition_s);
  }
  script.frames = frame;
  script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  script.heading = random.Uniform(-kPi, kPi);
  return annotated;
}

Status CheckBabelWords(const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const BabelAction& action : BabelActions()) known.insert(known.end(), {action.proc_label, action.action});
  return CheckWanted(wanted, known);
}

}  // namespace mocurate
