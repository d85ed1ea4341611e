// bench_keypoints [CLIPS [CAMERAS [NOISE [SEED [OPTION=NUMBER ...]]]]]: keypoints to a motion on one core. The studio's
// people stand before RGB cameras, all 24 joints detected with NOISE px (4), 10 % missed, 3 % misplaced. Prints the
// speed of the whole path and of its parts, and errors. Those are joints (mm) and rotations that joints determine
// (degrees): full rotations of joints with two or more children not on a line, directions of single bones of at least 6
// cm. uncertainty=1 adds the share of whitened errors within one and two standard deviations. Options: frames (of each
// clip, at most), audit (0: none), ceres, uncertainty, walk_refits, rotation_process_noise, velocity_process_noise,
// huber_share, true_bones, wrong (share of misplaced detections), missed (share), exchanged (frame from which all
// views exchange left and right), body_25. body_25=1 detects only OpenPose's 25 points on shapes of body_cc0; it
// separates coverage of joints among them from that of the others, and prints joint by joint to standard error.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/store/body_file.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/keypoint_fit.h"
#include "fitting/proportions.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/take_plan.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kShortBone = 0.06;
constexpr double kRateHz = 30.0;

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct StudioTake {
  std::string person;
  std::string name;
  Motion truth;
  Evidence evidence;
};

/// Angle of a rotation, or between two directions, in degrees.
double Between(const Matrix3d& a, const Matrix3d& b) { return kDegrees * LogMatrix(a.transpose() * b).norm(); }
double Between(const Vector3d& a, const Vector3d& b) { return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b)); }

std::vector<Matrix3d> Global(const Motion& motion, int frame) {
  std::vector<Matrix3d> global;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const Matrix3d local = motion.rotation_at(frame, j).toRotationMatrix();
    const int parent = motion.skeleton->joints[j].parent;
    global.push_back(parent < 0 ? local : Matrix3d(global[parent] * local));
  }
  return global;
}

/// Whitened error components and joint errors.
struct Coverage {
  double within_one = 0.0;
  double within_two = 0.0;
  double whitened = 0.0;
  double millimetres = 0.0;
  double squares = 0.0;  ///< of whitened components
  double sigmas_mm = 0.0;

  void Add(const Vector3d& white, double error_m, double sigma_m) {
    within_one += static_cast<double>((white.array().abs() < 1.0).count());
    within_two += static_cast<double>((white.array().abs() < 2.0).count());
    whitened += 3.0;
    millimetres += 1e3 * error_m;
    squares += white.squaredNorm();
    sigmas_mm += 1e3 * sigma_m;
  }
  void Add(const Coverage& other) {
    within_one += other.within_one;
    within_two += other.within_two;
    whitened += other.whitened;
    millimetres += other.millimetres;
    squares += other.squares;
    sigmas_mm += other.sigmas_mm;
  }
  double one() const { return within_one / std::max(whitened, 1.0); }
  double two() const { return within_two / std::max(whitened, 1.0); }
  double mm() const { return 3.0 * millimetres / std::max(whitened, 1.0); }
  double sigma_mm() const { return 3.0 * sigmas_mm / std::max(whitened, 1.0); }
  double rms() const { return std::sqrt(squares / std::max(whitened, 1.0)); }
};

struct Errors {
  double joint_mm = 0.0;
  double rotation_deg = 0.0;
  double joints = 0.0;
  double rotations = 0.0;
  Coverage all;
  std::map<int, Coverage> of_joint;
};

void AddCoverage(const Motion& truth, const Motion& fit, Errors& errors) {
  if (fit.position_cov.empty()) return;
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (int j = 0; j < truth.joint_count(); ++j) {
      const Matrix3d covariance =
          FromSixNumbers(fit.position_cov.data() + 6 * (static_cast<std::size_t>(f) * truth.joint_count() + j));
      const Vector3d error = fit.joints.at(f, j) - truth.joints.at(f, j);
      const Vector3d white = Eigen::LLT<Matrix3d>(covariance).matrixL().solve(error);
      errors.all.Add(white, error.norm(), std::sqrt(covariance.trace()));
      errors.of_joint[j].Add(white, error.norm(), std::sqrt(covariance.trace()));
    }
  }
}

