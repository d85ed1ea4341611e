#include "ingest/synthetic/actions.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace mocurate {
namespace {

void Wave(double at, const Manner& m, Pose& pose) {
  const double raised = Pulse(at, 0.0, 0.22, 0.78, 1.0);
  const double to_and_fro = std::sin(2.0 * kPi * m.cycles * at + m.phase) * Pulse(at, 0.12, 0.3, 0.7, 0.85);
  Toward(pose.arm[kRightSide], {0.25, 1.45 * m.amplitude, 1.45, 1.35 + 0.55 * m.amplitude * to_and_fro, 0.0}, raised);
  pose.arm[kRightSide].wrist += 0.25 * to_and_fro;
  pose.trunk_side -= 0.06 * raised;
  pose.head_rotation -= 0.1 * raised;
}

void Punch(double at, const Manner& m, Pose& pose) {
  const double guard = Pulse(at, 0.0, 0.18, 0.85, 1.0);
  Toward(pose.arm[kLeftSide], {0.55, 0.25, -0.2, 2.0, 0.0}, guard);
  Toward(pose.arm[kRightSide], {0.35, 0.3, -0.2, 2.1, 0.0}, guard);
  pose.leg[kLeftSide].flex += 0.25 * guard;
  pose.leg[kLeftSide].knee += 0.25 * guard;
  pose.leg[kRightSide].flex -= 0.2 * guard;
  pose.leg[kRightSide].knee += 0.15 * guard;
  const int strikes = std::max(1, static_cast<int>(m.cycles));
  for (int k = 0; k < strikes; ++k) {
    const double begin = 0.2 + 0.6 * k / strikes;
    const double length = 0.6 / strikes;
    const double strike = Pulse(at, begin, begin + 0.35 * length, begin + 0.45 * length, begin + length);
    Toward(pose.arm[kRightSide], {1.45 * m.amplitude, 0.05, -0.1, 0.12, 0.0}, strike);
    pose.trunk_twist += 0.5 * m.amplitude * strike;
    pose.lean += 0.08 * strike;
  }
}

void Kick(double at, const Manner& m, Pose& pose) {
  const double wind = Pulse(at, 0.05, 0.3, 0.3, 0.48);
  const double swing = Pulse(at, 0.28, 0.52, 0.56, 0.85);
  LegPose& leg = pose.leg[kRightSide];
  leg.flex += -0.4 * wind + 1.25 * m.amplitude * swing;
  leg.knee += 1.1 * wind + 0.15 * swing + 0.5 * Pulse(at, 0.56, 0.68, 0.7, 0.88);
  leg.point += 0.5 * swing;
  pose.leg[kLeftSide].flex += 0.12 * swing;
  pose.leg[kLeftSide].knee += 0.2 * swing;
  pose.lean -= 0.22 * m.amplitude * swing;
  pose.arm[kLeftSide].flex += 0.7 * m.amplitude * swing;
  pose.arm[kRightSide].flex += 0.3 * wind - 0.5 * swing;
  pose.arm[kLeftSide].abduct += 0.4 * swing;
  pose.arm[kRightSide].abduct += 0.35 * swing;
}

void Squat(double at, const Manner& m, Pose& pose) {
  const int repeats = m.cycles >= 2.5 ? 2 : 1;
  for (int k = 0; k < repeats; ++k) {
    const double begin = static_cast<double>(k) / repeats;
    const double length = 1.0 / repeats;
    const double down = Pulse(at, begin, begin + 0.42 * length, begin + 0.52 * length, begin + length);
    Crouch(pose, 0.95 * m.amplitude * down);
    for (ArmPose& arm : pose.arm) arm.flex += 1.25 * down;
  }
}

void Walk(double at, const Manner& m, Pose& pose) {
  const double going = Pulse(at, 0.0, 0.15, 0.85, 1.0);
  for (int side : {kLeftSide, kRightSide}) {
    const double phase = 2.0 * kPi * m.cycles * at + (side == kLeftSide ? 0.0 : kPi);
    const double swings = std::max(0.0, std::cos(phase));  // the leg comes forward
    pose.leg[side].flex += going * (0.06 + 0.38 * m.amplitude * std::sin(phase) + 0.22 * swings * swings);
    pose.leg[side].knee += going * (0.1 + 0.75 * swings * swings);
    pose.leg[side].point += going * 0.25 * std::max(0.0, -std::sin(phase));
    pose.arm[side].flex -= going * 0.45 * m.amplitude * std::sin(phase);
    pose.arm[side].elbow += going * 0.15;
  }
  pose.trunk_twist += going * 0.12 * m.amplitude * std::sin(2.0 * kPi * m.cycles * at);
  pose.lean += 0.05 * going;
  pose.left_support = LeftSupport(std::cos(2.0 * kPi * m.cycles * at));
}

void Jump(double at, const Manner& m, Pose& pose) {
  const double height = 0.22 * m.amplitude;
  const double flight = std::min(0.4, std::sqrt(8.0 * height / kGravity) / m.active_s);
  const double takeoff = 0.45;
  const double landing = takeoff + flight;
  Crouch(pose, 0.6 * m.amplitude * Pulse(at, 0.0, 0.28, 0.3, takeoff));
  Crouch(pose, 0.4 * m.amplitude * Pulse(at, landing - 0.02, landing + 0.12, landing + 0.15, 1.0));
  const double x = (at - takeoff) / flight;
  if (x > 0.0 && x < 1.0) pose.height += 4.0 * height * x * (1.0 - x);
  const double air = Pulse(at, takeoff - 0.08, takeoff + 0.04, landing - 0.05, landing + 0.05);
  for (LegPose& leg : pose.leg) leg.point += 0.5 * air;
  const double back = Pulse(at, 0.05, 0.28, 0.28, 0.45);
  const double up = Pulse(at, 0.3, 0.5, 0.6, 0.95);
  for (ArmPose& arm : pose.arm) arm.flex += -0.6 * back + 1.9 * m.amplitude * up;
}

void Clap(double at, const Manner& m, Pose& pose) {
  const double raised = Pulse(at, 0.0, 0.2, 0.82, 1.0);
  const double open = 0.5 + 0.5 * std::cos(2.0 * kPi * m.cycles * 1.5 * at + m.phase);
  for (ArmPose& arm : pose.arm) Toward(arm, {1.1, -0.12 + 0.5 * m.amplitude * open, -0.15, 0.55, 0.0}, raised);
}

void Throw(double at, const Manner& m, Pose& pose) {
  const double wind = Pulse(at, 0.0, 0.38, 0.42, 0.6);
  const double release = Pulse(at, 0.42, 0.6, 0.68, 1.0);
  Toward(pose.arm[kRightSide], {0.2, 1.5, 1.4, 1.7, 0.0}, wind);
  Toward(pose.arm[kRightSide], {1.5 * m.amplitude, 0.1, 0.2, 0.2, -0.2}, release);
  pose.arm[kLeftSide].flex += 0.8 * wind - 0.2 * release;
  pose.trunk_twist += m.amplitude * (-0.45 * wind + 0.5 * release);
  pose.leg[kLeftSide].flex += 0.35 * release;
  pose.leg[kLeftSide].knee += 0.35 * release;
  pose.lean += -0.08 * wind + 0.15 * release;
}

void Sit(double at, const Manner& m, Pose& pose) {
  const double down = MinimumJerk(at, 0.05, 0.85);
  const double bow = Pulse(at, 0.0, 0.4, 0.45, 0.95);
  for (LegPose& leg : pose.leg) {
    leg.flex += 1.42 * down;
    leg.knee += 1.5 * down;
  }
  pose.lean += 0.45 * m.amplitude * bow - 0.05 * down;
  pose.trunk_bend += 0.3 * bow;
  for (ArmPose& arm : pose.arm) Toward(arm, {0.55, 0.1, 0.0, 0.9, 0.0}, down);
}

void Turn(double at, const Manner& m, Pose& pose) {
  const double going = Pulse(at, 0.0, 0.15, 0.85, 1.0);
  pose.yaw += kPi * MinimumJerk(at, 0.03, 0.97);
  pose.head_rotation += 0.35 * Pulse(at, 0.0, 0.2, 0.6, 0.95);
  for (int side : {kLeftSide, kRightSide}) {
    const double lift = std::max(0.0, std::sin(2.0 * kPi * m.cycles * at + (side == kLeftSide ? 0.0 : kPi)));
    pose.leg[side].flex += 0.35 * m.amplitude * going * lift * lift;
    pose.leg[side].knee += 0.6 * m.amplitude * going * lift * lift;
    pose.arm[side].flex += (side == kLeftSide ? -0.2 : 0.2) * going;
  }
  pose.left_support = LeftSupport(std::sin(2.0 * kPi * m.cycles * at));
}

constexpr ActionRow kActions[] = {{"clap", Clap, 0.7, 0.6},   {"jump", Jump, 0.0, 1.7}, {"kick", Kick, 0.0, 1.9},
                                  {"punch", Punch, 0.9, 0.3}, {"sit", Sit, 0.0, 2.0},   {"squat", Squat, 0.0, 2.2},
                                  {"throw", Throw, 0.0, 1.9}, {"turn", Turn, 1.0, 0.4}, {"walk", Walk, 1.05, 0.5},
                                  {"wave", Wave, 0.6, 0.6}};

/// All tables, in the order of the source files.
std::vector<const ActionRow*> AllActions() {
  std::vector<const ActionRow*> all;
  for (const ActionRow& row : kActions) all.push_back(&row);
  for (const ActionRow& row : ExerciseActions()) all.push_back(&row);
  for (const ActionRow& row : EverydayActions()) all.push_back(&row);
  return all;
}

const ActionRow* Find(const std::string& name) {
  for (const ActionRow* row : AllActions()) {
    if (name == row->name) return row;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> KnownActions() {
  std::vector<std::string> names;
  for (const ActionRow* row : AllActions()) names.emplace_back(row->name);
  std::sort(names.begin(), names.end());
  return names;
}

Status CheckAction(const std::string& name) {
  if (Find(name) != nullptr) return {};
  std::string known;
  for (const std::string& other : KnownActions()) known += (known.empty() ? "" : ", ") + other;
  const auto near = Nearest(name, KnownActions());
  return Fail(ErrorCode::kConfig, "the studio cannot perform '" + name + "'", "ingest.synthetic.actions",
              near ? "did you mean '" + *near + "'?" : "it can perform " + known);
}

double NaturalPeriod(const std::string& action) {
  const ActionRow* row = Find(action);
  return row == nullptr ? 0.0 : row->period_s;
}

double NaturalDuration(const std::string& action, double cycles) {
  const ActionRow* row = Find(action);
  return row == nullptr ? 0.0 : row->once_s + cycles * row->period_s;
}

void Perform(const std::string& action, double progress, const Manner& manner, Pose& pose) {
  if (manner.seated) SitOn(pose, 1.0);
  if (manner.turn != 0.0) pose.yaw += manner.turn * std::clamp(progress, 0.0, 1.0);
  if (const ActionRow* row = Find(action)) row->perform(progress, manner, pose);
}

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
