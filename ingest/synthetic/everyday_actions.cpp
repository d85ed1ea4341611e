#include <algorithm>
#include <cmath>

#include "ingest/synthetic/actions.h"

namespace mocurate {
namespace {

// Positions of a hand, found by trial on the mean body: flex, abduct, twist, elbow, wrist of the arm.
constexpr ArmPose kAtTheMouth{1.22, 0.29, -0.60, 2.20, 0.0};
constexpr ArmPose kBottleTipped{1.52, 0.37, -0.65, 2.02, 0.0};
constexpr ArmPose kAtTheEar{1.53, 0.78, -0.30, 2.40, 0.0};
constexpr ArmPose kInThePocket{-0.25, 0.48, -0.85, 0.95, 0.0};
constexpr ArmPose kBeforeTheEyes{0.79, 0.36, -0.75, 1.75, 0.0};
constexpr ArmPose kAtTheWheel{0.72, 0.22, -0.29, 1.08, 0.0};
constexpr ArmPose kAtThePlate{0.42, 0.05, -0.38, 0.95, 0.0};
constexpr ArmPose kBehindTheHeadBoth{2.61, -0.15, -0.26, 1.78, 0.0};
constexpr ArmPose kReleaseBoth{1.95, 0.21, -0.90, 0.40, 0.0};
constexpr ArmPose kSalute{1.92, 0.94, -0.80, 2.18, 0.0};
constexpr ArmPose kRaised{2.85, 0.25, -0.30, 0.35, 0.0};
constexpr ArmPose kFist{1.05, 0.25, -0.20, 1.75, 0.0};
constexpr ArmPose kCarries{0.35, 0.15, -0.45, 1.35, 0.0};
constexpr ArmPose kAtTheTable{1.30, 0.05, -0.10, 0.25, 0.0};
constexpr ArmPose kReadyToCatch{1.45, 0.10, -0.40, 0.55, 0.0};
constexpr ArmPose kCaught{0.62, 0.30, -0.75, 1.95, 0.0};

enum Vessel { kBottle, kCup };

/// Up to the mouth, sips, down again.
void Drink(double at, const Manner& m, Pose& pose, bool left, bool right, Vessel vessel) {
  const double held = Held(at, m, 1.0);
  const double sip = Pulse(at, 0.25, 0.45, 0.6, 0.8) * (0.85 + 0.15 * Swing(at, m));
  for (int side : {kLeftSide, kRightSide}) {
    if (side == kLeftSide ? !left : !right) continue;
    Toward(pose.arm[side], kAtTheMouth, held);
    Toward(pose.arm[side], kBottleTipped, (vessel == kBottle ? 1.0 : 0.45) * held * sip);
    if (left && right) pose.arm[side].abduct -= 0.1 * held;
    pose.arm[side].wrist += (vessel == kBottle ? 0.1 : 0.35) * sip * held;
  }
  pose.head_nod -= (vessel == kBottle ? 0.45 : 0.22) * m.amplitude * sip;
  pose.trunk_bend -= 0.06 * sip;
}
void DrinkBottleRight(double at, const Manner& m, Pose& pose) { Drink(at, m, pose, false, true, kBottle); }
void DrinkBottleLeft(double at, const Manner& m, Pose& pose) { Drink(at, m, pose, true, false, kBottle); }
void DrinkCupRight(double at, const Manner& m, Pose& pose) { Drink(at, m, pose, false, true, kCup); }
void DrinkCupLeft(double at, const Manner& m, Pose& pose) { Drink(at, m, pose, true, false, kCup); }
void DrinkBothHands(double at, const Manner& m, Pose& pose) { Drink(at, m, pose, true, true, kCup); }

/// From the plate to the mouth and back, again and again.
void EatWith(double at, const Manner& m, Pose& pose, int hand) {
  const double held = Held(at, m, 0.7);
  const double x = Repetition(at, m);
  const double bite = Pulse(x, 0.05, 0.42, 0.55, 0.95);
  Toward(pose.arm[hand], kAtThePlate, held);
  Toward(pose.arm[hand], kAtTheMouth, held * bite);
  pose.head_nod += held * (0.12 + 0.14 * m.amplitude * bite);
  pose.trunk_bend += held * (0.10 + 0.08 * bite);
}
void EatRight(double at, const Manner& m, Pose& pose) { EatWith(at, m, pose, kRightSide); }
void EatLeft(double at, const Manner& m, Pose& pose) { EatWith(at, m, pose, kLeftSide); }

/// Both hands hold it below the chin; the head comes to it.
void EatBurger(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.8);
  const double bite = Pulse(Repetition(at, m), 0.1, 0.4, 0.55, 0.9);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, {1.0, 0.26, -0.70, 2.05, 0.0}, held);
    Toward(arm, kAtTheMouth, held * bite);
  }
  pose.head_nod += held * (0.08 + 0.22 * m.amplitude * bite);
  pose.trunk_bend += 0.12 * held;
}

