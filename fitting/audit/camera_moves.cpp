#include "fitting/audit/camera_moves.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {
namespace {

constexpr int kIterations = 20;                ///< Gauss-Newton steps, at most (numerical)
constexpr std::size_t kLeastDetections = 100;  ///< detections for a refit, at least
constexpr double kHuber = 10.0;                ///< px; scale of Huber's loss
constexpr double kNearest = 1e-3;              ///< m in front of the camera, at least (numerical)

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Detection {
  Vector3d point;       ///< world
  Vector2d normalised;  ///< at depth 1
  double weight = 0.0;
};

Vector2d ErrorOf(const Camera& camera, const RigidTransform& pose, const Detection& seen, Vector3d& at) {
  at = pose * seen.point;
  const Vector2d off = at.head<2>() / at.z() - seen.normalised;
  return {camera.fx * off.x(), camera.fy * off.y()};
}

double MedianErrorOfPose(const Camera& camera, const RigidTransform& pose, const std::vector<Detection>& detections) {
  std::vector<double> errors;
  Vector3d at;
  for (const Detection& seen : detections) {
    const Vector2d error = ErrorOf(camera, pose, seen, at);
    errors.push_back(at.z() > kNearest ? error.norm() : 1e6);
  }
  return MeanMedian(errors);
}

/// The camera with the pose that minimises the distances of its detections from the other views' points (Gauss-Newton
/// on the six numbers, Huber at 10 px, lens and focal length as calibrated). Empty with fewer than 100 detections of
/// such points, or where the median distance does not fall below `improved` times the previous one.
std::optional<Camera> RefitCamera(const ViewKeypoints& view, const TriangulatedTracks& points, double improved) {
  std::vector<Detection> detections;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
    const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * i);
    detections.push_back({point, view.normalised[i], view.confidence[i]});
  }
  if (detections.size() < kLeastDetections) return {};
  Camera refit = view.camera;
  RigidTransform& pose = refit.camera_from_world;
  const double before_px = MedianErrorOfPose(view.camera, pose, detections);
  for (int i = 0; i < kIterations; ++i) {
    Matrix6 normal = Matrix6::Identity() * 1e-9;
    Vector6 gradient = Vector6::Zero();
    for (const Detection& seen : detections) {
      Vector3d at;
      const Vector2d error = ErrorOf(view.camera, pose, seen, at);
      if (at.z() < kNearest) continue;
      Eigen::Matrix<double, 2, 3> slope;
      slope << view.camera.fx / at.z(), 0.0, -view.camera.fx * at.x() / (at.z() * at.z()),  //
          0.0, view.camera.fy / at.z(), -view.camera.fy * at.y() / (at.z() * at.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << -slope * Hat(at), slope;  // rotation about the camera's axes, then translation
      const double weight = seen.weight * std::min(1.0, kHuber / std::max(error.norm(), 1e-9));
      normal += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * error;
    }
    const Vector6 step = -normal.ldlt().solve(gradient);
    if (!step.allFinite()) return {};
    const Quaterniond rotation_step = ExpQuaternion(step.head<3>());
    pose.rotation = (rotation_step * pose.rotation).normalized();
    pose.translation = rotation_step * pose.translation + step.tail<3>();
    if (step.norm() < 1e-9) break;
  }
  if (!(MedianErrorOfPose(view.camera, pose, detections) < improved * before_px)) return {};
  return refit;
}

constexpr std::size_t kLeastViewsOfMove = 4;  ///< views that a rig must have: three must keep their pose (numerical)
constexpr double kImproved = 0.75;            ///< of the median error before the refit of a moved camera, at most
constexpr int kLeastMomentsOfPart = 5;        ///< moments of a part, at least
constexpr int kLeastDetectionsOfMoment = 6;   ///< detections of a moment, at least
/// Factor that splitting a take into two parts must save in absolute deviation, beside the noise.
constexpr double kPartPenalty = 1.1;
constexpr double kJumpPenalty = 1.02;  ///< factor on the cost of two parts: a jump must explain more than one pose does
constexpr double kUnchanged = 1e-9;    ///< px; difference of a moment's cost that counts as none (numerical)

/// Median pixel error of each moment, axis by axis; NaN with too few detections.
std::vector<Vector2d> MedianErrors(const ViewKeypoints& view, const TriangulatedTracks& points) {
  const auto keypoints = static_cast<std::size_t>(points.positions.joints);
  std::vector<Vector2d> medians;
  std::vector<double> u;
  std::vector<double> v;
  for (int m = 0; m < points.positions.frames; ++m) {
    u.clear();
    v.clear();
    for (std::size_t i = m * keypoints; i < (m + 1) * keypoints; ++i) {
      if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
      const Vector2d error = PixelError(view, i, Eigen::Map<const Vector3d>(points.positions.xyz.data() + 3 * i));
      u.push_back(error.x());
      v.push_back(error.y());
    }
    const bool enough = u.size() >= kLeastDetectionsOfMoment;
    medians.emplace_back(enough ? MeanMedian(u) : std::nan(""), enough ? MeanMedian(v) : std::nan(""));
  }
  return medians;
}

