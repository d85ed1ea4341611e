#include "fitting/audit/corrected_rig.h"

#include <algorithm>
#include <string>
#include <utility>

namespace mocurate {
namespace {

void ExchangeAllSides(const std::vector<std::size_t>& other_side, RigView& view) {
  for (std::size_t first = 0; first < view.confidence.size(); first += other_side.size()) {
    for (std::size_t k = 0; k < other_side.size(); ++k) {
      if (other_side[k] <= k) continue;
      std::swap(view.normalised[first + k], view.normalised[first + other_side[k]]);
      std::swap(view.confidence[first + k], view.confidence[first + other_side[k]]);
    }
  }
}

}  // namespace

int FrameAt(const std::vector<double>& time_s, double moment) {
  return static_cast<int>(std::lower_bound(time_s.begin(), time_s.end(), moment - 1e-9) - time_s.begin());
}

std::vector<RigView> CorrectedRig(const std::vector<RigView>& rig, const RigModel& model,
                                  const std::vector<std::size_t>& other_side, const std::vector<double>& time_s) {
  std::vector<RigView> corrected;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const std::vector<CameraPart>& parts = model.camera[v];
    RigView whole = rig[v];
    if (model.sides_exchanged[v]) ExchangeAllSides(other_side, whole);
    for (double& time : whole.time_s) time += model.clock_s[v];
    int begin = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const int end = p + 1 < parts.size() ? FrameAt(whole.time_s, parts[p + 1].from_s) : whole.frames();
      RigView view = parts.size() > 1 ? whole.Frames(begin, end) : whole;
      view.camera = TriangulationView(parts[p].camera);
      if (p > 0) view.camera.camera.name += " from frame " + std::to_string(FrameAt(time_s, parts[p].from_s));
      if (view.frames() > 0) corrected.push_back(std::move(view));
      begin = end;
    }
  }
  return corrected;
}

}  // namespace mocurate
