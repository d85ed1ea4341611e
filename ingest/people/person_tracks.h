#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"

namespace mocurate {

/// One id of a tracker, or several that are one person. Metres, y up.
struct PersonTrack {
  std::vector<std::uint64_t> ids;  ///< in order of their first frames
  std::vector<int> frames;         ///< (n) rising: where the person is seen
  JointPositions positions;        ///< (n,K,3)
  std::vector<double> confidence;  ///< (n*K), 0 is missing

  bool sees(std::size_t row, int point) const {
    return confidence[row * static_cast<std::size_t>(positions.joints) + static_cast<std::size_t>(point)] > 0.0;
  }
  std::string Name() const;  ///< its ids, "72057594037931101" or "72...101+72...368"
};

/// Summed variance of the coordinates of each joint that is ever seen, m2.
std::vector<double> JointVariances(const PersonTrack& track);

/// Summed variance of the joints' coordinates, m2: what NTU's authors tell bodies apart by.
double MotionEnergy(const PersonTrack& track);

/// Lengths of the bone that ends at a joint, metres, where both ends are seen.
std::vector<double> BoneLengths(const PersonTrack& track, const std::vector<int>& parents, std::size_t joint);

/// Median length of each bone, metres; 0 where it is never seen. `parents` (K), -1 for none.
std::vector<double> BoneSignature(const PersonTrack& track, const std::vector<int>& parents);
/// Mean distance of log lengths over the bones that both have; 1 when these are fewer than four.
double SignatureDistance(const std::vector<double>& a, const std::vector<double>& b);

/// Ids that are one person: interleaved ones (never seen together, on in each other's gaps, at one place), and ids that
/// end before another begins, within reach and with the same bones. Over gaps, ends are joined to beginnings by the
/// assignment of the least summed cost (distance over reach, plus signature over its limit), so that two people who are
/// lost at once come back as themselves. `max_lost_s`: longest time that a person may be lost. Each joint is a finding
/// "ids_stitched" (info; value: frames lost). Tracks come in order of their first frames.
std::vector<PersonTrack> StitchTracks(std::vector<PersonTrack> tracks, const std::vector<int>& parents,
                                      const std::vector<double>& time_s, double max_lost_s,
                                      std::vector<Finding>& findings);

/// Partner of each row in the assignment of the least summed cost, -1 for none: costs (rows x columns, row-major), each
/// row and column used once at most; a pair that costs as much as `none` or more is not made.
std::vector<int> LeastCostAssignment(const std::vector<double>& costs, int rows, int columns, double none);

}  // namespace mocurate
