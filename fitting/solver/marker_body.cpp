#include "fitting/solver/marker_body.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/rotation.h"
#include "core/motion/kinematics.h"
#include "fitting/solver/joint_track_fit.h"

namespace mocurate {
namespace {

constexpr int kMostFrames = 240;        ///< of all clips; evenly spread
constexpr int kMostRounds = 30;         ///< of poses and body in turn
constexpr int kMostWorse = 3;           ///< rounds without a lower cost, after which they end
constexpr double kSettled = 5e-4;       ///< m; a smaller change of every place and length ends the rounds
constexpr double kSkin = 0.008;         ///< m per axis: markers move with the skin (Leardini et al., 2005: 5 to 20 mm)
constexpr double kIndependent = 20.0;   ///< poses that frames of one person amount to: errors vary slowly
constexpr double kLengthSpread = 0.06;  ///< of a bone, beside the person's scale (ANSUR: 4 to 6 %)
constexpr double kSidesApart = 0.005;   ///< m between the lengths of both sides
constexpr double kScaleSpread = 0.1;    ///< of people
constexpr double kTurnSpread = 0.2;     ///< rad, of the turns that all frames of a joint share
constexpr double kLeastSpread = 1e-3;   ///< m of a marker's place

/// Unknowns: the scale; the length of each bone of the body, three numbers of each marker; a turn of each joint that is
/// the same in all frames, since rotations and places were fitted to each other.
struct Unknowns {
  std::vector<int> of_joint;  ///< (J) first unknown; -1: none
  std::vector<int> of_turn;   ///< (J) first of three; -1: of a marker
  int count = 1;

  explicit Unknowns(const Skeleton& skeleton) {
    for (const Joint& joint : skeleton.joints) {
      of_joint.push_back(joint.parent < 0 ? -1 : count);
      if (joint.parent >= 0) count += joint.landmark ? 3 : 1;
    }
    for (const Joint& joint : skeleton.joints) {
      of_turn.push_back(joint.landmark ? -1 : count);
      if (!joint.landmark) count += 3;
    }
  }