void AddErrors(const Motion& truth, const Motion& fit, Errors& errors) {
  const Skeleton& skeleton = *truth.skeleton;
  const auto children = skeleton.Children();
  for (int f = 0; f < truth.frame_count(); ++f) {
    const auto real = Global(truth, f);
    const auto fitted = Global(fit, f);
    for (int j = 0; j < truth.joint_count(); ++j) {
      errors.joint_mm += 1e3 * (truth.joints.at(f, j) - fit.joints.at(f, j)).norm();
      errors.joints += 1.0;
      if (children[j].size() >= 2) {
        errors.rotation_deg += Between(real[j], fitted[j]);
        errors.rotations += 1.0;
      } else if (children[j].size() == 1) {
        const int c = children[j][0];
        const Vector3d bone = truth.joints.at(f, c) - truth.joints.at(f, j);
        if (bone.norm() < kShortBone) continue;
        errors.rotation_deg += Between(bone, Vector3d(fit.joints.at(f, c) - fit.joints.at(f, j)));
        errors.rotations += 1.0;
      }
    }
  }
}

std::vector<StudioTake> Perform(int clips, int cameras, const KeypointOptions& detector, std::int64_t seed, int frames,
                                bool body_25, const BodyTemplate* body) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  StudioOptions options = FourViews(seed);
  options.subjects = std::max(5, (clips + 11) / 12);
  options.clips = 1;
  options.rig.kind = cameras > 0 ? RigKind::kRing : RigKind::kHuman36m;
  options.rig.cameras = std::max(cameras, 1);
  options.keypoints = detector;
  const auto actors = ActorsOf(options, options.subjects, body);
  const auto plan = PlanTakes(options, OneVariantPerAction(), {options.subjects, 1, kRateHz, 0.3, 0.6});
  const std::vector<Camera> rig = RigOf(options.rig, SensorKind::kColour);
  std::vector<StudioTake> takes;
  for (const PlannedTake& planned : *plan) {
    if (static_cast<int>(takes.size()) >= clips) break;
    StudioTake take;
    const Actor& actor = (*actors)[static_cast<std::size_t>(planned.subject - 1)];
    take.person = actor.subject.name;
    take.name = planned.Key();
    take.truth = PerformScript(planned.script, actor.subject, actor.skeleton, FrameRate{30, 1});
    if (frames > 0 && take.truth.frame_count() > frames) {
      std::vector<int> first(static_cast<std::size_t>(frames));
      for (int f = 0; f < frames; ++f) first[static_cast<std::size_t>(f)] = f;
      take.truth = SelectFrames(take.truth, first, RigidTransform{});
    }
    for (const Joint& joint : skeleton->joints) take.evidence.keypoint_names.push_back(joint.name);
    if (body_25) take.evidence.keypoint_names = NamesOf(Body25Places());
    const JointPositions places = body_25 ? PlacesOf(take.truth, Body25Places()) : take.truth.joints;
    for (const Camera& camera : rig) {
      KeypointView view;
      view.camera = camera;
      view.people = 1;
      for (int f = 0; f < take.truth.frame_count(); ++f) {
        view.time_s.push_back(take.truth.rate.FrameTime(f));
        std::vector<ImagePoint> points;
        for (int k = 0; k < places.joints; ++k) points.push_back({camera.ProjectWorld(places.at(f, k)), false});
        const OpenPosePerson person =
            Detected(points, options.keypoints, options.seed, take.name + "/" + camera.name + "/" + std::to_string(f));
        for (const DetectedKeypoint& point : person.pose) {
          view.values.insert(view.values.end(), {point.u_px, point.v_px, point.confidence});
        }
      }
      take.evidence.keypoint_views.push_back(std::move(view));
    }
    takes.push_back(std::move(take));
  }
  return takes;
}

