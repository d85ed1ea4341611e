#include "ingest/synthetic/humanact12_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/base/random.h"
#include "core/base/text.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

constexpr double kHumanAct12RateHz = 15.0;
constexpr double kHurried = 0.6;       // of its natural time: a shorter clip shows a part of the action
constexpr double kStepsPerTurn = 1.0;  // radians along the circle per cycle of walking
constexpr std::array<double, 7> kShares = {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0};

/// A coarse class: its label, the group of PHSPD's recordings that it was cut from, the share of clips on a chair.
struct CoarseClass {
  const char* label;
  int group;
  double seated;
};

/// 01 to 12.
constexpr CoarseClass kClasses[] = {{"warm_up", 1, 0.0}, {"walk", 1, 0.0},   {"run", 1, 0.0},
                                    {"jump", 1, 0.0},    {"drink", 1, 0.0},  {"lift_dumbbell", 1, 0.0},
                                    {"sit", 2, 0.0},     {"eat", 2, 0.7},    {"turn_steering_wheel", 2, 1.0},
                                    {"phone", 2, 0.4},   {"boxing", 3, 0.0}, {"throw", 3, 0.0}};

struct VariantRow {
  const char* code;
  const char* action;
  std::array<int, 7> frames;
  std::array<int, kHumanAct12Subjects> clips;
};

constexpr VariantRow kVariants[] = {
    // code, action, quantiles of frames, clips of subjects 1 to 12
    {"0101", "warm_up_wrist_ankle", {45, 53, 64, 85, 113, 128, 168}, {4, 1, 2, 4, 4, 1, 3, 1, 0, 3, 2, 0}},
    {"0102", "warm_up_pectoral", {26, 32, 43, 64, 83, 98, 159}, {4, 4, 5, 4, 3, 4, 4, 4, 4, 4, 5, 4}},
    {"0103", "warm_up_elbow_back", {9, 26, 50, 72, 87, 109, 145}, {4, 4, 2, 4, 4, 1, 4, 4, 3, 4, 5, 4}},
    {"0104", "warm_up_body_lean_right_arm", {18, 19, 29, 36, 51, 57, 72}, {1, 2, 4, 0, 1, 4, 4, 3, 1, 1, 4, 1}},
    {"0105", "warm_up_body_lean_left_arm", {12, 21, 31, 37, 44, 49, 67}, {1, 1, 4, 0, 1, 4, 4, 3, 1, 1, 4, 0}},
    {"0106", "warm_up_bow_right", {20, 27, 36, 39, 50, 64, 78}, {1, 4, 3, 0, 1, 0, 3, 3, 3, 1, 3, 2}},
    {"0107", "warm_up_bow_left", {14, 20, 30, 38, 51, 81, 112}, {1, 3, 3, 0, 1, 0, 3, 3, 3, 1, 3, 3}},
    {"0201", "walk", {45, 83, 120, 159, 208, 262, 354}, {4, 4, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4}},
    {"0301", "run", {33, 76, 99, 121, 172, 199, 357}, {4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 6}},
    {"0401", "jump_hands_up", {21, 56, 71, 93, 121, 166, 208}, {4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 10, 4}},
    {"0402", "jump_vertical", {22, 32, 51, 69, 84, 112, 165}, {2, 4, 3, 4, 1, 4, 4, 4, 1, 3, 5, 5}},
    {"0501", "drink_bottle_right", {23, 35, 51, 74, 97, 104, 154}, {4, 3, 0, 3, 0, 2, 4, 2, 4, 0, 3, 2}},
    {"0502", "drink_bottle_left", {32, 41, 50, 69, 96, 129, 153}, {4, 4, 4, 3, 4, 3, 4, 4, 4, 0, 5, 4}},
    {"0503", "drink_cup_right", {22, 25, 28, 55, 82, 103, 120}, {0, 1, 0, 1, 4, 1, 0, 1, 0, 0, 2, 1}},
    {"0504", "drink_cup_left", {15, 15, 15, 64, 120, 120, 120}, {0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0}},
    {"0505", "drink_both_hands", {143, 143, 155, 159, 159, 200, 200}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0}},
    {"0601", "lift_dumbbell_right", {9, 21, 44, 58, 67, 85, 134}, {4, 4, 3, 4, 3, 3, 4, 4, 4, 4, 4, 4}},
    {"0602", "lift_dumbbell_left", {9, 22, 34, 50, 67, 84, 111}, {4, 4, 4, 4, 3, 3, 4, 4, 4, 4, 3, 4}},
    {"0603", "lift_dumbbell_both", {12, 34, 53, 60, 78, 112, 177}, {4, 3, 4, 4, 4, 3, 4, 4, 4, 4, 5, 4}},
    {"0604", "lift_dumbbell_overhead", {28, 46, 64, 85, 103, 123, 194}, {5, 3, 4, 4, 3, 3, 4, 4, 1, 4, 4, 4}},
    {"0605", "lift_dumbbell_both_bend_legs", {17, 32, 67, 81, 94, 119, 187}, {2, 3, 4, 4, 3, 1, 4, 4, 2, 4, 3, 4}},
    {"0701", "sit", {8, 26, 34, 42, 54, 66, 108}, {4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 7, 7}},
    {"0801", "eat_right", {17, 34, 50, 67, 101, 121, 195}, {5, 0, 4, 1, 1, 2, 1, 1, 3, 4, 5, 6}},
    {"0802", "eat_left", {23, 31, 46, 61, 99, 117, 138}, {2, 4, 2, 3, 2, 2, 2, 3, 0, 0, 3, 2}},
    {"0803", "eat_both_hands", {22, 23, 29, 44, 68, 79, 115}, {0, 4, 3, 2, 1, 0, 2, 1, 0, 0, 5, 1}},
    {"0901", "steering_wheel", {15, 38, 51, 100, 150, 207, 264}, {4, 3, 4, 4, 4, 4, 4, 4, 3, 4, 8, 10}},
    {"1001", "phone_call", {57, 66, 77, 127, 198, 244, 284}, {4, 0, 1, 4, 1, 1, 0, 2, 0, 0, 6, 9}},
    {"1002", "phone_left", {24, 118, 175, 248, 313, 379, 471}, {0, 4, 4, 0, 4, 3, 4, 2, 4, 4, 4, 0}},
    {"1101", "boxing_left_right", {17, 24, 33, 51, 65, 71, 115}, {7, 4, 2, 0, 0, 2, 0, 0, 3, 3, 0, 5}},
    {"1102", "boxing_left_upwards", {11, 19, 24, 30, 34, 38, 57}, {3, 4, 3, 3, 4, 4, 4, 4, 3, 1, 1, 5}},
    {"1103", "boxing_right_upwards", {12, 20, 25, 30, 37, 43, 69}, {2, 4, 4, 4, 4, 4, 4, 2, 4, 4, 1, 4}},
    {"1104", "boxing_right_left", {21, 30, 33, 55, 69, 83, 93}, {0, 0, 0, 4, 1, 2, 4, 3, 2, 3, 5, 10}},
    {"1201", "throw", {15, 22, 30, 35, 45, 59, 75}, {3, 1, 4, 4, 3, 4, 4, 4, 4, 4, 12, 6}},
    {"1202", "throw_both_hands", {12, 16, 22, 30, 42, 59, 99}, {0, 3, 4, 4, 3, 3, 1, 4, 0, 4, 7, 5}},
};

