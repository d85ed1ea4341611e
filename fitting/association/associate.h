#pragma once

#include <vector>

#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// One person of a take, with the entry of each view.
struct AssociatedPerson {
  std::vector<std::vector<int>> entry;  ///< [view][frame of the view]: entry; -1: none
  double presence = 0.0;                ///< sum of the confidences of all their keypoints
  int frames_seen = 0;                  ///< frames of the take in which at least two views see them
};

/// All people that at least two views agree on.
struct Association {
  std::vector<double> time_s;            ///< (F) of the view with the most frames; ties: the first
  std::vector<AssociatedPerson> people;  ///< most present first
  std::vector<int> entries;              ///< (views) entries with enough keypoints
  std::vector<int> excluded;             ///< (views) of these, entries of no person: bystanders that one view alone
                                         ///< observes, and false detections
};

/// (views) share of each view's frames without the person.
std::vector<double> UnobservedShares(const AssociatedPerson& person);

/// Associates people across views and time. In each frame, entries go to known people by the distance of their
/// keypoints from the rays (median over keypoints, relative to the person's extent). From the remaining entries, pairs
/// of views propose bodies, which are ranked by further entries and by bone lengths. Pairs are neighbours in the list
/// and views a few strides away, so that cost grows linearly with the number of views. After a gap, a track continues
/// when position and bone lengths match. Views may have their own clocks and rates: a frame uses each view's nearest
/// frame in time. Frames are those of the view with the most frames, or `time_s` when given.
Association AssociatePeople(const std::vector<RigView>& rig, const std::vector<KnownLength>& lengths,
                            const std::vector<double>& time_s = {});

/// Median of the steps of a view's clock, seconds; 0 with fewer than two frames.
double UsualStep(const std::vector<double>& time_s);

/// Reads the keypoints (K each) of the entries (F of the view; -1: none) at a moment. Uses the view's frame at that
/// time (within a thousandth of `step`). Otherwise interpolates between the two frames around it, where both observe
/// the keypoint and are at most 2.5 steps apart. Writes nothing for unobserved keypoints.
void ReadBetweenFrames(const RigView& view, const std::vector<int>& entry, double step, double moment,
                       Vector2d* normalised, double* confidence);

/// One person's keypoints in every view at the times of the take, without lens distortion (ReadBetweenFrames).
std::vector<ViewKeypoints> ViewsOfPerson(const std::vector<RigView>& rig, const Association& take,
                                         const AssociatedPerson& person);

}  // namespace mocurate
