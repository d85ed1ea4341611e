#include "ingest/synthetic/script.h"

#include <algorithm>
#include <cmath>

#include "ingest/synthetic/pose.h"

namespace mocurate {
namespace {

constexpr double kSeatS = 1.5;       // minimum time for sitting down or standing up
constexpr double kTurnRate = 2.2;    // rad/s, of a standing person
constexpr double kLeastTurn = 0.25;  // radians; smaller rotations need no step
constexpr double kStepHz = 1.6;

/// Part 0 gives `a`. The weight is on the lower foot.
Pose Blend(const Pose& a, const Pose& b, double part) {
  Pose pose = a;
  for (int side : {kLeftSide, kRightSide}) {
    Toward(pose.arm[side], b.arm[side], part);
    for (const auto angle : {&LegPose::flex, &LegPose::abduct, &LegPose::twist, &LegPose::knee, &LegPose::point}) {
      Toward(pose.leg[side].*angle, b.leg[side].*angle, part);
    }
  }
  for (const auto field : {&Pose::trunk_bend, &Pose::trunk_twist, &Pose::trunk_side, &Pose::head_nod,
                           &Pose::head_rotation, &Pose::lean, &Pose::yaw, &Pose::height}) {
    Toward(pose.*field, b.*field, part);
  }
  pose.left_support = Pose().left_support;
  return pose;
}

/// Standing people shift and move their arms slightly: slow waves that do not repeat within a take.
void Fidget(const Subject& subject, double time_s, double phase, Pose& pose) {
  const auto slow = [&](double hertz, double offset) {
    return std::sin(2.0 * kPi * hertz * time_s + offset + 2.3 * phase) +
           0.6 * std::sin(2.0 * kPi * 1.73 * hertz * time_s + 2.1 * offset + 3.1 * phase);
  };
  for (int side : {kLeftSide, kRightSide}) {
    const double offset = side == kLeftSide ? 0.7 : 2.9;
    pose.arm[side].flex += 0.035 * slow(0.31, offset);
    pose.arm[side].abduct += 0.015 * slow(0.23, offset + 1.0);
    pose.arm[side].elbow += 0.06 * slow(0.27, offset + 2.0);
    pose.leg[side].knee += subject.knee + 0.02 * slow(0.19, offset);
    pose.leg[side].flex += 0.5 * subject.knee;
  }
  pose.trunk_bend += 0.02 * slow(0.17, 0.3);
  pose.trunk_twist += 0.03 * slow(0.21, 1.3);
  pose.trunk_side += 0.012 * slow(0.15, 2.3);
  pose.head_rotation += 0.07 * slow(0.18, 3.3);
  pose.head_nod += 0.03 * slow(0.24, 4.3);
}

class Performer {
 public:
  Performer(const Script& script, const Subject& subject, FrameRate rate)
      : script_(script), subject_(subject), rate_(rate) {
    double yaw = script.heading;
    for (const ScriptedAction& action : script.actions) {
      // The way back to the heading is the shorter one.
      yaw += std::remainder(script.heading - yaw, 2.0 * kPi);
      yaw_.push_back(yaw);
      Pose end;
      Perform(action.action, 1.0, action.manner, end);
      yaw += end.yaw;
    }
  }

  Pose During(std::size_t k, int frame) const {
    const ScriptedAction& action = script_.actions[k];
    Pose pose = StandingPose(subject_, rate_.FrameTime(frame), script_.sway_phase);
    Fidget(subject_, rate_.FrameTime(frame), script_.sway_phase, pose);
    pose.yaw = yaw_[k];
    const double span = std::max(1, action.end - 1 - action.begin);
    Perform(action.action, std::clamp((frame - action.begin) / span, 0.0, 1.0), action.manner, pose);
    return pose;
  }

  /// From the end of action k to the begin of the next.
  Pose Between(std::size_t k, const ScriptSpan& way, int frame) const {
    const double at = way.end > way.begin ? (frame - way.begin + 1.0) / (way.end - way.begin + 1.0) : 1.0;
    const Pose from = During(k, frame);
    const Pose to = During(k + 1, frame);
    const double part = MinimumJerk(at, 0.0, 1.0);
    Pose pose = Blend(from, to, part);
    const double before = MinimumJerk(at - 1.0 / (way.end - way.begin + 1.0), 0.0, 1.0);
    pose.homing = before < 1.0 ? (part - before) / (1.0 - before) : 0.0;
    const double turned = std::abs(to.yaw - from.yaw);
    const double stepping = std::min(1.0, turned / 1.5) * Pulse(at, 0.0, 0.2, 0.8, 1.0);
    if (turned < kLeastTurn) return pose;
    const double phase = 2.0 * kPi * kStepHz * rate_.FrameTime(frame - way.begin);
    for (int side : {kLeftSide, kRightSide}) {
      const double lift = std::max(0.0, std::sin(phase + (side == kLeftSide ? 0.0 : kPi)));
      pose.leg[side].flex += 0.35 * stepping * lift * lift;
      pose.leg[side].knee += 0.60 * stepping * lift * lift;
    }
    return pose;
  }

  int WayFrames(std::size_t k) const {
    const Pose from = During(k, script_.actions[k].end);
    const Pose to = During(k + 1, script_.actions[k].end);
    double seconds = std::max(script_.transition_s, std::abs(to.yaw - from.yaw) / kTurnRate);
    if (std::abs(to.leg[kLeftSide].knee - from.leg[kLeftSide].knee) > 0.8) seconds = std::max(seconds, kSeatS);
    return static_cast<int>(std::ceil(seconds * rate_.hz()));
  }

 private:
  const Script& script_;
  const Subject& subject_;
  FrameRate rate_;
  std::vector<double> yaw_;
};

std::vector<ScriptSpan> Ways(const Script& script, const Performer& performer) {
  std::vector<ScriptSpan> ways;
  for (std::size_t k = 0; k + 1 < script.actions.size(); ++k) {
    const int begin = script.actions[k].end;
    ways.push_back({begin, std::min(script.actions[k + 1].begin, begin + performer.WayFrames(k))});
  }
  return ways;
}

}  // namespace

std::vector<ScriptSpan> Transitions(const Script& script, FrameRate rate) {
  const Subject anybody;
  return Ways(script, Performer(script, anybody, rate));
}

Motion PerformScript(const Script& script, const Subject& subject, const SkeletonPtr& skeleton, FrameRate rate) {
  const Performer performer(script, subject, rate);
  const std::vector<ScriptSpan> ways = Ways(script, performer);
  std::vector<Pose> poses;
  std::size_t k = 0;
  for (int f = 0; f < script.frames; ++f) {
    if (script.actions.empty()) {
      poses.push_back(StandingPose(subject, rate.FrameTime(f), script.sway_phase));
      Fidget(subject, rate.FrameTime(f), script.sway_phase, poses.back());
      poses.back().yaw = script.heading;
      continue;
    }
    while (k + 1 < script.actions.size() && f >= ways[k].end) ++k;
    const bool on_the_way = k < ways.size() && f >= ways[k].begin;
    poses.push_back(on_the_way ? performer.Between(k, ways[k], f) : performer.During(k, f));
  }
  return MoveBody(skeleton, subject.bone_length, rate, poses, Vector3d::Zero());
}

}  // namespace mocurate
