#include <algorithm>
#include <cmath>

#include "ingest/synthetic/actions.h"

namespace mocurate {
namespace {

// Positions of a hand, found by trial on the mean body: flex, abduct, twist, elbow, wrist of the arm.
constexpr ArmPose kBeforeTheChest{0.79, 0.46, -1.03, 1.84, 0.0};
constexpr ArmPose kExpanderClosed{1.39, 0.55, -1.57, 1.97, 0.0};
constexpr ArmPose kExpanderOpen{1.45, 1.75, -1.45, 0.45, 0.0};
constexpr ArmPose kBehindTheHead{3.0, 0.12, -0.75, 2.44, 0.0};
constexpr ArmPose kHoldsTheElbow{2.92, 0.24, -1.31, 1.71, 0.0};
constexpr ArmPose kOverTheHead{2.99, -0.01, -1.34, 0.75, 0.0};
constexpr ArmPose kOnTheHip{-0.07, 0.77, -1.36, 1.45, 0.0};
constexpr ArmPose kGuard{0.73, 0.14, -0.43, 2.24, 0.0};
constexpr ArmPose kStraight{1.49, -0.21, -0.35, 0.28, 0.0};
constexpr ArmPose kUppercutLow{-0.08, 0.31, -0.22, 1.78, 0.0};
constexpr ArmPose kUppercutHigh{1.16, -0.12, -0.33, 1.48, 0.0};
constexpr ArmPose kCurled{0.27, 0.08, 0.17, 2.40, 0.0};
constexpr ArmPose kPressBottom{0.37, 0.61, 0.93, 2.48, 0.0};
constexpr ArmPose kPressTop{2.85, 0.20, -0.58, 0.50, 0.0};
constexpr ArmPose kAtTheRope{0.0, 0.35, 0.60, 1.10, 0.0};
constexpr ArmPose kReachesUp{2.95, 0.05, -0.40, 0.15, 0.0};

double UpAndDown(double x) { return 0.5 - 0.5 * std::cos(2.0 * kPi * x); }

/// Hands circle before the chest, the toes of one foot rotate on the floor; the other foot in the second half.
void WristAnkle(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.7);
  const double swing = Swing(at, m);
  const double quarter = std::cos(2.0 * kPi * m.cycles * at + m.phase);
  for (int side : {kLeftSide, kRightSide}) {
    ArmPose& arm = pose.arm[side];
    Toward(arm, kBeforeTheChest, held);
    arm.wrist += 0.45 * m.amplitude * held * (side == kLeftSide ? swing : -swing);
    arm.twist += 0.18 * m.amplitude * held * quarter;
    arm.elbow += 0.12 * held * swing;
  }
  const int side = at < 0.5 ? kRightSide : kLeftSide;
  const double lifted = at < 0.5 ? Pulse(at, 0.03, 0.15, 0.36, 0.48) : Pulse(at, 0.52, 0.64, 0.85, 0.97);
  LegPose& leg = pose.leg[side];
  leg.flex += 0.22 * lifted;
  leg.knee += 0.75 * lifted;
  leg.point += 0.8 * lifted;
  leg.twist += 0.35 * m.amplitude * lifted * swing;
  leg.abduct += 0.10 * lifted * quarter;
}

void Pectoral(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.6);
  const double open = 0.5 + 0.5 * Swing(at, m);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kExpanderClosed, held);
    Toward(arm, kExpanderOpen, held * open * std::min(1.0, m.amplitude));
  }
  pose.trunk_bend -= 0.10 * held * open;
  for (LegPose& leg : pose.leg) leg.knee += 0.08 * held * open;
}

void ElbowBack(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.9);
  const double pull = 0.5 + 0.5 * Swing(at, m);
  Toward(pose.arm[kRightSide], kBehindTheHead, held);
  Toward(pose.arm[kLeftSide], kHoldsTheElbow, held);
  pose.arm[kRightSide].abduct -= 0.20 * m.amplitude * held * pull;
  pose.trunk_side -= 0.14 * m.amplitude * held * pull;
  pose.head_nod += 0.15 * held;
}

/// One arm over the head, the other hand on the hip; by `lean` the trunk bends away from the raised arm.
void LeanAway(Pose& pose, int raised, double held, double amplitude, double lean) {
  Toward(pose.arm[raised], kOverTheHead, held);
  Toward(pose.arm[1 - raised], kOnTheHip, held);
  const double away = raised == kRightSide ? -1.0 : 1.0;
  pose.trunk_side += away * 0.5 * amplitude * lean;
}

