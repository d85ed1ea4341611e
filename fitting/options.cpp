#include "fitting/options.h"

#include <algorithm>

#include "core/base/sha256.h"

namespace mocurate {
namespace {

void DeclareMethod(OptionVisitor& v, FitMethod& method) {
  v.Choice("method", method,
           {{"joint_tracks", FitMethod::kJointTracks},
            {"point_clouds", FitMethod::kPointClouds},
            {"joints_and_clouds", FitMethod::kJointsAndClouds},
            {"keypoints", FitMethod::kKeypoints},
            {"keypoints_and_clouds", FitMethod::kKeypointsAndClouds},
            {"none", FitMethod::kNone}},
           "evidence the skeleton is fitted to; none hands a given motion on");
}

void DeclareOtherJoints(OptionVisitor& v, OtherJoints& other) {
  v.Choice("other_joints", other, {{"refuse", OtherJoints::kRefuse}, {"leave_out", OtherJoints::kLeaveOut}},
           "what becomes of tracked joints that the skeleton does not have");
}

void DeclareAction(OptionVisitor& v, const char* name, AuditAction& action, const char* help) {
  v.Choice(name, action, {{"off", AuditAction::kOff}, {"tell", AuditAction::kTell}, {"correct", AuditAction::kCorrect}},
           help);
}

}  // namespace

void TrackStep::Declare(OptionVisitor& v) {
  v.Choice("free", free, {{"root", FreeParts::kRoot}, {"pose", FreeParts::kPose}},
           "what may move: the person as a whole, or every joint");
  v.Choice("evidence", evidence, {{"positions", StepEvidence::kPositions}, {"all", StepEvidence::kAll}},
           "tracked positions alone, or recorded rotations too");
  v.Number("relative_tolerance", relative_tolerance, Unit::kNone, {1e-12, 1e-1},
           "the step ends at this relative change of cost");
  v.Integer("max_iterations", max_iterations, {1, 1000}, "of the solver, per window");
  v.Bool("refit_walks", refit_walks,
         "afterwards both walks are fitted to what each joint of the clip does, and when; the next step has them");
}

std::vector<TrackStep> StepsWithRefits(int refits, const TrackStep& last) {
  std::vector<TrackStep> steps;
  for (int i = 0; i < refits; ++i) {
    TrackStep step = last;
    step.evidence = i == 0 ? StepEvidence::kPositions : last.evidence;
    step.relative_tolerance = std::max(last.relative_tolerance, 1e-2);
    step.refit_walks = true;
    steps.push_back(step);
  }
  steps.push_back(last);
  return steps;
}

void JointTrackOptions::Declare(OptionVisitor& v) {
  v.Choice("solver", solver, {{"ceres", TrackSolver::kCeres}, {"banded", TrackSolver::kBanded}},
           "ceres, or our block-tridiagonal solver of the same costs, several times as fast");
  v.Choice("noise", noise, {{"pooled", NoiseScale::kPooled}, {"per_joint", NoiseScale::kPerJoint}},
           "one noise scale for all joints, or one each; both are estimated from the tracks");
  v.Number("huber_sigmas", huber_sigmas, Unit::kNone, {0.5, 100.0}, "residuals beyond this many sigmas count linearly");
  v.Number("rotation_walk", rotation_walk, Unit::kNone, {1e-3, 1e3}, "joint rotation, radians per square root second");
  v.Number("velocity_walk", velocity_walk, Unit::kNone, {1e-3, 1e3}, "joint position, metres per square root second");
  v.OptionalNumber("contact_walk", contact_walk, Unit::kNone, {1e-4, 1e3},
                   "ankles and toes that stand, metres per square root second; none: feet that stand are not held");
  v.Bool("recorded_rotations", recorded_rotations,
         "rotations that the source recorded, or a given motion has, are evidence beside the positions");
  v.Number("rest_spread", rest_spread, Unit::kRadian, {1e-2, 1e3}, "distance of joints from the rest pose");
  v.Number("limit_spread", limit_spread, Unit::kRadian, {1e-3, 1e2}, "distance beyond a joint limit");
  v.Number("hinge_spread", hinge_spread, Unit::kNone, {1e-3, 1e2},
           "sine of the angle by which a shin or forearm leaves the plane in which knee or elbow swings it");
  v.Number("bone_spread", bone_spread, Unit::kMetre, {1e-4, 1.0}, "distance from the prior length of a free bone");
  v.Number("max_gap", max_gap_s, Unit::kSecond, {1e-3, 1e4}, "frames further apart are not smoothed together");
  v.List("steps", steps, "what is solved one after the other, from a closed-form pose on; none: that pose is the fit");
  v.Integer("window_frames", window_frames, {10, 100000}, "longer clips are fitted in windows of this length");
  v.Integer("window_overlap", window_overlap, {1, 10000}, "frames of look-ahead that the next window fits again");
  v.Bool("uncertainty", uncertainty,
         "covariance of joint positions, standard deviation of rotations, by selected inversion");
}

void RepairOptions::Declare(OptionVisitor& v) {
  v.Bool("swaps", swaps, "exchange left and right limbs back where the tracker exchanged them");
  v.Number("swap_margin", swap_margin, Unit::kNone, {0.0, 1e4},
           "by how much likelier an exchange must be, as a difference of log likelihoods");
  v.Bool("collapsed", collapsed, "take for missing joints that stand exactly where their parent stands");
  v.Bool("teleports", teleports, "take for missing a person or a joint that is suddenly where nobody can be");
  v.Bool("torn", torn, "take for missing a joint that no bone reaches, or that jumps away and back");
  v.Bool("merged", merged,
         "take for missing knees and elbows, with what hangs from them, that are where the other side's are");
  v.Number("longest_teleport", longest_teleport_s, Unit::kSecond, {0.0, 1e4}, "longer ones are left as they are");
  v.Bool("held", held, "take for missing joints or frames that repeat to the last digit");
  v.Integer("held_frames", held_frames, {2, 10000}, "equal frames on end, the first one included, from which on");
  v.Number("longest_held", longest_held_s, Unit::kSecond, {0.0, 1e4}, "longer ones are left as they are");
}

void CloudOutlierOptions::Declare(OptionVisitor& v) {
  v.Bool("enabled", enabled, "drop points far from their neighbours");
  v.Integer("neighbours", neighbours, {2, 1000}, "neighbours whose mean distance is looked at");
  v.Number("spread_ratio", spread_ratio, Unit::kNone, {0.1, 100.0}, "standard deviations above the mean that stay");
}

void CloudStartOptions::Declare(OptionVisitor& v) {
  v.OptionalNumber("facing", facing, Unit::kRadian, {-6.3, 6.3},
                   "where the person faces when the clip begins, about y from +z, within 45 degrees; none: found");
  v.Choice(
      "posture", posture,
      {{"standing", StartPosture::kStanding}, {"seated", StartPosture::kSeated}, {"unknown", StartPosture::kUnknown}},
      "how the person is known to be when the clip begins");
}

void PointCloudOptions::Declare(OptionVisitor& v) {
  v.Choice("solver", solver, {{"ceres", TrackSolver::kCeres}, {"banded", TrackSolver::kBanded}},
           "ceres, or our normal equations of the same costs, several times as fast");
  v.Number("voxel_size", voxel_size, Unit::kMetre, {1e-3, 0.5}, "points are thinned to one per voxel");
  v.Number("max_distance", max_distance, Unit::kMetre, {1e-3, 2.0}, "points farther from the body do not pull");
  v.OptionalNumber("height", height, Unit::kMetre, {0.3, 2.6},
                   "of the person, standing, from crown to soles; none: measured, which takes somebody of whom a part "
                   "is never seen for smaller");
  v.Group("outliers", outliers, "statistical outlier removal");
  v.Group("start", start, "what is known of the first pose");
  v.Group("audit", audit, "what is wrong with the rig of depth cameras, before anything is fused");
  v.Number("capsule_radius_scale", capsule_radius_scale, Unit::kNone, {0.1, 10.0}, "factor on the skeleton's radii");
  v.Integer("iterations", iterations, {1, 1000}, "of matching points to capsules, at most, per frame");
  v.Number("rotation_walk", rotation_walk, Unit::kNone, {1e-3, 1e3}, "joint rotation, radians per square root second");
  v.Number("velocity_walk", velocity_walk, Unit::kNone, {1e-3, 1e3}, "root position, metres per square root second");
  v.Number("rest_spread", rest_spread, Unit::kRadian, {1e-2, 1e3},
           "distance of joints from the rest pose; the trunk, feet and hands move less");
  v.Number("huber_sigmas", huber_sigmas, Unit::kNone, {0.5, 100.0}, "residuals beyond this many sigmas count linearly");
  v.Bool("uncertainty", uncertainty, "covariance of joint positions, standard deviation of rotations");
}

void ContactOptions::Declare(OptionVisitor& v) {
  v.Bool("remove_sliding", remove_sliding, "hold each foot where it stands: its leg turns, all else stays");
  v.Number("height", height, Unit::kMetre, {0.0, 1.0}, "a foot stands at most this far above its lowest 5 %");
  v.Number("speed", speed, Unit::kMetrePerSecond, {0.0, 10.0}, "a foot that is faster does not stand");
  v.Number("min_time", min_time_s, Unit::kSecond, {0.0, 10.0}, "shorter contacts are none, shorter gaps are closed");
  v.Number("blend", blend_s, Unit::kSecond, {0.0, 10.0}, "over which a foot comes back to where it was");
}

void TriangulationOptions::Declare(OptionVisitor& v) {
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "detections below are not read");
  v.Number("outlier", outlier, Unit::kPixel, {0.1, 1e4}, "views further off from the others' point are left out");
  v.Number("noise", noise, Unit::kPixel, {0.01, 1e3}, "standard deviation of a detection of confidence 1");
  v.Integer("min_views", min_views, {2, 1000},
            "views that must agree on a point, and always most of those that see it");
}