/// From frame `from` on, exchanges left and right in all views.
void CallLeftRight(Evidence& evidence, const Skeleton& skeleton, int from) {
  for (KeypointView& view : evidence.keypoint_views) {
    for (int f = from; f < view.frames(); ++f) {
      double* frame = view.values.data() + 3 * static_cast<std::size_t>(f) * skeleton.joints.size();
      for (int j = 0; j < skeleton.joint_count(); ++j) {
        const int partner = skeleton.joints[j].mirror;
        if (partner > j) std::swap_ranges(frame + 3 * j, frame + 3 * j + 3, frame + 3 * partner);
      }
    }
  }
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  const auto argument = [&](int place, double otherwise) { return argc > place ? std::atof(argv[place]) : otherwise; };
  FittingOptions options = benchmarks::OptionsWithout();
  int longest = 0;
  bool true_bones = false;
  int exchanged_from = -1;
  bool body_25 = false;
  KeypointOptions detector = FourViews(0).keypoints;
  detector.noise = argument(3, 4.0);
  options.joint_tracks.solver = PoseSolver::kBanded;
  for (const auto& [name, value] : GivenNumbers(argc, argv, 5)) {
    if (name == "frames") longest = static_cast<int>(value);
    if (name == "audit" && value == 0.0) {
      KeypointAuditOptions& audit = options.keypoints.audit;
      audit.clocks = audit.moved = audit.exchanged = audit.unit = audit.order = audit.sides = AuditAction::kOff;
    }
    if (name == "contact_process_noise")
      options.joint_tracks.contact_process_noise = value > 0.0 ? std::optional<double>(value) : std::nullopt;
    if (name == "walk_refits") options.joint_tracks.steps = StepsWithRefits(static_cast<int>(value));
    if (name == "rotation_process_noise") options.joint_tracks.priors.rotation_noise = value;
    if (name == "velocity_process_noise") options.joint_tracks.priors.position_noise = value;
    if (name == "huber_share") options.joint_tracks.huber_share = value;
    if (name == "uncertainty") options.joint_tracks.uncertainty = value != 0.0;
    if (name == "true_bones") true_bones = value != 0.0;
    if (name == "exchanged") exchanged_from = static_cast<int>(value);
    if (name == "body_25") body_25 = value != 0.0;
    if (name == "wrong") detector.wrong_share = value;
    if (name == "missed") detector.miss_share = value;
    if (name == "ceres") options.joint_tracks.solver = value != 0.0 ? PoseSolver::kCeres : PoseSolver::kBanded;
  }
  std::optional<BodyTemplate> shapes;
  if (body_25) {
    const char* data = std::getenv("MOCURATE_DATA");
    auto read = ReadBodyTemplate(std::filesystem::path(data != nullptr ? data : "") / "body_cc0/body_cc0.h5");
    if (!read) return std::fprintf(stderr, "no body: set MOCURATE_DATA\n"), 2;
    shapes = std::move(*read);
  }
  auto takes = Perform(static_cast<int>(argument(1, 60)), static_cast<int>(argument(2, 4)), detector,
                       static_cast<std::int64_t>(argument(4, 4711)), longest, body_25, shapes ? &*shapes : nullptr);
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const SkeletonPtr full =
      takes.empty() ? skeleton : WithDetectorPoints(skeleton, DetectorNames(takes[0].evidence.keypoint_names));
  for (StudioTake& take : takes) {
    if (exchanged_from >= 0) CallLeftRight(take.evidence, *skeleton, exchanged_from);
  }
  std::map<std::string, std::vector<SkeletonTracks>> of_person;
  double frames = 0.0;
  double tracks_s = 0.0;
  Errors raw;
  for (const StudioTake& take : takes) {
    const double begin = CpuSeconds();
    auto found = TracksOnBody(take.evidence, *skeleton, full, options.keypoints);
    tracks_s += CpuSeconds() - begin;
    frames += take.truth.frame_count();
    if (!found) {
      std::fprintf(stderr, "%s: %s\n", take.name.c_str(), found.error().Message().c_str());
      continue;
    }
    for (int f = 0; f < take.truth.frame_count(); ++f) {
      for (int j = 0; j < skeleton->joint_count(); ++j) {
        if (!found->tracks.seen(f, j)) continue;
        raw.joint_mm += 1e3 * (found->tracks.positions.at(f, j) - take.truth.joints.at(f, j)).norm();
        raw.joints += 1.0;
      }
    }
    of_person[take.person].push_back(std::move(found->tracks));
  }
  ProportionsOptions medians;
  medians.symmetric = true;
  std::map<std::string, PersonBody> bodies;
  for (const auto& [person, clips] : of_person) {
    const auto estimate = EstimateProportions(clips, full, medians);
    bodies[person] = {estimate.skeleton, estimate.bone_length};
  }
  Errors errors;
  benchmarks::ClipLines lines(argc, argv);
  double fit_s = 0.0;
  double iterations = 0.0;
  double sigma = 0.0;
  for (const StudioTake& take : takes) {
    const double begin = CpuSeconds();
    PersonBody body = bodies[take.person];
    if (true_bones) {
      body.skeleton = WithDetectorPoints(take.truth.skeleton, DetectorNames(take.evidence.keypoint_names));
      body.bone_length = body.skeleton->RestBoneLengths();
      std::copy(take.truth.bone_length.begin(), take.truth.bone_length.end(), body.bone_length.begin());
    }
    const auto fit = FitKeypoints(take.evidence, take.truth.rate, skeleton, body.skeleton, body.bone_length, options);
    const double own_s = CpuSeconds() - begin;
    fit_s += own_s;
    if (!fit) continue;
    Errors own;
    AddErrors(take.truth, fit->motion, own);
    AddCoverage(take.truth, fit->motion, own);
    lines.Add(take.name, take.person, "keypoints",
              {{"joint_mm", own.joint_mm / own.joints},
               {"rotation_deg", own.rotation_deg / own.rotations},
               {"within_one", own.all.one()},
               {"within_two", own.all.two()},
               {"frames_per_s", take.truth.frame_count() / own_s}},
              benchmarks::OutcomeOf(*fit));
    iterations += fit->iterations;
    sigma += fit->noise_sigma;
    std::fprintf(stderr, "%-28s %4d frames, %5.1f mm, %4.1f deg, %d iterations\n", take.name.c_str(),
                 take.truth.frame_count(), own.joint_mm / own.joints, own.rotation_deg / own.rotations,
                 fit->iterations);
    AddErrors(take.truth, fit->motion, errors);
    AddCoverage(take.truth, fit->motion, errors);
    for (const RigFault& fault : fit->keypoints->faults) {
      std::fprintf(stderr, "  %s %s %.1f confidence %.3f\n", fault.code.c_str(), fault.camera.c_str(), fault.value,
                   fault.confidence);
    }
  }
  Coverage observed, unobserved;
  std::vector<bool> named(skeleton->joints.size(), false);
  for (const StudioTake& take : takes) {
    for (const std::string& name : DetectorNames(take.evidence.keypoint_names)) {
      if (const auto joint = skeleton->FindJoint(name)) named[static_cast<std::size_t>(*joint)] = true;
    }
  }
  for (const auto& [joint, coverage] : errors.of_joint) {
    (named[static_cast<std::size_t>(joint)] ? observed : unobserved).Add(coverage);
    if (!body_25) continue;
    std::fprintf(stderr, "%-16s %-6s %5.1f mm, stated %5.1f, %.3f %.3f, rms %.2f sigma\n",
                 skeleton->joints[joint].name.c_str(), named[static_cast<std::size_t>(joint)] ? "" : "unobserved",
                 coverage.mm(), coverage.sigma_mm(), coverage.one(), coverage.two(), coverage.rms());
  }
  if (body_25) {
    for (const auto& [name, of] : {std::pair<const char*, const Coverage&>{"seen", observed}, {"unseen", unobserved}}) {
      std::printf(
          "{\"joints\": \"%s\", \"joint_mm\": %.2f, \"stated_mm\": %.2f, \"within_one\": %.4f, "
          "\"within_two\": %.4f, \"whitened_rms\": %.2f}\n",
          name, of.mm(), of.sigma_mm(), of.one(), of.two(), of.rms());
    }
  }
  std::printf(
      "{\"name\": \"keypoints\", \"clips\": %zu, \"cameras\": %zu, \"frames\": %.0f, \"triangulated_mm\": %.2f, "
      "\"triangulated_share\": %.4f, \"joint_mm\": %.2f, \"rotation_deg\": %.2f, \"within_one\": %.4f, \"within_two\": "
      "%.4f, "
      "\"sigma_mm\": %.1f, \"iterations\": "
      "%.1f, "
      "\"tracks_frames_per_s\": %.0f, \"frames_per_s\": %.0f, \"threads\": 1}\n",
      takes.size(), takes.empty() ? 0 : takes[0].evidence.keypoint_views.size(), frames, raw.joint_mm / raw.joints,
      raw.joints / (frames * skeleton->joint_count()), errors.joint_mm / errors.joints,
      errors.rotation_deg / errors.rotations, errors.all.one(), errors.all.two(),
      1e3 * sigma / static_cast<double>(takes.size()), iterations / static_cast<double>(takes.size()),
      frames / tracks_s, frames / fit_s);
}
