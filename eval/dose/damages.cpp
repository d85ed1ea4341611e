#include "eval/dose/damages.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

/// Removes annotations of the undamaged motion's frames.
void DropFrameAnnotations(Motion& motion) {
  motion.state.clear();
  motion.position_cov.clear();
  motion.rotation_sigma.clear();
  motion.rotation_observed.clear();
  motion.contact.clear();
}

/// The remaining joints, on the common skeleton.
void DropRotations(Motion& motion) {
  motion.skeleton = motion.rest_pose();
  motion.rotation.clear();
  motion.root_translation.clear();
  motion.bone_length.clear();
  motion.rotation_reference = nullptr;
}

Vector3d NormalVector(Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return {x, y, z};
}

Random RandomOf(Damage damage, std::uint64_t seed, const std::string& item) {
  return Random(seed, std::string("damage ") + InfoOf(damage).name, item);
}

double MeanSquareDistance(const JointPositions& a, const JointPositions& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.xyz.size(); ++i) sum += (a.xyz[i] - b.xyz[i]) * (a.xyz[i] - b.xyz[i]);
  return a.xyz.empty() ? 0.0 : sum / (static_cast<double>(a.frames) * a.joints);
}

/// `noise` (F*(J+1)): for the root's position in units of `metres`, then for every joint's rotation in units of
/// `radians`.
Motion WithRotationNoise(const Motion& motion, const std::vector<Vector3d>& noise, double metres, double radians) {
  Motion noisy = motion;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  for (std::size_t f = 0; f < motion.root_translation.size(); ++f) {
    const Vector3d* of_frame = noise.data() + f * (joints + 1);
    noisy.root_translation[f] += metres * of_frame[0];
    for (std::size_t j = 0; j < joints; ++j) {
      if (motion.skeleton->joints[j].landmark) continue;  // fixed in its parent's frame
      const Vector3d turn = radians * of_frame[j + 1];
      Quaterniond& rotation = noisy.rotation[f * joints + j];
      if (const double angle = turn.norm(); angle > 0.0) {
        rotation = (rotation * Quaterniond(Eigen::AngleAxisd(angle, turn / angle))).normalized();
      }
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    MakeSignContinuous(noisy.rotation.data() + j, noisy.root_translation.size(), joints);
  }
  ComputeJoints(noisy);
  return noisy;
}

Motion JitterRotations(const Motion& motion, double metres, Random random) {
  std::vector<Vector3d> noise(motion.root_translation.size() * (static_cast<std::size_t>(motion.joint_count()) + 1));
  for (Vector3d& one : noise) one = NormalVector(random);
  // Displacements grow with the angle: by bisection, to a thousandth of the dose.
  const double wanted = 3.0 * metres * metres;
  double low = 0.0, high = 0.5 * metres;  // a bone of 2 m
  Motion noisy = WithRotationNoise(motion, noise, metres, high);
  for (int i = 0; i < 20 && MeanSquareDistance(noisy.joints, motion.joints) < wanted; ++i) {
    low = high;
    high = std::min(2.0 * high, kPi);
    noisy = WithRotationNoise(motion, noise, metres, high);
  }
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    noisy = WithRotationNoise(motion, noise, metres, middle);
    const double reached = MeanSquareDistance(noisy.joints, motion.joints);
    if (std::abs(reached / wanted - 1.0) < 1e-3) break;
    (reached < wanted ? low : high) = middle;
  }
  return noisy;
}

/// x -> world_from_motion * x.
Motion Moved(const Motion& motion, const RigidTransform& world_from_motion) {
  Clip clip;
  clip.motion = motion;
  Transform(world_from_motion, clip);
  return std::move(*clip.motion);
}

Motion DamagedMotion(const Motion& motion, Damage damage, double dose, DamagedValues values, std::uint64_t seed,
                     const std::string& item) {
  switch (damage) {
    case Damage::kJitter:
      return AddJitter(motion, dose, values, seed, item);
    case Damage::kSliding:
      return AddSliding(motion, dose, seed, item);
    case Damage::kTruncated:
      return Truncated(motion, dose);
    case Damage::kBoneDrift:
      return DriftBones(motion, dose);
    case Damage::kYaw:
      return Turned(motion, dose, seed, item);
    case Damage::kRate:
      return PlayedFaster(motion, dose);
    case Damage::kScale:
      return Scaled(motion, dose);
    default:
      return motion;
  }
}

/// Segments in the time of a motion that plays `factor` times as fast and ends at `end_s`.
void FitSegments(double factor, double end_s, std::vector<Segment>& segments) {
  for (Segment& segment : segments) {
    segment.begin_s /= factor;
    segment.end_s = std::min(segment.end_s / factor, end_s);
  }
  segments.erase(std::remove_if(segments.begin(), segments.end(),
                                [](const Segment& segment) { return segment.end_s <= segment.begin_s; }),
                 segments.end());
}

