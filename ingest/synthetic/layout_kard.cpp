#include <cmath>

#include "core/base/random.h"
#include "core/formats/joint_table.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr std::int64_t kKardRateHz = 30;
constexpr double kKardUnitsPerMetre = 1000.0;

/// Eight digits, as the set's own files have.
double EightDigits(double metres) {
  const double value = metres * kKardUnitsPerMetre;
  if (value == 0.0) return 0.0;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 7.0);
  return std::round(value / step) * step;
}

}  // namespace

Status WriteKardLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, KardClasses(), {10, 3, static_cast<double>(kKardRateHz), 0.2, 0.5});
  if (!takes) return Forward(takes);
  Random room(static_cast<std::uint64_t>(options.seed), "studio.room");
  const double height = room.Uniform(0.7, 1.0);
  const double away = room.Uniform(2.4, 2.9);
  // The sensor's own frame in canonical axes: the subject in front of it at -z.
  const RigidTransform sensor_from_world =
      LooksDown(options.tilt) * RigidTransform{Quaterniond::Identity(), Vector3d(0.0, -height, -away)};
  return folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string person = "s" + Digits(take.subject, 2);
    const std::string recording = "a" + Digits(take.kind->id, 2) + "_" + person + "_e" + Digits(take.repetition, 2);
    const Motion motion = SelectFrames(
        PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kKardRateHz, 1}), sensor_from_world);
    const std::vector<std::string> names = NamesOf(KardPlaces());
    TrackedTake tracked = Track(PlacesOf(motion, KardPlaces()), names, options.tracker, options.seed, recording);
    ExtrapolateMissing(options.tracker, options.seed, recording, tracked);  // the set cannot mark missing joints
    JointTable table;
    table.frames = motion.frame_count();
    table.rows_per_frame = static_cast<int>(names.size());
    table.columns = 3;
    for (int f = 0; f < table.frames; ++f) {
      for (int k = 0; k < table.rows_per_frame; ++k) {
        const Vector3d at = tracked.positions.at(f, k);
        table.values.insert(table.values.end(), {EightDigits(at.x()), EightDigits(at.y()), EightDigits(-at.z())});
      }
    }
    Status written = folder.Write("kard/" + recording + "_realworld.txt", WriteJointTable(table));
    if (!written) return written;
    ClipIdentity identity;
    identity.source = "kard";
    identity.person = person;
    identity.recording = recording;
    identity.end_frame = table.frames;
    folder.AddTruth(person, identity.id(), motion);
    return {};
  });
}

}  // namespace mocurate