struct PlannedClip {
  const HumanAct12Variant* variant = nullptr;
  int subject = 1;
  int number = 0;  ///< of this subject and variant
  int frames = 0;

  std::string Name() const {
    return std::string(variant->code) + "/" + std::to_string(subject) + "/" + std::to_string(number);
  }
};

bool IsWantedVariant(const HumanAct12Variant& variant, const std::vector<std::string>& actions) {
  return IsWanted(actions, {variant.label, variant.action, variant.code});
}

/// Every clip of the real set, its length one step of the distribution; the clips of a subject come in order.
std::vector<PlannedClip> ClipsOf(const HumanAct12Variant& variant, std::uint64_t seed) {
  std::vector<PlannedClip> clips;
  for (int subject = 1; subject <= kHumanAct12Subjects; ++subject) {
    for (int n = 0; n < variant.clips[subject - 1]; ++n) clips.push_back({&variant, subject, n, 0});
  }
  std::vector<std::size_t> step(clips.size());
  std::iota(step.begin(), step.end(), std::size_t{0});
  Random order(seed, "studio.span", variant.code);
  for (std::size_t i = step.size(); i > 1; --i) std::swap(step[i - 1], step[order.Below(i)]);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const double share = (static_cast<double>(step[i]) + order.Uniform()) / static_cast<double>(clips.size());
    clips[i].frames = SpanAt(variant, share);
  }
  return clips;
}

/// How a clip is performed, and the frames of the whole action.
std::pair<Manner, int> MannerOf(const PlannedClip& clip, std::uint64_t seed) {
  Random random(seed, "studio.manner", clip.Name());
  const std::string action = clip.variant->action;
  const double period = NaturalPeriod(action);
  const double least = kHurried * NaturalDuration(action, period > 0.0 ? 1.0 : 0.0);
  const int frames = std::max(clip.frames, static_cast<int>(std::ceil(least * kHumanAct12RateHz)));
  Manner manner;
  manner.active_s = frames / kHumanAct12RateHz;
  manner.amplitude = random.Uniform(0.88, 1.12);
  manner.phase = random.Uniform(-kPi, kPi);
  const double once = NaturalDuration(action, 0.0);
  if (period > 0.0) {
    manner.cycles = std::max(0.6, (manner.active_s - 0.5 * once) / (period * random.Uniform(0.85, 1.2)));
  }
  manner.seated = random.Uniform() < clip.variant->seated;
  const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
  if (action == "walk" || action == "run") manner.turn = side * kStepsPerTurn * manner.cycles;
  return {manner, frames};
}

