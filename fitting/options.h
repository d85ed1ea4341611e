#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/motion/gaps.h"
#include "fitting/rules.h"

namespace mocurate {

/// Which evidence a clip is fitted to. kNone passes a given motion through.
enum class FitMethod { kJointTracks, kPointClouds, kJointsAndClouds, kKeypoints, kKeypointsAndClouds, kNone };
const char* Name(FitMethod method);

/// What is done with a clip without depth where tracks and depth are to be fitted together.
enum class WithoutDepth { kRefuse, kTracks };

/// What is done with tracked joints that the skeleton does not have.
enum class OtherJoints { kRefuse, kLeaveOut };

/// One body for all clips of a person, or one per recording, for trackers that measure people anew.
enum class BodyOf { kPerson, kRecording };

/// Solver of a fit. Both minimise the same costs and reach the same optimum.
enum class PoseSolver { kCeres, kBanded };

/// Prior values of a plan: standard deviations of what people do without evidence.
struct PriorValues {
  double rest;            ///< rad, of a joint's angle from the rest pose (RestPoseSigmas scales it); without evidence
  double limit;           ///< rad, beyond a joint limit
  double hinge;           ///< sine of the angle by which a shin or forearm leaves the plane of its hinge; 0: no hinges,
                          ///< as always with depth, which shows how a limb lies
  double rotation_noise;  ///< rad per sqrt(s), process noise of each joint's rotation
  double position_noise;  ///< m per sqrt(s), process noise of positions
  bool all_joints;        ///< position noise and limits of all joints; else position noise of the root, limits of limbs

  /// Joint tracks are noisy, and their limits are soft; points on a surface are many, and a trunk must not absorb the
  /// error of a capsule body.
  static PriorValues OfTracks() { return {1.0, 0.5, 0.25, 0.55, 0.33, true}; }
  static PriorValues OfClouds() { return {1.0, 0.1, 0.0, 0.55, 0.33, false}; }
};

/// Free parameters of a step: the root alone, or the root and every joint.
enum class FreeParts { kRoot, kPose };

/// Evidence of a step: tracked positions alone, or positions and recorded rotations.
enum class StepEvidence { kPositions, kAll };

/// A step of a fit of joint tracks. It starts from the pose of the step before, the first from a closed form.
struct TrackStep {
  FreeParts free = FreeParts::kPose;
  StepEvidence evidence = StepEvidence::kAll;
  double relative_tolerance = 1e-4;  ///< stop at this relative change of cost
  std::int64_t max_iterations = 100;
  bool refit_process_noise = false;  ///< refit both process noises afterwards, per joint and time

  void Declare(OptionVisitor& v);
};

/// `refits` loose steps that refit the process noises, the first one to positions alone; then the final step.
std::vector<TrackStep> StepsWithRefits(int refits, const TrackStep& last = {});

/// Fit of a skeleton to joint tracks. The noise of the tracks is estimated from them, not set here. Process noise of q
/// per square root second: a random walk with standard deviation q * sqrt(dt) after dt.
struct JointTrackOptions {
  PoseSolver solver = PoseSolver::kCeres;  ///< not an option of the group: FittingOptions::UseSolver
  PriorValues priors = PriorValues::OfTracks();
  double huber_share = 0.1;  ///< of clean samples, whose residuals count linearly. Source: bench_studio_fits 201
  /// m per sqrt(s) of ankles and toes that the previous step has in contact with the floor; none: no contact prior.
  std::optional<double> contact_process_noise = 0.02;
  bool recorded_rotations = true;  ///< rotations that the source recorded are evidence beside the positions
  double max_gap_s = kMaxGap_s;    ///< of the clip: longest gap whose frames count as interpolated
  Rules rules;                     ///< not an option of the group: FittingOptions::UseRules
  std::vector<TrackStep> steps = StepsWithRefits(2);  ///< none: the closed form is the fit
  std::int64_t window_frames = 600;                   ///< longer clips are fitted in windows
  std::int64_t window_overlap = 60;                   ///< frames at a window's end that the next window fits again
  bool uncertainty = true;                            ///< covariance of joints, standard deviation of rotations
  bool poses = false;  ///< FitResult::poses too, 45 KB a frame; set by fits that add depth, no option of the user

