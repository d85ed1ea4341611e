#include "fitting/options.h"

#include <algorithm>

#include "core/base/sha256.h"
#include "fitting/stages.h"

namespace mocurate {
namespace {

constexpr std::pair<const char*, FitMethod> kMethods[] = {{"joint_tracks", FitMethod::kJointTracks},
                                                          {"point_clouds", FitMethod::kPointClouds},
                                                          {"joints_and_clouds", FitMethod::kJointsAndClouds},
                                                          {"keypoints", FitMethod::kKeypoints},
                                                          {"keypoints_and_clouds", FitMethod::kKeypointsAndClouds},
                                                          {"none", FitMethod::kNone}};

void DeclareMethod(OptionVisitor& v, FitMethod& method) {
  v.Choice("method", method, {std::begin(kMethods), std::end(kMethods)},
           "evidence that the skeleton is fitted to; none passes a given motion through");
}

void DeclareOtherJoints(OptionVisitor& v, OtherJoints& other) {
  v.Choice("other_joints", other, {{"refuse", OtherJoints::kRefuse}, {"exclude", OtherJoints::kLeaveOut}},
           "tracked joints that the skeleton does not have: refuse the clip, or exclude the joints");
}

void DeclareAction(OptionVisitor& v, const char* name, AuditAction& action, const char* help) {
  v.Choice(name, action,
           {{"off", AuditAction::kOff}, {"report", AuditAction::kReport}, {"correct", AuditAction::kCorrect}}, help);
}

/// Sets the rules of the groups that the stages fitting and proportions have in common.
template <class Options>
void SetRulesOfGroups(const Rules& rules, Options& options) {
  options.joint_tracks.rules = rules;
  options.point_clouds.rules = options.point_clouds.audit.rules = rules;
  options.keypoints.audit.rules = rules;
}

}  // namespace

const char* Name(FitMethod method) { return kMethods[static_cast<std::size_t>(method)].first; }

void TrackStep::Declare(OptionVisitor& v) {
  v.Choice("free", free, {{"root", FreeParts::kRoot}, {"pose", FreeParts::kPose}},
           "free parameters: the root alone, or the root and every joint");
  v.Choice("evidence", evidence, {{"positions", StepEvidence::kPositions}, {"all", StepEvidence::kAll}},
           "tracked positions alone, or positions and recorded rotations");
  v.Number("relative_tolerance", relative_tolerance, Unit::kNone, {1e-12, 1e-1},
           "relative change of cost at which the step ends");
  v.Integer("max_iterations", max_iterations, {1, 1000}, "solver iterations per window, at most");
  v.Bool("refit_process_noise", refit_process_noise,
         "after this step, refit both process noises per joint and time; the next step uses them");
}

std::vector<TrackStep> StepsWithRefits(int refits, const TrackStep& last) {
  std::vector<TrackStep> steps;
  for (int i = 0; i < refits; ++i) {
    TrackStep step = last;
    step.evidence = i == 0 ? StepEvidence::kPositions : last.evidence;
    step.relative_tolerance = std::max(last.relative_tolerance, 1e-2);
    step.refit_process_noise = true;
    steps.push_back(step);
  }
  steps.push_back(last);
  return steps;
}

void JointTrackOptions::Declare(OptionVisitor& v) {
  v.Renamed("solver", "fitting.solver");
  v.Number("huber_share", huber_share, Unit::kNone, {1e-6, 0.9},
           "share of clean samples whose residuals count linearly, as those of outliers do (Huber loss)");
  v.Number("rotation_process_noise", priors.rotation_noise, Unit::kNone, {1e-3, 1e3},
           "process noise of a joint's rotation, radians per square root second");
  v.Number("velocity_process_noise", priors.position_noise, Unit::kNone, {1e-3, 1e3},
           "process noise of a joint's position, metres per square root second");
  v.OptionalNumber(
      "contact_process_noise", contact_process_noise, Unit::kNone, {1e-4, 1e3},
      "process noise of ankles and toes in contact, metres per square root second; none: no contact prior");
  v.Bool("recorded_rotations", recorded_rotations,
         "use rotations of the source or of a given motion as evidence, beside the positions");
  v.Number("rest_sigma", priors.rest, Unit::kRadian, {1e-2, 1e3},
           "standard deviation of a joint's angle from the rest pose");
  v.Number("limit_sigma", priors.limit, Unit::kRadian, {1e-3, 1e2},
           "standard deviation of an angle beyond a joint limit");
  v.Number("hinge_sigma", priors.hinge, Unit::kNone, {1e-3, 1e2},
           "standard deviation of a shin or forearm out of its hinge plane, as the sine of the angle");
  v.List("steps", steps, "solver steps, in order, from a closed-form pose; none: that pose is the fit");
  v.Integer("window_frames", window_frames, {10, 100000}, "longer clips are fitted in windows of this length");
  v.Integer("window_overlap", window_overlap, {1, 10000},
            "frames at the end of a window that the next window fits again");
  v.Bool("uncertainty", uncertainty,
         "covariance of joint positions, standard deviation of rotations, by selected inversion");
}

void RepairOptions::Declare(OptionVisitor& v) {
  v.Bool("swaps", swaps, "exchange left and right limbs where the tracker swapped them");
  v.Number("swap_margin", swap_margin, Unit::kNone, {0.0, 1e4}, "difference of log likelihoods that an exchange needs");
  v.Bool("collapsed", collapsed, "mark a joint at exactly its parent's position as missing");
  v.Bool("position_jumps", position_jumps, "mark a person or joint missing after an impossible jump");
  v.Bool("bone_violations", bone_violations,
         "mark a joint missing that violates bone lengths, or that jumps away and back");
  v.Number("longest_jump", longest_jump_s, Unit::kSecond, {0.0, 1e4}, "longer jumps are left as they are");
  v.Bool("repeated_values", repeated_values, "mark joints or frames missing that repeat a value to the last digit");
  v.Integer("repeated_frames", repeated_frames, {2, 10000},
            "consecutive equal frames that count as a repeat, the first one included");
  v.Number("longest_repeat", longest_repeat_s, Unit::kSecond, {0.0, 1e4}, "longer repeats are left as they are");
}

void CloudStartOptions::Declare(OptionVisitor& v) {
  v.OptionalNumber("facing", facing, Unit::kRadian, {-6.3, 6.3},
                   "initial heading of the person about y, from +z, within 45 degrees; none: estimated");
  v.Choice(
      "posture", posture,
      {{"standing", StartPosture::kStanding}, {"seated", StartPosture::kSeated}, {"unknown", StartPosture::kUnknown}},
      "posture of the person when the clip begins");
}

void PointCloudOptions::Declare(OptionVisitor& v) {
  v.Renamed("solver", "fitting.solver");
  v.Number("voxel_size", voxel_size, Unit::kMetre, {1e-3, 0.5}, "edge of a voxel; one point per voxel is kept");
  v.Number("max_distance", max_distance, Unit::kMetre, {1e-3, 2.0}, "points farther from the body are ignored");
  v.OptionalNumber(
      "height", height, Unit::kMetre, {0.3, 2.6},
      "height of the standing person, crown to soles; none: measured, which underestimates a person of whom "
      "a part is never seen");
  v.Number("shortest", shortest, Unit::kMetre, {0.3, 2.6},
           "height of the shortest person: a measured one below is wrong");
  v.Number("tallest", tallest, Unit::kMetre, {0.3, 2.6},
           "height of the tallest person: a still in which legs are high may measure as a giant, and is then measured "
           "again from the sizes of adults, or refused");
  v.Group("start", start, "prior of the first pose");
  v.Group("audit", audit, "audit of the depth cameras before fusion");
  v.Integer("iterations", iterations, {1, 1000}, "iterations of matching points to capsules per frame, at most");
  v.Number("rotation_process_noise", priors.rotation_noise, Unit::kNone, {1e-3, 1e3},
           "process noise of a joint's rotation, radians per square root second");
  v.Number("velocity_process_noise", priors.position_noise, Unit::kNone, {1e-3, 1e3},
           "process noise of the root's position, metres per square root second");
  v.Number("rest_sigma", priors.rest, Unit::kRadian, {1e-2, 1e3},
           "standard deviation of a joint's angle from the rest pose; less for trunk, feet and hands");
  v.Number("huber_share", huber_share, Unit::kNone, {1e-6, 0.9},
           "share of clean samples whose residuals count linearly, as those of outliers do (Huber loss)");
  v.Bool("uncertainty", uncertainty, "covariance of joint positions, standard deviation of rotations");
}

void ContactOptions::Declare(OptionVisitor& v) {
  v.Bool("remove_sliding", remove_sliding,
         "remove foot sliding: each foot keeps its place during contact, only its leg changes");
  v.Number("height", height, Unit::kMetre, {0.0, 1.0}, "contact needs a foot at most this far above its lowest 5 %");
  v.Number("speed", speed, Unit::kMetrePerSecond, {0.0, 10.0}, "a faster foot is not in contact");
  v.Number("min_time", min_time_s, Unit::kSecond, {0.0, 10.0}, "shorter contacts are dropped, shorter gaps are closed");
  v.Number("blend", blend_s, Unit::kSecond, {0.0, 10.0}, "time over which the correction fades out");
}

void TriangulationOptions::Declare(OptionVisitor& v) {
  v.Number("min_confidence", min_confidence, Unit::kNone, {0.0, 1.0}, "detections below this confidence are not read");
  v.Number("outlier", outlier, Unit::kPixel, {0.1, 1e4}, "views further from the other views' point are excluded");
  v.Number("noise", noise, Unit::kPixel, {0.01, 1e3}, "standard deviation of a detection of confidence 1");
  v.Integer("min_views", min_views, {2, 1000},
            "views that must agree on a point; a majority of those that detect it is always needed");
}

void RigAuditOptions::Declare(OptionVisitor& v) {
  DeclareAction(v, "clocks", clocks, "cameras with a clock offset");
  DeclareAction(v, "moved", moved, "cameras with another pose than calibrated, or moved during the take");
  DeclareAction(v, "exchanged", exchanged, "cameras whose files are exchanged");
  DeclareAction(v, "unit", unit, "calibration in another unit than declared; report refuses the clip");
  v.Number("longest_clock", longest_s, Unit::kSecond, {0.0, 10.0}, "larger clock offsets are not considered");
  v.Number("sure", sure, Unit::kNone, {0.5, 1.0},
           "least confidence of a fault that is reported or corrected, as findings state it");
}

void KeypointAuditOptions::Declare(OptionVisitor& v) {
  RigAuditOptions::Declare(v);
  DeclareAction(v, "order", order, "keypoints in another detector's order than declared; report refuses the clip");
  DeclareAction(v, "sides", sides, "views that label left limbs as right ones for a time");
  v.Number("side_margin", side_margin, Unit::kNone, {0.0, 1e4},
           "difference of log likelihoods that an exchange of sides needs");
}

void KeypointFitOptions::Declare(OptionVisitor& v) {
  v.Group("triangulation", triangulation, "robust triangulation");
  v.Group("audit", audit, "audit of the cameras and keypoints before triangulation");
  v.Path("rig", rig,
         "audited rig, a file of `mocurate rig audit`: its corrections are used, and those that the take itself "
         "suggests are only reported; empty: the take's own");
}

void FittingOptions::Declare(OptionVisitor& v) {
  DeclareMethod(v, method);
  v.Choice("without_depth", without_depth, {{"refuse", WithoutDepth::kRefuse}, {"tracks", WithoutDepth::kTracks}},
           "with method: joints_and_clouds, for clips without depth images: refuse, or fit the tracks alone");
  v.Text("skeleton", skeleton, "skeleton of the fitted motion: a name or a YAML file");
  DeclareOtherJoints(v, other_joints);
  v.Choice("solver", solver, {{"ceres", PoseSolver::kCeres}, {"banded", PoseSolver::kBanded}},
           "ceres, or a block-tridiagonal solver of the same terms, faster");
  v.Number("check", check, Unit::kNone, {0.0, 1.0},
           "share of the clips whose last solve is done by the other solver too, from the same start; differences are "
           "findings");
  v.Group("repair", repair, "corrections of joint tracks before the fit");
  v.Group("joint_tracks", joint_tracks, "fit of tracked joints");
  v.Group("point_clouds", point_clouds, "fit of fused depth views");
  v.Group("contacts", contacts, "foot contacts, after the fit");
  v.Group("keypoints", keypoints, "fit of 2-D keypoints of several views");
  rules.Declare(v);
  UseRules(rules);
  UseSolver(solver);
}

void FittingOptions::UseRules(const Rules& used) {
  rules = repair.rules = used;
  SetRulesOfGroups(used, *this);
}

void RigStageOptions::Declare(OptionVisitor& v) {
  v.Text("config", config, "name of the configuration");
  v.Text("skeleton", skeleton, "skeleton whose proportions people have");
  v.Group("keypoints", keypoints, "triangulation of the keypoints, and the audit");
}

void ProportionsSettings::Declare(OptionVisitor& v) {
  v.Text("skeleton", skeleton, "skeleton whose bone lengths are measured: a name or a YAML file");
  v.Choice("body_of", body_of, {{"person", BodyOf::kPerson}, {"recording", BodyOf::kRecording}},
           "one body for all clips of a person, or one per recording, for trackers that measure people anew in each");
  v.Bool("symmetric", symmetric, "left and right limbs have equal lengths");
  v.Bool("own_directions", own_directions,
         "measure the directions of bones that start at one joint (hips and spine, shoulders and neck); no: keep the "
         "skeleton's");
  v.Group("joint_tracks", joint_tracks, "fit of tracked joints");
}

void ProportionsOptions::Declare(OptionVisitor& v) {
  DeclareMethod(v, method);
  DeclareOtherJoints(v, other_joints);
  ProportionsSettings::Declare(v);
  v.Group("point_clouds", point_clouds, "tracking of the clouds that lengths are measured on");
  v.Group("keypoints", keypoints, "triangulation of the keypoints that lengths are measured on");
  rules.Declare(v);
  SetRulesOfGroups(rules, *this);
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

StageDeclaration RigDeclaration() { return {"rig", 4, "mocurate-annotate", SolverLimits()}; }

StageDeclaration ProportionsDeclaration() { return {"proportions", 38, "mocurate-annotate", SolverLimits()}; }

StageDeclaration FittingDeclaration() { return {"fitting", 65, "mocurate-annotate", SolverLimits()}; }

}  // namespace mocurate