void RigAuditOptions::Declare(OptionVisitor& v) {
  DeclareAction(v, "clocks", clocks, "cameras whose clocks are off");
  DeclareAction(v, "moved", moved, "cameras that stand elsewhere, or were moved during the take");
  DeclareAction(v, "exchanged", exchanged, "cameras that have each other's files");
  DeclareAction(v, "unit", unit, "calibration in another unit than declared; told, it is refused");
  v.Number("longest_clock", longest_s, Unit::kSecond, {0.0, 10.0}, "clocks further off are not believed");
  v.Number("sure", sure, Unit::kNone, {0.5, 1.0}, "how sure something must be to be corrected");
}

void KeypointAuditOptions::Declare(OptionVisitor& v) {
  RigAuditOptions::Declare(v);
  DeclareAction(v, "order", order, "keypoints in another detector's order than declared; told, they are refused");
  DeclareAction(v, "sides", sides, "views that list left limbs as right ones for a while");
  v.Number("side_margin", side_margin, Unit::kNone, {0.0, 1e4},
           "by how much likelier exchanged sides must be, as a difference of log likelihoods");
}

void KeypointFitOptions::Declare(OptionVisitor& v) {
  v.Group("triangulation", triangulation, "points from the views that agree on them");
  v.Group("audit", audit, "what is wrong with the rig, before anything is triangulated");
}

