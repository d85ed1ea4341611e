#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// Which evidence a clip is fitted to. kNone hands a given motion on as it is.
enum class FitMethod { kJointTracks, kPointClouds, kJointsAndClouds, kKeypoints, kKeypointsAndClouds, kNone };

/// Whether all joints share one noise scale or each has its own.
enum class NoiseScale { kPooled, kPerJoint };

/// What becomes of a clip without depth where tracks and depth are to be fitted together.
enum class WithoutDepth { kRefuse, kTracks };

/// What becomes of tracked joints that the skeleton does not have.
enum class OtherJoints { kRefuse, kLeaveOut };

/// Whose body it is: one of all clips of a person, or one of each recording, for trackers that measure people anew.
enum class BodyOf { kPerson, kRecording };

/// What solves a problem of a fit. Both minimise the same costs to the same optimum.
enum class TrackSolver { kCeres, kBanded };

/// What a step of a fit may move: the person as a whole, or every joint.
enum class FreeParts { kRoot, kPose };

/// Which evidence a step reads: the tracked positions alone, or recorded rotations too.
enum class StepEvidence { kPositions, kAll };

/// A step of a fit of joint tracks. It starts from the pose that the step before left, the first from a closed form.
struct TrackStep {
  FreeParts free = FreeParts::kPose;
  StepEvidence evidence = StepEvidence::kAll;
  double relative_tolerance = 1e-4;  ///< stop at this relative change of cost
  std::int64_t max_iterations = 100;
  bool refit_walks = false;  ///< then both walks are fitted to what each joint did, and when

  void Declare(OptionVisitor& v);
};

/// `refits` loose steps that fit the walks to the clip, the first one to positions alone, and the one that counts.
std::vector<TrackStep> StepsWithRefits(int refits, const TrackStep& last = {});

/// Fit of a skeleton to joint tracks. The noise of the tracks is estimated from them, never set here. Spreads are
/// standard deviations of what a person does: a random walk of q per square root of a second moves q * sqrt(dt) in dt.
struct JointTrackOptions {
  TrackSolver solver = TrackSolver::kCeres;
  NoiseScale noise = NoiseScale::kPooled;
  double huber_sigmas = 2.5;    ///< residuals beyond this many sigmas count linearly
  double rotation_walk = 0.55;  ///< rad per sqrt(s), each joint
  double velocity_walk = 0.33;  ///< m per sqrt(s), each joint
  /// m per sqrt(s) of ankles and toes while the steps before have them stand on the floor; none: no such prior.
  std::optional<double> contact_walk = 0.02;
  bool recorded_rotations = true;  ///< rotations that the source recorded are evidence beside the positions
  double rest_spread = 3.3;        ///< rad from the rest pose; holds what no evidence determines
  double limit_spread = 0.5;       ///< rad beyond a joint limit
  double hinge_spread = 0.25;      ///< sine of the angle by which a shin or forearm leaves the plane of its hinge
  double bone_spread = 0.02;       ///< m from the prior bone length, where bones are free
  double max_gap_s = 0.5;          ///< frames further apart than this are not smoothed together
  std::vector<TrackStep> steps = StepsWithRefits(2);  ///< none: the closed form is the fit
  std::int64_t window_frames = 600;                   ///< longer clips are fitted in windows
  std::int64_t window_overlap = 60;                   ///< frames of look-ahead that the next window fits again
  bool uncertainty = true;                            ///< covariance of joints, standard deviation of rotations

  void Declare(OptionVisitor& v);
};

/// What is mended in joint tracks before they are fitted. The evidence itself stays as it is.
struct RepairOptions {
  bool swaps = true;                ///< exchange left and right limbs where the tracker did
  double swap_margin = 16.0;        ///< difference of log likelihoods that an exchange takes
  bool collapsed = true;            ///< take for missing what stands exactly where its parent does
  bool teleports = true;            ///< take for missing what is where nobody can be
  double longest_teleport_s = 1.0;  ///< longer ones stay: another place may be true
  bool torn = true;                 ///< take for missing what no bone reaches, or what jumps away and back
  bool merged = true;               ///< take for missing limbs of both sides that are in one place
  bool held = true;                 ///< take for missing what repeats to the last digit
  std::int64_t held_frames = 3;     ///< with the frame that is repeated
  double longest_held_s = 5.0;      ///< longer ones stay

  void Declare(OptionVisitor& v);
};

/// Outliers of a fused point cloud.
struct CloudOutlierOptions {
  bool enabled = false;          ///< beside what is dropped on the images; most of the time of a fit
  std::int64_t neighbours = 20;  ///< mean distance to this many neighbours is looked at
  double spread_ratio = 2.0;     ///< points further than mean + ratio * standard deviation are dropped

  void Declare(OptionVisitor& v);
};

/// How a person is known to stand when a clip begins.
enum class StartPosture { kStanding, kSeated, kUnknown };

/// What is known of the first pose of a clip.
struct CloudStartOptions {
  std::optional<double> facing;  ///< rad about y, 0 faces +z, within 45 degrees; none: found
  StartPosture posture = StartPosture::kUnknown;

  void Declare(OptionVisitor& v);
};

/// What is done about something that is wrong with a rig.
enum class AuditAction { kOff, kTell, kCorrect };

