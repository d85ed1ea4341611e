#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/quality/view_alignment.h"
#include "ingest/options.h"
#include "ingest/people/person_tracks.h"

namespace mocurate {

/// Whom one camera followed, in metres and canonical axes of its own.
struct CameraPeople {
  std::string view;
  int frames = 0;
  std::vector<PersonTrack> people;
  int first = 0;          ///< frame at the moment of frame 0 of the others, where it is declared
  bool declared = false;  ///< it is
};

/// What became of a camera.
struct PlacedView {
  bool used = false;
  ViewAlignment alignment;  ///< `a` is the reference
  std::vector<int> slots;   ///< by person of the merged: which of its people that is, -1: none
};

/// Several cameras in the world of one.
struct PlacedViews {
  std::size_t reference = 0;
  std::vector<PlacedView> views;  ///< as given; the reference is used and lies where it is
  std::vector<Finding> findings;  ///< "no_person_in_view", "view_excluded", "clock_offset"
};

/// Aligns the cameras pair by pair (people of two cameras in the order that fits best, at most three each). The
/// reference is the camera that agrees with most others, the first of equal ones; what does not agree with it is left
/// out. Error kInconsistent: no person is observed at all, or cameras contradict each other and no two agree;
/// Reason::kViewNumbering: a camera agrees with another only beyond `max_offset_s`, or they share less than half of the
/// shorter recording, and neither is declared.
Expected<PlacedViews> PlaceViews(const std::vector<CameraPeople>& cameras, const ViewOptions& options, double rate_hz,
                                 const std::string& where);

/// One person in the world and at the times of the reference, frames [begin, end) of it. Places are the middle of what
/// the cameras say, weighed by confidence squared, those farther off the less; confidence is that of the surest camera
/// which agrees within 0.1 m, half of it where none does.
JointTracks MergePerson(const std::vector<CameraPeople>& cameras, const PlacedViews& placed, std::size_t slot,
                        int begin, int end, double rate_hz);

}  // namespace mocurate
