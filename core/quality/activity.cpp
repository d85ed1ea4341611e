#include "core/quality/activity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace mocurate {
namespace {

constexpr double kFootRests = 0.01;      // metres a frame
constexpr double kFootInContact = 0.02;  // metres above the lowest foot
constexpr double kTooDeep = 0.005;       // metres below the lowest foot
constexpr double kRootStep = 0.001;      // metres a frame: below, the root stands
constexpr double kFootStep = 1.2e-4;     // metres a frame: below, the foot stands
constexpr double kFollows = 0.6;  // step of a foot about the root, over the root's: below, it moves with the root
constexpr double kFollowsInAir = 0.4;
constexpr double kOvertakes = 1.75;
constexpr std::size_t kShortest = 4;  // frames of a stretch without contact

/// Length of each joint's difference of that order between frames, mean over joints and frames. `root`: about the root.
double MeanDifference(const Motion& motion, int order, bool root) {
  const auto at = [&](int frame, int joint) {
    const Vector3d place = motion.joints.at(frame, joint);
    return root ? Vector3d(place - motion.joints.at(frame, 0)) : place;
  };
  const int frames = motion.frame_count() - order;
  double sum = 0.0;
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Vector3d first = at(f + 1, j) - at(f, j);
      sum += order == 1 ? first.norm() : (at(f + 2, j) - at(f + 1, j) - first).norm();
    }
  }
  return sum / (static_cast<double>(frames) * motion.joint_count());
}

/// A foot's steps to the next frame (the last one repeats), and whether it is in contact.
struct Foot {
  std::vector<Vector3d> place, step;
  std::vector<double> rate;  ///< step about the root over the root's step
  std::vector<bool> contact, follows;

  std::size_t frames() const { return place.size(); }
};

std::vector<Vector3d> Steps(const std::vector<Vector3d>& places) {
  std::vector<Vector3d> steps;
  for (std::size_t f = 0; f + 1 < places.size(); ++f) steps.push_back(places[f + 1] - places[f]);
  steps.push_back(steps.back());
  return steps;
}

Foot FootOf(const Motion& motion, int joint, const std::vector<Vector3d>& root_steps, double floor) {
  Foot foot;
  std::vector<Vector3d> relative;
  for (int f = 0; f < motion.frame_count(); ++f) {
    foot.place.push_back(motion.joints.at(f, joint));
    relative.push_back(foot.place.back() - motion.joints.at(f, 0));
  }
  foot.step = Steps(foot.place);
  const std::vector<Vector3d> relative_steps = Steps(relative);
  for (std::size_t f = 0; f < foot.frames(); ++f) {
    const double root = root_steps[f].norm(), step = foot.step[f].norm();
    foot.contact.push_back(step < kFootRests || foot.place[f].y() - floor < kFootInContact);
    foot.rate.push_back(relative_steps[f].norm() / (root + 1e-6));
    const bool together = foot.rate[f] < kFollows || foot.rate[f] > kOvertakes;
    foot.follows.push_back(root >= kRootStep && together && step > kFootStep);
  }
  return foot;
}

/// [begin, end) of the frames without contact.
std::vector<std::array<std::size_t, 2>> InAir(const Foot& foot) {
  std::vector<std::array<std::size_t, 2>> stretches;
  for (std::size_t f = 0; f < foot.frames(); ++f) {
    if (foot.contact[f]) continue;
    if (stretches.empty() || stretches.back()[1] != f) stretches.push_back({f, f});
    stretches.back()[1] = f + 1;
  }
  return stretches;
}

/// Frames in which a foot in the air moves with the root.
double FramesAfloat(const Foot& foot, const std::vector<Vector3d>& root_steps) {
  double afloat = 0.0;
  for (const auto& [begin, end] : InAir(foot)) {
    if (end - begin < kShortest) continue;
    std::size_t standing = 0, following = 0;
    for (std::size_t f = begin; f < end; ++f) {
      standing += root_steps[f].norm() < kRootStep ? 1 : 0;
      following += foot.rate[f] < kFollowsInAir ? 1 : 0;
    }
    if (2 * standing <= end - begin) afloat += static_cast<double>(following);
  }
  return afloat;
}

/// Strict local maxima; a plateau counts once.
int Peaks(const std::vector<double>& values) {
  int peaks = 0;
  for (std::size_t i = 1; i + 1 < values.size();) {
    std::size_t next = i + 1;
    while (next < values.size() && values[next] == values[i]) ++next;
    if (values[i - 1] < values[i] && next < values.size() && values[next] < values[i]) ++peaks;
    i = next;
  }
  return peaks;
}

