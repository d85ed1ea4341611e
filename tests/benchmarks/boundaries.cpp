// Accuracy of cuts of recordings: change points, repetitions, spans by example. Prints the tables of docs/trimming.md.
//
//   bench_boundaries [change_points|cycles|by_example|all] [SEED [RECORDINGS]]
//
// SEED selects the studio's people and the clips that are joined. The constants of change points were chosen with seeds
// 101 and 102 of the studio, KARD and Bandai 1; the confidence of spans by example with seeds 1 and 2. Joined clips
// need the unpacked data (MOCURATE_DATA).

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>

#include "canon/trim/by_example.h"
#include "canon/trim/trim.h"
#include "core/base/text.h"
#include "core/formats/depth_sequence.h"
#include "core/motion/operations.h"
#include "tests/benchmarks/joined_recordings.h"
#include "tests/support/boundary_score.h"

namespace mocurate {
namespace {

constexpr double kLeastClipS = 1.0;  // of joined clips: closer seams lie within the tolerances

/// Boundaries of one recording with confidences.
struct FoundBoundaries {
  std::vector<double> times_s;
  std::vector<double> confidence;
};

FoundBoundaries ByChangePoints(const Motion& motion) {
  FoundBoundaries found;
  const auto segments = ProposeSegments(ChangePointOptions(), motion);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    found.times_s.push_back(motion.rate.FrameTime(segments[i].begin));
    found.confidence.push_back(segments[i].confidence);
  }
  return found;
}

/// Times at which the fastest joint crosses a speed and stays on that side for 0.3 s.
FoundBoundaries BySpeed(const Motion& motion, double speed) {
  const std::vector<double> speeds = FrameSpeeds(motion, kSpeedWindow_s);
  const int least = std::max(1, static_cast<int>(std::lround(0.3 * motion.rate.hz())));
  FoundBoundaries found;
  bool moving = !speeds.empty() && speeds[0] >= speed;
  for (int f = 1; f + least <= static_cast<int>(speeds.size()); ++f) {
    const bool changes =
        std::all_of(speeds.begin() + f, speeds.begin() + f + least, [&](double s) { return (s >= speed) != moving; });
    if (!changes) continue;
    moving = !moving;
    found.times_s.push_back(motion.rate.FrameTime(f));
  }
  found.confidence.assign(found.times_s.size(), 1.0);
  return found;
}

/// The middle of each stillness of at least 0.3 s within the recording.
FoundBoundaries ByStillness(const Motion& motion, double speed) {
  const FoundBoundaries passes = BySpeed(motion, speed);
  const std::vector<double> speeds = FrameSpeeds(motion, kSpeedWindow_s);
  FoundBoundaries found;
  for (std::size_t i = 0; i + 1 < passes.times_s.size(); ++i) {
    const auto frame = static_cast<std::size_t>(std::lround(passes.times_s[i] * motion.rate.hz()));
    if (speeds[frame] < speed) found.times_s.push_back(0.5 * (passes.times_s[i] + passes.times_s[i + 1]));
  }
  found.confidence.assign(found.times_s.size(), 1.0);
  return found;
}

using Judged = std::vector<std::pair<double, bool>>;  // confidence, right

/// Probability that a correct boundary has a higher confidence than a wrong one; 0.5 if either set is empty.
double RankQuality(const Judged& judged) {
  double pairs = 0.0, won = 0.0;
  for (const auto& [a, right] : judged) {
    for (const auto& [b, other] : judged) {
      if (!right || other) continue;
      pairs += 1.0;
      won += a > b ? 1.0 : a == b ? 0.5 : 0.0;
    }
  }
  return pairs > 0.0 ? won / pairs : 0.5;
}

using Recordings = std::vector<LongRecording>;

/// The recorded take of the rendered sequence, from its JSON: 12 Hz, idle counts as rest.
Recordings RenderedSequence() {
  Recordings recordings;
  const std::string file = TestData() + "/clouds/rendered_seq/seq_male.json";
  const auto bytes = ReadFile(file);
  const auto skeleton = LoadSkeleton("smpl24");
  if (!bytes || !skeleton) return recordings;
  const auto sequence = ParseDepthSequence(*bytes, file);
  const auto truth = ParseDepthSequenceTruth(*bytes, file);
  if (!sequence || !truth) return recordings;
  JointPositions joints(truth->frames, truth->joints);
  for (int f = 0; f < truth->frames; ++f) {
    for (int j = 0; j < truth->joints; ++j) {
      const Vector3d& place = truth->joint[static_cast<std::size_t>(f) * static_cast<std::size_t>(truth->joints) +
                                           static_cast<std::size_t>(j)];
      joints.at(f, j) = Vector3d(place.x(), -place.y(), -place.z());
    }
  }
  LongRecording recording;
  recording.motion = MakeJointsOnly(*skeleton, FrameRate::FromHz(truth->fps), joints);
  for (const DepthSequenceLabel& label : sequence->labels) recording.truth_s.push_back(label.first / truth->fps);
  recording.truth_s = InnerTimes(recording.truth_s, recording.motion.duration());
  recordings.push_back(std::move(recording));
  return recordings;
}

template <class Find>
Judged PrintRow(const std::string& set, const char* method, const Recordings& recordings, const Find& find) {
  BoundaryScore half, quarter;
  Judged judged;
  double seconds = 0.0, length_s = 0.0;
  for (const LongRecording& recording : recordings) {
    const auto begin = std::chrono::steady_clock::now();
    const FoundBoundaries found = find(recording.motion);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    length_s += recording.motion.duration();
    half.Add(ScoreBoundaries(found.times_s, recording.truth_s, 0.5));
    quarter.Add(ScoreBoundaries(found.times_s, recording.truth_s, 0.25));
    std::vector<bool> right(found.times_s.size(), false);
    for (const auto& pair : MatchBoundaries(found.times_s, recording.truth_s, 0.5)) {
      right[static_cast<std::size_t>(pair.first)] = true;
    }
    for (std::size_t i = 0; i < right.size(); ++i) judged.emplace_back(found.confidence[i], right[i]);
  }
  std::printf("| %s | %s | %zu | %d | %.3f | %.3f | %.3f | %.3f | %.0f | %.2f | %.2f |\n", set.c_str(), method,
              recordings.size(), half.truth, half.f1(), half.precision(), half.recall(), quarter.f1(),
              1000.0 * half.median_s(), RankQuality(judged), 60.0 * seconds / length_s);
  return judged;
}

void PrintConfidences(const Judged& judged) {
  std::printf("\n| confidence | boundaries | right |\n|---|---|---|\n");
  const double edges[] = {0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 1.01};
  for (int k = 0; k < 6; ++k) {
    int count = 0, right = 0;
    for (const auto& [confidence, is_right] : judged) {
      if (confidence < edges[k] || confidence >= edges[k + 1]) continue;
      ++count;
      right += is_right ? 1 : 0;
    }
    std::printf("| %.1f to %.1f | %d | %.2f |\n", edges[k], std::min(1.0, edges[k + 1]), count,
                count > 0 ? static_cast<double>(right) / count : 0.0);
  }
}

Judged PrintSet(const std::string& set, const Recordings& recordings) {
  if (recordings.empty()) return {};
  Judged judged = PrintRow(set, "change points", recordings, ByChangePoints);
  for (const double speed : {0.15, 0.3}) {
    const std::string method = "speed " + RoundedText(speed) + " m/s";
    PrintRow(set, method.c_str(), recordings, [&](const Motion& motion) { return BySpeed(motion, speed); });
    const std::string middle = "middle of stillness, " + RoundedText(speed) + " m/s";
    PrintRow(set, middle.c_str(), recordings, [&](const Motion& motion) { return ByStillness(motion, speed); });
  }
  return judged;
}

void ChangePointTable(std::int64_t seed, int recordings) {
  std::printf(
      "| set | method | recordings | boundaries | F1 at 0.5 s | precision | recall | F1 at 0.25 s | median, ms | AUC "
      "of "
      "confidence | s per minute |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  const int subjects = std::max(1, recordings / 5);
  Recordings studio = StudioRecordings(seed, subjects, 5);
  Judged judged = PrintSet("studio", studio);
  for (LongRecording& recording : studio) {
    recording.truth_s.insert(recording.truth_s.end(), recording.ways_s.begin(), recording.ways_s.end());
    recording.truth_s = InnerTimes(recording.truth_s, recording.motion.duration());
  }
  PrintRow("studio, ends of transitions counted too", "change points", studio, ByChangePoints);
  if (TestData().empty()) return;
  const std::vector<std::pair<std::string, std::string>> sets = {
      {"msr_action3d", "kinect20"}, {"hdm05", "cmu31"}, {"bandai2", "bandai22"}, {"kard", "openni15"}};
  Recordings joined;
  for (const auto& [source, skeleton] : sets) {
    Recordings of_set = JoinedRecordings(ClipsByPerson(source, skeleton, kLeastClipS), recordings, seed);
    PrintSet(source + ", joined", of_set);
    std::move(of_set.begin(), of_set.end(), std::back_inserter(joined));
  }
  const Judged of_joined = PrintSet("all joined", joined);
  judged.insert(judged.end(), of_joined.begin(), of_joined.end());
  PrintSet("rendered_seq", RenderedSequence());
  PrintConfidences(judged);
}

Motion Noisy(const Motion& motion, double sigma) {
  Random random(9, "tracker noise");
  JointPositions joints = motion.joints;
  for (double& value : joints.xyz) value += sigma * random.Normal();
  return MakeJointsOnly(motion.skeleton, motion.rate, joints);
}

/// Errors of counts: found minus true.
struct CountErrors {
  std::map<int, int> histogram;
  int right = 0, all = 0;

  void Add(int found, int truth) {
    ++histogram[std::clamp(found - truth, -3, 3)];
    right += found == truth ? 1 : 0;
    ++all;
  }
  void Print(const std::string& what) const {
    std::printf("| %s | %d | %.3f |", what.c_str(), all, all > 0 ? static_cast<double>(right) / all : 0.0);
    for (int error = -3; error <= 3; ++error) {
      const auto at = histogram.find(error);
      std::printf(" %d |", at == histogram.end() ? 0 : at->second);
    }
    std::printf("\n");
  }
};

void CycleTable(std::int64_t seed) {
  const auto exercises = SplitBlanks(
      "boxing_left_right boxing_left_upwards boxing_right_left boxing_right_upwards butt_kicks jump_hands_up "
      "jump_vertical lift_dumbbell_both lift_dumbbell_both_bend_legs lift_dumbbell_left lift_dumbbell_overhead "
      "lift_dumbbell_right run run_on_the_spot warm_up_body_lean_left_arm warm_up_body_lean_right_arm warm_up_bow_left "
      "warm_up_bow_right warm_up_elbow_back warm_up_pectoral warm_up_wrist_ankle");
  const auto once = SplitBlanks("kick throw jump sit pick_up salute side_kick throw_both_hands stand_up");
  std::printf("\n| what | takes | count right | -3 and less | -2 | -1 | 0 | 1 | 2 | 3 and more |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
  CountErrors sum, noisy, single;
  std::map<int, CountErrors> of_count;
  for (const std::string_view name : exercises) {
    const std::string action(name);
    CountErrors errors;
    for (int person = 0; person < 4; ++person) {
      for (int cycles = 1; cycles <= 8; ++cycles) {
        const Motion motion = StudioExercise(seed, action, person, cycles).motion;
        const int found = static_cast<int>(FindCycles(CycleOptions(), motion).size());
        errors.Add(found, cycles);
        sum.Add(found, cycles);
        of_count[cycles].Add(found, cycles);
        noisy.Add(static_cast<int>(FindCycles(CycleOptions(), Noisy(motion, 0.01)).size()), cycles);
      }
    }
    if (errors.right < errors.all) errors.Print(action);
  }
  for (const auto& [cycles, errors] : of_count) errors.Print("exercises of " + std::to_string(cycles));
  sum.Print("all exercises, 1 to 8 repetitions");
  noisy.Print("the same with 10 mm of white noise a coordinate");
  for (const std::string_view name : once) {
    const std::string action(name);
    for (int person = 0; person < 4; ++person) {
      single.Add(static_cast<int>(FindCycles(CycleOptions(), StudioExercise(seed, action, person, 0).motion).size()),
                 1);
    }
  }
  single.Print("actions that are done once");
  if (TestData().empty()) return;
  CountErrors recorded;
  for (const auto& [person, clips] : ClipsByPerson("hdm05", "cmu31", 0.0)) {
    for (const Clip& clip : clips) {
      if (clip.label.find("1Reps") == std::string::npos) continue;
      recorded.Add(static_cast<int>(FindCycles(CycleOptions(), *clip.motion).size()), 1);
    }
  }
  recorded.Print("HDM05, classes of one repetition");
}

struct JudgedSpan {
  double confidence = 0.0;
  bool right = false;
};

/// Judges the spans of one label in all recordings except its examples; adds their number to `truth`.
void JudgeLabel(const Recordings& recordings, const std::string& label, bool by_category,
                std::vector<JudgedSpan>& judged, int& truth) {
  const auto label_of = [&](const Segment& segment) { return by_category ? segment.category : segment.label; };
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (std::size_t k = 0; k < recordings[r].segments.size(); ++k) {
      if (label_of(recordings[r].segments[k]) == label) places.emplace_back(r, k);
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> marked;
  std::vector<Motion> examples;
  for (std::size_t e = 0; e < 3; ++e) {
    const auto [r, k] = places[e * places.size() / 3];
    marked.emplace(r, k);
    const Motion& motion = recordings[r].motion;
    const Segment& segment = recordings[r].segments[k];
    Clip clip;
    clip.rate = motion.rate;
    clip.motion = motion;
    const auto cut = Cut(clip, static_cast<int>(std::lround(segment.begin_s * motion.rate.hz())),
                         static_cast<int>(std::lround(segment.end_s * motion.rate.hz())));
    if (cut) examples.push_back(*cut->motion);
  }
  truth += static_cast<int>(places.size() - marked.size());
  ByExampleOptions options;
  options.min_confidence = 0.02;
  options.join_gap_s = 0.0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    auto found = FindByExample(options, examples, recordings[r].motion);
    if (!found) continue;
    std::sort(found->begin(), found->end(),
              [](const KeptSpan& a, const KeptSpan& b) { return a.confidence > b.confidence; });
    std::set<std::size_t> taken;
    for (const KeptSpan& span : *found) {
      const double begin_s = recordings[r].motion.rate.FrameTime(span.begin);
      const double end_s = recordings[r].motion.rate.FrameTime(span.end);
      bool right = false, of_example = false;
      for (std::size_t k = 0; k < recordings[r].segments.size(); ++k) {
        const Segment& segment = recordings[r].segments[k];
        if (label_of(segment) != label) continue;
        const double both = std::min(end_s, segment.end_s) - std::max(begin_s, segment.begin_s);
        const double either = std::max(end_s, segment.end_s) - std::min(begin_s, segment.begin_s);
        if (both < 0.5 * either) continue;
        of_example = of_example || marked.count({r, k}) > 0;
        right = right || taken.insert(k).second;
      }
      if (!of_example) judged.push_back({span.confidence, right});
    }
  }
}

void ByExampleRow(const Recordings& recordings, bool by_category) {
  std::map<std::string, int> counts;
  for (const LongRecording& recording : recordings) {
    for (const Segment& segment : recording.segments) ++counts[by_category ? segment.category : segment.label];
  }
  std::vector<JudgedSpan> judged;
  int truth = 0, labels = 0;
  for (const auto& [label, count] : counts) {
    if (count < 5) continue;
    JudgeLabel(recordings, label, by_category, judged, truth);
    ++labels;
  }
  std::sort(judged.begin(), judged.end(),
            [](const JudgedSpan& a, const JudgedSpan& b) { return a.confidence > b.confidence; });
  double right = 0.0, recall = 0.0, threshold = 1.0, kept = 0.0, kept_right = 0.0;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    right += judged[i].right ? 1.0 : 0.0;
    if (judged[i].confidence >= ByExampleOptions().min_confidence) {
      kept += 1.0;
      kept_right += judged[i].right ? 1.0 : 0.0;
    }
    if (right / static_cast<double>(i + 1) < 0.9) continue;
    recall = right / truth;
    threshold = judged[i].confidence;
  }
  std::printf("| %s | %d | %d | %.3f | %.2f | %.3f | %.3f |\n",
              by_category ? "labels that joints distinguish" : "all actions", labels, truth, recall, threshold,
              kept > 0.0 ? kept_right / kept : 1.0, kept_right / std::max(1, truth));
}

void ByExampleTable(std::int64_t seed, int recordings) {
  std::printf(
      "\n| labels | with five spans and more | other spans | recall at precision 0.9 | at confidence | precision at "
      "the "
      "default | recall there |\n|---|---|---|---|---|---|---|\n");
  const Recordings studio = StudioRecordings(seed, std::max(2, recordings / 8), 8, FrameRate{30, 1});
  ByExampleRow(studio, true);
  ByExampleRow(studio, false);
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const std::int64_t seed = argc > 2 ? std::atoll(argv[2]) : 31;
  const int recordings = argc > 3 ? std::atoi(argv[3]) : 40;
  if (what != "change_points" && what != "cycles" && what != "by_example" && what != "all") {
    std::fprintf(stderr, "usage: bench_boundaries [change_points|cycles|by_example|all] [SEED [RECORDINGS]]\n");
    return 2;
  }
  if (what == "change_points" || what == "all") mocurate::ChangePointTable(seed, recordings);
  if (what == "cycles" || what == "all") mocurate::CycleTable(seed);
  if (what == "by_example" || what == "all") mocurate::ByExampleTable(seed, recordings);
  return 0;
}
