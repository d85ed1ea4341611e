#include "core/quality/contacts.h"

#include <algorithm>

#include "core/base/median.h"
#include "core/geometry/rotation.h"
#include "core/motion/limbs.h"

namespace mocurate {
namespace {

constexpr double kLowestShare = 0.05;  // of a joint's places that count as its floor

double FloorUnderJoint(const Motion& motion, int joint) {
  std::vector<double> heights;
  for (int f = 0; f < motion.frame_count(); ++f) heights.push_back(motion.joints.at(f, joint).y());
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kLowestShare * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}

double SpeedAt(const Motion& motion, int frame, int joint) {
  const int before = std::max(0, frame - 1);
  const int after = std::min(motion.frame_count() - 1, frame + 1);
  if (after == before) return 0.0;
  return (motion.joints.at(after, joint) - motion.joints.at(before, joint)).norm() * motion.rate.hz() /
         (after - before);
}

}  // namespace

std::vector<int> FootJoints(const Skeleton& skeleton) {
  std::vector<int> feet;
  for (const Limb& leg : LimbsOf(skeleton).leg) {
    const int foot = leg.tip >= 0 ? leg.tip : leg.end;
    if (foot >= 0) feet.push_back(foot);
  }
  return feet;
}

std::vector<bool> JointContacts(const Motion& motion, int joint, const ContactLimits& limits) {
  std::vector<bool> standing(motion.frame_count(), false);
  const double ceiling = FloorUnderJoint(motion, joint) + limits.height;
  for (int f = 0; f < motion.frame_count(); ++f) {
    standing[f] = motion.joints.at(f, joint).y() <= ceiling && SpeedAt(motion, f, joint) <= limits.speed;
  }
  const double shortest = limits.min_time_s * motion.rate.hz();
  for (const FrameRun& gap : RunsWhere(standing, false)) {
    const bool between = gap.begin > 0 && gap.end < motion.frame_count();
    if (between && gap.end - gap.begin < shortest)
      std::fill(standing.begin() + gap.begin, standing.begin() + gap.end, true);
  }
  for (const FrameRun& run : RunsWhere(standing, true)) {
    if (run.end - run.begin < shortest) std::fill(standing.begin() + run.begin, standing.begin() + run.end, false);
  }
  return standing;
}

std::optional<double> FloorPenetration(const Motion& motion, const ContactLimits& limits) {
  const std::vector<int> feet = FootJoints(*motion.skeleton);
  if (feet.empty() || motion.frame_count() == 0) return std::nullopt;
  std::vector<double> standing_heights;
  for (const int foot : feet) {
    const std::vector<bool> stands = JointContacts(motion, foot, limits);
    for (int f = 0; f < motion.frame_count(); ++f) {
      if (stands[static_cast<std::size_t>(f)]) standing_heights.push_back(motion.joints.at(f, foot).y());
    }
  }
  if (standing_heights.empty()) return std::nullopt;
  const double floor = Median(std::move(standing_heights));
  double sum = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    double lowest = floor;
    for (const int foot : feet) lowest = std::min(lowest, motion.joints.at(f, foot).y());
    sum += floor - lowest;
  }
  return sum / motion.frame_count();
}

std::optional<double> LimitViolations(const Motion& motion) {
  if (motion.joints_only()) return std::nullopt;
  constexpr double kTolerance = 1e-6;  // rad, of float32 rotations
  std::size_t count = 0, beyond = 0;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const auto& limits = motion.skeleton->joints[static_cast<std::size_t>(j)].limits;
    if (!limits) continue;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Vector3d vector = LogQuaternion(motion.rotation_at(f, j));
      ++count;
      const bool inside = ((vector - limits->min).array() >= -kTolerance).all() &&
                          ((limits->max - vector).array() >= -kTolerance).all();
      beyond += inside ? 0 : 1;
    }
  }
  if (count == 0) return std::nullopt;
  return static_cast<double>(beyond) / static_cast<double>(count);
}

}  // namespace mocurate