void BodyLean(double at, const Manner& m, Pose& pose, int raised) {
  const double held = Held(at, m, 0.8);
  const double lean = held * (0.55 + 0.45 * Swing(at, m));
  LeanAway(pose, raised, held, m.amplitude, lean);
  for (LegPose& leg : pose.leg) leg.abduct += 0.14 * held;
}
void BodyLeanRight(double at, const Manner& m, Pose& pose) { BodyLean(at, m, pose, kRightSide); }
void BodyLeanLeft(double at, const Manner& m, Pose& pose) { BodyLean(at, m, pose, kLeftSide); }

/// Down to one foot, the hand of the other side reaches for it.
void BowTo(double at, const Manner& m, Pose& pose, int foot) {
  const double held = Held(at, m, 0.9);
  const double down = held * (0.75 + 0.25 * Swing(at, m)) * std::min(1.15, m.amplitude);
  for (LegPose& leg : pose.leg) leg.abduct += 0.20 * held;
  Bow(pose, 0.75 * down);
  pose.trunk_bend += 0.65 * down;
  pose.trunk_twist += (foot == kRightSide ? -0.55 : 0.55) * down;
  pose.trunk_side += (foot == kRightSide ? 0.12 : -0.12) * down;
  Toward(pose.arm[1 - foot], {1.0, 0.05, 0.0, 0.1, 0.0}, down);
  Toward(pose.arm[foot], {-0.1, 0.35, 0.0, 0.3, 0.0}, down);
}
void BowRight(double at, const Manner& m, Pose& pose) { BowTo(at, m, pose, kRightSide); }
void BowLeft(double at, const Manner& m, Pose& pose) { BowTo(at, m, pose, kLeftSide); }

/// Shares of a step and of its lifted foot: a step out, a lunge, and the step back.
struct LungeStep {
  double out, lifted;
};
LungeStep LungeAt(double x) {
  return {Pulse(x, 0.02, 0.40, 0.56, 0.95), Pulse(x, 0.02, 0.16, 0.20, 0.38) + Pulse(x, 0.57, 0.72, 0.76, 0.95)};
}
void LiftFoot(LegPose& leg, double lifted) {
  leg.flex += 0.35 * lifted;
  leg.knee += 0.70 * lifted;
}

/// Sideways to the left; the right foot stays in place. The angles keep both soles level with the floor.
void LungeLeft(Pose& pose, const LungeStep& step, double reach) {
  LegPose &left = pose.leg[kLeftSide], &right = pose.leg[kRightSide];
  right.abduct += 0.55 * reach * step.out;
  left.abduct += 0.30 * reach * step.out;
  left.flex += 0.50 * reach * step.out;
  left.knee += 1.00 * reach * step.out;
  LiftFoot(left, step.lifted);
  pose.left_support = 0.0;
}
void LeftStretch(double at, const Manner& m, Pose& pose) {
  const LungeStep step = LungeAt(Repetition(at, m));
  LungeLeft(pose, step, m.amplitude);
  LeanAway(pose, kRightSide, Held(at, m, 0.8), m.amplitude, 1.1 * step.out);
}
void LeftLunge(double at, const Manner& m, Pose& pose) {
  const LungeStep step = LungeAt(Repetition(at, m));
  LungeLeft(pose, step, 1.35 * m.amplitude);
  pose.lean += 0.20 * step.out;
  for (LegPose& leg : pose.leg) leg.flex += 0.20 * step.out;
  for (ArmPose& arm : pose.arm) Toward(arm, kBeforeTheChest, Held(at, m, 0.6));
}

/// The right foot steps forwards, the left one stays in place on its toes; the trunk stays upright.
void ForwardLunge(double at, const Manner& m, Pose& pose) {
  const LungeStep step = LungeAt(Repetition(at, m));
  LegPose &left = pose.leg[kLeftSide], &right = pose.leg[kRightSide];
  right.flex += 1.00 * m.amplitude * step.out;
  right.knee += 1.05 * m.amplitude * step.out;
  left.flex -= 0.35 * m.amplitude * step.out;
  left.knee += 0.65 * m.amplitude * step.out;
  LiftFoot(right, step.lifted);
  pose.left_support = 1.0;
  for (ArmPose& arm : pose.arm) Toward(arm, kOnTheHip, Held(at, m, 0.6));
}

