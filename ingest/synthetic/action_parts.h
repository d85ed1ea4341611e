#pragma once

#include "core/base/pi.h"
#include "ingest/synthetic/actions.h"

namespace mocurate {

// What actions are made of. Every one moves a pose by a part in [0, 1] of the way.

constexpr int kLeftSide = 0;
constexpr int kRightSide = 1;
constexpr double kGravity = 9.81;  // m/s^2

/// Up from `rise` to `top`, down from `fall` to `end`.
double Pulse(double at, double rise, double top, double fall, double end);

/// 1 between a rise and a fall of `rise_s` seconds each, at most a third of the action each.
double Held(double at, const Manner& manner, double rise_s);

/// sin of the `cycles`-fold turn, from the manner's phase on.
double Swing(double at, const Manner& manner);

/// Place in [0, 1) of the repetition that `at` falls into; repetitions are whole.
double Repetition(double at, const Manner& manner);
int Repetitions(const Manner& manner);

void Toward(double& angle, double target, double part);
void Toward(ArmPose& arm, const ArmPose& target, double part);

/// The weight goes from one foot to the other as `swing` of the left leg passes zero (1: fully in the air).
double LeftSupport(double swing);

/// Both legs bend, feet level.
void Crouch(Pose& pose, double depth);

/// The pelvis tips forwards, the legs stay upright.
void Bow(Pose& pose, double angle);

/// Onto a chair, hands on the thighs.
void SitOn(Pose& pose, double part);

}  // namespace mocurate
