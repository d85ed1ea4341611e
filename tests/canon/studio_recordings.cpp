#include "tests/canon/studio_recordings.h"

#include <algorithm>
#include <utility>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {

std::vector<double> InnerTimes(std::vector<double> times, double duration_s) {
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  const auto outside = [&](double t) { return t < 0.05 || t > duration_s - 0.05; };
  times.erase(std::remove_if(times.begin(), times.end(), outside), times.end());
  return times;
}

std::vector<LongRecording> StudioRecordings(std::int64_t seed, int subjects, int sequences, FrameRate rate) {
  StudioOptions options;
  options.seed = seed;
  std::vector<LongRecording> recordings;
  const auto actors = ActorsOf(options, subjects, nullptr);
  for (int subject = 1; actors && subject <= subjects; ++subject) {
    for (int number = 1; number <= sequences; ++number) {
      const PlannedSequence plan = PlanSequence(options, subject, number, 3, 6, rate.hz());
      const Actor& actor = (*actors)[static_cast<std::size_t>(subject - 1)];
      LongRecording recording;
      recording.name = plan.Person() + "/" + std::to_string(number);
      recording.motion = PerformScript(plan.script, actor.subject, actor.skeleton, rate);
      std::vector<double> times;
      for (const ScriptedAction& action : plan.script.actions) {
        Segment segment{rate.FrameTime(action.begin), rate.FrameTime(action.end), action.action, action.action, ""};
        times.insert(times.end(), {segment.begin_s, segment.end_s});
        for (const std::string from : {"drink_bottle", "drink_cup"}) {
          if (segment.category.rfind(from, 0) == 0) segment.category.replace(0, from.size(), "drink");
        }
        if (segment.category == "boxing_right_left") segment.category = "boxing_left_right";
        recording.segments.push_back(std::move(segment));
      }
      recording.truth_s = InnerTimes(std::move(times), recording.motion.duration());
      const std::vector<ScriptSpan> ways = Transitions(plan.script, rate);
      for (std::size_t k = 0; k < ways.size(); ++k) {
        const Manner& from = plan.script.actions[k].manner;
        const Manner& to = plan.script.actions[k + 1].manner;
        const std::string& before = plan.script.actions[k].action;
        const bool moves = from.seated != to.seated || before == "sit" || before == "turn" || from.turn != 0.0;
        if (moves && ways[k].end < plan.script.actions[k + 1].begin)
          recording.ways_s.push_back(rate.FrameTime(ways[k].end));
      }
      recordings.push_back(std::move(recording));
    }
  }
  return recordings;
}

LongRecording StudioExercise(std::int64_t seed, const std::string& action, int person, int cycles, FrameRate rate) {
  StudioOptions options;
  options.seed = seed;
  LongRecording recording;
  recording.name = action + "/" + std::to_string(person) + "/" + std::to_string(cycles);
  const auto actors = ActorsOf(options, 4, nullptr);
  if (!actors) return recording;
  Random random(static_cast<std::uint64_t>(seed), "studio exercise", recording.name);
  Manner manner = NaturalManner(action, 0.0, random);
  if (cycles > 0) {
    manner.cycles = cycles;
    manner.active_s = NaturalDuration(action, cycles) / random.Uniform(0.85, 1.2);
  }
  Script script;
  const int begin = static_cast<int>(rate.hz() * random.Uniform(0.2, 1.0));
  const int end = begin + static_cast<int>(rate.hz() * manner.active_s);
  script.actions.push_back({action, begin, end, manner});
  script.frames = end + static_cast<int>(rate.hz() * random.Uniform(0.2, 1.0));
  script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  const Actor& actor = (*actors)[static_cast<std::size_t>(person)];
  recording.motion = PerformScript(script, actor.subject, actor.skeleton, rate);
  recording.segments = {{rate.FrameTime(begin), rate.FrameTime(end), action, action, ""}};
  return recording;
}

}  // namespace mocurate
