#include "ingest/synthetic/phspd_annotation.h"

#include "core/base/random.h"
#include "core/formats/phspd_text.h"

namespace mocurate {
namespace {

constexpr std::int64_t kPhspdRateHz = 15;
constexpr double kGapFrames = 4.0;  // mean length of a run without annotation

}  // namespace

Motion PerformRecording(const PlannedRecording& recording, const std::vector<Actor>& actors) {
  const Actor& actor = actors[static_cast<std::size_t>(recording.subject - 1)];
  return PerformScript(recording.script, actor.subject, actor.skeleton, FrameRate{kPhspdRateHz, 1});
}

std::vector<int> AnnotatedFrames(const StudioOptions& options, const PlannedRecording& recording) {
  const std::string name = PhspdRecording{recording.subject, recording.group, recording.time}.Name();
  Random random(static_cast<std::uint64_t>(options.seed), "studio.annotated", name);
  const double leaves = 1.0 / kGapFrames;
  const double enters = leaves * options.missing_share / (1.0 - options.missing_share);
  std::vector<int> frames;
  bool is_missing = false;
  for (int f = 0; f < recording.script.frames; ++f) {
    if (!is_missing) frames.push_back(f);
    is_missing = is_missing ? random.Uniform() >= leaves : random.Uniform() < enters;
  }
  return frames;
}

}  // namespace mocurate
