
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "core/formats/npy.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr std::int64_t kKardRateHz = 30;
constexpr double kKardUnitsPerMetre = 1000.0;

constexpr std::int64_t kCmuRateHz = 12;
constexpr double kCmuUnit = 0.0254 / 0.45;  // metres: that of the database's ASF files
constexpr TakeRules kCmuTakes = {8, 17, static_cast<double>(kCmuRateHz), 0.2, 0.5};  // 1,088 clips of 8 classes

/// The set's name of a class: "animal_behavior" -> "Animal Behavior".
std::string CmuText(const std::string& label) {
  std::string text = label;
  bool first = true;
  for (char& c : text) {
    if (c == '_') c = ' ';
    if (first) c = static_cast<char>(c - 'a' + 'A');
    first = c == ' ';
  }
  return text;
}

constexpr double kMicrometres = 1e6;

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
    const std::string person = "s" + ZeroPadded(take.subject, 2);
    const std::string recording =
        "a" + ZeroPadded(take.kind->id, 2) + "_" + person + "_e" + ZeroPadded(take.repetition, 2);
    const Motion motion = SelectFrames(
        PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kKardRateHz, 1}), sensor_from_world);
    const std::vector<std::string> names = NamesOf(KardPlaces());
    TrackedTake tracked = Track(PlacesOf(motion, KardPlaces()), names, options.tracker, options.seed, recording);
    ExtrapolateMissing(options.tracker, options.seed, recording, tracked);  // the set cannot mark missing joints
    const auto written = [](double metres) { return RoundedToDigits(metres * kKardUnitsPerMetre, 8); };
    JointTable table;
    table.frames = motion.frame_count();
    table.rows_per_frame = static_cast<int>(names.size());
    table.columns = 3;
    for (int f = 0; f < table.frames; ++f) {
      for (int k = 0; k < table.rows_per_frame; ++k) {
        const Vector3d at = tracked.positions.at(f, k);
        table.values.insert(table.values.end(), {written(at.x()), written(at.y()), written(-at.z())});
      }
    }
    Status done = folder.Write("kard/" + recording + "_realworld.txt", WriteJointTable(table));
    if (!done) return done;
    folder.AddTruth(person, "kard/" + person + "/" + recording, motion);
    return {};
  });
}

Status WriteCmu8Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, Cmu8Classes(), kCmuTakes);
  if (!takes) return Forward(takes);
  const auto name_of = [](const PlannedTake& take) {
    return ZeroPadded(take.subject, 2) + "_" + ZeroPadded(take.kind->id, 1) + ZeroPadded(take.repetition, 2);
  };
  Status done = folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string name = name_of(take);
    const Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kCmuRateHz, 1});
    const JointPositions places = PlacesOf(motion, Cmu20Places());
    NpyArray array{{static_cast<std::size_t>(motion.frame_count()), Cmu20Places().size(), 3}, "<f8", places.xyz, {}};
    for (double& value : array.values) value /= kCmuUnit;
    if (Status written = folder.Write("cmu8/mocap_3djoints/" + name + ".npy", WriteNpy(array)); !written) {
      return written;
    }
    folder.AddTruth("P" + ZeroPadded(take.subject, 2), "cmu8/unknown/" + name, motion);  // the set states no person
    return {};
  });
  if (!done) return done;
  std::string table = "motion,action_type\n";  // sorted by class: the first appearances are the classes' order
  for (const PlannedTake& take : *takes) table += name_of(take) + "," + CmuText(take.kind->label) + "\n";
  return folder.Write("cmu8/pose_clip.csv", table);
}

Status WriteTracksLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const Expected<std::vector<PlannedTake>> takes = PlanVariantTakes(options);
  if (!takes) return Forward(takes);
  return folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kVariantRateHz, 1});
    if (options.tilt != 0.0) motion = SelectFrames(motion, LooksDown(options.tilt));
    const std::string person = "p" + ZeroPadded(take.subject, 2);
    const std::string recording = std::string(take.kind->label) + "_" + person + "_r" + ZeroPadded(take.repetition, 2);
    std::vector<std::string> names;
    for (const Joint& joint : actor.skeleton->joints) names.push_back(joint.name);
    const TrackedTake tracked = Track(motion.joints, names, options.tracker, options.seed, recording);
    const std::string text = TrackText(tracked, Vector3d::Ones(), kMicrometres);
    if (Status written = folder.Write("tracks/" + recording + ".txt", text); !written) return written;
    folder.AddTruth(person, "tracks/" + person + "/" + recording, motion);
    return {};
  });
}

}  // namespace mocurate