void SteeringWheel(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.6);
  const double turned = m.amplitude * Swing(at, m) * held;
  for (int side : {kLeftSide, kRightSide}) {
    const double up = side == kLeftSide ? turned : -turned;
    Toward(pose.arm[side], kAtTheWheel, held);
    pose.arm[side].flex += 0.40 * up;
    pose.arm[side].elbow += 0.25 * std::abs(turned);
    pose.arm[side].abduct -= 0.20 * std::max(0.0, up);
  }
  pose.trunk_side += 0.10 * turned;
  pose.head_rotation += 0.12 * turned;
}

/// Out of the pocket, looked at, to the ear for a while, back.
void PhoneCall(double at, const Manner& m, Pose& pose) {
  const double talk = Swing(at, m);
  ArmPose& arm = pose.arm[kRightSide];
  Toward(arm, kInThePocket, Pulse(at, 0.0, 0.10, 0.12, 0.20) + Pulse(at, 0.80, 0.88, 0.92, 1.0));
  Toward(arm, kBeforeTheEyes, Pulse(at, 0.13, 0.22, 0.26, 0.34));
  const double ear = Pulse(at, 0.25, 0.35, 0.72, 0.84);
  Toward(arm, kAtTheEar, ear);
  arm.abduct += 0.06 * ear * talk;
  pose.head_rotation += 0.22 * m.amplitude * ear * talk;
  pose.head_nod += 0.30 * Pulse(at, 0.12, 0.2, 0.26, 0.34) + 0.05 * ear;
  pose.trunk_twist += 0.08 * ear * talk;
  pose.trunk_side += 0.04 * ear;
}

void PhoneLeft(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 1.2);
  const double talk = Swing(at, m);
  Toward(pose.arm[kLeftSide], kAtTheEar, held);
  pose.arm[kLeftSide].abduct += 0.08 * held * talk;
  pose.arm[kRightSide].flex += 0.35 * held * m.amplitude * std::max(0.0, talk);
  pose.arm[kRightSide].elbow += 0.55 * held * m.amplitude * std::max(0.0, talk);
  pose.head_rotation -= 0.20 * m.amplitude * held * talk;
  pose.trunk_side -= 0.04 * held;
}

void ThrowBoth(double at, const Manner& m, Pose& pose) {
  const double wind = Pulse(at, 0.0, 0.40, 0.44, 0.58);
  const double release = Pulse(at, 0.44, 0.58, 0.66, 1.0);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kBehindTheHeadBoth, wind);
    Toward(arm, kReleaseBoth, release);
  }
  pose.trunk_bend += m.amplitude * (-0.22 * wind + 0.40 * release);
  pose.lean += 0.10 * release - 0.06 * wind;
  pose.leg[kLeftSide].flex += 0.30 * release;
  pose.leg[kLeftSide].knee += 0.30 * release;
}

void PickUp(double at, const Manner& m, Pose& pose) {
  const double down = Pulse(at, 0.05, 0.45, 0.52, 0.95);
  Crouch(pose, 0.40 * m.amplitude * down);
  Bow(pose, 0.55 * down);
  pose.trunk_bend += 0.45 * down;
  Toward(pose.arm[kRightSide], {0.95, 0.0, 0.0, 0.1, 0.0}, down);
  Toward(pose.arm[kRightSide], {0.6, 0.15, -0.2, 1.4, 0.0}, Pulse(at, 0.55, 0.85, 0.9, 1.0));
}

/// Straight down to the floor and up again; the pelvis goes back for balance.
void BendDown(double at, const Manner& m, Pose& pose) {
  const double down = Pulse(at, 0.03, 0.42, 0.58, 0.97);
  Bow(pose, 1.20 * down);
  pose.trunk_bend += 0.70 * m.amplitude * down;
  pose.head_nod += 0.15 * down;
  for (LegPose& leg : pose.leg) {
    leg.flex += 0.20 * down;
    leg.knee += 0.15 * down;
  }
  for (ArmPose& arm : pose.arm) Toward(arm, {1.65, 0.05, 0.0, 0.10, 0.0}, down);
}

/// Grips an object on the floor with both hands and lifts it; ends with the object before the belly.
void PickUpObject(double at, const Manner& m, Pose& pose) {
  const double down = Pulse(at, 0.02, 0.40, 0.48, 0.90);
  Crouch(pose, 0.95 * m.amplitude * down);
  Bow(pose, 0.45 * down);
  pose.trunk_bend += 0.30 * down;
  for (ArmPose& arm : pose.arm) {
    Toward(arm, {1.25, -0.02, 0.0, 0.15, 0.0}, MinimumJerk(at, 0.02, 0.36));
    Toward(arm, kCarries, MinimumJerk(at, 0.48, 0.86));
  }
}
/// The same backwards: carries the object down with both hands and rises without it.
void PutDownObject(double at, const Manner& m, Pose& pose) { PickUpObject(1.0 - at, m, pose); }

