#include "fitting/uncertainty/frame_covariances.h"

#include <algorithm>
#include <string>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {

Status VisitCovariances(const TrackWindow& whole, const std::function<void(const FrameCovariance&)>& visit) {
  const OneThread one_thread;
  const int length = static_cast<int>(whole.options.window_frames);
  const int context = static_cast<int>(whole.options.window_overlap);
  whole.state.Update(0, whole.end, true);
  BlockTridiagonal own_memory;
  for (int begin = 0; begin < whole.end; begin += length) {
    const int end = std::min(begin + length, whole.end);
    TrackWindow window{whole.tracks, whole.state, whole.sigma, whole.options};
    window.begin = std::max(begin - context, 0);
    window.end = std::min(end + context, whole.end);
    window.noise_scale = whole.noise_scale;
    window.rotations = whole.rotations;
    window.rest_sigmas = whole.rest_sigmas;
    window.rest_information = whole.rest_information;
    TrackEquations track(window);
    BlockTridiagonal& equations = whole.memory != nullptr ? *whole.memory : own_memory;
    equations.Resize(window.end - window.begin, track.size());
    track.Linearise(equations);
    if (!equations.Factor(Eigen::VectorXd::Zero(equations.blocks() * equations.size()))) {
      return Fail(ErrorCode::kInconsistent,
                  "the pose is undetermined in spite of its priors (singular normal equations)",
                  "frames " + std::to_string(begin) + " to " + std::to_string(end),
                  "check that these frames show a person, in metres");
    }
    Eigen::MatrixXd next;
    equations.VisitInverse([&](int f, const Eigen::MatrixXd& own, const Eigen::MatrixXd& with_next) {
      const int frame = window.begin + f;
      if (frame >= begin && frame < end) visit({track, frame, own, with_next, next, equations.Next(f)});
      next = own;
    });
  }
  return {};
}

}  // namespace mocurate