/// Arms up and the back arched, then the spine rolls down until the hands hang at the toes.
void SpinalStretch(double at, const Manner& m, Pose& pose) {
  const double up = Pulse(at, 0.0, 0.30, 0.30, 0.56);
  const double down = Pulse(at, 0.30, 0.66, 0.66, 1.0);
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kReachesUp, up);
    Toward(arm, {1.5, 0.05, 0.0, 0.1, 0.0}, down);
  }
  Bow(pose, m.amplitude * (0.75 * down - 0.06 * up));
  pose.trunk_bend += m.amplitude * (1.0 * down - 0.25 * up);
  pose.head_nod += 0.40 * down - 0.30 * up;
}

/// Legs of running; `travel` is the reach of a step forwards and back.
void RunLegs(double at, const Manner& m, double travel, double heel, double lift, Pose& pose) {
  const double going = Held(at, m, 0.5);
  for (int side : {kLeftSide, kRightSide}) {
    const double phase = 2.0 * kPi * m.cycles * at + (side == kLeftSide ? 0.0 : kPi);
    const double swings = std::max(0.0, std::cos(phase));
    pose.leg[side].flex += going * (0.12 + travel * m.amplitude * std::sin(phase) + lift * swings * swings);
    pose.leg[side].knee += going * (0.25 + heel * swings * swings);
    pose.leg[side].point += going * 0.35 * std::max(0.0, -std::sin(phase));
    Toward(pose.arm[side].elbow, 1.5, going);
    pose.arm[side].flex -= going * 0.55 * m.amplitude * std::sin(phase);
  }
  const double balance = std::cos(2.0 * kPi * m.cycles * at);
  pose.height += going * 0.05 * m.amplitude * std::max(0.0, 1.0 - 4.0 * balance * balance);
  pose.left_support = LeftSupport(balance);
  pose.trunk_twist += going * 0.16 * std::sin(2.0 * kPi * m.cycles * at);
}

void Run(double at, const Manner& m, Pose& pose) {
  RunLegs(at, m, 0.48, 1.25, 0.30, pose);
  pose.lean += 0.12 * Held(at, m, 0.5);
}
void RunOnTheSpot(double at, const Manner& m, Pose& pose) { RunLegs(at, m, 0.0, 1.5, 1.0, pose); }
void ButtKicks(double at, const Manner& m, Pose& pose) { RunLegs(at, m, 0.0, 2.1, 0.05, pose); }

void Jumps(double at, const Manner& m, double arms, Pose& pose) {
  const double x = Repetition(at, m);
  const double wanted = 0.16 * m.amplitude;
  const double period = m.active_s / Repetitions(m);
  const double flight = std::min(0.45, std::sqrt(8.0 * wanted / 9.81) / std::max(0.3, period));
  const double height = std::min(wanted, 9.81 * flight * period * flight * period / 8.0);  // what the time allows
  const double takeoff = 0.42;
  const double landing = takeoff + flight;
  Crouch(pose, 0.5 * m.amplitude * Pulse(x, 0.0, 0.25, 0.27, takeoff));
  Crouch(pose, 0.3 * m.amplitude * Pulse(x, landing - 0.02, landing + 0.06, landing + 0.06, 1.0));
  const double air = (x - takeoff) / flight;
  if (air > 0.0 && air < 1.0) pose.height += 4.0 * height * air * (1.0 - air);
  for (LegPose& leg : pose.leg) leg.point += 0.5 * Pulse(x, takeoff - 0.06, takeoff + 0.04, landing - 0.05, landing);
  const double back = Pulse(x, 0.0, 0.2, 0.2, 0.4);
  const double up = Pulse(x, 0.16, 0.56, 0.60, 1.0);
  for (ArmPose& arm : pose.arm) {
    arm.flex += -0.45 * back + arms * up;
    arm.abduct += 0.15 * up;
  }
}
void JumpHandsUp(double at, const Manner& m, Pose& pose) { Jumps(at, m, 2.5, pose); }
void JumpVertical(double at, const Manner& m, Pose& pose) { Jumps(at, m, 0.7, pose); }

