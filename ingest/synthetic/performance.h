#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "ingest/options.h"
#include "ingest/synthetic/pose.h"

namespace mocurate {

/// One of the studio's people: a body and habits.
struct Subject {
  std::string name;                 ///< "p01"
  std::vector<double> bone_length;  ///< (J) of the skeleton it was made for, metres
  double amplitude = 1.0;
  double tempo = 1.0;
  double stance = 0.05;      ///< legs apart, radians
  double arm_abduct = 0.15;  ///< of a standing person, radians
  double elbow = 0.25;
  double stoop = 0.0;
  double knee = 0.0;  ///< flexion when standing, radians; of scripts only
};

/// One take of the capture.
struct Take {
  std::string action;
  int subject = 0;     ///< from 0
  int repetition = 0;  ///< from 0

  /// "wave_p01_r01.txt"
  std::string file() const;
};

/// All takes, sorted by file name.
std::vector<Take> Takes(const SyntheticOptions& options);

/// The bodies differ in stature (0.90 to 1.10 of the skeleton's, in equal steps) and in the proportions of legs, arms,
/// trunk, width and head (5 % each).
std::vector<Subject> Cast(std::int64_t seed, std::int64_t subjects, const Skeleton& skeleton);

/// Pose of the standing subject at a moment: small sway, and breathing.
Pose StandingPose(const Subject& subject, double time_s, double sway_phase);

/// The true motion of a take in the sensor's frame: canonical axes (right-handed, y up, origin at the sensor, the
/// person in front of it at -z). The standing foot stays where it is.
Motion PerformTake(const SyntheticOptions& options, const Take& take, const Subject& subject,
                   const SkeletonPtr& skeleton);

}  // namespace mocurate
