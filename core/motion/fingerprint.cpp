#include "core/motion/fingerprint.h"

#include "core/base/sha256.h"

namespace mocurate {

std::string MotionFingerprint(const Motion& motion) {
  Sha256 hasher;
  hasher.Add(motion.rate.Text() + " " + std::to_string(motion.frame_count()) + " " +
             std::to_string(motion.joint_count()) + "\n");
  const std::vector<float> stored(motion.joints.xyz.begin(), motion.joints.xyz.end());
  hasher.Add(stored.data(), stored.size() * sizeof(float));
  return hasher.Hex().substr(0, 16);
}

}  // namespace mocurate
