#include "canon/frames/level.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/heading.h"
#include "core/motion/limbs.h"
#include "core/motion/operations.h"
#include "core/quality/contacts.h"

namespace mocurate {
namespace {

constexpr int kBodySamples = 8;        // sampled frames of a clip for its body axis, evenly spaced
constexpr double kExtendedLeg = 0.95;  // ratio of hip-ankle distance to thigh plus shank, of a standing person
constexpr double kHeightSigma = 0.03;  // metres, of a standing foot's height: a tracker's noise and people's ankles
constexpr double kBodySigma = 0.07;    // radians, of a standing person's axis around the vertical and the common lean
constexpr double kLeanSigma = 0.05;    // radians, prior of the common lean
constexpr int kIterations = 4;         // of rotating by the estimate and solving for the remainder
constexpr double kConverged = 1e-5;    // radians

/// Unknowns: horizontal parts x and z of the up direction, lean, height.
using FloorMatrix = Eigen::Matrix4d;
using FloorRow = Eigen::Vector4d;

struct FloorEquations {
  FloorMatrix matrix = FloorMatrix::Zero();
  FloorRow right = FloorRow::Zero();

  void Add(const FloorRow& row, double value, double sigma, double weight) {
    const double w = weight / (sigma * sigma);
    matrix += w * row * row.transpose();
    right += w * value * row;
  }
};

/// Weight of a residual under Huber's loss at two standard deviations.
double HuberWeight(double residual, double sigma) {
  const double size = std::abs(residual) / sigma;
  return size <= 2.0 ? 1.0 : 2.0 / size;
}

struct UprightSample {
  Vector3d axis;     // ankles to shoulders, unit
  Vector3d forward;  // unit
  double weight;     // the samples of a clip sum to 1
};

struct StandingClip {
  std::vector<Vector3d> feet;  // standing positions, metres
  std::vector<UprightSample> body;
};

/// Positions of a motion in a world rotated by `level_from_world`.
Motion TurnedPlaces(const Motion& motion, const Matrix3d& level_from_world) {
  Motion turned;
  turned.skeleton = motion.skeleton;
  turned.rate = motion.rate;
  turned.joints = motion.joints;
  for (int f = 0; f < turned.joints.frames; ++f) {
    for (int j = 0; j < turned.joints.joints; ++j) turned.joints.at(f, j) = level_from_world * motion.joints.at(f, j);
  }
  return turned;
}

std::vector<Vector3d> PlacesOfFeet(const Motion& motion) {
  std::vector<Vector3d> places;
  for (const int foot : FootJoints(*motion.skeleton)) {
    for (const FrameRun& run : RunsWhere(JointContacts(motion, foot, {}), true)) {
      Vector3d sum = Vector3d::Zero();
      for (int f = run.begin; f < run.end; ++f) sum += motion.joints.at(f, foot);
      places.emplace_back(sum / (run.end - run.begin));
    }
  }
  return places;
}

std::vector<UprightSample> UprightSamples(const Motion& motion) {
  const Limbs limbs = LimbsOf(*motion.skeleton);
  std::vector<UprightSample> samples;
  const auto known = [](const Limb& limb) { return limb.root >= 0 && limb.middle >= 0 && limb.end >= 0; };
  if (!known(limbs.leg[0]) || !known(limbs.leg[1]) || limbs.arm[0].root < 0 || limbs.arm[1].root < 0) return samples;
  std::vector<int> standing;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const bool extended = std::all_of(limbs.leg.begin(), limbs.leg.end(), [&](const Limb& leg) {
      const Vector3d hip = motion.joints.at(f, leg.root), knee = motion.joints.at(f, leg.middle),
                     ankle = motion.joints.at(f, leg.end);
      return (hip - ankle).norm() >= kExtendedLeg * ((hip - knee).norm() + (knee - ankle).norm());
    });
    if (extended) standing.push_back(f);
  }
  const int count = std::min<int>(kBodySamples, static_cast<int>(standing.size()));
  for (int k = 0; k < count; ++k) {
    const int f = standing[static_cast<std::size_t>(k) * standing.size() / static_cast<std::size_t>(count)];
    const auto middle = [&](int a, int b) { return Vector3d(0.5 * (motion.joints.at(f, a) + motion.joints.at(f, b))); };
    const Vector3d axis = middle(limbs.arm[0].root, limbs.arm[1].root) - middle(limbs.leg[0].end, limbs.leg[1].end);
    const auto axes = BodyAxes(motion, f);
    if (!axes || axis.norm() < 1e-3 || axis.y() < 0.5 * axis.norm()) continue;
    samples.push_back({axis.normalized(), axes->col(2), 1.0 / count});
  }
  return samples;
}

/// Solves for the remaining tilt, the lean and the height in a nearly level world, by iteratively reweighted least
/// squares.
struct FloorSolution {
  FloorRow value = FloorRow::Zero();
  FloorMatrix covariance = FloorMatrix::Zero();
};

FloorSolution SolveFloor(const LevelOptions& options, const std::vector<StandingClip>& clips) {
  FloorSolution solution;
  bool first = true;
  for (int pass = 0; pass < 5; ++pass, first = false) {
    FloorEquations equations;
    equations.Add(FloorRow(0, 0, 1, 0), 0.0, kLeanSigma, 1.0);
    double squares = 0.0, weights = 0.0;
    const auto add = [&](const FloorRow& row, double value, double sigma, double weight) {
      const double residual = row.dot(solution.value) - value;
      const double robust = first ? 1.0 : HuberWeight(residual, sigma);
      equations.Add(row, value, sigma, weight * robust);
      squares += weight * robust * residual * residual / (sigma * sigma);
      weights += weight * robust;
    };
    for (const StandingClip& clip : clips) {
      for (const Vector3d& foot : clip.feet) {
        add(FloorRow(foot.x(), foot.z(), 0, -1), -foot.y(), kHeightSigma, 1.0);
      }
      if (options.rule == FloorRule::kHeight) continue;
      for (const UprightSample& body : clip.body) {
        add(FloorRow(1, 0, body.forward.x(), 0), body.axis.x() / body.axis.y(), kBodySigma, body.weight);
        add(FloorRow(0, 1, body.forward.z(), 0), body.axis.z() / body.axis.y(), kBodySigma, body.weight);
      }
    }
    if (options.rule == FloorRule::kHeight) {
      equations.Add(FloorRow(1, 0, 0, 0), 0.0, 1e-9, 1.0);
      equations.Add(FloorRow(0, 1, 0, 0), 0.0, 1e-9, 1.0);
    }
    const Eigen::LDLT<FloorMatrix> factors(equations.matrix);
    solution.value = factors.solve(equations.right);
    const double misfit = first ? 1.0 : std::max(1.0, squares / std::max(1.0, weights));
    solution.covariance = misfit * factors.solve(FloorMatrix::Identity());
  }
  return solution;
}

}  // namespace

