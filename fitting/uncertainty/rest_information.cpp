#include "fitting/uncertainty/rest_information.h"

#include <algorithm>
#include <cmath>

#include "fitting/solver/rest_spreads.h"

namespace mocurate {
namespace {

constexpr double kPeoplesTurn = 1.0;  ///< radians from the rest pose, of hips, knees, shoulders and elbows
constexpr double kLasting_s = 5.0;    ///< for as long people go on about what they do

}  // namespace

std::vector<double> UsualTurns(const Skeleton& skeleton) { return RestSpreads(skeleton, kPeoplesTurn); }

std::vector<double> RestInformationOfWalks(const TrackWindow& whole) {
  std::vector<double> information(whole.tracks.confidence.size());
  const std::vector<double> turns = UsualTurns(*whole.tracks.skeleton);
  for (int j = 0; j < whole.tracks.joints(); ++j) {
    const double square = turns[static_cast<std::size_t>(j)] * turns[static_cast<std::size_t>(j)];
    const auto of_step = [&](int step) {
      return std::min(std::tanh(0.25 * whole.TurnVariance(step, j) / square), 0.5 * whole.Step(step) / kLasting_s);
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
