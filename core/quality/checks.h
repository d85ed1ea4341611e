#pragma once

#include <array>

#include "core/quality/tracked_points.h"

namespace mocurate {

struct RepeatLimits {
  int frozen_frames = 2;  ///< consecutive frames without any motion
  int held_frames = 3;    ///< consecutive frames in which one joint repeats its value while others move
};

/// Positions that repeat to the last digit, which sensor noise excludes: a frame written twice, a stream that hung, or
/// joints filled with their last value.
///   "frozen_frames": every observed joint repeats; the span is the repeating frames, value their count. Two frames
///                    have severity info.
///   "repeated_frames": nearly all frames of the clip are repeated two to four times; value: the mean number of copies.
///                    Nothing else is then reported.
///   "repeated_value": one joint repeats and others do not; value the count of frames.
/// A hold with soft ends (steps below 1 mm, or that grow to more than twice) is intended: it occurs in authored and
/// simulated motion, and sensor noise prevents it. A clip in which at least half of the joints' holds are soft is
/// authored: none of its holds is reported, as its planted feet stop within a frame too. In a recorded clip all are.
/// Samples rounded to pixels or millimetres repeat by chance. There a hold is reported if it is longer than chance
/// explains, at the grid's step and the joint's speed around it, and does not begin and end with single grid steps. A
/// joint that never moves is ignored when other joints are checked for freezing. It is itself reported where most
/// joints and its parent move, but not if it is a root or fixed to a fixed joint. A clip without motion is one frozen
/// span.
std::vector<Finding> FindRepeats(const TrackedPoints& points, const RepeatLimits& limits = {});

/// Exact zeros marked as observed.
///   "zero_frames": runs of frames in which every joint is at 0 0 0; value the count of frames.
///   "zero_joint": one joint is at 0 0 0 in these frames while others are not; value the count of frames. The root
///                 may be there in all frames, or in the first: it is the clip's origin.
///   "collapsed_frames": all joints (three or more) lie within 2 cm, but elsewhere they make a body, or never do.
std::vector<Finding> FindBlanks(const TrackedPoints& points);

struct PositionJumpLimits {
  double speed = 12.0;   ///< m/s: largest speed of a person's trunk (the fastest sprint peaks at 12.4 m/s)
  double slack = 0.3;    ///< metres that a tracker may be off on top of it
  double start = 50.0;   ///< m/s2: largest acceleration of a whole body
  double sudden = 0.15;  ///< metres that a tracker may be off on top of that
  int lost_frames = 0;   ///< undeclared, between two frames: the person continues at their speed in these
  double reach = 2.5;    ///< metres from the middle of the body: farther no joint of a person can be
};

/// Implausible changes of position.
///   "position_jump": frames of the body that no possible path joins to the rest of the clip. A path moves at most at
///   `speed`. Where three quarters of the points move along, its velocity differs from that of the 8 frames on either
///   side by at most `start`. The rest is the longest chain of frames on one path; value: metres from that path. With
///   `lost_frames` a step may also be that many times the median step: a runner continues through a gap. Between frames
///   with different observed joints the common ones count.
///   "unrecovered_jump": the step from or to these frames at an end of the clip, where only `speed` is required. The
///   body does not return, and the right side of the step is ambiguous; value: metres.
///   "joint_far": one joint (for example the root), farther than `reach` from the middle of the body; value: metres.
std::vector<Finding> FindPositionJumps(const TrackedPoints& points, const PositionJumpLimits& limits = {});

struct SwapLimits {
  double ratio = 0.35;  ///< of squared steps with the sides exchanged to those without, below which they are exchanged
  double step = 0.1;    ///< metres, root mean square of the limbs' steps in the frame; smaller ones are ignored
  double gap_s = 0.25;  ///< longest time without the limbs over which steps are taken
};

/// Pairs (left, right) of one kind of limb, by the names of the points: "left_knee" and "right_knee", "LeftKnee",
/// "knee_l", "Foot_L" ...
struct LimbPairs {
  std::vector<std::array<int, 2>> arms;  ///< shoulder, elbow, wrist, hand ...
  std::vector<std::array<int, 2>> legs;  ///< hip, knee, ankle, foot ...
  std::vector<std::array<int, 2>> face;  ///< eye, ear
};
LimbPairs FindLimbPairs(const std::vector<std::string>& names);

/// Left-right swaps: arms or legs that move within one frame to the positions of the other side. A change without a
/// single clear step, because limbs are missing or outliers there, is found where the limbs are within `gap_s` of
/// another change as before it (or were as after it). Between two changes the sides are exchanged. The state that lasts
/// longer in the clip is taken as right; a clip that is wrong throughout is found by handedness instead. A step in
/// which the whole body jumps is ignored: frames are missing there, and half a stride later each foot is where the
/// other was. "swapped_sides": the span in the rarer state; value: the smallest ratio of squared steps at its ends.
/// Arms and legs of one span are one finding; where one pair changes sides, a ratio of 0.6 is enough for the other.
std::vector<Finding> FindSwaps(const TrackedPoints& points, const SwapLimits& limits = {});

struct RigidityLimits {
  double spread = 0.35;      ///< of a bone's length: standard deviation over length, median over the bones
  double proportion = 0.33;  ///< mean distance of the bones' log lengths from those at rest, after the best scale
};

/// Numbers of the right shape that are not joint positions: rotations (Lie parameters in a file named joints),
/// features, joints in another order. Bones keep their length, also badly tracked ones, and their proportions are a
/// person's (trackers are off by 0.2 at most, Lie parameters by 0.4 and more, although they too may hardly change).
/// "not_joint_positions", severity error; value: the one that is over its limit, proportion (as a factor) first. Needs
/// `parents` with three bones, `rest_lengths` for the proportions, and 8 frames for the spread; else nothing is
/// reported.
std::vector<Finding> FindNonRigidBody(const TrackedPoints& points, const RigidityLimits& limits = {});

struct CheckLimits {
  RepeatLimits repeats;
  PositionJumpLimits position_jumps;
  SwapLimits swaps;
  RigidityLimits rigidity;
  bool metres = true;      ///< false: the unit is suspect, and checks in metres (all but zeros, repeats
                           ///< and proportions) are skipped
  int most_per_code = 20;  ///< findings of one code; one more finding gives the number of the rest
};

/// Defects of one person's points: FindBlanks, FindRepeats, FindPositionJumps, FindSwaps, FindNonRigidBody and
/// FindWrongRate, in order of code, frame and joint. Metres, y up. Blank samples are missing for the other checks; a
/// clip that is not a body gets no further checks. `rate_hz` 0: unknown, and not checked.
std::vector<Finding> CheckPoints(const TrackedPoints& points, double rate_hz, const CheckLimits& limits = {});

/// Share of the frames that findings of `code` cover.
double CoveredShare(const std::vector<Finding>& findings, const std::string& code, int frames);

}  // namespace mocurate
