#include "core/formats/npy.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

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

}  // namespace

Status WriteCmu8Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, Cmu8Classes(), kCmuTakes);
  if (!takes) return Forward(takes);
  const auto name_of = [](const PlannedTake& take) {
    return Digits(take.subject, 2) + "_" + Digits(take.kind->id, 1) + Digits(take.repetition, 2);
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
    ClipIdentity identity;
    identity.source = "cmu8";
    identity.person = "unknown";  // not stated by the set
    identity.recording = name;
    identity.end_frame = motion.frame_count();
    folder.AddTruth("P" + Digits(take.subject, 2), identity.id(), motion);
    return {};
  });
  if (!done) return done;
  std::string table = "motion,action_type\n";  // sorted by class: the first appearances are the classes' order
  for (const PlannedTake& take : *takes) table += name_of(take) + "," + CmuText(take.kind->label) + "\n";
  return folder.Write("cmu8/pose_clip.csv", table);
}

}  // namespace mocurate
