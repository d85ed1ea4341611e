#include "ingest/sources/exported_motion.h"

#include <algorithm>
#include <cmath>

namespace mocurate {

std::optional<ExportedMotion> ExportedMotionIn(const Npz& npz) {
  const NpyArray* joints = npz.Find("joints");
  const NpyArray* names = npz.Find("joint_names");
  const NpyArray* parents = npz.Find("parents");
  const NpyArray* rate = npz.Find("mocap_frame_rate");
  const NpyArray* skeleton = npz.Find("skeleton");
  for (const NpyArray* array : {joints, names, parents, rate, skeleton, npz.Find("representation")}) {
    if (array == nullptr) return std::nullopt;
  }
  const std::size_t count = names->texts.size();
  const bool places = joints->shape.size() == 3 && joints->shape[1] == count && joints->shape[2] == 3;
  if (!places || joints->values.empty() || parents->values.size() != count) return std::nullopt;
  if (skeleton->texts.size() != 1 || rate->values.size() != 1) return std::nullopt;
  ExportedMotion exported{joints, names->texts, {}, skeleton->texts[0], rate->values[0]};
  if (!std::isfinite(exported.rate_hz) || exported.rate_hz <= 0.0) return std::nullopt;
  for (std::size_t j = 0; j < count; ++j) {
    const double parent = parents->values[j];
    // A parent comes before its children, as in every skeleton.
    if (!(parent >= -1.0 && parent < static_cast<double>(j)) || (j > 0) != (parent >= 0.0)) return std::nullopt;
    exported.parents.push_back(static_cast<int>(parent));
  }
  const NpyArray* state = npz.Find("state");
  const bool states = state != nullptr && state->shape == std::vector<std::size_t>{joints->shape[0], count} &&
                      std::all_of(state->values.begin(), state->values.end(), [](double value) {
                        return value == 0.0 || value == 1.0 || value == 2.0 || value == 3.0;
                      });
  if (states) exported.state = state;
  return exported;
}

}  // namespace mocurate
