#include "canon/trim/trim.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "canon/recipes/spans_file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kMostAtOnce = 100;  // segments; people mark less than ten

std::vector<KeptSpan> AnnotatedSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings) {
  const Motion& motion = *clip.motion;
  std::vector<KeptSpan> spans;
  std::map<std::pair<int, int>, std::string> label_of;  // of the spans by their frames
  for (const Segment& segment : clip.segments) {
    const int begin =
        std::clamp(static_cast<int>(std::lround(segment.begin_s * motion.rate.hz())), 0, motion.frame_count());
    const int end =
        std::clamp(static_cast<int>(std::lround(segment.end_s * motion.rate.hz())), 0, motion.frame_count());
    if (std::find(options.drop_labels.begin(), options.drop_labels.end(), segment.label) != options.drop_labels.end()) {
      findings.push_back(DroppedSpan(clip, "label_excluded", begin, end, segment.end_s - segment.begin_s,
                                     "segment '" + segment.label + "' is in trim.drop_labels", Severity::kInfo));
      continue;
    }
    const auto [same, added] = label_of.emplace(std::pair(begin, end), "");  // a clip id contains its frames
    if (!added) {
      findings.push_back(DroppedSpan(
          clip, "same_frames", begin, end, segment.end_s - segment.begin_s,
          "segment '" + segment.label + "' has the same frames as segment '" + same->second + "', which was kept"));
      continue;
    }
    // A listed span with a fine label has one class; BABEL's labels have several categories, of which the first is
    // used.
    const bool by_category = options.class_from == ClassFrom::kCategory || segment.origin == kListedOrigin;
    const std::string category = segment.category.substr(0, segment.category.find(", "));
    if (by_category && !category.empty()) {
      spans.push_back({begin, end, category, segment.label});
    } else {
      spans.push_back({begin, end, segment.label, ""});
    }
    same->second = spans.back().label;
  }
  if (clip.segments.empty()) {
    findings.push_back(DroppedSpan(clip, "no_annotation", 0, motion.frame_count(), 0.0,
                                   "the clip has no annotated segment; trim.rule is 'annotated'"));
  }
  return spans;
}

/// The speed limit of a movement as text.
std::string SpeedLimit(const TrimOptions& options) {
  const bool still = options.moving_speed <= options.still_speed;
  return std::string(still ? "trim.still_speed" : "trim.moving_speed") + " is " +
         RoundedText(std::max(options.still_speed, options.moving_speed)) + " m/s";
}

std::vector<KeptSpan> MovingSpan(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings) {
  const Motion& motion = *clip.motion;
  const std::vector<double> speeds = FrameSpeeds(motion, kSpeedWindow_s);
  const double moving_speed = std::max(options.still_speed, options.moving_speed);
  int first = 0;
  int last = static_cast<int>(speeds.size()) - 1;
  while (first <= last && speeds[first] < moving_speed) ++first;
  while (last >= first && speeds[last] < moving_speed) --last;
  if (first > last) {
    const double fastest = speeds.empty() ? 0.0 : *std::max_element(speeds.begin(), speeds.end());
    findings.push_back(DroppedSpan(clip, "never_moves", 0, motion.frame_count(), fastest,
                                   "fastest frame " + RoundedText(fastest) + " m/s, " + SpeedLimit(options)));
    return {};
  }
  while (first > 0 && speeds[first - 1] >= options.still_speed) --first;
  while (last + 1 < static_cast<int>(speeds.size()) && speeds[last + 1] >= options.still_speed) ++last;
  const int margin = static_cast<int>(std::lround(options.margin_s * motion.rate.hz()));
  const KeptSpan span{std::max(0, first - margin), std::min(motion.frame_count(), last + 1 + margin), clip.label,
                      clip.fine_label};
  if (span.end - span.begin < motion.frame_count()) {
    findings.push_back(DroppedSpan(
        clip, "still_frames", span.begin, span.end, static_cast<double>(motion.frame_count() - (span.end - span.begin)),
        "still frames at the ends were cut; the frames named here were kept", Severity::kInfo));
  }
  return {span};
}

std::vector<KeptSpan> ChangeSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings) {
  std::vector<KeptSpan> spans;
  const std::vector<ProposedSegment> segments = ProposeSegments(options.change_points, *clip.motion);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const ProposedSegment& segment = segments[i];
    if (segment.rest && !options.change_points.keep_rests) {
      const double length_s = clip.motion->rate.FrameTime(segment.end - segment.begin);
      findings.push_back(DroppedSpan(clip, "rest", segment.begin, segment.end, length_s,
                                     "rest of " + RoundedText(length_s) + " s; trim.change_points.keep_rests is false",
                                     Severity::kInfo));
      continue;
    }
    const double end_confidence = i + 1 < segments.size() ? segments[i + 1].confidence : 1.0;
    spans.push_back(
        {segment.begin, segment.end, clip.label, clip.fine_label, std::min(segment.confidence, end_confidence)});
  }
  return spans;
}

