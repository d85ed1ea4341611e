#pragma once

#include <string>
#include <vector>

#include "ingest/options.h"
#include "ingest/people/uestc.h"

namespace mocurate {

/// The performer of a video among VIBE's tracks by `people.rule`. kUestcReleased and kUestcCorrected: SelectUestcTrack,
/// from `people.start`. Any other rule: where people are is the joints moved by the camera's estimate, frames counted
/// from the first in which any person is; ids that are one person are joined, false tracks are excluded and the rest
/// ranked as of any tracker (choose_people.h); gaps of who is chosen are filled along the shortest arc. Errors
/// kInconsistent: no track, no person, a field that the rule reads is missing, or frame_ids span more than 20 frames a
/// row and 1000; `name` is the file.
Expected<UestcPerson> ChooseVibePerson(const std::vector<VibeTrack>& tracks, const PeopleOptions& options,
                                       double rate_hz, const std::string& name);

/// The track that a source names: frames between its rows are filled along the shortest arc and reported as
/// "frames_filled". A track that does not declare its frames is taken as it is. Errors as of ChooseVibePerson.
Expected<UestcPerson> NamedVibePerson(const VibeTrack& track, const std::string& name);

}  // namespace mocurate
