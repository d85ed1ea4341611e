// bench_hard_stills [BODIES [SEED [FOLDER [NAME=VALUE ...]]]]: fits single frames of people in poses that a search for
// a first pose may miss (tests/fitting/hard_poses.h), on one core. Of 12 bodies the odd ones are shapes of body_cc0
// with their skin, the even ones capsule bodies with other proportions. The first of three depth cameras in a ring
// of 3.2 m see them, or a ring of four. Before one camera the person faces about towards it, else any way, unless the
// pose says otherwise. Images are written to FOLDER. Options: first (number of the first body, 1); views (1 to 4;
// unset: each); noise (1: a Kinect's errors, 0: none; unset: both); facing (1: the pelvis's heading is given where the
// pose has one); pose (one by name; unset: all); body (standing: measured in four stills of the person standing before
// three cameras; still: in the still alone; known). Prints a line for each number of views: the shares of stills that
// are confidently wrong, accepted (not reported as ambiguous) and more than 60 mm off, medians of mean joint errors,
// and how well the stated deviation of a joint separates errors above 50 mm (area under the ROC curve).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/fit_clouds.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/hard_poses.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr int kBodies = 12, kMostViews = 4;
constexpr int kFirstOption = 4;       ///< of the arguments
constexpr double kVariation = 0.1;    ///< rad RMS, of a joint's rotation around the pose's
constexpr double kFrontish = 0.8;     ///< rad, largest angle of a heading from that towards the camera
constexpr double kLargeError = 0.06;  ///< m, mean over the joints
constexpr double kLargeJointError = 0.05;

/// A fit beside the truth. Lengths in metres, angles in radians.
struct StillError {
  double joints = 0.0;     ///< mean
  double sigma = 0.0;      ///< as stated, per axis; RMS over the joints
  bool ambiguous = false;  ///< as reported
  std::vector<double> joint, joint_sigma;
  // How a wrong pose is wrong:
  double exchanged = 0.0;  ///< mean over the joints if those of the left and right of the fit were exchanged
  double pelvis = 0.0;     ///< between both rotations of the pelvis
  double trunk = 0.0;      ///< between both directions from pelvis to neck
};

StillError Compare(const FitResult& fit, const Motion& truth) {
  StillError error;
  const Motion& motion = fit.motion;
  JointPositions exchanged = motion.joints;
  double variance = 0.0;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const Matrix3d covariance = FromSixNumbers(motion.position_cov.data() + 6 * static_cast<std::size_t>(j));
    variance += covariance.trace() / 3.0 / motion.joint_count();
    error.joint.push_back((motion.joints.at(0, j) - truth.joints.at(0, j)).norm());
    error.joint_sigma.push_back(std::sqrt(covariance.trace() / 3.0));
    exchanged.at(0, j) = motion.joints.at(0, motion.skeleton->joints[static_cast<std::size_t>(j)].mirror);
  }
  error.joints = MeanJointError(motion.joints, truth.joints);
  error.sigma = std::sqrt(variance);
  for (const Finding& finding : fit.findings) error.ambiguous = error.ambiguous || finding.code == kAmbiguousPose;
  error.exchanged = MeanJointError(exchanged, truth.joints);
  error.pelvis = AngleBetween(motion.rotation_at(0, 0), truth.rotation_at(0, 0));
  const int neck = *truth.skeleton->FindJoint("neck");
  const Vector3d trunk = motion.joints.at(0, neck) - motion.joints.at(0, 0);
  const Vector3d true_trunk = truth.joints.at(0, neck) - truth.joints.at(0, 0);
  error.trunk = std::atan2(trunk.cross(true_trunk).norm(), trunk.dot(true_trunk));
  return error;
}

/// Area under the receiver operating characteristic: the share of pairs of a sample with and one without the property
/// in which the former has the larger score; equal scores count half. NaN without such pairs.
double RocAuc(std::vector<std::pair<double, bool>> samples) {
  std::sort(samples.begin(), samples.end());
  double pairs = 0.0, without = 0.0, with = 0.0;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    double equal_without = 0.0, equal_with = 0.0;
    for (; end < samples.size() && samples[end].first == samples[begin].first; ++end)
      (samples[end].second ? equal_with : equal_without) += 1.0;
    pairs += equal_with * (without + 0.5 * equal_without);
    without += equal_without, with += equal_with;
  }
  return pairs / (without * with);
}

/// Figures of many stills. Accepted are those that were fitted and not reported as ambiguous.
struct Tally {
  int stills = 0, failed = 0, accepted = 0, large = 0;
  int confidently_wrong = 0;  ///< accepted, and the error is large and above three stated deviations
  std::vector<double> errors, accepted_errors;
  std::vector<std::pair<double, bool>> joints;  ///< stated deviation, whether the error is large

