#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/view_registration.h"

namespace mocurate {

/// Whether views have files, all as many, and stamps that increase.
bool CanSampleRig(const std::vector<DepthView>& views);

/// Depth views of a clip at the moments that a rig is judged by: groups of two consecutive frames (one, where the clip
/// has no more), evenly spread. Images are read when they are asked for, each once. V views.
class DepthRigSampler {
 public:
  /// Views of which CanSampleRig holds.
  explicit DepthRigSampler(std::vector<DepthView> views);

  /// The moments with each view `late[v]` frames later than the others; a frame that a view does not have is one in
  /// which it observed no person. Errors of ReadFrame.
  Expected<ObservedRig> Seen(const std::vector<int>& late);

  /// Groups in which view v is `more` frames later than in Seen(late), and the others are as they are there.
  Expected<ObservedRig> SeenLater(const std::vector<int>& late, std::size_t view, int more);

  const std::vector<DepthView>& views() const { return views_; }
  const std::vector<int>& frames() const { return frames_; }  ///< first of each group
  int together() const { return together_; }
  int count() const { return static_cast<int>(views_[0].files.size()); }
  int flat() const { return flat_; }  ///< images read so far that show something flat in the place of a person
  double step_s() const;              ///< between frames; 0 where stamps do not say

 private:
  Expected<const ViewSurface*> At(std::size_t view, int frame);
  Status SetPlace();

  std::vector<DepthView> views_;                ///< as given
  std::vector<std::vector<DepthView>> single_;  ///< each on its own
  std::vector<DepthView> bare_;                 ///< without files
  std::vector<int> frames_;
  int together_ = 1;
  std::map<std::pair<std::size_t, int>, std::unique_ptr<ViewSurface>> surfaces_;
  Vector3d centre_ = Vector3d::Zero();
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  bool placed_ = false;
  int flat_ = 0;
};

/// (views, groups) root mean square distance of a view's points to the surfaces that others see there, in the first
/// moment of each group; mm, 0 where no other view sees the same surface.
std::vector<std::vector<double>> ResidualsOfViews(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// kInconsistent where no person is observed and the points are flat (DepthRigSampler::flat).
Status CheckPersonIsSeen(const ObservedRig& rig, int flat);

/// (views) mean of those losses of LossOfSamples that are of pairs with a view.
std::vector<double> LossOfViews(const ObservedRig& rig, const std::vector<double>& losses);

/// (views) share of the moments with a person in which a view shows none.
std::vector<double> WithoutPerson(const ObservedRig& rig);

/// Those losses of LossOfSamples that are of pairs with `view`, where both of two rigs have them.
std::pair<std::vector<double>, std::vector<double>> OfView(const ObservedRig& rig, std::size_t view,
                                                           const std::vector<double>& losses,
                                                           const std::vector<double>& others);

}  // namespace mocurate
