#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/pi.h"
#include "ingest/synthetic/pose.h"

namespace mocurate {

/// How one repetition is performed.
struct Manner {
  double amplitude = 1.0;
  double phase = 0.0;     ///< radians, of oscillating movements
  double cycles = 2.0;    ///< of movements that repeat
  double active_s = 2.0;  ///< seconds from the first to the last movement
  bool seated = false;    ///< on a chair all the time
  double turn = 0.0;      ///< radians about +y over the action: walks in a circle
};

/// Names of the actions, sorted: simple ones (clap, jump, kick, ...), HumanAct12's 34 variants (humanact12_set.h) and
/// those of other sets.
std::vector<std::string> KnownActions();

/// Error kConfig for an unknown name, with the nearest known one.
Status CheckAction(const std::string& name);

/// Seconds of one cycle at an everyday tempo; 0 for actions performed once. Known actions only.
double NaturalPeriod(const std::string& action);

/// Seconds of the action with that many cycles.
double NaturalDuration(const std::string& action, double cycles);

/// Moves `pose` (standing) to its state at `progress` in [0, 1] of the action's time. One-handed actions that do not
/// name a side lead with the right. Known actions only.
void Perform(const std::string& action, double progress, const Manner& manner, Pose& pose);

/// Minimum-jerk step from 0 at `begin` to 1 at `end` (Flash and Hogan 1985).
double MinimumJerk(double at, double begin, double end);

// Building blocks of actions. Each one moves a pose by a fraction in [0, 1] of the full movement.

constexpr int kLeftSide = 0;
constexpr int kRightSide = 1;
constexpr double kGravity = 9.81;  // m/s^2

/// Rises from 0 to 1 between `rise` and `top`, falls to 0 between `fall` and `end`.
double Pulse(double at, double rise, double top, double fall, double end);

/// 1 between a rise and a fall of `rise_s` seconds each, at most a third of the action each.
double Held(double at, const Manner& manner, double rise_s);

/// sin of `cycles` periods, starting at the manner's phase.
double Swing(double at, const Manner& manner);

/// Progress in [0, 1) within the current repetition; repetitions are whole.
double Repetition(double at, const Manner& manner);
int Repetitions(const Manner& manner);

void Toward(double& angle, double target, double part);
void Toward(ArmPose& arm, const ArmPose& target, double part);

/// Shifts the weight between the feet as `swing` of the left leg passes zero (1: fully in the air).
double LeftSupport(double swing);

/// Both legs bend, feet level.
void Crouch(Pose& pose, double depth);

/// The pelvis tilts forwards, the legs stay upright.
void Bow(Pose& pose, double angle);

/// Onto a chair, hands on the thighs.
void SitOn(Pose& pose, double part);

/// One action: a function that moves a pose, and its timing.
struct ActionRow {
  const char* name;
  void (*perform)(double at, const Manner& manner, Pose& pose);
  double period_s;  ///< of one cycle; 0: performed once
  double once_s;    ///< seconds to reach the pose and return
};

/// Warming up, lifting, boxing, running, jumping.
const std::vector<ActionRow>& ExerciseActions();
/// Drinking, eating, telephoning, driving, throwing, greeting, picking up.
const std::vector<ActionRow>& EverydayActions();

}  // namespace mocurate
