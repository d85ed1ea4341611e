#include "ingest/synthetic/take_plan.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace mocurate {

std::string PlannedTake::Key() const {
  return std::to_string(kind->id) + "/" + std::to_string(subject) + "/" + std::to_string(repetition);
}

bool IsWanted(const std::vector<std::string>& wanted, std::initializer_list<const char*> names) {
  return wanted.empty() || std::any_of(names.begin(), names.end(), [&](const char* name) {
           return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
         });
}

Status CheckWanted(const std::vector<std::string>& wanted, const std::vector<std::string>& known) {
  for (const std::string& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = Nearest(name, known);
    std::string all;
    for (std::size_t i = 0; i < known.size(); ++i) {
      const auto place = known.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(known.begin(), place, known[i]) != place) continue;
      all += (all.empty() ? "" : ", ") + known[i];
    }
    return Fail(ErrorCode::kConfig, "the layout has no action '" + name + "'", "actions",
                near ? "did you mean '" + *near + "'?" : "it has " + all);
  }
  return {};
}

Manner NaturalManner(const std::string& action, double seated_share, Random& random) {
  Manner manner;
  const double period = NaturalPeriod(action);
  const double cycles = period > 0.0 ? random.Uniform(2.0, 4.0) : 0.0;
  const double tempo = random.Uniform(0.85, 1.2);
  manner.cycles = std::max(1.0, cycles);
  manner.active_s = NaturalDuration(action, cycles) / tempo;
  manner.amplitude = random.Uniform(0.88, 1.12);
  manner.phase = random.Uniform(-kPi, kPi);
  manner.seated = random.Uniform() < seated_share;
  const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
  if (action == "walk" || action == "run") manner.turn = side * manner.cycles;
  return manner;
}

Expected<std::vector<PlannedTake>> PlanTakes(const StudioOptions& options, const std::vector<SetClass>& classes,
                                             const TakeRules& rules) {
  std::vector<std::string> known;
  for (const SetClass& kind : classes) known.emplace_back(kind.label);
  if (Status wanted = CheckWanted(options.actions, known); !wanted) return Forward(wanted);
  const auto subjects = options.subjects > 0 ? options.subjects : rules.subjects;
  const auto repetitions = options.clips > 0 ? options.clips : rules.repetitions;
  std::vector<PlannedTake> takes;
  for (const SetClass& kind : classes) {
    if (!IsWanted(options.actions, {kind.label})) continue;
    for (int s = 1; s <= subjects; ++s) {
      for (int r = 1; r <= repetitions; ++r) {
        PlannedTake take{&kind, s, r, {}};
        Random random(static_cast<std::uint64_t>(options.seed), "studio.take", take.Key());
        const Manner manner = NaturalManner(kind.action, kind.seated, random);
        const auto frames = [&](double seconds) { return static_cast<int>(std::lround(seconds * rules.rate_hz)); };
        const int begin = frames(random.Uniform(rules.least_rest_s, rules.most_rest_s));
        const int end = begin + std::max(2, frames(manner.active_s));
        take.script.actions.push_back({kind.action, begin, end, manner});
        take.script.frames = end + frames(random.Uniform(rules.least_rest_s, rules.most_rest_s));
        take.script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
        take.script.heading = random.Uniform(-0.2, 0.2);
        takes.push_back(std::move(take));
      }
    }
  }
  return takes;
}

Expected<std::vector<PlannedTake>> PlanNtuTakes(const StudioOptions& options) {
  return PlanTakes(options, NtuClasses(), {40, 2, 30.0, 0.3, 0.7});
}

const std::vector<SetClass>& Cmu8Classes() {
  static const std::vector<SetClass> classes = {{0, "walk", "walk", 0},
                                                {1, "wash", "wave", 0},
                                                {2, "run", "run", 0},
                                                {3, "jump", "jump_vertical", 0},
                                                {4, "animal_behavior", "squat", 0},
                                                {5, "dance", "warm_up_body_lean_left_arm", 0},
                                                {6, "step", "run_on_the_spot", 0},
                                                {7, "climb", "lift_dumbbell_overhead", 0}};
  return classes;
}

const std::vector<SetClass>& KardClasses() {
  static const std::vector<SetClass> classes = {{1, "horizontal_arm_wave", "wave", 0},
                                                {2, "high_arm_wave", "wave", 0},
                                                {3, "two_hand_wave", "cheer_up", 0},
                                                {4, "catch_cap", "salute", 0},
                                                {5, "high_throw", "throw", 0},
                                                {6, "draw_x", "shake_fist", 0},
                                                {7, "draw_tick", "punch", 0},
                                                {8, "toss_paper", "throw_both_hands", 0},
                                                {9, "forward_kick", "kick", 0},
                                                {10, "side_kick", "side_kick", 0},
                                                {11, "take_umbrella", "pick_up", 0},
                                                {12, "bend", "warm_up_bow_right", 0},
                                                {13, "hand_clap", "clap", 0},
                                                {14, "walk", "walk", 0},
                                                {15, "phone_call", "phone_call", 0},
                                                {16, "drink", "drink_bottle_right", 0},
                                                {17, "sit_down", "sit", 0},
                                                {18, "stand_up", "stand_up", 0}};
  return classes;
}