std::vector<KeptSpan> CycleSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings) {
  std::vector<KeptSpan> spans = FindCycles(options.cycles, *clip.motion);
  for (KeptSpan& span : spans) {
    span.label = clip.label;
    span.fine_label = clip.fine_label;
  }
  if (spans.empty()) {
    findings.push_back(DroppedSpan(clip, "no_repetition", 0, clip.motion->frame_count(), 0.0,
                                   "the person never moves; trim.rule is 'cycles'"));
  }
  return spans;
}

}  // namespace

Finding DroppedSpan(const Clip& clip, const char* code, int begin, int end, double value, std::string message,
                    Severity severity) {
  Finding finding = MakeFinding(code, severity, value, std::move(message), FindingAction::kDropped, clip.id());
  finding.frame_begin = begin;
  finding.frame_end = end;
  return finding;
}

bool EstimatesCuts(TrimRule rule) {
  return rule == TrimRule::kChangePoints || rule == TrimRule::kCycles || rule == TrimRule::kByExample;
}

Status CheckOverlap(const Clip& clip, const std::string& where) {
  const int frames = clip.motion->frame_count();
  std::vector<int> change(static_cast<std::size_t>(frames) + 1, 0);  // of the number of segments from frame to frame
  for (const Segment& segment : clip.segments) {
    const auto frame = [&](double seconds) { return std::clamp(seconds * clip.motion->rate.hz(), 0.0, 1.0 * frames); };
    const double begin = std::floor(frame(segment.begin_s)), end = std::ceil(frame(segment.end_s));
    if (!(begin < end)) continue;
    ++change[static_cast<std::size_t>(begin)];
    --change[static_cast<std::size_t>(end)];
  }
  int there = 0;
  for (int f = 0; f < frames; ++f) {
    there += change[static_cast<std::size_t>(f)];
    if (there <= kMostAtOnce) continue;
    return Fail(ErrorCode::kInconsistent,
                "frame " + std::to_string(f) + " of " + clip.id() + " is in " + std::to_string(there) +
                    " annotated segments, at most " + std::to_string(kMostAtOnce) + " are read",
                where, "leave out spans that repeat others");
  }
  return {};
}

std::vector<double> FrameSpeeds(const Motion& motion, double window_s) {
  const int frames = motion.frame_count();
  std::vector<double> speeds(frames, 0.0);
  if (frames < 2) return speeds;
  const int half = std::max(1, static_cast<int>(std::lround(0.5 * window_s * motion.rate.hz())));
  const int width = std::min(frames, 2 * half + 1);
  // Least-squares slope: sum of (t - mean t) x over sum of (t - mean t)^2.
  std::vector<double> weight(width);
  double squares = 0.0;
  for (int i = 0; i < width; ++i) {
    weight[i] = motion.rate.FrameTime(i) - 0.5 * motion.rate.FrameTime(width - 1);
    squares += weight[i] * weight[i];
  }
  for (int f = 0; f < frames; ++f) {
    const int begin = std::clamp(f - half, 0, frames - width);
    for (int j = 0; j < motion.joint_count(); ++j) {
      Vector3d sum = Vector3d::Zero();
      for (int i = 0; i < width; ++i) sum += weight[i] * motion.joints.at(begin + i, j);
      speeds[f] = std::max(speeds[f], sum.norm() / squares);
    }
  }
  return speeds;
}

std::vector<KeptSpan> LongEnough(const TrimOptions& options, const Clip& clip, const std::vector<KeptSpan>& spans,
                                 std::vector<Finding>& findings) {
  std::vector<KeptSpan> kept;
  for (const KeptSpan& span : spans) {
    const double length_s = clip.motion->rate.FrameTime(span.end - span.begin);
    const bool still = span.end - span.begin < 2 && options.min_length_s > 0.0;
    if (span.end <= span.begin || still || length_s < options.min_length_s) {
      const std::string what = still ? "one frame" : RoundedText(length_s) + " s";
      findings.push_back(DroppedSpan(
          clip, "too_short", span.begin, span.end, length_s,
          what + " of '" + span.label + "', trim.min_length is " + RoundedText(options.min_length_s) + " s"));
      continue;
    }
    kept.push_back(span);
  }
  return kept;
}

std::vector<KeptSpan> FindSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings) {
  std::vector<KeptSpan> spans;
  switch (options.rule) {
    case TrimRule::kNone:
      spans = {{0, clip.motion->frame_count(), clip.label, clip.fine_label}};
      break;
    case TrimRule::kAnnotated:
      spans = AnnotatedSpans(options, clip, findings);
      break;
    case TrimRule::kMotionEnergy:
      spans = MovingSpan(options, clip, findings);
      break;
    case TrimRule::kChangePoints:
      spans = ChangeSpans(options, clip, findings);
      break;
    case TrimRule::kCycles:
      spans = CycleSpans(options, clip, findings);
      break;
    case TrimRule::kTriples:    // samples of two spans each: canon/recipes/action_triples.h
    case TrimRule::kByExample:  // needs examples of other clips: SpansByExample of canon/trim/by_example.h
      break;
  }
  return LongEnough(options, clip, spans, findings);
}

std::optional<double> LimitOfTrim(const TrimOptions& options, const std::string& rule) {
  if (rule == "too_short") return options.min_length_s;
  if (rule == "never_moves") return std::max(options.still_speed, options.moving_speed);
  return std::nullopt;
}

}  // namespace mocurate
