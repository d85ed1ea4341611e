#include "ingest/synthetic/action_parts.h"

#include <algorithm>
#include <cmath>

namespace mocurate {

double MinimumJerk(double at, double begin, double end) {
  if (end <= begin) return at < end ? 0.0 : 1.0;
  const double x = std::clamp((at - begin) / (end - begin), 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

double Pulse(double at, double rise, double top, double fall, double end) {
  return MinimumJerk(at, rise, top) - MinimumJerk(at, fall, end);
}

double Held(double at, const Manner& manner, double rise_s) {
  const double rise = std::min(1.0 / 3.0, rise_s / std::max(1e-3, manner.active_s));
  return Pulse(at, 0.0, rise, 1.0 - rise, 1.0);
}

double Swing(double at, const Manner& manner) { return std::sin(2.0 * kPi * manner.cycles * at + manner.phase); }

int Repetitions(const Manner& manner) { return std::max(1, static_cast<int>(std::lround(manner.cycles))); }

double Repetition(double at, const Manner& manner) {
  const double turns = std::clamp(at, 0.0, 1.0) * Repetitions(manner);
  return turns - std::floor(turns);
}

void Toward(double& angle, double target, double part) { angle += part * (target - angle); }

void Toward(ArmPose& arm, const ArmPose& target, double part) {
  Toward(arm.flex, target.flex, part);
  Toward(arm.abduct, target.abduct, part);
  Toward(arm.twist, target.twist, part);
  Toward(arm.elbow, target.elbow, part);
  Toward(arm.wrist, target.wrist, part);
}

double LeftSupport(double swing) { return 1.0 / (1.0 + std::exp(swing / 0.12)); }

void Crouch(Pose& pose, double depth) {
  for (LegPose& leg : pose.leg) {
    leg.flex += 1.45 * depth;
    leg.knee += 1.75 * depth;
    leg.abduct += 0.12 * depth;
  }
  pose.lean += 0.30 * depth;
  pose.trunk_bend += 0.35 * depth;
}

void Bow(Pose& pose, double angle) {
  pose.lean += angle;
  for (LegPose& leg : pose.leg) leg.flex += angle;
}

void SitOn(Pose& pose, double part) {
  for (LegPose& leg : pose.leg) {
    leg.flex += 1.42 * part;
    leg.knee += 1.5 * part;
  }
  pose.lean -= 0.05 * part;
  for (ArmPose& arm : pose.arm) Toward(arm, {0.55, 0.1, 0.0, 0.9, 0.0}, part);
}

}  // namespace mocurate