const std::vector<SetClass>& NtuClasses() {
  static const std::vector<SetClass> classes = {{1, "drink_water", "drink_bottle_right", 0.3},
                                                {2, "eat_meal", "eat_right", 0.6},
                                                {6, "pick_up", "pick_up", 0},
                                                {7, "throw", "throw", 0},
                                                {8, "sit_down", "sit", 0},
                                                {9, "stand_up", "stand_up", 0},
                                                {10, "clap", "clap", 0},
                                                {22, "cheer_up", "cheer_up", 0},
                                                {23, "hand_waving", "wave", 0},
                                                {24, "kick_something", "kick", 0},
                                                {27, "jump_up", "jump", 0},
                                                {28, "phone_call", "phone_call", 0.3},
                                                {38, "salute", "salute", 0},
                                                {80, "squat_down", "squat", 0},
                                                {93, "shake_fist", "shake_fist", 0},
                                                {99, "run_on_the_spot", "run_on_the_spot", 0},
                                                {100, "butt_kicks", "butt_kicks", 0},
                                                {102, "side_kick", "side_kick", 0}};
  return classes;
}

const std::vector<SetClass>& Ntu13Classes() {
  static const std::vector<SetClass> classes = [] {
    std::vector<SetClass> chosen;
    for (const int id : {6, 7, 8, 9, 22, 23, 24, 38, 80, 93, 99, 100, 102}) {
      for (const SetClass& kind : NtuClasses()) {
        if (kind.id == id) chosen.push_back(kind);
      }
    }
    return chosen;
  }();
  return classes;
}

const std::vector<SetClass>& UestcClasses() {
  static const std::vector<SetClass> classes = {{0, "punching-and-knee-lifting", "punch_and_knee_lift", 0},
                                                {1, "marking-time-and-knee-lifting", "run_on_the_spot", 0},
                                                {2, "jumping-jack", "jump_hands_up", 0},
                                                {3, "squatting", "squat", 0},
                                                {4, "forward-lunging", "forward_lunge", 0},
                                                {5, "left-lunging", "left_lunge", 0},
                                                {6, "left-stretching", "left_stretch", 0},
                                                {7, "raising-hand-and-jumping", "jump_hands_up", 0},
                                                {8, "left-kicking", "kick", 0},
                                                {9, "rotation-clapping", "clap", 0},
                                                {10, "front-raising", "lift_dumbbell_both", 0},
                                                {11, "pulling-chest-expanders", "warm_up_pectoral", 0},
                                                {12, "punching", "punch", 0},
                                                {13, "wrist-circling", "warm_up_wrist_ankle", 0},
                                                {14, "single-dumbbell-raising", "lift_dumbbell_right", 0},
                                                {15, "shoulder-raising", "cheer_up", 0},
                                                {16, "elbow-circling", "warm_up_pectoral", 0},
                                                {17, "dumbbell-one-arm-shoulder-pressing", "lift_dumbbell_left", 0},
                                                {18, "arm-circling", "cheer_up", 0},
                                                {19, "dumbbell-shrugging", "lift_dumbbell_both", 0},
                                                {20, "pinching-back", "warm_up_pectoral", 0},
                                                {21, "head-anticlockwise-circling", "phone_left", 0},
                                                {22, "shoulder-abduction", "warm_up_body_lean_left_arm", 0},
                                                {23, "deltoid-muscle-stretching", "warm_up_elbow_back", 0},
                                                {24, "straight-forward-flexion", "bend_down", 0},
                                                {25, "spinal-stretching", "spinal_stretch", 0},
                                                {26, "dumbbell-side-bend", "warm_up_body_lean_right_arm", 0},
                                                {27, "standing-opposite-elbow-to-knee-crunch", "run_on_the_spot", 0},
                                                {28, "standing-rotation", "turn", 0},
                                                {29, "overhead-stretching", "lift_dumbbell_overhead", 0},
                                                {30, "upper-back-stretching", "warm_up_elbow_back", 0},
                                                {31, "knee-to-chest", "run_on_the_spot", 0},
                                                {32, "knee-circling", "warm_up_wrist_ankle", 0},
                                                {33, "alternate-knee-lifting", "run_on_the_spot", 0},
                                                {34, "bent-over-twist", "warm_up_bow_left", 0},
                                                {35, "rope-skipping", "rope_skipping", 0},
                                                {36, "standing-toe-touches", "warm_up_bow_right", 0},
                                                {37, "standing-gastrocnemius-calf", "squat", 0},
                                                {38, "single-leg-lateral-hopping", "jump_vertical", 0},
                                                {39, "high-knees-running", "run_on_the_spot", 0}};
  return classes;
}

}  // namespace mocurate
