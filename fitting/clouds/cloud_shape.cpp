#include "fitting/clouds/cloud_shape.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/body/bone_capsules.h"
#include "core/body/capsule_body.h"
#include "core/geometry/rotation.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_terms.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

constexpr int kUnknowns = 1 + kShapeComponents;  ///< logarithm of the scale, then the shape (numerical)
constexpr int kShapeRounds = 10;                 ///< Gauss-Newton steps, at most (numerical)
constexpr double kSettledStep = 0.02;            ///< standard deviations; shorter steps end the search (numerical)
constexpr double kLongestStep = 1.0;             ///< standard deviations per round, at most (numerical)
constexpr double kLargestScaling = 0.05;         ///< log scale; largest change per round (numerical)
constexpr double kShapeSigma = 0.01;             ///< m; error of capsules with the right shape
constexpr double kErrorsShared = 0.25;           ///< weight: capsules of a limb share shape errors
/// Standard deviations and log scale; step of finite differences (numerical).
constexpr double kTinyStep = 1e-3;

using ShapeUnknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Information = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// A body of one size and shape, posed in one cloud after another.
struct Figure {
  SkeletonPtr skeleton;
  CapsuleBody body;
  PoseState state;

  Figure(const SkeletonPtr& rest, double scale, const BodyShape& shape, int frames)
      : skeleton(WithShape(rest, shape)),
        body(CapsuleBody::Make(skeleton, scale)),
        state(*skeleton, frames, Lengths(scale), body.MovingJoints()) {}

  std::vector<double> Lengths(double scale) const {
    std::vector<double> lengths = skeleton->RestBoneLengths();
    for (double& length : lengths) length *= scale;
    return lengths;
  }
};

/// Rows of the points of one frame, in order; derivatives by its pose where there are `columns`.
struct PointRows {
  const PoseState& state;
  int frame;
  const PoseColumns* columns;
  std::vector<double> r{};
  std::vector<double> root{};  ///< of the slopes of their losses
  std::vector<Eigen::RowVectorXd> by_pose{};

  void operator()(const BodyRows<1>& rows) {
    r.push_back(rows.r[0]);
    root.push_back(std::sqrt(rows.Slope()));
    if (columns == nullptr) return;
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(columns->size());
    row.head<3>() = rows.a.head<3>();
    const auto add_rotation = [&](int joint) {
      if (columns->of(joint) >= 0) row.segment<3>(columns->of(joint)) = rows.a * TwistOf(state, frame, joint);
    };
    for (const int joint : state.path(rows.carrier)) add_rotation(joint);
    add_rotation(rows.carrier);
    by_pose.push_back(std::move(row));
  }
  template <class Others>
  void operator()(const Others&) {}
};

class ShapeFit {
 public:
  ShapeFit(const std::vector<FusedCloud>& clouds, SkeletonPtr skeleton, ShapedPerson person,
           const PointCloudOptions& options)
      : clouds_(clouds), skeleton_(std::move(skeleton)), options_(options), person_(std::move(person)) {}

  /// One round; returns the length of its step, in standard deviations.
  Expected<double> Step() {
    Figure figure = At(ShapeUnknowns::Zero(), static_cast<int>(clouds_.size()));
    Information information = Information::Zero();
    ShapeUnknowns right = ShapeUnknowns::Zero();
    for (int f = 0; f < static_cast<int>(clouds_.size()); ++f) {
      if (Status on = StopIfInterrupted("shape of a person in depth views"); !on) return Forward(on);
      figure.state.SetFrameParameters(f, person_.poses[f]);
      const FrameFit fit = FitOf(f, options_);
      const auto fitted = FitCloudFrame(figure.body, clouds_[f], fit, figure.state, options_);
      if (!fitted) return Forward(fitted);
      person_.poses[f] = figure.state.FrameParameters(f);
      AddFrame(f, figure, information, right);
    }
    information *= kErrorsShared / static_cast<double>(clouds_.size());
    right *= kErrorsShared / static_cast<double>(clouds_.size());
    information(0, 0) += 1.0 / Square(person_.scale_sigma);
    right[0] -= moved_ / Square(person_.scale_sigma);
    for (int k = 0; k < kShapeComponents; ++k) {
      information(1 + k, 1 + k) += 1.0;
      right[1 + k] -= person_.shape[k];
    }
    ShapeUnknowns step = information.ldlt().solve(right);
    const double longest = step.tail<kShapeComponents>().cwiseAbs().maxCoeff();
    if (longest > kLongestStep) step *= kLongestStep / longest;
    if (std::abs(step[0]) > kLargestScaling) step *= kLargestScaling / std::abs(step[0]);
    person_.scale *= std::exp(step[0]);
    moved_ += step[0];
    for (int k = 0; k < kShapeComponents; ++k) person_.shape[k] += step[1 + k];
    return std::max(step.tail<kShapeComponents>().cwiseAbs().maxCoeff(), std::abs(step[0]) / person_.scale_sigma);
  }

