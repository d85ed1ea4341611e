#pragma once

#include <cstddef>

#include "ingest/options.h"
#include "ingest/people/person_tracks.h"

namespace mocurate {

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