double FloorPlane::tilt() const { return std::acos(std::clamp(up.y(), -1.0, 1.0)); }

void to_json(nlohmann::json& json, const FloorPlane& floor) {
  json = {{"up", {floor.up.x(), floor.up.y(), floor.up.z()}},
          {"tilt_deg", floor.tilt() * 180.0 / kPi},
          {"tilt_sigma_deg", floor.tilt_sigma * 180.0 / kPi},
          {"height_m", floor.height},
          {"height_sigma_m", floor.height_sigma},
          {"lean_deg", floor.lean * 180.0 / kPi},
          {"contacts", floor.contacts},
          {"clips", floor.clips}};
}

void from_json(const nlohmann::json& json, FloorPlane& floor) {
  const auto up = json.at("up").get<std::vector<double>>();
  floor.up = Vector3d(up.at(0), up.at(1), up.at(2)).normalized();
  floor.height = json.at("height_m").get<double>();
  floor.tilt_sigma = json.at("tilt_sigma_deg").get<double>() * kPi / 180.0;
}

std::optional<FloorPlane> EstimateFloor(const LevelOptions& options, const std::vector<Motion>& motions) {
  FloorPlane floor;
  FloorSolution solution;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Matrix3d level_from_world = SwingBetween(floor.up, Vector3d::UnitY()).toRotationMatrix();
    std::vector<StandingClip> clips;
    floor.contacts = 0;
    for (const Motion& motion : motions) {
      const Motion turned = TurnedPlaces(motion, level_from_world);
      // For a sensor far from level, feet are found only after a first rotation makes people upright.
      const bool upright_first = iteration == 0 && options.rule == FloorRule::kTilt;
      StandingClip clip{upright_first ? std::vector<Vector3d>() : PlacesOfFeet(turned), UprightSamples(turned)};
      floor.contacts += static_cast<int>(clip.feet.size());
      if (!clip.feet.empty() || !clip.body.empty()) clips.push_back(std::move(clip));
    }
    floor.clips = static_cast<int>(clips.size());
    if (iteration > 0 || options.rule == FloorRule::kHeight) {
      if (floor.contacts == 0) return std::nullopt;
    } else {
      clips.push_back({{Vector3d::Zero()}, {}});  // the height is not estimated yet
    }
    solution = SolveFloor(options, clips);
    const Vector3d up_here = Vector3d(solution.value[0], 1.0, solution.value[1]).normalized();
    floor.up = options.rule == FloorRule::kHeight ? Vector3d(Vector3d::UnitY())
                                                  : Vector3d(level_from_world.transpose() * up_here);
    floor.height = solution.value[3] * up_here.y();
    if (iteration > 1 && std::acos(std::min(1.0, up_here.y())) < kConverged) break;
    if (options.rule == FloorRule::kHeight) break;
  }
  floor.lean = solution.value[2];
  const Eigen::Matrix2d tilt = solution.covariance.topLeftCorner<2, 2>();
  floor.tilt_sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tilt).eigenvalues().maxCoeff());
  floor.height_sigma = std::sqrt(solution.covariance(3, 3));
  return floor;
}

void LevelClip(const FloorPlane& floor, Clip& clip) {
  Transform({SwingBetween(floor.up, Vector3d::UnitY()), Vector3d(0.0, -floor.height, 0.0)}, clip);
  clip.provenance["level.tilt_deg"] = RoundedText(floor.tilt() * 180.0 / kPi, 3);
  clip.provenance["level.sigma_deg"] = RoundedText(floor.tilt_sigma * 180.0 / kPi, 2);
  clip.provenance[kHeightOrigin] = kOriginFloor;
}

}  // namespace mocurate
