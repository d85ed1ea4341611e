#include "core/motion/action_parts.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {

Expected<ActionParts> PartsOf(const Clip& clip) {
  const auto refused = [&](const std::string& what) {
    return Fail(ErrorCode::kInconsistent, what, clip.id(),
                "samples of previous action, transition and action are made by canon.trim.rule: triples");
  };
  if (!clip.motion) return refused("the clip has no motion");
  const std::size_t count = clip.segments.size();
  if (count != 3 && count != 2) {
    return refused("the clip has " + Counted(static_cast<long long>(count), "segment") + ", a sample has 3");
  }
  std::vector<Segment> segments = clip.segments;
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return a.begin_s < b.begin_s; });
  ActionParts parts;
  int end = 0;
  for (std::size_t i = 0, k = 3 - count; i < count; ++i, ++k) {
    const auto frame = [&](double seconds) { return static_cast<int>(std::lround(seconds * clip.motion->rate.hz())); };
    const int begin = frame(segments[i].begin_s);
    if (begin != end) return refused("segment '" + segments[i].label + "' does not begin where the one before it ends");
    end = frame(segments[i].end_s);
    parts.frames[k] = end - begin;
    parts.label[k] = segments[i].label;
    if (parts.frames[k] < 1) return refused("segment '" + segments[i].label + "' has no frame");
  }
  if (end != clip.motion->frame_count()) {
    return refused("the segments end at frame " + std::to_string(end) + ", the motion has " +
                   Counted(clip.motion->frame_count(), "frame"));
  }
  return parts;
}

Expected<Motion> TakePart(const Clip& clip, ClipPart part) {
  if (part == ClipPart::kWhole && clip.motion) return *clip.motion;
  const Expected<ActionParts> parts = PartsOf(clip);
  if (!parts) return Forward(parts);
  const int transition = parts->frames[0], action = transition + parts->frames[1];
  const bool first = part == ClipPart::kTransition;
  Clip bare;  // the motion alone: evidence would be cut too
  bare.motion = clip.motion;
  bare.rate = clip.rate;
  const auto cut = Cut(bare, first ? transition : action, first ? action : action + parts->frames[2]);
  if (!cut) return Forward(cut);
  return *cut->motion;
}

}  // namespace mocurate
