#include "canon/recipes/action_triples.h"

#include <algorithm>
#include <cmath>

#include "canon/recipes/spans_file.h"
#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

// As the released code (multiact.md A.3); frames of a sample.
constexpr double kTransitionShare = 0.1;  // of each neighbour that a transition includes
constexpr double kMostTaken = 5.0;        // maximum frames of each neighbour that a transition includes
constexpr int kExtraFrames = 3;           // after the label that the action includes, where they exist
constexpr int kLeastPart = 3;             // frames of each part

/// A segment in frames of the recording.
struct LabelledSpan {
  std::string label;
  int begin = 0;
  int end = 0;

  int frames() const { return end - begin; }
};

/// Frames of the recording in each part of a sample, before decimation.
struct RecordedParts {
  int previous = 0;
  int transition = 0;
  int current = 0;

  int all() const { return previous + transition + current; }
};

std::vector<LabelledSpan> SpansInFrames(const std::vector<Segment>& segments, FrameRate rate) {
  // Times are truncated, as in the released code. Listed spans may come from frame numbers, so that 1e-6 frames count
  // as rounding.
  const auto frame = [&](double seconds, const Segment& segment) {
    return static_cast<int>(seconds * rate.hz() + (segment.origin == kListedOrigin ? 1e-6 : 0.0));
  };
  std::vector<LabelledSpan> spans;
  for (const Segment& segment : segments) {
    const LabelledSpan span{segment.label, frame(segment.begin_s, segment), frame(segment.end_s, segment)};
    if (span.frames() > 0) spans.push_back(span);
  }
  std::stable_sort(spans.begin(), spans.end(),
                   [](const LabelledSpan& a, const LabelledSpan& b) { return a.begin < b.begin; });
  return spans;
}

/// Frames of a neighbour that the transition includes: a share of it, at most `most` of the sample's frames, at least
/// one.
int TakenFrames(int frames, double share, double most, int step) {
  return static_cast<int>(std::max(std::min(share * frames, most * step), 1.0));
}

Finding RejectedTriple(const char* code, const LabelledSpan& a, const LabelledSpan& b, int frames,
                       const std::string& rule) {
  Finding finding = MakeFinding(code, Severity::kInfo, frames,
                                "'" + a.label + "' to '" + b.label + "': " + Counted(frames, "frame") + ", " + rule,
                                FindingAction::kDropped);
  finding.frame_begin = a.begin;
  finding.frame_end = b.end;
  return finding;
}

}  // namespace

std::vector<ActionTriple> FindTriples(const TripleOptions& options, const std::vector<Segment>& segments,
                                      FrameRate rate, int frames, std::vector<Finding>& findings) {
  const int step = std::max(1, static_cast<int>(std::round(rate.hz()) / options.rate_hz));
  const int most = static_cast<int>(options.most_frames);
  const std::vector<LabelledSpan> spans = SpansInFrames(segments, rate);
  std::vector<ActionTriple> triples;
  const auto add = [&](const LabelledSpan& a, const LabelledSpan& b, RecordedParts parts) {
    const auto reject = [&](const char* code, int count, const std::string& rule) {
      findings.push_back(RejectedTriple(code, a, b, count, rule));
    };
    if (frames - b.end >= 3 && parts.all() < (most - 1 - kExtraFrames) * step) parts.current += kExtraFrames * step;
    if (parts.all() >= (most - 1) * step) {
      reject("triple_too_long", parts.all() / step, "trim.triples.most_frames is " + std::to_string(most));
      return;
    }
    ActionTriple triple{a.label, b.label, a.begin, step, 0, 0, 0};
    const int stop = std::min(a.begin + parts.all(), frames - 1);
    const int taken = std::max(0, (stop - a.begin + step - 1) / step);
    triple.previous_frames = parts.previous / step + 1;
    triple.transition_frames = (parts.previous + parts.transition) / step - parts.previous / step;
    triple.current_frames = taken - triple.previous_frames - triple.transition_frames;
    const int least_previous = static_cast<int>(options.context) + 1;
    const int shortest = std::min({triple.previous_frames, triple.transition_frames, triple.current_frames});
    if (taken >= most) {
      reject("triple_too_long", taken, "trim.triples.most_frames is " + std::to_string(most));
    } else if (taken <= options.least_frames) {
      reject("triple_too_short", taken,
             "trim.triples.least_frames is " + std::to_string(options.least_frames) + ", a sample needs more");
    } else if (shortest < kLeastPart || triple.previous_frames < least_previous) {
      reject("triple_too_short", taken,
             "with parts of " + std::to_string(triple.previous_frames) + ", " +
                 std::to_string(triple.transition_frames) + " and " + std::to_string(triple.current_frames) +
                 " frames; the minimum is " + std::to_string(least_previous) + ", " + std::to_string(kLeastPart) +
                 " and " + std::to_string(kLeastPart));
    } else {
      triples.push_back(std::move(triple));
    }
  };
  const auto is_transition = [&](const LabelledSpan& span) { return span.label == options.transition; };
  for (const LabelledSpan& a : spans) {
    if (is_transition(a)) continue;
    for (const LabelledSpan& next : spans) {
      if (next.begin != a.end) continue;
      if (!is_transition(next)) {
        const int of_a = TakenFrames(a.frames(), 2.0 * kTransitionShare, 2.0 * kMostTaken, step);
        const int of_b = TakenFrames(next.frames(), 2.0 * kTransitionShare, 2.0 * kMostTaken, step);
        add(a, next, {a.frames() - of_a, of_a + of_b, next.frames() - of_b});
        continue;
      }
      for (const LabelledSpan& b : spans) {
        if (b.begin != next.end || is_transition(b)) continue;
        const int of_each =
            TakenFrames(a.frames(), kTransitionShare, kMostTaken, step);  // of b as of a (multiact.md H11)
        add(a, b, {a.frames() - of_each, next.frames() + 2 * of_each, b.frames() - of_each});
      }
    }
  }
  return triples;
}

Expected<Clip> TakeTriple(const TripleOptions& options, const ActionTriple& triple, const Clip& clip) {
  auto cut = Cut(clip, triple.first_frame, triple.end_frame());
  if (!cut) return Forward(cut);
  FrameRate rate = clip.motion->rate;
  rate.denominator *= triple.step;
  Clip sample = Resample(*cut, rate);
  sample.label = triple.current;
  const auto segment = [&](int begin, int end, const std::string& label) {
    return Segment{rate.FrameTime(begin), rate.FrameTime(end), label, "", "triple"};
  };
  const int transition = triple.previous_frames, current = transition + triple.transition_frames;
  sample.segments = {segment(0, transition, triple.previous), segment(transition, current, options.transition),
                     segment(current, triple.frames(), triple.current)};
  return sample;
}

}  // namespace mocurate