/// Sum of the distances of moments [begin, end) from their median, px.
double SumOfDeviations(const std::vector<Vector2d>& errors, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> values;
    for (std::size_t i = begin; i < end; ++i) {
      if (std::isfinite(errors[i][axis])) values.push_back(errors[i][axis]);
    }
    const double median = MeanMedian(values);
    for (const double value : values) sum += std::abs(value - median);
  }
  return sum;
}

/// First moment of the second part, where the errors jump; 0 without a jump.
std::size_t Jump(const std::vector<Vector2d>& errors, double noise_px) {
  const double whole = SumOfDeviations(errors, 0, errors.size());
  double least = whole / kPartPenalty - noise_px;
  std::size_t best = 0;
  for (std::size_t i = kLeastMomentsOfPart; i + kLeastMomentsOfPart <= errors.size(); ++i) {
    const double parts = SumOfDeviations(errors, 0, i) + SumOfDeviations(errors, i, errors.size());
    if (parts >= least) continue;
    least = parts;
    best = i;
  }
  return best;
}

ViewKeypoints Only(const ViewKeypoints& view, std::size_t begin, std::size_t end) {
  ViewKeypoints part = view;
  for (std::size_t i = 0; i < part.confidence.size(); ++i) {
    if (i < begin || i >= end) part.confidence[i] = 0.0;
  }
  return part;
}

double MedianErrorOfView(const ViewKeypoints& view, const TriangulatedTracks& points) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
    errors.push_back(PixelError(view, i, Eigen::Map<const Vector3d>(points.positions.xyz.data() + 3 * i)).norm());
  }
  return MeanMedian(errors);
}

/// The camera refitted in one or two parts to the points of the other views.
std::optional<CameraMove> Refitted(const RigSamples& samples, const RigModel& model, std::size_t view,
                                   const ViewKeypoints& seen, const TriangulatedTracks& points, std::size_t jump) {
  const auto keypoints = static_cast<std::size_t>(samples.keypoints());
  const std::size_t all = seen.confidence.size();
  CameraMove move{view, model.camera[view], model, {}, {}, {}, 1.0};
  if (jump > 0) {
    CameraPart later = move.camera[0];
    later.from_s = 0.5 * (samples.moments()[jump - 1].time_s + samples.moments()[jump].time_s);
    move.camera.push_back(later);
  }
  bool any = false;
  for (std::size_t part = 0; part < move.camera.size(); ++part) {
    const std::size_t begin = part == 0 ? 0 : jump * keypoints;
    const std::size_t end = part + 1 < move.camera.size() ? jump * keypoints : all;
    const auto refit = RefitCamera(Only(seen, begin, end), points, kImproved);
    if (!refit) continue;
    any = true;
    move.camera[part].camera = *refit;
  }
  if (!any) return {};
  move.model.camera[view] = move.camera;
  return move;
}

/// Some moments leave a gap in which they cannot locate a jump: there, the camera keeps its given pose, if it has it in
/// one of its two parts.
void KeepPoseInGap(const RigSamples& some, const Camera& given, std::vector<CameraPart>& parts) {
  const auto later = std::find_if(some.moments().begin(), some.moments().end(),
                                  [&](const RigMoment& moment) { return moment.time_s >= parts[1].from_s; });
  if (HaveSamePose(parts[0].camera, given)) {
    parts[1].from_s = later->time_s;
  } else if (HaveSamePose(parts[1].camera, given)) {
    parts[1].from_s = std::nextafter((later - 1)->time_s, later->time_s);
  }
}

/// Points triangulated from the other views.
TriangulatedTracks PointsWithout(const RigSamples& frames, const RigModel& model, std::size_t view,
                                 const TriangulationOptions& options) {
  std::vector<ViewKeypoints> rest;
  std::vector<std::size_t> view_of;
  const std::vector<ViewKeypoints> all = frames.Views(model, &view_of);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (view_of[i] != view) rest.push_back(all[i]);
  }
  return TriangulateViews(rest, frames.count(), frames.keypoints(), options);
}

}  // namespace

