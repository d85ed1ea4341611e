#include <algorithm>

#include "core/motion/heading.h"
#include "train/data/batches.h"

namespace mocurate {
RigidTransform NetworkFromWorld(CanonicalChoice choice, const Matrix3d& rest_axes, const Quaterniond& root,
                                const Vector3d& place, const RigidTransform& canonical_from_source) {
  if (choice == CanonicalChoice::kNone) return Inverse(canonical_from_source);
  RigidTransform network_from_world;
  if (choice == CanonicalChoice::kZero) {
    network_from_world.rotation = root.conjugate();
  } else {
    const Heading heading = HeadingOfAxes(root * rest_axes, HeadingRule::kHips, kLeastHorizontal);
    network_from_world.rotation = Quaterniond(Eigen::AngleAxisd(-heading.yaw, Vector3d::UnitY()));
  }
  network_from_world.translation = -(network_from_world.rotation * place);
  return network_from_world;
}

MotionRows PlacedSamples(const TrainingSet& set, CanonicalChoice choice, int frames, const std::vector<int>& rows) {
  const std::size_t B = rows.size(), J = set.skeleton->joints.size(), T = static_cast<std::size_t>(frames);
  const Matrix3d rest_axes = RestAxes(*set.skeleton);
  using RowMatrix = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  MotionRows batch;
  batch.frames = frames;
  batch.motion.assign(T * B * 3 * J, 0.0f);
  batch.rotation.assign(T * B * 9 * J, 0.0f);
  for (std::size_t i = 0; i < batch.rotation.size(); i += 9) {
    for (const std::size_t k : {0, 4, 8}) batch.rotation[i + k] = 1.0f;
  }
  for (std::size_t b = 0; b < B; ++b) {
    const TrainingSet::Clip& clip = set.clips[static_cast<std::size_t>(rows[b])];
    const auto quaternion = [&](std::size_t frame, std::size_t j) {
      const float* q = set.rotation.data() + ((clip.first + frame) * J + j) * 4;
      return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    };
    const auto joint = [&](std::size_t frame, std::size_t j) {
      const float* p = set.joints.data() + ((clip.first + frame) * J + j) * 3;
      return Vector3d(p[0], p[1], p[2]);
    };
    const auto anchor = static_cast<std::size_t>(clip.parts[0] - 1);
    const RigidTransform network_from_world =
        NetworkFromWorld(choice, rest_axes, quaternion(anchor, 0), joint(anchor, 0), clip.canonical_from_source);
    const auto count = std::min<std::size_t>(T, static_cast<std::size_t>(clip.frames));
    for (std::size_t t = 0; t < count; ++t) {
      for (std::size_t j = 0; j < J; ++j) {
        const Vector3d place = network_from_world * joint(t, j);
        std::copy_n(place.cast<float>().eval().data(), 3, batch.motion.data() + ((t * B + b) * J + j) * 3);
        Quaterniond rotation = quaternion(t, j);
        if (j == 0) rotation = network_from_world.rotation * rotation;
        Eigen::Map<RowMatrix>(batch.rotation.data() + ((t * B + b) * J + j) * 9) =
            rotation.toRotationMatrix().cast<float>();
      }
    }
    batch.label.push_back(clip.label);
    batch.length.push_back(static_cast<int>(count));
    batch.parts.insert(batch.parts.end(), clip.parts.begin(), clip.parts.end());
    batch.word.insert(batch.word.end(), clip.word.begin(), clip.word.end());
  }
  return batch;
}

}  // namespace mocurate