/// Audit of cameras and calibration before views are put together. What is corrected is a finding, and stands in the
/// clip's provenance.
struct RigAuditOptions {
  AuditAction clocks = AuditAction::kCorrect;     ///< a camera whose clock is off
  AuditAction moved = AuditAction::kCorrect;      ///< a camera that stands elsewhere, or was moved during the take
  AuditAction exchanged = AuditAction::kCorrect;  ///< cameras that have each other's files
  AuditAction unit = AuditAction::kTell;          ///< calibration in another unit than declared
  double longest_s = 0.5;                         ///< clocks further off are not believed
  double sure = 0.99;                             ///< confidence from which on something is corrected

  void Declare(OptionVisitor& v);
};

/// And of the keypoints that the views list.
struct KeypointAuditOptions : RigAuditOptions {
  AuditAction order = AuditAction::kTell;     ///< keypoints in another detector's order than declared
  AuditAction sides = AuditAction::kCorrect;  ///< a view that lists left limbs as right ones
  double side_margin = 10.0;                  ///< difference of log likelihoods that takes

  void Declare(OptionVisitor& v);
};

/// Fit of a capsule body to fused depth views.
struct PointCloudOptions {
  TrackSolver solver = TrackSolver::kCeres;
  double voxel_size = 0.03;      ///< m, after fusing the views
  double max_distance = 0.1;     ///< m from the body; farther points do not pull
  std::optional<double> height;  ///< m, of the person from crown to soles; none: measured from the clouds
  CloudOutlierOptions outliers;
  CloudStartOptions start;
  RigAuditOptions audit;
  double capsule_radius_scale = 1.0;
  std::int64_t iterations = 40;  ///< of matching points to capsules, at most, per frame
  double rotation_walk = 0.55;   ///< rad per sqrt(s), each joint
  double velocity_walk = 0.33;   ///< m per sqrt(s), root
  double rest_spread = 1.0;  ///< rad from the rest pose; joints of the trunk, feet and hands have less, see RestSpreads
  double huber_sigmas = 2.5;
  bool uncertainty = true;  ///< covariance of joints, standard deviation of rotations

  void Declare(OptionVisitor& v);
};

/// Feet that stand do not slide: what is done to the fitted motion afterwards. See RemoveFootSliding.
struct ContactOptions {
  bool remove_sliding = false;
  double height = 0.05;     ///< metres above the lowest 5 % of a foot's places
  double speed = 0.6;       ///< m/s; a foot that is faster does not stand
  double min_time_s = 0.1;  ///< shorter contacts are none, shorter gaps are closed
  double blend_s = 0.15;    ///< over which a foot comes back to where it was

  void Declare(OptionVisitor& v);
};

/// Triangulation that survives wrong detections. Lengths in pixels of the original images.
struct TriangulationOptions {
  double min_confidence = 0.1;  ///< detections below are not read
  double outlier = 30.0;        ///< px; a view further off than this from the others' point is left out
  double noise = 4.0;           ///< px, standard deviation per axis of a detection of confidence 1
  std::int64_t min_views = 2;   ///< that must agree; and always most of those that see the point

  void Declare(OptionVisitor& v);
};

/// Fit of 2-D keypoints of several calibrated views: people are associated across views and followed, one is
/// triangulated, and the points are fitted as joint tracks are.
struct KeypointFitOptions {
  TriangulationOptions triangulation;
  KeypointAuditOptions audit;

  void Declare(OptionVisitor& v);
};

struct FittingOptions {
  FitMethod method = FitMethod::kJointTracks;
  std::string skeleton;  ///< name in configs/skeletons/ or a YAML file
  WithoutDepth without_depth = WithoutDepth::kRefuse;
  OtherJoints other_joints = OtherJoints::kRefuse;
  RepairOptions repair;
  JointTrackOptions joint_tracks;
  PointCloudOptions point_clouds;
  ContactOptions contacts;
  KeypointFitOptions keypoints;

  void Declare(OptionVisitor& v);
};

struct ProportionsSettings {
  std::string skeleton;
  BodyOf body_of = BodyOf::kPerson;
  bool symmetric = true;            ///< left and right limbs share their lengths
  bool own_directions = true;       ///< bones that start at one joint point where the person's do
  std::int64_t refine_clips = 0;    ///< clips on which bones are fitted together with the pose; 0: medians only
  std::int64_t refine_frames = 60;  ///< frames of each, from its middle
  JointTrackOptions joint_tracks;

  void Declare(OptionVisitor& v);
};

/// Options of the stage: what a job sets, and the method, other joints and tracking of its stage `fitting`.
struct ProportionsOptions : ProportionsSettings {
  FitMethod method = FitMethod::kJointTracks;
  OtherJoints other_joints = OtherJoints::kRefuse;
  PointCloudOptions point_clouds;  ///< tracking of the clouds the lengths are read from
  KeypointFitOptions keypoints;    ///< how the points that they are read from are found

  void Declare(OptionVisitor& v);
};

/// Largest number of one person's clips that proportions are read from.
inline constexpr int kMaxProportionClips = 30;

/// The clips that stand for a person: at most kMaxProportionClips ids, smallest SHA-256 first chosen, returned sorted.
/// Which clips exist beside a chosen one changes little, their order nothing.
std::vector<std::string> ChooseProportionClips(std::vector<std::string> clip_ids);

StageDeclaration ProportionsDeclaration();
StageDeclaration FittingDeclaration();

}  // namespace mocurate