/// Four low hops a cycle, elbows at the sides, the wrists turn the rope once a hop. In the air the person steers back
/// to the starting point.
void RopeSkipping(double at, const Manner& m, Pose& pose) {
  Manner hops = m;
  hops.cycles = 4.0 * m.cycles;
  const double held = Held(at, m, 0.4);
  const double x = Repetition(at, hops);
  const double from_top = std::abs(x - 0.5);  // of a hop; in the air below 0.25
  const double flight_s = 0.5 * m.active_s / Repetitions(hops);
  const double height = std::min(0.07 * m.amplitude, kGravity * flight_s * flight_s / 8.0);
  pose.height += held * height * std::max(0.0, 1.0 - 16.0 * from_top * from_top);
  if (from_top < 0.25) pose.homing = 0.15 * held;
  Crouch(pose, 0.15 * held * MinimumJerk(from_top, 0.25, 0.5));
  for (LegPose& leg : pose.leg) leg.point += 0.4 * held * (1.0 - MinimumJerk(from_top, 0.22, 0.42));
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kAtTheRope, held);
    arm.twist += 0.25 * held * std::sin(2.0 * kPi * x);
    arm.elbow += 0.20 * held * std::cos(2.0 * kPi * x);
    arm.wrist += 0.45 * held * std::sin(2.0 * kPi * x);
  }
}

void Curl(double at, const Manner& m, Pose& pose, bool left, bool right) {
  const double up = std::min(1.0, m.amplitude) * UpAndDown(Repetition(at, m));
  if (left) Toward(pose.arm[kLeftSide], kCurled, up);
  if (right) Toward(pose.arm[kRightSide], kCurled, up);
  pose.trunk_bend -= 0.04 * up;
  if (left != right) pose.trunk_side += (right ? -0.05 : 0.05) * up;
}
void CurlRight(double at, const Manner& m, Pose& pose) { Curl(at, m, pose, false, true); }
void CurlLeft(double at, const Manner& m, Pose& pose) { Curl(at, m, pose, true, false); }
void CurlBoth(double at, const Manner& m, Pose& pose) { Curl(at, m, pose, true, true); }

void PressOverhead(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.7);
  const double up = UpAndDown(Repetition(at, m));
  for (ArmPose& arm : pose.arm) {
    Toward(arm, kPressBottom, held);
    Toward(arm, kPressTop, held * up);
  }
  pose.trunk_bend -= 0.06 * held * up;
}

void CurlBendLegs(double at, const Manner& m, Pose& pose) {
  const double x = UpAndDown(Repetition(at, m));
  const double held = Held(at, m, 0.5);
  Crouch(pose, 0.6 * m.amplitude * held * x);
  for (ArmPose& arm : pose.arm) Toward(arm, kCurled, held * (1.0 - x));
}

/// Fists at the chin; the strike of `side` at fraction `x` of its time.
void Guard(Pose& pose, double held) {
  for (ArmPose& arm : pose.arm) Toward(arm, kGuard, held);
  pose.leg[kLeftSide].flex += 0.22 * held;
  pose.leg[kLeftSide].knee += 0.25 * held;
  pose.leg[kRightSide].flex -= 0.18 * held;
  pose.leg[kRightSide].knee += 0.18 * held;
}
void Strike(Pose& pose, int side, double x, double amplitude) {
  const double out = Pulse(x, 0.0, 0.48, 0.5, 1.0);
  Toward(pose.arm[side], kStraight, out);
  pose.trunk_twist += (side == kRightSide ? 0.45 : -0.40) * amplitude * out;
  pose.lean += 0.05 * out;
}

void BoxAlternating(double at, const Manner& m, Pose& pose, int first) {
  const double held = Held(at, m, 0.35);
  Guard(pose, held);
  const double x = 2.0 * Repetition(at, m);
  Strike(pose, x < 1.0 ? first : 1 - first, x < 1.0 ? x : x - 1.0, held * m.amplitude);
}
void BoxLeftRight(double at, const Manner& m, Pose& pose) { BoxAlternating(at, m, pose, kLeftSide); }
void BoxRightLeft(double at, const Manner& m, Pose& pose) { BoxAlternating(at, m, pose, kRightSide); }

/// Punches in turn; the knee of the other side comes up with each.
void PunchAndKneeLift(double at, const Manner& m, Pose& pose) {
  const double held = Held(at, m, 0.35);
  for (ArmPose& arm : pose.arm) Toward(arm, kGuard, held);
  const double x = 2.0 * Repetition(at, m);
  const int fist = x < 1.0 ? kLeftSide : kRightSide;
  const double part = x < 1.0 ? x : x - 1.0;
  Strike(pose, fist, part, held * m.amplitude);
  const double up = m.amplitude * Pulse(part, 0.0, 0.45, 0.52, 1.0);
  pose.leg[1 - fist].flex += 1.45 * up;
  pose.leg[1 - fist].knee += 1.60 * up;
  pose.leg[1 - fist].point += 0.30 * up;
  pose.left_support = fist == kLeftSide ? 1.0 : 0.0;
}

