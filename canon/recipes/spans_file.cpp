#include "canon/recipes/spans_file.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

bool NamesClip(const ListedSpan& span, const Clip& clip) {
  return span.clip == clip.identity.recording || span.clip == RecordingOf(clip.id()) || span.clip == clip.id();
}

Finding SpanOutside(const Clip& clip, const ListedSpan& span, double seconds, Severity severity, FindingAction action) {
  return MakeFinding("span_outside", severity, seconds,
                     span.place + ": '" + span.label + "' from " + RoundedText(span.begin, 6) + " to " +
                         RoundedText(span.end, 6) + (span.in_frames ? " frames" : " s") + " exceeds the clip, " +
                         RoundedText(BeginInRecording(clip), 6) + " to " +
                         RoundedText(BeginInRecording(clip) + clip.motion->duration(), 6) + " s of its recording",
                     action, clip.id());
}

}  // namespace

std::optional<std::string_view> BuiltInSpans(const std::string& name) { return FindResource("spans/" + name + ".csv"); }

Expected<std::vector<ListedSpan>> ReadSpans(const std::filesystem::path& file) {
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  return ParseSpanTable(*bytes, DisplayPath(file));
}

Expected<std::vector<ListedSpan>> ListedSpans(const TrimOptions& options) {
  if (!options.spans.empty()) return ReadSpans(options.spans);
  if (options.spans_of.empty()) return std::vector<ListedSpan>();
  const auto table = BuiltInSpans(options.spans_of);
  if (table) return ParseSpanTable(*table, options.spans_of);
  return Fail(ErrorCode::kConfig, "no built-in table of spans is named '" + options.spans_of + "'",
              "canon.trim.spans_of", "use humanact12, or name a file under canon.trim.spans");
}

void ApplySpans(const std::vector<ListedSpan>& spans, Clip& clip, std::vector<Finding>& findings) {
  bool named = false;
  std::vector<Segment> segments;
  const double duration_s = clip.motion->duration();
  for (const ListedSpan& span : spans) {
    if (!NamesClip(span, clip)) continue;
    named = true;
    const auto seconds = [&](double place) {
      if (!span.in_frames) return place - BeginInRecording(clip);
      return (place - static_cast<double>(FirstRecordedFrame(clip))) / RecordedRate(clip).hz();
    };
    Segment segment{std::max(0.0, seconds(span.begin)), seconds(span.end), span.label, "", kListedOrigin};
    if (!span.fine_label.empty()) {
      segment.label = span.fine_label;
      segment.category = span.label;
    }
    const double frame_s = clip.rate.FrameTime(1);
    const double beyond = segment.end_s - duration_s;
    if (segment.begin_s >= duration_s - 0.5 * frame_s || segment.end_s <= 0.5 * frame_s) {
      findings.push_back(SpanOutside(clip, span, beyond, Severity::kError, FindingAction::kDropped));
      continue;
    }
    if (beyond > 0.5 * frame_s)
      findings.push_back(SpanOutside(clip, span, beyond, Severity::kWarning, FindingAction::kKept));
    segment.end_s = std::min(segment.end_s, duration_s);
    segments.push_back(std::move(segment));
  }
  if (!named) return;
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return a.begin_s < b.begin_s; });
  clip.segments = std::move(segments);
}

}  // namespace mocurate
