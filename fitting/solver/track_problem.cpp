#include "fitting/solver/track_problem.h"

#include <Eigen/Cholesky>

namespace mocurate {

Matrix3d TrackProblem::RobustInformation(int frame, int joint) const {
  const Vector3d away = state.position(frame, joint) - tracks.positions.at(frame, joint);
  const Matrix3d information = Information(frame, joint);
  return HuberSlope(away.dot(information * away), huber) * information;
}

StepTerm TrackProblem::StepAfter(int frame) const {
  StepTerm step;
  for (int j = 0; j < tracks.joints() && Joined(frame); ++j) {
    step.rotation.push_back(1.0 / RotationVariance(frame, j));
    // A joint that no frame shows would move far if the trunk were tilted: that is no evidence of an upright trunk.
    const bool coupled = j == 0 || (options.priors.all_joints && shown[static_cast<std::size_t>(j)]);
    step.move.push_back(coupled ? 1.0 / MoveVariance(frame, j) : 0.0);
  }
  return step;
}

PoseTerms TrackProblem::Terms(int begin, int end, bool after_fixed) const& {
  PoseTerms terms;
  terms.huber = huber;
  terms.limit = 1.0 / options.priors.limit;
  const bool hinged = options.priors.hinge > 0.0;
  if (hinged) terms.hinge = 1.0 / options.priors.hinge;
  terms.frames.resize(static_cast<std::size_t>(end - begin));
  for (int f = begin; f < end; ++f) {
    FrameTerms& frame = terms.frames[static_cast<std::size_t>(f - begin)];
    frame.frame = f;
    for (int j = 0; j < tracks.joints(); ++j) {
      if (tracks.seen(f, j)) {
        const Matrix3d whitening = Eigen::LLT<Matrix3d>(Information(f, j)).matrixU();
        frame.points.push_back({j, tracks.positions.at(f, j), whitening});
      }
      if (const std::size_t at = Index(f, j); rotations != nullptr && rotations->has(at))
        frame.rotations.push_back({j, rotations->world_from_joint[at].toRotationMatrix(), rotations->weight[at]});
      const auto& limits = tracks.skeleton->joints[static_cast<std::size_t>(j)].limits;
      const auto& hinge = hinges[static_cast<std::size_t>(j)];
      frame.priors.push_back({RestInformation(f, j), limits ? &*limits : nullptr, hinged && hinge ? &*hinge : nullptr});
    }
    if (f + 1 < end) frame.next = StepAfter(f);
    if (f == begin && after_fixed) frame.fixed.push_back({f - 1, StepAfter(f - 1)});
  }
  return terms;
}

}  // namespace mocurate