/// The right hand carries an object to a table, lets go of it and comes back.
void Place(double at, const Manner& m, Pose& pose) {
  const double reach = Pulse(at, 0.10, 0.48, 0.60, 0.98);
  Toward(pose.arm[kRightSide], kCarries, 1.0 - MinimumJerk(at, 0.60, 0.70));
  Toward(pose.arm[kRightSide], kAtTheTable, reach);
  Bow(pose, 0.40 * m.amplitude * reach);
  pose.trunk_bend += 0.25 * reach;
  pose.trunk_twist += 0.30 * reach;
  pose.head_nod += 0.25 * reach;
}

/// Hands up before the face, to the ball, and with it to the chest.
void Catch(double at, const Manner& m, Pose& pose) {
  const double ready = MinimumJerk(at, 0.05, 0.42);
  const double caught = MinimumJerk(at, 0.46, 0.68);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kReadyToCatch, ready);
    Toward(arm, kCaught, caught);
  }
  pose.trunk_bend += m.amplitude * (0.10 * (ready - caught) + 0.12 * caught);
  pose.head_nod += 0.20 * caught;
  Crouch(pose, m.amplitude * (0.10 * ready + 0.12 * Pulse(at, 0.46, 0.66, 0.68, 0.95)));
}

/// On a chair from begin to end; looks about, a hand comes to the chin.
void StaySeated(double at, const Manner& m, Pose& pose) {
  const double moves = Pulse(at, 0.10, 0.40, 0.60, 0.90);
  SitOn(pose, 1.0);
  Toward(pose.arm[kRightSide], kAtTheMouth, 0.95 * moves);
  pose.head_rotation += 0.35 * m.amplitude * moves;
  pose.trunk_bend += 0.20 * moves;
}

void StandUp(double at, const Manner& m, Pose& pose) {
  const double seated = 1.0 - MinimumJerk(at, 0.15, 0.95);
  const double bow = Pulse(at, 0.0, 0.4, 0.45, 0.95);
  SitOn(pose, seated);
  pose.lean += 0.45 * m.amplitude * bow;
  pose.trunk_bend += 0.3 * bow;
}

void CheerUp(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.9);
  const double pump = 0.5 + 0.5 * Swing(at, m);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kRaised, held);
    arm.elbow += 0.9 * m.amplitude * held * pump;
  }
  pose.trunk_bend -= 0.08 * held;
  Crouch(pose, 0.10 * held * pump);
}

void Salute(double at, const Manner& m, Pose& pose) {
  Toward(pose.arm[kRightSide], kSalute, Held(at, m, 0.55) * std::min(1.0, m.amplitude));
  pose.trunk_bend -= 0.04 * Held(at, m, 0.55);
}

void ShakeFist(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.5);
  const double shake = Swing(at, m);
  Toward(pose.arm[kRightSide], kFist, held);
  pose.arm[kRightSide].flex += 0.30 * m.amplitude * held * shake;
  pose.arm[kRightSide].elbow += 0.25 * m.amplitude * held * shake;
  pose.lean += 0.05 * held;
}

}  // namespace

const std::vector<ActionRow>& EverydayActions() {
  static const std::vector<ActionRow> actions = {{"bend_down", BendDown, 0.0, 2.4},
                                                 {"catch", Catch, 0.0, 1.8},
                                                 {"cheer_up", CheerUp, 1.0, 1.8},
                                                 {"drink_bottle_left", DrinkBottleLeft, 1.6, 2.0},
                                                 {"drink_bottle_right", DrinkBottleRight, 1.6, 2.0},
                                                 {"drink_both_hands", DrinkBothHands, 1.8, 2.4},
                                                 {"drink_cup_left", DrinkCupLeft, 1.6, 2.0},
                                                 {"drink_cup_right", DrinkCupRight, 1.6, 2.0},
                                                 {"eat_both_hands", EatBurger, 2.3, 0.8},
                                                 {"eat_left", EatLeft, 2.4, 0.6},
                                                 {"eat_right", EatRight, 2.4, 0.6},
                                                 {"phone_call", PhoneCall, 2.6, 3.0},
                                                 {"phone_left", PhoneLeft, 2.8, 2.0},
                                                 {"pick_up", PickUp, 0.0, 2.4},
                                                 {"pick_up_object", PickUpObject, 0.0, 2.4},
                                                 {"place", Place, 0.0, 2.2},
                                                 {"put_down_object", PutDownObject, 0.0, 2.4},
                                                 {"salute", Salute, 0.0, 2.0},
                                                 {"shake_fist", ShakeFist, 0.5, 0.8},
                                                 {"stand_up", StandUp, 0.0, 1.8},
                                                 {"stay_seated", StaySeated, 0.0, 2.0},
                                                 {"steering_wheel", SteeringWheel, 2.2, 0.6},
                                                 {"throw_both_hands", ThrowBoth, 0.0, 2.4}};
  return actions;
}

}  // namespace mocurate
