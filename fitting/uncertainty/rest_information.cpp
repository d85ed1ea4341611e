#include "fitting/uncertainty/rest_information.h"

#include <algorithm>
#include <cmath>

#include "fitting/solver/rest_sigmas.h"

namespace mocurate {
namespace {

constexpr double kAutocorrelationTime_s = 5.0;  ///< for which people keep a posture

}  // namespace

std::vector<double> TypicalRotations(const Skeleton& skeleton) { return RestPoseSigmas(skeleton, kTypicalSigma); }

std::vector<double> RestInformationOfProcessNoise(const TrackWindow& whole) {
  std::vector<double> information(whole.tracks.confidence.size());
  const std::vector<double> typical = TypicalRotations(*whole.tracks.skeleton);
  for (int j = 0; j < whole.tracks.joints(); ++j) {
    const double square = typical[static_cast<std::size_t>(j)] * typical[static_cast<std::size_t>(j)];
    const auto of_step = [&](int step) {
      return std::min(std::tanh(0.25 * whole.RotationVariance(step, j) / square),
                      0.5 * whole.Step(step) / kAutocorrelationTime_s);
    };
    for (int f = 0; f < whole.end; ++f) {
      const double before = f > 0 && whole.Joined(f - 1) ? of_step(f - 1) : 1.0;
      const double after = f + 1 < whole.end && whole.Joined(f) ? of_step(f) : 1.0;
      information[whole.Index(f, j)] = 0.5 / square * (before + after);
    }
  }
  return information;
}

}  // namespace mocurate
