#include "core/motion/gaps.h"

#include <algorithm>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kTimeTolerance = 1e-6;  // seconds: times are multiples of a frame, rounded

/// Marks the frames of `times` nearest to the samples (`sample_s`) for which `seen` holds.
template <class Seen>
void MarkFrames(const std::vector<double>& times, const std::vector<double>& sample_s, Seen seen,
                std::vector<bool>& observed) {
  for (std::size_t i = 0; i < sample_s.size(); ++i) {
    if (!seen(i)) continue;
    std::size_t at = i;
    if (sample_s.size() != times.size()) {
      const auto after = std::lower_bound(times.begin(), times.end(), sample_s[i]);
      at = static_cast<std::size_t>(after - times.begin());
      const bool before_is_nearer =
          at == times.size() || (at > 0 && sample_s[i] - times[at - 1] < times[at] - sample_s[i]);
      if (before_is_nearer) --at;
    }
    observed[at] = true;
  }
}

void MarkMotion(const Motion& motion, std::vector<bool>& observed) {
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (std::size_t f = 0; f < observed.size(); ++f) {
    const auto first = motion.state.begin() + static_cast<std::ptrdiff_t>(f * joints);
    observed[f] =
        motion.state.empty() || std::any_of(first, first + static_cast<std::ptrdiff_t>(joints), [](JointState state) {
          return state == JointState::kObserved || state == JointState::kRepaired;
        });
  }
}

}  // namespace

std::vector<FrameRun> RunsWhere(const std::vector<bool>& flags, bool value) {
  std::vector<FrameRun> runs;
  const int count = static_cast<int>(flags.size());
  for (int f = 0; f < count; ++f) {
    if (flags[f] != value) continue;
    if (!runs.empty() && runs.back().end == f) {
      ++runs.back().end;
    } else {
      runs.push_back({f, f + 1});
    }
  }
  return runs;
}

double MaxGapOf(const Clip& clip) {
  const auto declared = clip.provenance.find(kDeclaredMaxGap);
  return declared == clip.provenance.end() ? kMaxGap_s : ParseDouble(declared->second).value_or(kMaxGap_s);
}

std::vector<JointState> GapStates(const std::vector<bool>& observed, const std::vector<double>& time_s, double frame_s,
                                  double max_gap_s) {
  const std::size_t frames = observed.size();
  std::vector<JointState> states(frames, JointState::kObserved);
  for (const FrameRun& run : RunsWhere(observed, false)) {
    const auto begin = static_cast<std::size_t>(run.begin), end = static_cast<std::size_t>(run.end);
    const bool inside = begin > 0 && end < frames;
    const double length_s =
        inside ? time_s[end] - time_s[begin - 1] - frame_s : time_s[end - 1] - time_s[begin] + frame_s;
    const bool none = begin == 0 && end == frames;
    const bool filled = !none && length_s <= max_gap_s + kTimeTolerance;
    std::fill(states.begin() + run.begin, states.begin() + run.end,
              filled ? JointState::kInterpolated : JointState::kInferred);
  }
  return states;
}

std::vector<double> FrameTimes(const Clip& clip) {
  if (!clip.motion) return EvidenceTimes(clip.evidence);
  std::vector<double> times;
  for (int f = 0; f < clip.motion->frame_count(); ++f) times.push_back(clip.motion->rate.FrameTime(f));
  return times;
}

std::vector<bool> ObservedFrames(const Clip& clip) {
  const std::vector<double> times = FrameTimes(clip);
  std::vector<bool> observed(times.size(), false);
  if (times.empty()) return observed;
  if (clip.motion) MarkMotion(*clip.motion, observed);
  const Evidence& evidence = clip.evidence;
  if (evidence.tracks) {
    const JointTracks& tracks = *evidence.tracks;
    const auto wide = static_cast<std::ptrdiff_t>(tracks.names.size());
    MarkFrames(
        times, tracks.time_s,
        [&](std::size_t f) {
          const auto first = tracks.confidence.begin() + static_cast<std::ptrdiff_t>(f) * wide;
          return std::any_of(first, first + wide, [](double confidence) { return confidence > 0.0; });
        },
        observed);
  }
  // Depth images beside keypoints show the room too: whether a person is there, the keypoints say.
  const bool depth_alone = evidence.keypoint_views.empty();
  for (const DepthView& view : depth_alone ? evidence.depth_views : std::vector<DepthView>()) {
    MarkFrames(
        times, view.time_s, [&](std::size_t f) { return !view.files[f].empty(); }, observed);
  }
  if (evidence.clouds) {
    const CloudFiles& clouds = *evidence.clouds;
    MarkFrames(
        times, clouds.time_s, [&](std::size_t f) { return !clouds.files[f].empty(); }, observed);
  }
  for (const KeypointView& view : evidence.keypoint_views) {
    const int numbers = view.people * view.points() * 3;
    MarkFrames(
        times, view.time_s,
        [&](std::size_t f) {
          const double* values = view.values.data() + f * static_cast<std::size_t>(numbers);
          for (int i = 2; i < numbers; i += 3) {
            if (values[i] > 0.0) return true;
          }
          return false;
        },
        observed);
  }
  return observed;
}

std::vector<bool> InferredFrames(const Motion& motion) {
  std::vector<bool> inferred(static_cast<std::size_t>(motion.frame_count()), false);
  if (motion.state.empty()) return inferred;
  const auto joints = static_cast<std::ptrdiff_t>(motion.joint_count());
  for (std::size_t f = 0; f < inferred.size(); ++f) {
    const auto first = motion.state.begin() + static_cast<std::ptrdiff_t>(f) * joints;
    inferred[f] = std::all_of(first, first + joints, [](JointState state) { return state == JointState::kInferred; });
  }
  return inferred;
}

bool IsAllInferred(const Motion& motion) {
  return motion.frame_count() > 0 && LongestRunWithoutInferred(motion).frames() == 0;
}

void MarkShortGaps(double max_gap_s, Motion& motion) {
  std::vector<bool> observed = InferredFrames(motion);
  observed.flip();
  std::vector<double> times;
  for (int f = 0; f < motion.frame_count(); ++f) times.push_back(motion.rate.FrameTime(f));
  const auto first = std::find(observed.begin(), observed.end(), true) - observed.begin();
  const auto last = observed.rend() - std::find(observed.rbegin(), observed.rend(), true);
  const std::vector<JointState> states = GapStates(observed, times, motion.rate.FrameTime(1), max_gap_s);
  const auto joints = static_cast<std::ptrdiff_t>(motion.joint_count());
  for (std::size_t f = 0; f < states.size(); ++f) {
    const bool inside = static_cast<std::ptrdiff_t>(f) >= first && static_cast<std::ptrdiff_t>(f) < last;
    if (states[f] != JointState::kInterpolated || !inside) continue;
    std::fill_n(motion.state.begin() + static_cast<std::ptrdiff_t>(f) * joints, joints, JointState::kInterpolated);
  }
}

FrameRun LongestRunWithoutInferred(const Motion& motion) {
  const std::vector<FrameRun> runs = RunsWhere(InferredFrames(motion), false);
  const auto longest = std::max_element(runs.begin(), runs.end(),
                                        [](const FrameRun& a, const FrameRun& b) { return a.frames() < b.frames(); });
  return longest == runs.end() ? FrameRun() : *longest;
}

}  // namespace mocurate