bool TakesShareOfMotions(Damage damage) {
  return damage == Damage::kFrozen || damage == Damage::kMirrored || damage == Damage::kSwappedLabels;
}

/// Labels that clips have, by name.
std::vector<std::string> LabelsOfClips(const std::vector<Clip>& clips) {
  std::set<std::string> labels;
  for (const Clip& clip : clips) labels.insert(clip.label);
  labels.erase("");
  return {labels.begin(), labels.end()};
}

void DamageShareOf(Dataset& dataset, Damage damage, double share, std::uint64_t seed) {
  const std::vector<std::string> classes = LabelsOfClips(dataset.clips);
  std::vector<std::string> items;
  for (const Clip& clip : dataset.clips) items.push_back(clip.id());
  const std::vector<bool> damaged = DamagedShare(items, share, damage, seed);
  for (std::size_t i = 0; i < items.size(); ++i) {
    Clip& clip = dataset.clips[i];
    if (!damaged[i]) continue;
    if (damage == Damage::kFrozen) clip.motion = Frozen(*clip.motion);
    if (damage == Damage::kMirrored) {
      clip.motion = std::move(*Mirror(clip).motion);
      DropFrameAnnotations(*clip.motion);
    }
    if (damage == Damage::kSwappedLabels && !clip.label.empty()) {
      Random random = RandomOf(damage, seed, items[i]);
      const auto own = std::find(classes.begin(), classes.end(), clip.label) - classes.begin();
      const auto step = 1 + random.Below(classes.size() - 1);
      clip.label = classes[(static_cast<std::size_t>(own) + step) % classes.size()];
      clip.fine_label.clear();
    }
  }
}

}  // namespace

Motion AddJitter(const Motion& motion, double millimetres, DamagedValues values, std::uint64_t seed,
                 const std::string& item) {
  Random random = RandomOf(Damage::kJitter, seed, item);
  const double metres = kMetresPerMillimetre * millimetres;
  if (values == DamagedValues::kRotations && !motion.joints_only()) {
    Motion noisy = JitterRotations(motion, metres, random);
    DropFrameAnnotations(noisy);
    return noisy;
  }
  Motion noisy = motion;
  DropFrameAnnotations(noisy);
  DropRotations(noisy);
  for (double& value : noisy.joints.xyz) value += metres * random.Normal();
  return noisy;
}

Motion AddSliding(const Motion& motion, double millimetres_per_second, std::uint64_t seed, const std::string& item) {
  Random random = RandomOf(Damage::kSliding, seed, item);
  const double angle = random.Uniform(0.0, 2.0 * kPi);
  const Vector3d velocity =
      kMetresPerMillimetre * millimetres_per_second * Vector3d(std::cos(angle), 0.0, std::sin(angle));
  Motion sliding = motion;
  DropFrameAnnotations(sliding);
  for (int f = 0; f < sliding.frame_count(); ++f) {
    const Vector3d way = motion.rate.FrameTime(f) * velocity;
    for (int j = 0; j < sliding.joint_count(); ++j) sliding.joints.at(f, j) += way;
    if (!sliding.joints_only()) sliding.root_translation[static_cast<std::size_t>(f)] += way;
  }
  return sliding;
}

Motion Frozen(const Motion& motion) {
  Motion frozen = motion;
  DropFrameAnnotations(frozen);
  const auto joints = static_cast<std::ptrdiff_t>(motion.joint_count());
  for (int f = 1; f < motion.frame_count(); ++f) {
    std::copy_n(motion.joints.xyz.begin(), 3 * joints, frozen.joints.xyz.begin() + 3 * joints * f);
    if (motion.joints_only()) continue;
    std::copy_n(motion.rotation.begin(), joints, frozen.rotation.begin() + joints * f);
    frozen.root_translation[static_cast<std::size_t>(f)] = motion.root_translation.front();
  }
  return frozen;
}

Motion Truncated(const Motion& motion, double share) {
  const int kept = motion.frame_count() - static_cast<int>(std::lround(share * motion.frame_count()));
  Clip clip;
  clip.rate = motion.rate;
  clip.motion = motion;
  const auto cut = Cut(clip, 0, std::max(1, kept));
  Motion shorter = cut ? *cut->motion : motion;
  DropFrameAnnotations(shorter);
  return shorter;
}

Motion DriftBones(const Motion& motion, double percent_per_second) {
  Motion drifting = motion;
  DropFrameAnnotations(drifting);
  DropRotations(drifting);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const double growth = 1.0 + 0.01 * percent_per_second * motion.rate.FrameTime(f);
    const Vector3d root = motion.joints.at(f, 0);
    for (int j = 1; j < motion.joint_count(); ++j) {
      drifting.joints.at(f, j) = root + growth * (motion.joints.at(f, j) - root);
    }
  }
  return drifting;
}

