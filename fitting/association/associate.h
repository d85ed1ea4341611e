#pragma once

#include <vector>

#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// One person of a take: which entry of which view is theirs.
struct AssociatedPerson {
  std::vector<std::vector<int>> entry;  ///< [view][frame of the view]: entry; -1: none
  double presence = 0.0;                ///< sum of the confidences of all their keypoints
  int frames_seen = 0;                  ///< frames of the take in which at least two views see them
};

/// Everybody that at least two views agree on.
struct Association {
  std::vector<double> time_s;            ///< (F) of the view with the most frames; ties: the first
  std::vector<AssociatedPerson> people;  ///< most present first
  std::vector<int> entries;              ///< (views) with enough keypoints to tell
  std::vector<int> excluded;  ///< (views) of them assigned to no person: bystanders in one view only, false detections
};

/// (views) share of each view's frames that show nothing of a person.
std::vector<double> UnobservedShares(const AssociatedPerson& person);

/// People across views and time. Frame by frame, entries go to the people known before by how far their keypoints lie
/// from the rays (median over the keypoints, in shares of the person's extent); among what is left, pairs of views
/// propose bodies, which most further entries and the bone lengths decide. Pairs are neighbours in the list and some
/// strides away, so that cost grows linearly with the number of views. People are the same after a gap where place
/// and bone lengths allow it. Views may have clocks and rates of their own: a frame uses each view's nearest in time.
/// Frames are those of the view with the most, or at `time_s` where that is given.
Association AssociatePeople(const std::vector<RigView>& rig, const std::vector<KnownLength>& lengths,
                            const std::vector<double>& time_s = {});

}  // namespace mocurate