  void AddFailed() { ++stills, ++failed; }

  void Add(const StillError& error) {
    const bool is_large = error.joints > kLargeError;
    ++stills;
    large += is_large ? 1 : 0;
    errors.push_back(error.joints);
    for (std::size_t j = 0; j < error.joint.size(); ++j)
      joints.emplace_back(error.joint_sigma[j], error.joint[j] > kLargeJointError);
    if (error.ambiguous) return;
    ++accepted;
    accepted_errors.push_back(error.joints);
    confidently_wrong += is_large && error.sigma < error.joints / 3.0 ? 1 : 0;
  }

  Json Figures() const {
    const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps; };
    const auto share = [&](int count) { return rounded(static_cast<double>(count) / stills, 1e4); };
    const auto median_mm = [&](const std::vector<double>& of) {
      return of.empty() ? Json(nullptr) : Json(rounded(1e3 * MeanMedian(of), 1e2));
    };
    return {{"stills", stills},
            {"failed", failed},
            {"confidently_wrong", share(confidently_wrong)},
            {"accepted", share(accepted)},
            {"accepted_median_mm", median_mm(accepted_errors)},
            {"median_mm", median_mm(errors)},
            {"above_60_mm", share(large)},
            {"sigma_auc", rounded(RocAuc(joints), 1e4)}};
  }
};

/// The first `views` cameras of a ring.
std::vector<Camera> CamerasFor(int views) {
  RigOptions ring;
  ring.cameras = std::max(3, views);
  std::vector<Camera> cameras = RingRig(ring, SensorKind::kDepth);
  cameras.resize(static_cast<std::size_t>(views));
  return cameras;
}

DepthSensorOptions SensorOf(bool noise) {
  DepthSensorOptions sensor;
  if (noise) return sensor;
  sensor.noise = sensor.quantisation = sensor.flying_share = sensor.hole_share = sensor.grazing = 0.0;
  return sensor;
}

/// Writes what the cameras record of a motion of one frame.
Expected<Clip> Record(const Actor& actor, const Motion& motion, int views, bool noise, std::uint64_t seed,
                      const std::filesystem::path& folder, const std::string& name) {
  Clip clip;
  clip.rate = motion.rate;
  const BodyView body(actor);
  for (const Camera& camera : CamerasFor(views)) {
    const std::vector<Vector2d> rays = PixelRays(camera);
    const std::string item = name + "_" + camera.name;
    DepthView view;
    view.camera = camera;
    view.files.push_back(folder / (item + ".png"));
    view.time_s.push_back(0.0);
    const DepthImage image = SimulateDepth(body.Depth(motion, 0, camera, rays), {}, camera, rays, SensorOf(noise),
                                           static_cast<std::int64_t>(seed), item);
    if (Status written = WriteDepthImage(image, view.files.back()); !written) return Forward(written);
    clip.evidence.depth_views.push_back(std::move(view));
  }
  return clip;
}

/// A heading for a pose before so many cameras.
double YawBefore(int views, Faces faces, Random random) {
  const double drawn = random.Uniform(-1.0, 1.0);
  const double between = views == 2 ? kPi / 3.0 : 0.0;  // the middle of both cameras
  return faces == Faces::kAway || (faces == Faces::kCamera && views == 1) ? between + kFrontish * drawn : kPi * drawn;
}

/// Every second actor has a skin.
std::vector<Actor> Actors(std::uint64_t seed, const BodyTemplate& body) {
  StudioOptions studio;
  studio.seed = static_cast<std::int64_t>(seed);
  const auto skins = ActorsOf(studio, kBodies / 2, &body);
  const auto capsules = ActorsOf(studio, kBodies / 2, nullptr);
  std::vector<Actor> actors;
  for (std::size_t i = 0; i < kBodies / 2; ++i) actors.push_back((*skins)[i]), actors.push_back((*capsules)[i]);
  return actors;
}

struct Wanted {
  std::uint64_t seed = 101;
  std::filesystem::path folder;
  std::string pose;
  std::string body = "standing";
  bool facing = false;
  std::vector<int> views;
  std::vector<bool> noise;
};