  void Declare(OptionVisitor& v);
};

/// Corrections of joint tracks before they are fitted. The evidence itself is not changed.
struct RepairOptions {
  bool swaps = true;                 ///< exchange left and right limbs where the tracker swapped them
  double swap_margin = 16.0;         ///< difference of log likelihoods that an exchange needs
  bool collapsed = true;             ///< mark a joint at exactly its parent's position as missing
  bool position_jumps = true;        ///< mark a person or joint missing after an impossible jump
  double longest_jump_s = 1.0;       ///< longer ones stay: the new position may be true
  bool bone_violations = true;       ///< mark joints missing that violate bone lengths or jump away and back
  bool repeated_values = true;       ///< mark joints missing that repeat a value to the last digit
  std::int64_t repeated_frames = 3;  ///< including the first of them
  double longest_repeat_s = 5.0;     ///< longer ones stay
  Rules rules;                       ///< not an option of the group: FittingOptions::UseRules

  void Declare(OptionVisitor& v);
};

/// Posture of a person when a clip begins.
enum class StartPosture { kStanding, kSeated, kUnknown };

/// Prior of the first pose of a clip.
struct CloudStartOptions {
  std::optional<double> facing;  ///< rad about y, 0 faces +z, within 45 degrees; none: estimated
  StartPosture posture = StartPosture::kUnknown;

  void Declare(OptionVisitor& v);
};

/// Action on a fault of a rig.
enum class AuditAction { kOff, kReport, kCorrect };

/// Audit of cameras and calibration before views are combined. A correction is reported as a finding and recorded in
/// the clip's provenance.
struct RigAuditOptions {
  AuditAction clocks = AuditAction::kCorrect;  ///< clock offset of a camera
  AuditAction moved = AuditAction::kCorrect;   ///< a camera with another pose than calibrated, or moved during the take
  AuditAction exchanged = AuditAction::kCorrect;  ///< cameras whose files are exchanged
  AuditAction unit = AuditAction::kReport;        ///< calibration in another unit than declared
  double longest_s = 0.5;                         ///< larger clock offsets are not considered
  double sure = 0.99;                             ///< least confidence of a fault (RigFault::confidence)
  Rules rules;                                    ///< not an option of the group: FittingOptions::UseRules

  void Declare(OptionVisitor& v);
};

/// The same for the keypoints of the views.
struct KeypointAuditOptions : RigAuditOptions {
  AuditAction order = AuditAction::kReport;   ///< keypoints in another detector's order than declared
  AuditAction sides = AuditAction::kCorrect;  ///< a view that labels left limbs as right ones
  double side_margin = 10.0;                  ///< difference of log likelihoods that an exchange of sides needs

  void Declare(OptionVisitor& v);
};

/// Fit of a capsule body to fused depth views.
struct PointCloudOptions {
  PoseSolver solver = PoseSolver::kCeres;  ///< not an option of the group: FittingOptions::UseSolver
  PriorValues priors = PriorValues::OfClouds();
  double voxel_size = 0.03;      ///< m, after fusing the views
  double max_distance = 0.1;     ///< m from the body; farther points are ignored
  std::optional<double> height;  ///< m, of the standing person from crown to soles; none: measured from the clouds
  double shortest = 0.7;         ///< m; a measured person outside is measured again from other sizes, or refused
  double tallest = 2.2;          ///< m
  CloudStartOptions start;
  RigAuditOptions audit;
  std::int64_t iterations = 40;  ///< of matching points to capsules, at most, per frame
  double huber_share = 0.1;
  bool uncertainty = true;  ///< covariance of joints, standard deviation of rotations
  Rules rules;              ///< not an option of the group: FittingOptions::UseRules

