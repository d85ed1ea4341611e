#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "ingest/options.h"

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

/// Who is there: `chosen` in order of their first frames, and what became of the others.
struct People {
  std::vector<PersonTrack> chosen;
  std::vector<PersonTrack> others;  ///< sound, but not asked for
  std::vector<PersonTrack> false_tracks;
  std::vector<Finding> findings;  ///< "false_track" with the reason, "bodies_skipped", "second_person"
};

/// The ids of a tracker with those joined that are one person, as `options` say: nothing is joined by the official
/// rule.
std::vector<PersonTrack> JoinIds(std::vector<PersonTrack> tracks, const PeopleOptions& options,
                                 const std::vector<int>& parents, const std::vector<double>& time_s,
                                 std::vector<Finding>& findings);

/// Sets false tracks aside (but never all: of false tracks alone those that move most are taken, and reported;
/// kOfficial knows none), ranks the rest by `rule` and takes `wanted`. `frames` of the file; `rest_lengths` (K) of a
/// person's bones. A person beyond the wanted who is there in half of the frames and moves as much as the last chosen
/// is reported as "second_person" (warning): a name that speaks of fewer people than there are.
People ChoosePeople(std::vector<PersonTrack> tracks, std::size_t wanted, TrackRule rule, bool look_for_false_tracks,
                    const std::vector<int>& parents, const std::vector<double>& rest_lengths, int frames);

}  // namespace mocurate