void AddClip(const PlannedClip& clip, std::uint64_t seed, PlannedRecording& recording) {
  Random random(seed, "studio.rest", clip.Name());
  const auto [manner, frames] = MannerOf(clip, seed);
  const int rest = 14 + static_cast<int>(random.Below(22));
  const int begin = recording.script.frames + rest;
  recording.script.actions.push_back({clip.variant->action, begin, begin + frames, manner});
  recording.script.frames = begin + frames;
  const int first = begin + (frames - clip.frames) / 2;
  recording.clips.push_back({clip.variant, first, first + clip.frames - 1});
}

}  // namespace

const std::vector<HumanAct12Variant>& HumanAct12Variants() {
  static const std::vector<HumanAct12Variant> variants = [] {
    std::vector<HumanAct12Variant> all;
    for (const VariantRow& row : kVariants) {
      const CoarseClass& coarse = kClasses[std::stoi(std::string(row.code, 2)) - 1];
      all.push_back({row.code, coarse.label, row.action, coarse.group, coarse.seated, row.frames, row.clips});
    }
    return all;
  }();
  return variants;
}

int SpanAt(const HumanAct12Variant& variant, double share) {
  std::size_t k = 1;
  while (k + 1 < kShares.size() && share > kShares[k]) ++k;
  const double part = std::clamp((share - kShares[k - 1]) / (kShares[k] - kShares[k - 1]), 0.0, 1.0);
  return static_cast<int>(std::lround((1.0 - part) * variant.frames[k - 1] + part * variant.frames[k]));
}

std::vector<PlannedRecording> PlanHumanAct12(const StudioOptions& options) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  std::map<std::tuple<int, int, int>, PlannedRecording> recordings;
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    if (!IsWantedVariant(variant, options.actions)) continue;
    for (const PlannedClip& clip : ClipsOf(variant, seed)) {
      if (options.subjects > 0 && clip.subject > options.subjects) continue;
      if (options.clips > 0 && clip.number >= options.clips) continue;
      const int time = clip.number % 4 + 1;
      PlannedRecording& recording = recordings[{clip.subject, variant.group, time}];
      recording.subject = clip.subject;
      recording.group = variant.group;
      recording.time = time;
      AddClip(clip, seed, recording);
    }
  }
  std::vector<PlannedRecording> planned;
  for (auto& [key, recording] : recordings) {
    recording.script.frames += 15;
    Random random(seed, "studio.recording",
                  std::to_string(recording.subject) + "/" + std::to_string(recording.group) + "/" +
                      std::to_string(recording.time));
    recording.script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
    recording.script.heading = random.Uniform(-0.2, 0.2);
    planned.push_back(std::move(recording));
  }
  return planned;
}

std::string PlannedSequence::Person() const { return "p" + ZeroPadded(subject, 2); }

PlannedSequence PlanSequence(const StudioOptions& options, int subject, int number, int least, int most,
                             double rate_hz) {
  PlannedSequence sequence{subject, number, {}, {}};
  Random random(static_cast<std::uint64_t>(options.seed), "studio.sequence", sequence.Key());
  std::vector<const HumanAct12Variant*> choice;
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    if (IsWantedVariant(variant, options.actions)) choice.push_back(&variant);
  }
  int frame = static_cast<int>(random.Uniform(0.3, 1.5) * rate_hz);
  const int actions = least + static_cast<int>(random.Below(static_cast<std::uint64_t>(most - least + 1)));
  for (int k = 0; k < actions; ++k) {
    const HumanAct12Variant* variant = choice[random.Below(choice.size())];
    const Manner manner = NaturalManner(variant->action, variant->seated, random);
    const int end = frame + std::max(2, static_cast<int>(std::lround(manner.active_s * rate_hz)));
    sequence.script.actions.push_back({variant->action, frame, end, manner});
    sequence.kinds.push_back(variant);
    frame = end + static_cast<int>(random.Uniform(0.6, 2.2) * rate_hz);
  }
  sequence.script.frames = frame;
  sequence.script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  sequence.script.heading = random.Uniform(-kPi, kPi);
  return sequence;
}

PlannedSequence PlanDepthSequence(const StudioOptions& options, int subject) {
  constexpr int kActions = 4;
  const int actions = options.clips > 0 ? static_cast<int>(options.clips) : kActions;
  PlannedSequence sequence = PlanSequence(options, subject, 1, actions, actions, kDepthSequenceHz);
  sequence.script.heading = 0.1 * sequence.script.heading;
  return sequence;
}

Status CheckVariants(const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    known.insert(known.end(), {variant.label, variant.action, variant.code});
  }
  return CheckWanted(wanted, known);
}

}  // namespace mocurate