  void Declare(OptionVisitor& v);
};

/// Removal of foot sliding from the fitted motion. See RemoveFootSliding.
struct ContactOptions {
  bool remove_sliding = false;
  double height = 0.05;     ///< metres above the lowest 5 % of a foot's places
  double speed = 0.6;       ///< m/s; a faster foot is not in contact
  double min_time_s = 0.1;  ///< shorter contacts are dropped, shorter gaps are closed
  double blend_s = 0.15;    ///< time over which the correction fades out

  void Declare(OptionVisitor& v);
};

/// Robust triangulation. Lengths in pixels of the original images.
struct TriangulationOptions {
  double min_confidence = 0.1;  ///< detections below this confidence are not read
  double outlier = 30.0;        ///< px; a view further from the other views' point is excluded
  double noise = 4.0;           ///< px, standard deviation per axis of a detection of confidence 1
  std::int64_t min_views = 2;   ///< that must agree; a majority of the views that detect the point is always needed

  void Declare(OptionVisitor& v);
};

/// Fit of 2-D keypoints of several calibrated views: people are associated across views and time, the keypoints of one
/// are triangulated and fitted as joint tracks.
struct KeypointFitOptions {
  TriangulationOptions triangulation;
  KeypointAuditOptions audit;
  std::filesystem::path rig;  ///< RigFile whose corrections are used; empty: those that the audit of the take finds

  void Declare(OptionVisitor& v);
};

struct FittingOptions {
  FitMethod method = FitMethod::kJointTracks;
  std::string skeleton;  ///< name in configs/skeletons/ or a YAML file
  WithoutDepth without_depth = WithoutDepth::kRefuse;
  OtherJoints other_joints = OtherJoints::kRefuse;
  PoseSolver solver = PoseSolver::kCeres;
  double check = 0.0;  ///< share of the clips that are solved by the other solver too
  RepairOptions repair;
  JointTrackOptions joint_tracks;
  PointCloudOptions point_clouds;
  ContactOptions contacts;
  KeypointFitOptions keypoints;
  Rules rules;  ///< option `without`

  /// Sets the rules, or the solver, of this and of all groups, as reading the option does.
  void UseRules(const Rules& used);
  void UseSolver(PoseSolver used) { solver = joint_tracks.solver = point_clouds.solver = used; }
  void Declare(OptionVisitor& v);
};

/// Options of the stage `rig`.
struct RigStageOptions {
  std::string config;  ///< name of the configuration, for the reader of the file
  std::string skeleton;
  KeypointFitOptions keypoints;

  void Declare(OptionVisitor& v);
};

struct ProportionsSettings {
  std::string skeleton;
  BodyOf body_of = BodyOf::kPerson;
  bool symmetric = true;       ///< left and right limbs have equal lengths
  bool own_directions = true;  ///< measure the directions of bones that start at one joint
  JointTrackOptions joint_tracks;

  void Declare(OptionVisitor& v);
};

/// Options of the stage: those of the job's group, and method, other joints and tracking of the stage `fitting`.
struct ProportionsOptions : ProportionsSettings {
  FitMethod method = FitMethod::kJointTracks;
  OtherJoints other_joints = OtherJoints::kRefuse;
  PointCloudOptions point_clouds;  ///< tracking of the clouds that lengths are measured on
  KeypointFitOptions keypoints;    ///< triangulation of the keypoints that lengths are measured on
  Rules rules;                     ///< option `without`

  void Declare(OptionVisitor& v);
};

/// Clips of one person that proportions are read from, at most (numerical).
inline constexpr int kMaxProportionClips = 30;

/// The clips that represent a person: at most kMaxProportionClips ids, chosen by smallest SHA-256, returned sorted.
/// Adding a clip changes the choice little; the order of clips does not change it.
std::vector<std::string> ChooseProportionClips(std::vector<std::string> clip_ids);

}  // namespace mocurate
