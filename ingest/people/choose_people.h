#pragma once

#include <cstddef>

#include "ingest/options.h"
#include "ingest/people/person_tracks.h"

namespace mocurate {

/// Why a track shows no person.
struct FalseTrackLimits {
  int fewest_frames = 8;  ///< "short": fewer frames, or less than `least_share` of the file's
  double least_share = 0.05;
  double still = 0.004;  ///< "frozen": metres that the joints move about their mean (median of the joints)
  double flat =
      0.5;  ///< "furniture": height over width that the box around the body reaches in no third of its frames ...
  double proportion = 0.35;  ///< ... or bones whose log lengths are so far from a person's, or ...
  double spread = 0.3;       ///< ... change their length by so much
  double together = 0.25;    ///< "double": metres between its middle and another's in most frames they share
};

/// Who is there: `chosen` in order of their first frames, and what became of the others.
struct People {
  std::vector<PersonTrack> chosen;
  std::vector<PersonTrack> others;  ///< sound, but not asked for
  std::vector<PersonTrack> false_tracks;
  std::vector<Finding> findings;  ///< "false_track" with the reason, "bodies_skipped", "second_person"
};

/// Whether ids are taken for other people than the file says: not by the official rule.
bool StitchesIds(const PeopleOptions& options);

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
                    const FalseTrackLimits& limits, const std::vector<int>& parents,
                    const std::vector<double>& rest_lengths, int frames);

}  // namespace mocurate
