#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/heading.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "job/verbs/reproduce.h"

namespace mocurate {
namespace {

constexpr int kLeastFrames = 12, kMostFrames = 60;  // of the shown motion

/// Angle between the trunk, from the root to between the shoulders, and the vertical; radians.
double TrunkAngle(const Motion& motion, int frame, const std::array<int, 2>& shoulders) {
  const Vector3d top = 0.5 * (motion.joints.at(frame, shoulders[0]) + motion.joints.at(frame, shoulders[1]));
  const Vector3d trunk = top - motion.joints.at(frame, 0);
  return std::atan2(std::hypot(trunk.x(), trunk.z()), trunk.y());
}

/// Error kInconsistent.
Expected<Clip> MotionThatEndsBentDown(const Dataset& set, const std::string& where) {
  const auto shoulders = set.skeleton->Shoulders();
  const Clip* bent = nullptr;
  int last = 0;
  double most = -1.0;
  for (const Clip& clip : set.clips) {
    if (!shoulders || !clip.motion || clip.motion->joints_only() || clip.segments.size() < 2) continue;
    const int end = std::min(clip.motion->frame_count(),
                             static_cast<int>(std::lround(clip.segments.front().end_s * clip.motion->rate.hz())));
    for (int f = kLeastFrames; f < end; ++f) {
      const double angle = TrunkAngle(*clip.motion, f, *shoulders);
      if (angle > most) most = angle, bent = &clip, last = f;
    }
  }
  if (bent == nullptr) {
    return Fail(ErrorCode::kInconsistent, "no sample has a previous motion with rotations", where,
                "use a set of samples of two actions");
  }
  auto cut = Cut(*bent, std::max(0, last + 1 - kMostFrames), last + 1);
  if (!cut) return Forward(cut);
  Transform(Inverse(bent->canonical_from_source), *cut);
  return cut;
}

}  // namespace

Expected<PlacedMotions> PlacedByEachRule(const std::filesystem::path& dataset, const std::filesystem::path& file) {
  auto set = ReadDataset(dataset);
  if (!set) return Forward(set);
  const auto source = MotionThatEndsBentDown(*set, DisplayPath(dataset));
  if (!source) return Forward(source);
  PlacedMotions placed;
  placed.labels = {"(a) the previous motion before and after face-front", "(b) face-front and zero-canonicalisation"};
  placed.colours = {{"face-front", "red"}, {"zero", "blue"}};
  const Motion& motion = *source->motion;
  const int last = motion.frame_count() - 1;
  const Quaterniond upright = motion.rotation_at(last, 0).conjugate();
  const RigidTransform zero{upright, -(upright * motion.root_translation[static_cast<std::size_t>(last)])};
  const std::tuple<const char*, RigidTransform, std::vector<std::size_t>> rules[] = {
      {"before", RigidTransform(), {0}}, {"face-front", FacingFront(motion, last), {0, 1}}, {"zero", zero, {1}}};
  set->splits.clear();
  set->labels = placed.labels;
  for (const auto& [name, rule, panels] : rules) {
    set->clips.clear();
    for (const std::size_t panel : panels) {
      Clip clip = *source;
      Transform(rule, clip);
      clip.label = placed.labels[panel];
      clip.segments.clear();
      clip.identity.recording += "." + std::to_string(panel);
      set->clips.push_back(std::move(clip));
    }
    std::filesystem::path own = file;
    own.replace_filename(file.stem().string() + "_" + name + ".h5");
    if (Status written = WriteDataset(*set, own); !written) return Forward(written);
    placed.sets.emplace_back(name, own);
  }
  return placed;
}

}  // namespace mocurate