void FittingOptions::Declare(OptionVisitor& v) {
  DeclareMethod(v, method);
  v.Choice("without_depth", without_depth, {{"refuse", WithoutDepth::kRefuse}, {"tracks", WithoutDepth::kTracks}},
           "with method: joints_and_clouds, what becomes of a clip whose depth images are not at hand");
  v.Text("skeleton", skeleton, "skeleton of the fitted motion: a name or a YAML file");
  DeclareOtherJoints(v, other_joints);
  v.Group("repair", repair, "what is mended in joint tracks before the fit");
  v.Group("joint_tracks", joint_tracks, "fit of tracked joints");
  v.Group("point_clouds", point_clouds, "fit of fused depth views");
  v.Group("contacts", contacts, "feet on the floor, after the fit");
  v.Group("keypoints", keypoints, "fit of 2-D keypoints of several views");
}

void ProportionsSettings::Declare(OptionVisitor& v) {
  v.Text("skeleton", skeleton, "skeleton whose bone lengths are wanted: a name or a YAML file");
  v.Choice(
      "body_of", body_of, {{"person", BodyOf::kPerson}, {"recording", BodyOf::kRecording}},
      "one body for all clips of a person, or one for each recording: of trackers that measure people anew in each");
  v.Bool("symmetric", symmetric, "left and right limbs share their lengths");
  v.Bool(
      "own_directions", own_directions,
      "bones that start at one joint (hips and spine, shoulders and neck) point where the person's do; no: where the "
      "skeleton's do");
  v.Integer("refine_clips", refine_clips, {0, kMaxProportionClips},
            "clips on which bones are fitted together with the pose; 0 keeps the medians");
  v.Integer("refine_frames", refine_frames, {2, 10000}, "frames of each, from its middle");
  v.Group("joint_tracks", joint_tracks, "fit of tracked joints");
}

void ProportionsOptions::Declare(OptionVisitor& v) {
  DeclareMethod(v, method);
  DeclareOtherJoints(v, other_joints);
  ProportionsSettings::Declare(v);
  v.Group("point_clouds", point_clouds, "tracking of the clouds the lengths are read from");
  v.Group("keypoints", keypoints, "points of 2-D keypoints that the lengths are read from");
}

std::vector<std::string> ChooseProportionClips(std::vector<std::string> clip_ids) {
  std::vector<std::pair<std::string, std::string>> ranked;
  for (std::string& id : clip_ids) ranked.emplace_back(Sha256Hex(id), std::move(id));
  std::sort(ranked.begin(), ranked.end());
  if (ranked.size() > kMaxProportionClips) ranked.resize(kMaxProportionClips);
  std::vector<std::string> chosen;
  for (auto& [hash, id] : ranked) chosen.push_back(std::move(id));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

StageDeclaration ProportionsDeclaration() { return {"proportions", 34, "mocurate-annotate", SolverLimits()}; }

StageDeclaration FittingDeclaration() { return {"fitting", 53, "mocurate-annotate", SolverLimits()}; }

}  // namespace mocurate