/// The bones of an actor as the fitter knows them before it sees stills.
Expected<BodyFromClouds> BodyOf(const Actor& actor, const std::string& person, bool noise, const Wanted& wanted,
                                PointCloudOptions options) {
  BodyFromClouds body;
  body.skeleton = actor.skeleton;
  body.bone_length = actor.subject.bone_length;
  if (wanted.body != "standing") return body;
  std::vector<Clip> clips;
  for (const HardPose& pose : StandingPoses()) {
    const std::string name = person + "_" + pose.name + "_n" + (noise ? "1" : "0");
    const Motion motion = PosedActor(actor, pose, 0.0, kVariation, Random(wanted.seed, "hard still", name));
    auto clip = Record(actor, motion, 3, noise, wanted.seed, wanted.folder, name);
    if (!clip) return Forward(clip);
    clips.push_back(*std::move(clip));
  }
  options.start.facing = 0.0;
  options.start.posture = StartPosture::kStanding;
  auto measured = MeasureBodyInClouds(clips, *LoadSkeleton("smpl24"), options);
  if (!measured) return Forward(measured);
  double square = 0.0;
  for (std::size_t j = 1; j < body.bone_length.size(); ++j)
    square += std::pow(measured->bone_length[j] - body.bone_length[j], 2.0);
  std::fprintf(stderr, "%s, noise %d: bones %.1f mm off, RMS\n", person.c_str(), noise ? 1 : 0,
               1e3 * std::sqrt(square / static_cast<double>(body.bone_length.size() - 1)));
  return measured;
}

class HardStills {
 public:
  HardStills(const Wanted& wanted, const PointCloudOptions& options, benchmarks::ClipLines& lines)
      : wanted_(wanted), options_(options), lines_(lines) {}

  /// All wanted stills of an actor. Errors of images that cannot be written, and of the measured body.
  Status AddActor(const Actor& actor, const std::string& person) {
    for (const bool noise : wanted_.noise) {
      const auto body = BodyOf(actor, person, noise, wanted_, options_);
      if (!body) return Forward(body);
      for (const HardPose& pose : HardPoses()) {
        if (!wanted_.pose.empty() && wanted_.pose != pose.name) continue;
        for (const int views : wanted_.views) {
          if (Status added = AddStill(actor, person, *body, pose, views, noise); !added) return added;
        }
      }
    }
    return {};
  }

  /// Whether there were any stills.
  bool Print() {
    for (const auto& [pose, tally] : by_pose_)
      std::fprintf(stderr, "%-24s %s\n", pose.c_str(), tally.Figures().dump().c_str());
    for (int views = 1; views <= kMostViews + 1; ++views) {  // all numbers of views last
      std::array<Tally, 3>& tallies = by_views_[views <= kMostViews ? views : 0];
      if (tallies[2].stills == 0) continue;
      Json line = {{"name", "hard_stills"}, {"views", views <= kMostViews ? Json(views) : Json("all")}};
      line.update(tallies[2].Figures());
      if (wanted_.noise.size() > 1) {
        line["without_noise"] = tallies[0].Figures();
        line["with_noise"] = tallies[1].Figures();
      }
      if (views > kMostViews) line["cpu_s_per_still"] = std::round(1e3 * seconds_ / tallies[2].stills) / 1e3;
      std::printf("%s\n", line.dump().c_str());
    }
    return by_views_[0][2].stills > 0;
  }

 private:
  Status AddStill(const Actor& actor, const std::string& person, const BodyFromClouds& body, const HardPose& pose,
                  int views, bool noise) {
    const std::string of_pose = person + "_" + pose.name, of_views = of_pose + "_v" + std::to_string(views);
    const std::string name = of_views + "_n" + (noise ? "1" : "0");
    const double yaw = YawBefore(views, pose.faces, Random(wanted_.seed, "hard still heading", of_views));
    const Motion truth = PosedActor(actor, pose, yaw, kVariation, Random(wanted_.seed, "hard still", of_pose));
    const auto clip = Record(actor, truth, views, noise, wanted_.seed, wanted_.folder, name);
    if (!clip) return Forward(clip);
    PointCloudOptions options = options_;
    if (wanted_.facing && pose.faces != Faces::kNowhere) options.start.facing = HeadingOf(truth, 0);
    const std::clock_t begin = std::clock();
    const auto fit = Fit(*clip, body, options);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    seconds_ += seconds;
    const std::array<Tally*, 5> tallies = {&by_views_[views][noise ? 1 : 0], &by_views_[views][2],
                                           &by_views_[0][noise ? 1 : 0], &by_views_[0][2], &by_pose_[pose.name]};
    if (!fit || fit->motion.position_cov.empty()) {
      for (Tally* tally : tallies) tally->AddFailed();
      std::fprintf(stderr, "%-48s %s\n", name.c_str(), fit ? "no covariance" : fit.error().Message().c_str());
      lines_.Add(name, person, "clouds", {{"failed", 1}});
      return {};
    }
    const StillError error = Compare(*fit, truth);
    for (Tally* tally : tallies) tally->Add(error);
    std::string codes;
    for (const Finding& finding : fit->findings) codes += " " + finding.code + " " + RoundedText(finding.value, 2);
    std::fprintf(stderr,
                 "%-48s %6.1f mm, sigma %5.1f; sides exchanged %6.1f mm, pelvis %3.0f deg, trunk %3.0f deg; residual "
                 "%4.1f mm, %.1f s%s\n",
                 name.c_str(), 1e3 * error.joints, 1e3 * error.sigma, 1e3 * error.exchanged, kDegrees * error.pelvis,
                 kDegrees * error.trunk, 1e3 * fit->residual_rms, seconds, codes.c_str());
    const Json figures = {{"joint_mm", 1e3 * error.joints},         {"sigma_mm", 1e3 * error.sigma},
                          {"ambiguous", error.ambiguous ? 1 : 0},   {"exchanged_mm", 1e3 * error.exchanged},
                          {"pelvis_deg", kDegrees * error.pelvis},  {"trunk_deg", kDegrees * error.trunk},
                          {"residual_mm", 1e3 * fit->residual_rms}, {"frames_per_s", 1.0 / seconds}};
    lines_.Add(name, person, "clouds", figures, benchmarks::OutcomeOf(*fit));
    return {};
  }