  const ShapedPerson& person() const { return person_; }

 private:
  Figure At(const ShapeUnknowns& change, int frames) const {
    BodyShape shape = person_.shape;
    for (int k = 0; k < kShapeComponents; ++k) shape[k] += change[1 + k];
    return {skeleton_, person_.scale * std::exp(change[0]), shape, frames};
  }

  /// Adds a frame to the Gauss-Newton system, with its pose eliminated.
  void AddFrame(int f, Figure& figure, Information& information, ShapeUnknowns& right) const {
    const FusedCloud& cloud = clouds_[f];
    figure.state.Update(f, f + 1, true);
    FrameFit fit;
    fit.frame = f;
    PoseTerms terms = CloudTerms(figure.body, options_);
    std::vector<CloudMatch> matches = MatchPoints(figure.body, figure.state, f, cloud, options_.max_distance);
    const double sigma = std::max(kShapeSigma, RobustSigma(matches));
    terms.frames = {TermsOfFit(figure.body, cloud, fit, std::move(matches), sigma, options_)};
    PoseEquations pose(figure.state);
    BlockTridiagonal equations(1, pose.columns().size());
    pose.Linearise(terms, figure.state, equations);
    PointRows here{figure.state, f, &pose.columns()};
    VisitFrame<true>(terms, figure.state, 0, here);
    const auto count = static_cast<Eigen::Index>(here.r.size());
    Eigen::MatrixXd by_pose(count, pose.columns().size());
    Eigen::VectorXd residual = Eigen::Map<const Eigen::VectorXd>(here.r.data(), count);
    Eigen::MatrixXd by_shape(count, kUnknowns);
    for (int k = 0; k < kUnknowns; ++k) {
      ShapeUnknowns change = ShapeUnknowns::Zero();
      change[k] = kTinyStep;
      Figure other = At(change, 1);
      other.state.SetFrameParameters(0, figure.state.FrameParameters(f));
      other.state.Update(0, 1, false);
      PoseTerms moved = terms;
      moved.body = &other.body;
      moved.frames.front().frame = 0;
      PointRows there{other.state, 0, nullptr};
      VisitFrame<false>(moved, other.state, 0, there);
      by_shape.col(k) = (Eigen::Map<const Eigen::VectorXd>(there.r.data(), count) - residual) / kTinyStep;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const double root = here.root[static_cast<std::size_t>(i)];
      residual[i] *= root;
      by_pose.row(i) = root * here.by_pose[static_cast<std::size_t>(i)];
      by_shape.row(i) *= root;
    }
    const Eigen::MatrixXd cross = by_pose.transpose() * by_shape;
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(equations.Diagonal(0));
    if (factor.info() != Eigen::Success) return;  // the pose is undetermined: the frame adds nothing
    information += by_shape.transpose() * by_shape - cross.transpose() * factor.solve(cross);
    right -= by_shape.transpose() * residual - cross.transpose() * factor.solve(equations.Gradient(0));
  }

  const std::vector<FusedCloud>& clouds_;
  SkeletonPtr skeleton_;
  const PointCloudOptions& options_;
  ShapedPerson person_;
  double moved_ = 0.0;  ///< logarithm of the scale, relative to the initial one
};

}  // namespace

SkeletonPtr WithShape(const SkeletonPtr& skeleton, const BodyShape& shape) {
  if (shape == BodyShape{} || !HasTemplateShape(*skeleton)) return skeleton;
  auto own = std::make_shared<Skeleton>(*skeleton);
  for (Joint& joint : own->joints) {
    if (joint.parent >= 0) joint.rest_offset += OffsetChange(joint.name, shape);
  }
  own->shape = shape;
  return own;
}

Expected<ShapedPerson> FitShape(const std::vector<FusedCloud>& clouds, const SkeletonPtr& skeleton, ShapedPerson person,
                                const PointCloudOptions& options) {
  ShapeFit fit(clouds, skeleton, std::move(person), options);
  for (int round = 0; round < kShapeRounds; ++round) {
    const Expected<double> step = fit.Step();
    if (!step) return Forward(step);
    if (*step < kSettledStep) break;
  }
  return fit.person();
}

}  // namespace mocurate