/// Frames of stretches without any contact in which the left foot's path turns more than twice.
double FramesTurning(const Foot& left, const Foot& right) {
  double turning = 0.0;
  for (const auto& of_left : InAir(left)) {
    for (const auto& of_right : InAir(right)) {
      const std::size_t begin = std::max(of_left[0], of_right[0]), end = std::min(of_left[1], of_right[1]);
      if (end < begin + kShortest) continue;
      const auto direction = [&](std::size_t f) {
        const Vector3d way = left.place[f] - left.place[begin];
        return Vector3d(way / (way.norm() + 1e-6));
      };
      std::vector<double> angles;
      for (std::size_t f = begin + 1; f < end; ++f) {
        angles.push_back(std::acos(std::clamp(direction(f).dot(direction(end - 1)), -1.0, 1.0)));
      }
      if (Peaks(angles) > 2) turning += static_cast<double>(end - begin);
    }
  }
  return turning;
}

double Floating(const Foot& left, const Foot& right, const std::vector<Vector3d>& root_steps) {
  double frames = 0.0;
  for (std::size_t f = 0; f < left.frames(); ++f) {
    const bool both = left.contact[f] && right.contact[f];
    const bool one = left.contact[f] != right.contact[f];
    if (both && left.follows[f] && right.follows[f]) frames += 1.0;
    if (one && (left.contact[f] ? left.follows[f] : right.follows[f])) frames += 1.0;
  }
  frames += 0.5 * (FramesAfloat(left, root_steps) + FramesAfloat(right, root_steps)) + FramesTurning(left, right);
  return frames / static_cast<double>(left.frames());
}

double Slide(const Foot& foot) {
  double path = 0.0, contacts = 0.0;
  for (std::size_t f = 0; f < foot.frames(); ++f) {
    if (!foot.contact[f]) continue;
    path += std::hypot(foot.step[f].x(), foot.step[f].z());
    contacts += 1.0;
  }
  return path / (contacts + 1e-6);
}

}  // namespace

std::optional<Activity> ActivityOf(const Motion& motion) {
  if (motion.frame_count() < 2) return std::nullopt;
  Activity activity;
  const double period = motion.rate.FrameTime(1) - motion.rate.FrameTime(0);
  activity.movement = MeanDifference(motion, 1, false) / period;
  for (int f = 0; f + 3 < motion.frame_count(); ++f) {
    double largest = 0.0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Vector3d third = motion.joints.at(f + 3, j) - motion.joints.at(f, j) -
                             3.0 * (motion.joints.at(f + 2, j) - motion.joints.at(f + 1, j));
      largest = std::max(largest, third.norm() / (period * period * period));
    }
    activity.peak_jerk = std::max(activity.peak_jerk, largest);
    activity.jerk_area += largest * period;
  }
  return activity;
}

std::optional<MBenchMeasures> MBenchOf(const Motion& motion) {
  std::array<int, 2> joints{};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string name = side == 0 ? "left" : "right";
    auto joint = motion.skeleton->FindJoint(name + "_foot");
    if (!joint) joint = motion.skeleton->FindJoint(name + "_ankle");
    if (!joint) return std::nullopt;
    joints[side] = *joint;
  }
  if (motion.frame_count() < static_cast<int>(kShortest)) return std::nullopt;
  double floor = motion.joints.at(0, joints[0]).y(), deep = 0.0, depths = 0.0;
  std::vector<Vector3d> root;
  for (int f = 0; f < motion.frame_count(); ++f) {
    root.push_back(motion.joints.at(f, 0));
    for (const int joint : joints) floor = std::min(floor, motion.joints.at(f, joint).y());
  }
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (const int joint : joints) {
      const double height = motion.joints.at(f, joint).y() - floor;
      if (height >= -kTooDeep) continue;
      deep -= height;
      depths += 1.0;
    }
  }
  const std::vector<Vector3d> root_steps = Steps(root);
  const Foot left = FootOf(motion, joints[0], root_steps, floor), right = FootOf(motion, joints[1], root_steps, floor);
  MBenchMeasures measures;
  measures.slide = 1e3 * 0.5 * (Slide(left) + Slide(right));
  measures.floating = Floating(left, right, root_steps);
  measures.jitter = 1e3 * (MeanDifference(motion, 2, false) + MeanDifference(motion, 2, true));
  measures.dynamic = 1e3 * (MeanDifference(motion, 1, false) + MeanDifference(motion, 1, true));
  measures.penetration = depths > 0.0 ? 1e3 * deep / depths : 0.0;
  return measures;
}

}  // namespace mocurate
