#include <cmath>

#include "core/formats/joint_table.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr double kMicrometres = 1e6;

/// One row "x y z confidence" per joint, metres, "0 0 0 0" for a missing joint.
std::string TracksText(const TrackedTake& tracked) {
  JointTable table;
  table.frames = tracked.positions.frames;
  table.rows_per_frame = tracked.positions.joints;
  table.columns = 4;
  for (int f = 0; f < table.frames; ++f) {
    for (int j = 0; j < table.rows_per_frame; ++j) {
      const bool seen = tracked.seen[static_cast<std::size_t>(f) * table.rows_per_frame + j] != 0;
      const Vector3d at = seen ? Vector3d(tracked.positions.at(f, j)) : Vector3d::Zero();
      for (int axis = 0; axis < 3; ++axis)
        table.values.push_back(std::round(kMicrometres * at[axis]) / kMicrometres + 0.0);
      table.values.push_back(seen ? 1.0 : 0.0);
    }
  }
  return WriteJointTable(table);
}

}  // namespace

Status WriteTracksLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const Expected<std::vector<PlannedTake>> takes = PlanVariantTakes(options);
  if (!takes) return Forward(takes);
  return folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kVariantRateHz, 1});
    if (options.tilt != 0.0) motion = SelectFrames(motion, LooksDown(options.tilt));
    ClipIdentity identity;
    identity.source = "tracks";
    identity.person = "p" + Digits(take.subject, 2);
    identity.recording = std::string(take.kind->label) + "_" + identity.person + "_r" + Digits(take.repetition, 2);
    identity.end_frame = motion.frame_count();
    std::vector<std::string> names;
    for (const Joint& joint : actor.skeleton->joints) names.push_back(joint.name);
    const TrackedTake tracked = Track(motion.joints, names, options.tracker, options.seed, identity.recording);
    Status written = folder.Write("tracks/" + identity.recording + ".txt", TracksText(tracked));
    if (!written) return written;
    folder.AddTruth(identity.person, identity.id(), motion);
    return {};
  });
}

}  // namespace mocurate