void Uppercut(double at, const Manner& m, Pose& pose, int side) {
  const double held = Held(at, m, 0.3);
  Guard(pose, held);
  const double x = Repetition(at, m);
  const double turn = side == kRightSide ? 1.0 : -1.0;
  const double low = held * Pulse(x, 0.0, 0.3, 0.35, 0.5);
  const double high = held * Pulse(x, 0.33, 0.55, 0.6, 0.95);
  Toward(pose.arm[side], kUppercutLow, low);
  Toward(pose.arm[side], kUppercutHigh, high);
  pose.trunk_twist += turn * m.amplitude * (-0.3 * low + 0.5 * high);
  Crouch(pose, 0.15 * low);
}
void UppercutRight(double at, const Manner& m, Pose& pose) { Uppercut(at, m, pose, kRightSide); }
void UppercutLeft(double at, const Manner& m, Pose& pose) { Uppercut(at, m, pose, kLeftSide); }

void SideKick(double at, const Manner& m, Pose& pose) {
  const double chamber = Pulse(at, 0.05, 0.32, 0.5, 0.9);
  const double out = Pulse(at, 0.3, 0.48, 0.52, 0.72);
  LegPose& leg = pose.leg[kRightSide];
  leg.flex += 0.9 * chamber - 0.45 * out;
  leg.knee += 1.4 * chamber - 1.2 * out;
  leg.abduct += (0.25 * chamber + 0.85 * out) * m.amplitude;
  pose.trunk_side -= 0.45 * m.amplitude * out;
  pose.left_support = 1.0 - 0.5 * (1.0 - Pulse(at, 0.0, 0.12, 0.88, 1.0));
  for (ArmPose& arm : pose.arm) Toward(arm, kGuard, 0.8 * chamber);
}

}  // namespace

const std::vector<ActionRow>& ExerciseActions() {
  static const std::vector<ActionRow> actions = {{"boxing_left_right", BoxLeftRight, 0.85, 0.4},
                                                 {"boxing_left_upwards", UppercutLeft, 1.0, 0.4},
                                                 {"boxing_right_left", BoxRightLeft, 0.85, 0.4},
                                                 {"boxing_right_upwards", UppercutRight, 1.0, 0.4},
                                                 {"butt_kicks", ButtKicks, 0.62, 0.5},
                                                 {"forward_lunge", ForwardLunge, 2.0, 0.2},
                                                 {"jump_hands_up", JumpHandsUp, 1.35, 0.0},
                                                 {"jump_vertical", JumpVertical, 1.25, 0.0},
                                                 {"left_lunge", LeftLunge, 2.0, 0.2},
                                                 {"left_stretch", LeftStretch, 2.2, 0.4},
                                                 {"lift_dumbbell_both", CurlBoth, 1.9, 0.0},
                                                 {"lift_dumbbell_both_bend_legs", CurlBendLegs, 2.4, 0.0},
                                                 {"lift_dumbbell_left", CurlLeft, 1.8, 0.0},
                                                 {"lift_dumbbell_overhead", PressOverhead, 2.1, 0.0},
                                                 {"lift_dumbbell_right", CurlRight, 1.8, 0.0},
                                                 {"punch_and_knee_lift", PunchAndKneeLift, 1.6, 0.0},
                                                 {"rope_skipping", RopeSkipping, 1.9, 0.0},
                                                 {"run", Run, 0.72, 0.4},
                                                 {"run_on_the_spot", RunOnTheSpot, 0.68, 0.4},
                                                 {"side_kick", SideKick, 0.0, 2.1},
                                                 {"spinal_stretch", SpinalStretch, 0.0, 3.8},
                                                 {"warm_up_body_lean_left_arm", BodyLeanLeft, 1.5, 1.2},
                                                 {"warm_up_body_lean_right_arm", BodyLeanRight, 1.5, 1.2},
                                                 {"warm_up_bow_left", BowLeft, 1.3, 1.4},
                                                 {"warm_up_bow_right", BowRight, 1.3, 1.4},
                                                 {"warm_up_elbow_back", ElbowBack, 1.7, 1.5},
                                                 {"warm_up_pectoral", Pectoral, 1.1, 0.8},
                                                 {"warm_up_wrist_ankle", WristAnkle, 0.8, 1.2}};
  return actions;
}

}  // namespace mocurate