  /// Of a body, without turns.
  Eigen::VectorXd Of(const MarkerBody& body) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
    values[0] = body.scale;
    for (std::size_t j = 1; j < of_joint.size(); ++j) {
      const Joint& joint = body.skeleton->joints[j];
      if (joint.landmark)
        values.segment<3>(of_joint[j]) = joint.rest_offset;
      else
        values[of_joint[j]] = body.bone_length[j];
    }
    return values;
  }
};

/// Takes places, lengths and scale of a solution; returns the largest change, metres.
double Take(const Eigen::VectorXd& solution, const Skeleton& rest, const Unknowns& unknowns, MarkerBody& body) {
  auto own = std::make_shared<Skeleton>(rest);
  double change = 0.0;
  for (int j = 1; j < rest.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    Joint& joint = own->joints[at];
    const int i = unknowns.of_joint[at];
    if (joint.landmark) joint.rest_offset = solution.segment<3>(i);
    const double length = joint.landmark ? joint.rest_offset.norm() : std::max(0.0, solution[i]);
    change = std::max({change, (joint.rest_offset - body.skeleton->joints[at].rest_offset).norm(),
                       std::abs(length - body.bone_length[at])});
    body.bone_length[at] = length;
  }
  body.skeleton = std::move(own);
  body.scale = solution[0];
  return change;
}

/// The normal equations of all priors.
void AddPriors(const Skeleton& rest, const std::vector<double>& place_sigma, const Unknowns& unknowns,
               Eigen::MatrixXd& a, Eigen::VectorXd& b) {
  // Of x_i - scale * mean, of variance sigma^2.
  const auto add = [&](int i, double mean, double sigma) {
    const double w = 1.0 / (sigma * sigma);
    a(i, i) += w;
    a(i, 0) -= w * mean;
    a(0, i) -= w * mean;
    a(0, 0) += w * mean * mean;
  };
  a(0, 0) += 1.0 / (kScaleSpread * kScaleSpread);
  b[0] += 1.0 / (kScaleSpread * kScaleSpread);
  for (const int turn : unknowns.of_turn) {
    for (int k = turn; turn >= 0 && k < turn + 3; ++k) a(k, k) += 1.0 / (kTurnSpread * kTurnSpread);
  }
  for (int j = 1; j < rest.joint_count(); ++j) {
    const Joint& joint = rest.joints[static_cast<std::size_t>(j)];
    const int i = unknowns.of_joint[static_cast<std::size_t>(j)];
    if (joint.landmark) {
      const double sigma = std::max(kLeastSpread, place_sigma[static_cast<std::size_t>(j)]);
      for (int k = 0; k < 3; ++k) add(i + k, joint.rest_offset[k], sigma);
      continue;
    }
    const double length = joint.rest_offset.norm();
    add(i, length, std::max(kLeastSpread, kLengthSpread * length));
    if (joint.mirror <= j) continue;
    const int other = unknowns.of_joint[static_cast<std::size_t>(joint.mirror)];
    const double w = 1.0 / (kSidesApart * kSidesApart);
    a(i, i) += w;
    a(other, other) += w;
    a(i, other) -= w;
    a(other, i) -= w;
  }
}

/// Derivative of a place by some of the unknowns, from the first on.
struct Columns {
  int first = 0;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> values;
};

/// A marker's place in a frame, beside the root, by each unknown that it depends on. `skeleton` has the present places
/// of markers, `lengths` are the present bones.
std::vector<Columns> ColumnsOf(const Skeleton& skeleton, const std::vector<double>& lengths, const Unknowns& unknowns,
                               const std::vector<Quaterniond>& turns, int marker) {
  std::vector<Columns> columns;
  for (int j = marker; j > 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
    const auto at = static_cast<std::size_t>(j);
    const Joint& joint = skeleton.joints[at];
    const auto parent = static_cast<std::size_t>(joint.parent);
    const Matrix3d turn = turns[parent].toRotationMatrix();
    const Vector3d direction = joint.rest_offset.stableNormalized();
    const Vector3d offset = j == marker ? joint.rest_offset : Vector3d(lengths[at] * direction);
    columns.push_back({unknowns.of_joint[at], turn});
    if (j != marker) columns.back().values = turn * direction;
    columns.push_back({unknowns.of_turn[parent], -turn * Hat(offset)});
  }
  return columns;
}

/// Adds a frame, with its root eliminated: the markers' places relative to their middle.
void AddFrame(const SkeletonTracks& tracks, int frame, const std::vector<double>& lengths, const Unknowns& unknowns,
              const std::vector<Quaterniond>& turns, double weight, Eigen::MatrixXd& a, Eigen::VectorXd& b) {
  const Skeleton& skeleton = *tracks.skeleton;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, unknowns.count);
  Vector3d places = Vector3d::Zero();
  int seen = 0;
  for (int m = 0; m < skeleton.joint_count(); ++m) {
    if (!skeleton.joints[static_cast<std::size_t>(m)].landmark || !tracks.seen(frame, m)) continue;
    const std::vector<Columns> columns = ColumnsOf(skeleton, lengths, unknowns, turns, m);
    const Vector3d place = tracks.positions.at(frame, m);
    for (const Columns& one : columns) {
      const auto width = one.values.cols();
      for (const Columns& other : columns) {
        a.block(one.first, other.first, width, other.values.cols()).noalias() +=
            weight * (one.values.transpose() * other.values);
      }
      b.segment(one.first, width).noalias() += weight * (one.values.transpose() * place);
      sum.middleCols(one.first, width) += one.values;
    }
    places += place;
    ++seen;
  }
  if (seen == 0) return;
  a.noalias() -= weight / seen * (sum.transpose() * sum);
  b.noalias() -= weight / seen * (sum.transpose() * places);
}