ObservedMove MoveAtPoints(const Camera& was, const Camera& is, const TriangulatedTracks& points) {
  std::vector<double> px, m;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0) continue;
    const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * i);
    const Vector3d before = was.camera_from_world * point, after = is.camera_from_world * point;
    if (before.z() <= 0.0 || after.z() <= 0.0) continue;
    const double off = (before.head<2>() / before.z() - after.head<2>() / after.z()).norm();
    px.push_back(is.fx * off);
    m.push_back(after.z() * off);
  }
  return {MeanMedian(px), MeanMedian(m)};
}

double ConfidenceOfMove(const RigSamples& samples, const std::vector<CameraPart>& parts,
                        const std::vector<double>& worse, const std::vector<double>& better) {
  const std::vector<int> halves = HalvesOf(worse.size());
  double best = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::vector<double> before, after;
    bool changed[2] = {false, false};
    for (std::size_t i = 0; i < worse.size(); ++i) {
      const double time = samples.moments()[i].time_s;
      if (time < parts[p].from_s || (p + 1 < parts.size() && time >= parts[p + 1].from_s)) continue;
      if (std::abs(worse[i] - better[i]) <= kUnchanged) continue;
      changed[halves[i]] = true;
      before.push_back(worse[i]);
      after.push_back(better[i]);
    }
    if (changed[0] && changed[1]) best = std::max(best, Confidence(before, after));
  }
  return ConfidenceOfTests(best, parts.size());
}

std::optional<CameraMove> FindMoveOf(const RigSamples& samples, const RigModel& model, std::size_t view,
                                     const TriangulationOptions& options) {
  const bool few = samples.views() < kLeastViewsAudited || samples.count() < kLeastMomentsOfPart;
  if (few || model.camera[view].size() > 1) return {};
  const ViewKeypoints seen = samples.View(model, view, 0);
  const TriangulatedTracks points = PointsWithout(samples, model, view, options);
  if (MedianErrorOfView(seen, points) <= 0.0) return {};
  std::optional<CameraMove> best;
  const std::vector<std::size_t> jumps{0, Jump(MedianErrors(seen, points), options.noise)};
  for (std::size_t i = 0; i < 2; ++i) {
    if (i == 1 && jumps[1] == 0) continue;
    auto move = Refitted(samples, model, view, seen, points, jumps[i]);
    if (!move) continue;
    move->cost = CostsUnder(samples, move->model, options);
    const double jump = i == 1 ? kJumpPenalty : 1.0;
    if (!best || jump * Sum(move->cost) < Sum(best->cost)) best = std::move(move);
  }
  return best;
}

std::vector<double> HeldOutCostsOfMoves(const RigSamples& samples, const RigModel& model,
                                        const std::vector<std::size_t>& views, const TriangulationOptions& options) {
  return HeldOutCosts(samples, options, [&](const RigSamples& half) {
    RigModel fitted = model;
    for (const std::size_t v : views) {
      auto move = FindMoveOf(half, fitted, v, options);
      if (!move) continue;
      fitted = std::move(move->model);
      if (fitted.camera[v].size() == 2) KeepPoseInGap(half, model.camera[v][0].camera, fitted.camera[v]);
    }
    return fitted;
  });
}

std::optional<CameraMove> FindMove(const RigSamples& samples, const RigModel& model,
                                   const TriangulationOptions& options) {
  if (samples.views() < kLeastViewsOfMove || samples.views() > kMostViewsAudited) return {};
  std::vector<CameraMove> moves;
  for (std::size_t v = 0; v < samples.views(); ++v) {
    auto move = FindMoveOf(samples, model, v, options);
    if (!move) continue;
    move->held_out = HeldOutCostsOfMoves(samples, model, {v}, options);
    moves.push_back(std::move(*move));
  }
  if (moves.empty()) return {};
  const auto best = std::min_element(moves.begin(), moves.end(), [](const CameraMove& a, const CameraMove& b) {
    return Sum(a.held_out) < Sum(b.held_out);
  });
  for (const CameraMove& other : moves) {
    if (other.view == best->view) continue;
    const double beaten = ConfidenceOfMove(samples, best->camera, other.held_out, best->held_out);
    best->confidence = std::min(best->confidence, ConfidenceOfTests(beaten, samples.views() - 1));
    if (beaten < kRivalBeaten) best->rivals.push_back(other.view);
  }
  return std::move(*best);
}

void RefitParts(const RigSamples& frames, std::size_t view, const TriangulationOptions& options, RigModel& model) {
  /// Factor on the median error before a refit, at most: the move is already confirmed.
  constexpr double kAnyBetter = 1.05;
  const TriangulatedTracks points = PointsWithout(frames, model, view, options);
  std::vector<CameraPart>& parts = model.camera[view];
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto refit = RefitCamera(frames.View(model, view, part), points, kAnyBetter);
    if (refit) parts[part].camera = *refit;
  }
}

