#include "fitting/clouds/cloud_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace mocurate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kHeadings = 8;                                   ///< tried, evenly around
constexpr std::array<double, 3> kArmsDown = {1.3, 0.2, -1.0};  ///< rad from the T-pose
constexpr int kCoarsePoints = 500;
constexpr int kCoarseIterations = 12;
constexpr double kWidening = 2.0;
constexpr int kFinalists = 4;
constexpr double kSameHeading = 0.6;  ///< rad; finalists face further apart

/// Every n-th point, so that about `count` are left.
FusedCloud Coarse(const FusedCloud& cloud, int count) {
  const int step = std::max(1, cloud.size() / count);
  const int size = (cloud.size() + step - 1) / step;
  FusedCloud coarse{Eigen::Matrix3Xd(3, size), Eigen::Matrix3Xd(3, size), 0};
  for (int i = 0; i < size; ++i) {
    coarse.points.col(i) = cloud.points.col(static_cast<Eigen::Index>(i) * step);
    coarse.normals.col(i) = cloud.normals.col(static_cast<Eigen::Index>(i) * step);
  }
  return coarse;
}

/// Upright, facing `heading` about y, arms lowered; amid the points.
void StartPose(const FleshBody& body, const FusedCloud& cloud, int frame, double heading, double arms_down,
               PoseState& state) {
  std::fill(state.translation(frame), state.rotation(frame, 0), 0.0);
  for (int j = 0; j < state.joints(); ++j) Eigen::Map<Vector3d>(state.rotation(frame, j)).setZero();
  state.rotation(frame, 0)[1] = heading;
  if (const auto shoulders = body.skeleton->Shoulders()) {
    state.rotation(frame, (*shoulders)[0])[2] = -arms_down;
    state.rotation(frame, (*shoulders)[1])[2] = arms_down;
  }
  state.Update(frame, frame + 1, false);
  const HeightSpan of_body = HeightOf(body, state, frame);
  const HeightSpan of_cloud = HeightOf(cloud.points);
  const Vector3d centre = cloud.points.rowwise().mean();
  const double up = 0.5 * (of_cloud.low + of_cloud.high - of_body.low - of_body.high);
  Eigen::Map<Vector3d>(state.translation(frame)) = Vector3d(centre.x(), up, centre.z());
}

struct Candidate {
  double cost = 0.0;
  double heading = 0.0;
  std::vector<double> parameters;
};

/// Where the pose in the state faces about y.
double HeadingOf(const PoseState& state, int frame) {
  const Vector3d front = state.global(frame, 0).col(2);
  return std::atan2(front.x(), front.z());
}

Status Refine(const FleshBody& body, const FusedCloud& cloud, const FrameFit& fit, const PointCloudOptions& options,
              PoseState& state, Candidate& candidate) {
  const auto fitted = FitCloudFrame(body, cloud, fit, state, options);
  if (!fitted) return Forward(fitted);
  candidate.cost = PoseCost(body, cloud, state, fit.frame, options);
  candidate.heading = HeadingOf(state, fit.frame);
  candidate.parameters = state.FrameParameters(fit.frame);
  return {};
}

/// The cheapest ones that face in different directions.
std::vector<Candidate> Finalists(std::vector<Candidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  std::vector<Candidate> finalists;
  for (Candidate& candidate : candidates) {
    const bool is_new = std::none_of(finalists.begin(), finalists.end(), [&](const Candidate& other) {
      return std::abs(std::remainder(candidate.heading - other.heading, 2.0 * kPi)) < kSameHeading;
    });
    if (is_new && finalists.size() < kFinalists) finalists.push_back(std::move(candidate));
  }
  return finalists;
}

}  // namespace

HeightSpan HeightOf(const Eigen::Matrix3Xd& points) {
  std::vector<double> y(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) y[i] = points(1, i);
  std::sort(y.begin(), y.end());
  const std::size_t stray = y.size() / 2000;
  return {y[stray], y[y.size() - 1 - stray]};
}

HeightSpan HeightOf(const FleshBody& body, const PoseState& state, int frame) {
  HeightSpan span{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const FleshCapsule& capsule : body.capsules) {
    const CapsuleEnds ends = EndsOf(capsule, state, frame);
    span.low = std::min({span.low, ends.begin.y() - capsule.radius, ends.end.y() - capsule.radius});
    span.high = std::max({span.high, ends.begin.y() + capsule.radius, ends.end.y() + capsule.radius});
  }
  return span;
}

Status FindStart(const FleshBody& body, const FusedCloud& cloud, int frame, const PointCloudOptions& options,
                 PoseState& state) {
  const FusedCloud coarse = Coarse(cloud, kCoarsePoints);
  std::vector<Candidate> candidates;
  for (int h = 0; h < kHeadings; ++h) {
    for (const double arms_down : kArmsDown) {
      StartPose(body, cloud, frame, 2.0 * kPi * h / kHeadings, arms_down, state);
      candidates.emplace_back();
      const FrameFit fit{frame, std::nullopt, kWidening, kCoarseIterations};
      if (Status fitted = Refine(body, coarse, fit, options, state, candidates.back()); !fitted) return fitted;
    }
  }
  std::vector<Candidate> finalists = Finalists(std::move(candidates));
  for (Candidate& finalist : finalists) {
    state.SetFrameParameters(frame, finalist.parameters);
    const FrameFit fit{frame, std::nullopt, 1.0, static_cast<int>(options.iterations)};
    if (Status fitted = Refine(body, cloud, fit, options, state, finalist); !fitted) return fitted;
  }
  const auto best = std::min_element(finalists.begin(), finalists.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  state.SetFrameParameters(frame, best->parameters);
  state.Update(frame, frame + 1, false);
  return {};
}

}  // namespace mocurate