/// Every n-th frame of each clip, so that all have kMostFrames at most.
std::vector<SkeletonTracks> Sampled(const std::vector<SkeletonTracks>& clips) {
  long long all = 0;
  for (const SkeletonTracks& clip : clips) all += clip.frames();
  const int step = static_cast<int>(std::max(1LL, (all + kMostFrames - 1) / kMostFrames));
  std::vector<SkeletonTracks> sampled;
  for (const SkeletonTracks& clip : clips) {
    SkeletonTracks own = clip;
    const auto joints = static_cast<std::size_t>(clip.joints());
    std::size_t rows = 0;
    for (int f = 0; f < clip.frames(); f += step, ++rows) {
      own.time_s[rows] = clip.time_s[static_cast<std::size_t>(f)];
      for (std::size_t j = 0; j < joints; ++j) {
        own.positions.at(static_cast<int>(rows), static_cast<int>(j)) = clip.positions.at(f, static_cast<int>(j));
        own.confidence[rows * joints + j] = clip.confidence[static_cast<std::size_t>(f) * joints + j];
      }
    }
    sampled.push_back(CutTracks(own, 0, static_cast<int>(rows)));
  }
  return sampled;
}

}  // namespace

Expected<MarkerBody> LearnMarkerBody(const std::vector<SkeletonTracks>& clips, const JointTrackOptions& options) {
  const SkeletonPtr rest = clips.front().skeleton;
  const Unknowns unknowns(*rest);
  const std::vector<SkeletonTracks> sampled = Sampled(clips);
  JointTrackOptions quick = options;
  quick.uncertainty = false;
  quick.solver = PoseSolver::kBanded;
  MarkerBody body;
  body.skeleton = rest;
  body.bone_length = rest->RestBoneLengths();
  body.place_sigma = clips.front().place_sigma;
  for (const SkeletonTracks& clip : sampled) body.frames += clip.frames();
  const double weight = std::min(1.0, kIndependent / body.frames) / (kSkin * kSkin);
  MarkerBody best = body;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0, worse = 0; round < kMostRounds && worse < kMostWorse; ++round) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(unknowns.count, unknowns.count);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns.count);
    AddPriors(*rest, clips.front().place_sigma, unknowns, a, b);
    const Eigen::VectorXd present = unknowns.Of(body);
    double cost = present.dot(a * present) - 2.0 * b.dot(present);  // and a constant
    for (const SkeletonTracks& clip : sampled) {
      const SkeletonTracks tracks = OnBody(clip, body.skeleton);
      const auto fit = FitJointTracks(tracks, FrameRate::FromHz(30.0), body.bone_length, quick);
      if (!fit) return Forward(fit);
      std::vector<Vector3d> joints(rest->joints.size());
      std::vector<Quaterniond> turns(rest->joints.size());
      for (int f = 0; f < clip.frames(); ++f) {
        ForwardKinematics(*body.skeleton, fit->motion.root_translation[static_cast<std::size_t>(f)],
                          &fit->motion.rotation_at(f, 0), body.bone_length, joints.data(), turns.data());
        AddFrame(tracks, f, body.bone_length, unknowns, turns, weight, a, b);
        for (int m = 0; m < clip.joints(); ++m) {
          if (clip.seen(f, m))
            cost += weight * (clip.positions.at(f, m) - joints[static_cast<std::size_t>(m)]).squaredNorm();
        }
      }
    }
    // Poses have priors that places do not know: rounds may drift away from the best.
    worse = cost < least ? 0 : worse + 1;
    const Eigen::LDLT<Eigen::MatrixXd> solver(a);
    if (cost < least) {
      least = cost;
      best = body;
      const Eigen::MatrixXd covariance = solver.solve(Eigen::MatrixXd::Identity(unknowns.count, unknowns.count));
      for (int j = 1; j < rest->joint_count(); ++j) {
        const auto at = static_cast<std::size_t>(j);
        if (rest->joints[at].landmark)
          best.place_sigma[at] = std::sqrt(covariance.diagonal().segment<3>(unknowns.of_joint[at]).mean());
      }
    }
    if (Take(solver.solve(b), *rest, unknowns, body) < kSettled) break;
  }
  return best;
}

}  // namespace mocurate