  Expected<FitResult> Fit(const Clip& clip, BodyFromClouds body, const PointCloudOptions& options) const {
    if (wanted_.body == "still") {
      auto measured = MeasureBodyInClouds({clip}, *LoadSkeleton("smpl24"), options);
      if (!measured) return Forward(measured);
      body = *std::move(measured);
    }
    auto clouds = FuseClip(clip, options);
    if (!clouds) return Forward(clouds);
    return FitFusedClouds(*std::move(clouds), {clip.rate, {0.0}}, body.skeleton, body.bone_length, options);
  }

  const Wanted& wanted_;
  const PointCloudOptions& options_;
  benchmarks::ClipLines& lines_;
  std::map<int, std::array<Tally, 3>> by_views_;  ///< 0: all; of each: without noise, with noise, both
  std::map<std::string, Tally> by_pose_;
  double seconds_ = 0.0;
};

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  Wanted wanted;
  const int bodies = argc > 1 ? std::atoi(argv[1]) : kBodies;
  if (argc > 2) wanted.seed = static_cast<std::uint64_t>(std::atoll(argv[2]));
  wanted.folder = argc > 3 ? argv[3] : "/tmp/bench_hard_stills";
  std::map<std::string, double> given = GivenNumbers(argc, argv, kFirstOption);
  wanted.pose = GivenText(argc, argv, kFirstOption, "pose");
  if (given.count("body") != 0) wanted.body = GivenText(argc, argv, kFirstOption, "body");
  wanted.facing = given["facing"] != 0.0;
  for (int views = 1; views <= kMostViews; ++views) {
    if (given.count("views") == 0 || views == static_cast<int>(given["views"])) wanted.views.push_back(views);
  }
  for (const bool noise : {false, true}) {
    if (given.count("noise") == 0 || noise == (given["noise"] != 0.0)) wanted.noise.push_back(noise);
  }
  if (wanted.body != "standing" && wanted.body != "still" && wanted.body != "known")
    return std::fprintf(stderr, "body=%s: not standing, still or known\n", wanted.body.c_str()), 2;
  PointCloudOptions options = benchmarks::OptionsWithout().point_clouds;
  options.solver = PoseSolver::kBanded;
  const char* data = std::getenv("MOCURATE_DATA");
  const auto body = ReadBodyTemplate(std::filesystem::path(data != nullptr ? data : "") / "body_cc0/body_cc0.h5");
  if (!body) return std::fprintf(stderr, "no body: set MOCURATE_DATA\n"), 2;
  std::filesystem::create_directories(wanted.folder);
  const std::vector<Actor> actors = Actors(wanted.seed, *body);
  benchmarks::ClipLines lines(argc, argv);
  HardStills stills(wanted, options, lines);
  const int first = given.count("first") != 0 ? static_cast<int>(given["first"]) : 1;
  for (int b = std::max(1, first); b < first + bodies && b <= kBodies; ++b) {
    const std::string person = "s" + std::to_string(wanted.seed) + "_p" + std::to_string(b);
    if (Status added = stills.AddActor(actors[static_cast<std::size_t>(b - 1)], person); !added)
      return std::fprintf(stderr, "%s: %s\n", person.c_str(), added.error().Message().c_str()), 1;
  }
  if (!stills.Print()) return std::fprintf(stderr, "no still of that pose, body and number of views\n"), 2;
}
