#include "core/quality/measures.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr double kContactHeight = 0.05;  ///< metres above the floor
constexpr double kFloorShare = 0.05;

void MeasureBones(const TrackedPoints& samples, const Skeleton& skeleton, MotionMeasures& measures) {
  measures.bone_spreads_mm.assign(samples.count(), 0.0);
  double sum = 0.0;
  int bones = 0;
  for (int j = 0; j < samples.count(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0) continue;
    std::vector<double> lengths;
    for (int f = 0; f < samples.frames(); ++f) {
      if (!samples.sees(f, j) || !samples.sees(f, parent)) continue;
      lengths.push_back((samples.at(f, j) - samples.at(f, parent)).norm());
    }
    if (lengths.size() < 2) continue;
    double mean = 0.0;
    for (const double length : lengths) mean += length / static_cast<double>(lengths.size());
    double square = 0.0;
    for (const double length : lengths) square += (length - mean) * (length - mean);
    measures.bone_spreads_mm[j] = 1e3 * std::sqrt(square / static_cast<double>(lengths.size()));
    sum += measures.bone_spreads_mm[j];
    ++bones;
  }
  if (bones > 0) measures.bone_spread_mm = sum / bones;
}

/// Third divided difference times 3!: exact for cubics at any spacing.
Vector3d ThirdDerivative(const TrackedPoints& samples, int frame, int joint) {
  Vector3d value[4];
  for (int i = 0; i < 4; ++i) value[i] = samples.at(frame + i, joint);
  for (int order = 1; order < 4; ++order) {
    for (int i = 0; i + order < 4; ++i) {
      value[i] = (value[i + 1] - value[i]) / (samples.time_s[frame + i + order] - samples.time_s[frame + i]);
    }
  }
  return 6.0 * value[0];
}

void MeasureJerk(const TrackedPoints& samples, MotionMeasures& measures) {
  double square = 0.0;
  std::size_t count = 0;
  for (int j = 0; j < samples.count(); ++j) {
    for (int f = 0; f + 3 < samples.frames(); ++f) {
      bool whole = true;
      for (int i = 0; i < 4; ++i) whole = whole && samples.sees(f + i, j);
      if (!whole) continue;
      square += ThirdDerivative(samples, f, j).squaredNorm();
      ++count;
    }
  }
  if (count > 0) measures.jerk = std::sqrt(square / static_cast<double>(count));
}

void MeasurePresence(const TrackedPoints& samples, MotionMeasures& measures) {
  std::size_t missing = 0;
  std::size_t all = 0;
  for (int j = 0; j < samples.count(); ++j) {
    int present = 0;
    for (int f = 0; f < samples.frames(); ++f) present += samples.sees(f, j) ? 1 : 0;
    if (present == 0) continue;
    missing += static_cast<std::size_t>(samples.frames() - present);
    all += static_cast<std::size_t>(samples.frames());
  }
  if (all > 0) measures.missing_share = static_cast<double>(missing) / static_cast<double>(all);
  for (int f = 1; f < samples.frames(); ++f) {
    bool same = true;
    bool any = false;
    for (int j = 0; same && j < samples.count(); ++j) {
      if (samples.sees(f, j) != samples.sees(f - 1, j)) same = false;
      if (!same || !samples.sees(f, j)) continue;
      any = true;
      same = samples.at(f, j) == samples.at(f - 1, j);
    }
    measures.frozen_frames += same && any ? 1 : 0;
  }
}

std::vector<int> Feet(const Skeleton& skeleton) {
  std::vector<int> feet;
  for (const char* side : {"left", "right"}) {
    std::optional<int> foot = skeleton.FindJoint(std::string(side) + "_foot");
    if (!foot) foot = skeleton.FindJoint(std::string(side) + "_ankle");
    if (foot) feet.push_back(*foot);
  }
  return feet;
}

void MeasureSkate(const TrackedPoints& samples, const Skeleton& skeleton, MotionMeasures& measures) {
  double path = 0.0;
  double time = 0.0;
  for (const int foot : Feet(skeleton)) {
    std::vector<double> heights;
    for (int f = 0; f < samples.frames(); ++f) {
      if (samples.sees(f, foot)) heights.push_back(samples.at(f, foot).y());
    }
    if (heights.empty()) continue;
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kFloorShare * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), low, heights.end());
    const double ceiling = *low + kContactHeight;
    for (int f = 1; f < samples.frames(); ++f) {
      if (!samples.sees(f, foot) || !samples.sees(f - 1, foot)) continue;
      if (samples.at(f, foot).y() > ceiling || samples.at(f - 1, foot).y() > ceiling) continue;
      const Vector3d step = samples.at(f, foot) - samples.at(f - 1, foot);
      path += std::hypot(step.x(), step.z());
      time += samples.time_s[f] - samples.time_s[f - 1];
    }
  }
  if (time > 0.0) measures.foot_skate = path / time;
}

double Rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 5.0);
  return std::round(value / unit) * unit;
}

}  // namespace

MotionMeasures MeasureJoints(const Skeleton& skeleton, const JointPositions& joints,
                             const std::vector<double>& confidence, const std::vector<double>& time_s) {
  const TrackedPoints samples{joints, confidence, time_s};
  MotionMeasures measures;
  measures.frames = joints.frames;
  MeasureBones(samples, skeleton, measures);
  MeasureJerk(samples, measures);
  MeasurePresence(samples, measures);
  MeasureSkate(samples, skeleton, measures);
  return measures;
}

MotionMeasures MeasureMotion(const Motion& motion) {
  std::vector<double> time_s;
  for (int f = 0; f < motion.frame_count(); ++f) time_s.push_back(motion.rate.FrameTime(f));
  return MeasureJoints(*motion.skeleton, motion.joints, {}, time_s);
}

nlohmann::json MeasuresJson(const MotionMeasures& measures, const Skeleton& skeleton) {
  nlohmann::json bones = nlohmann::json::object();
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.joints[j].parent >= 0) bones[skeleton.joints[j].name] = Rounded(measures.bone_spreads_mm[j]);
  }
  return {{"frames", measures.frames},
          {"bone_spread_mm", Rounded(measures.bone_spread_mm)},
          {"bone_spreads_mm", bones},
          {"jerk", Rounded(measures.jerk)},
          {"missing_share", Rounded(measures.missing_share)},
          {"frozen_frames", measures.frozen_frames},
          {"foot_skate", Rounded(measures.foot_skate)}};
}

}  // namespace mocurate