Motion Turned(const Motion& motion, double degrees, std::uint64_t seed, const std::string& item) {
  if (motion.frame_count() == 0) return motion;
  Random random = RandomOf(Damage::kYaw, seed, item);
  const double sign = random.Below(2) == 0 ? 1.0 : -1.0;
  const Quaterniond turn(Eigen::AngleAxisd(sign * degrees * kPi / 180.0, Vector3d::UnitY()));
  const Vector3d centre = motion.joints.at(0, 0);
  Motion turned = Moved(motion, {turn, centre - turn * centre});
  DropFrameAnnotations(turned);
  return turned;
}

Motion PlayedFaster(const Motion& motion, double factor) {
  // A recording of a lower rate, played at the old one.
  constexpr std::int64_t kMillionths = 1000000;
  Clip clip;
  clip.rate = motion.rate;
  clip.motion = motion;
  const FrameRate slower{motion.rate.numerator * kMillionths,
                         motion.rate.denominator * std::llround(factor * static_cast<double>(kMillionths))};
  Motion faster = std::move(*Resample(clip, slower).motion);
  faster.rate = motion.rate;
  DropFrameAnnotations(faster);
  return faster;
}

Motion Scaled(const Motion& motion, double factor) {
  if (motion.frame_count() == 0) return motion;
  Motion scaled = motion;
  DropFrameAnnotations(scaled);
  const Vector3d centre = motion.joints.at(0, 0);
  const auto place = [&](const Vector3d& at) -> Vector3d { return centre + factor * (at - centre); };
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) scaled.joints.at(f, j) = place(motion.joints.at(f, j));
  }
  for (Vector3d& translation : scaled.root_translation) translation = place(translation);
  for (double& length : scaled.bone_length) length *= factor;
  if (!scaled.joints_only()) ComputeJoints(scaled);
  return scaled;
}

std::vector<bool> DamagedShare(const std::vector<std::string>& items, double share, Damage damage, std::uint64_t seed) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < items.size(); ++i) {
    Random random(seed, std::string("share of ") + InfoOf(damage).name, items[i]);
    order.emplace_back(random.Uniform(), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<bool> damaged(items.size(), false);
  const auto count = static_cast<std::size_t>(std::llround(share * static_cast<double>(items.size())));
  for (std::size_t i = 0; i < std::min(count, items.size()); ++i) damaged[order[i].second] = true;
  return damaged;
}

Status CheckDamage(const std::vector<Clip>& clips, Damage damage, DamagedValues values) {
  if (damage == Damage::kBoneDrift && values == DamagedValues::kRotations) {
    return Fail(ErrorCode::kUnsupported, "the extractor reads rotations, which do not contain bone lengths",
                InfoOf(damage).name, "choose other damages with --doses");
  }
  const std::size_t labels = LabelsOfClips(clips).size();
  if (damage != Damage::kSwappedLabels || labels >= 2) return {};
  return Fail(ErrorCode::kInconsistent,
              "the motions have " + Counted(static_cast<long long>(labels), "label") + ", swapping labels needs two",
              InfoOf(damage).name, "supply labels with --real-labels, or choose other damages with --doses");
}

Dataset DamagedDataset(const Dataset& dataset, const std::vector<int>& rows, Damage damage, double dose,
                       DamagedValues values, std::uint64_t seed) {
  Dataset damaged;
  damaged.skeleton = dataset.skeleton;
  damaged.labels = dataset.labels;
  damaged.fine_labels = dataset.fine_labels;
  damaged.recipe = dataset.recipe;
  damaged.created_by = dataset.created_by;
  damaged.axes = dataset.axes;
  const bool none = dose == InfoOf(damage).none;
  const bool positions =
      damage == Damage::kBoneDrift || (damage == Damage::kJitter && values == DamagedValues::kJoints);
  damaged.joints_only = dataset.joints_only || (positions && !none);
  for (const int row : rows) damaged.clips.push_back(dataset.clips[static_cast<std::size_t>(row)]);
  std::sort(damaged.clips.begin(), damaged.clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
  if (none) return damaged;
  if (TakesShareOfMotions(damage)) {
    DamageShareOf(damaged, damage, dose, seed);
    return damaged;
  }
  for (Clip& clip : damaged.clips) {
    clip.motion = DamagedMotion(*clip.motion, damage, dose, values, seed, clip.id());
    FitSegments(damage == Damage::kRate ? dose : 1.0, clip.motion->duration(), clip.segments);
  }
  return damaged;
}

}  // namespace mocurate