double WhenMoved(const RigSamples& frames, const RigModel& model, std::size_t view,
                 const TriangulationOptions& options) {
  const TriangulatedTracks points = PointsWithout(frames, model, view, options);
  std::vector<std::vector<double>> cost;
  for (std::size_t part = 0; part < 2; ++part) {
    RigModel alone = model;
    alone.camera[view] = {CameraPart{model.camera[view][part].camera}};
    const std::vector<ViewKeypoints> seen{frames.View(alone, view, 0)};
    cost.push_back(CostOfMoments(seen, points, options.noise));
  }
  double later = 0.0;
  for (const double of_moment : cost[1]) later += of_moment;
  double least = later;
  std::size_t best = 0;
  double sum = later;
  for (std::size_t i = 0; i < cost[0].size(); ++i) {
    sum += cost[0][i] - cost[1][i];
    if (sum >= least) continue;
    least = sum;
    best = i + 1;
  }
  if (best == 0) return frames.moments().front().time_s;
  if (best >= frames.moments().size()) return frames.moments().back().time_s;
  return frames.moments()[best].time_s;
}

namespace {

/// Factor on the noise of a detection: smaller shifts of the image are not reported.
constexpr double kLeastShareOfNoise = 2.0;
constexpr double kGrossShift = 3.0;  ///< times the median shift: larger shifts come from wrong pairs of views

/// Longest distance between two cameras.
double ExtentOf(const RigModel& rig) {
  double extent = 0.0;
  for (const auto& one : rig.camera) {
    for (const auto& other : rig.camera) {
      extent = std::max(extent, (one[0].camera.Centre() - other[0].camera.Centre()).norm());
    }
  }
  return extent;
}

}  // namespace

bool HaveSamePose(const Camera& a, const Camera& b) {
  return a.camera_from_world.translation == b.camera_from_world.translation &&
         a.camera_from_world.rotation.coeffs() == b.camera_from_world.rotation.coeffs();
}

std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model) {
  std::vector<std::size_t> moved;
  for (std::size_t v = 0; v < given.camera.size(); ++v) {
    const std::vector<CameraPart>& parts = model.camera[v];
    const auto stands = [&](const CameraPart& part) { return HaveSamePose(part.camera, given.camera[v][0].camera); };
    if (!std::all_of(parts.begin(), parts.end(), stands)) moved.push_back(v);
  }
  return moved;
}

bool GoesTooFar(const RigModel& given, const CameraMove& move) {
  double moved = 0.0;
  for (const CameraPart& part : move.camera) {
    moved = std::max(moved, (part.camera.Centre() - given.camera[move.view][0].camera.Centre()).norm());
  }
  return moved > ExtentOf(given);
}

bool IsNotableMove(const Camera& was, const std::vector<CameraPart>& parts, const TriangulatedTracks& points,
                   double noise_px) {
  return std::any_of(parts.begin(), parts.end(), [&](const CameraPart& part) {
    const ObservedMove seen = MoveAtPoints(was, part.camera, points);
    return seen.px >= kLeastShareOfNoise * noise_px && seen.m >= kLeastMove;
  });
}

Matrix3d ShiftBetween(const RigSamples& samples, const RigModel& one, const RigModel& other,
                      const TriangulationOptions& options) {
  const auto points = [&](const RigModel& model) {
    return TriangulateViews(samples.Views(model), samples.count(), samples.keypoints(), options);
  };
  const TriangulatedTracks here = points(one);
  const TriangulatedTracks there = points(other);
  std::vector<Vector3d> shifts;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < here.confidence.size(); ++i) {
    if (here.confidence[i] <= 0.0 || there.confidence[i] <= 0.0) continue;
    shifts.emplace_back(Eigen::Map<const Vector3d>(here.positions.xyz.data() + 3 * i) -
                        Eigen::Map<const Vector3d>(there.positions.xyz.data() + 3 * i));
    lengths.push_back(shifts.back().norm());
  }
  const double gross = kGrossShift * MeanMedian(lengths);
  Matrix3d sum = Matrix3d::Zero();
  double count = 0.0;
  for (const Vector3d& shift : shifts) {
    if (shift.norm() > gross) continue;
    sum += shift * shift.transpose();
    count += 1.0;
  }
  return count > 0.0 ? Matrix3d(sum / count) : sum;
}

RigFault DisagreementOf(const std::vector<RigView>& rig, std::vector<std::size_t> views) {
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  std::vector<std::string> names;
  for (const std::size_t v : views) names.push_back(rig[v].camera.camera.name);
  return MakeFault(kContradictingView, JoinTexts(names), 0.0, "views disagree (" + JoinTexts(names) + "):");
}

}  // namespace mocurate
