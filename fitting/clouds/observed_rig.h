#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/view_registration.h"

namespace mocurate {

/// Whether all views have equally many files, and increasing stamps.
bool CanSampleRig(const std::vector<DepthView>& views);

/// Depth views of a clip at the moments of an audit: groups of two consecutive frames (one, for a shorter clip), evenly
/// spaced. Loads each image once, on request. V views.
class DepthRigSampler {
 public:
  /// `views` must satisfy CanSampleRig.
  explicit DepthRigSampler(std::vector<DepthView> views);

  /// The moments with each view `delays[v]` frames later than the others; a missing frame counts as one without a
  /// person. Errors of ReadFrame.
  Expected<ObservedRig> Seen(const std::vector<int>& delays);

  /// Groups with view v `more` frames later than in Seen(delays), the others as in it.
  Expected<ObservedRig> SeenLater(const std::vector<int>& delays, std::size_t view, int more);

  const std::vector<DepthView>& views() const { return views_; }
  const std::vector<int>& frames() const { return frames_; }  ///< first frame of each group
  int together() const { return together_; }
  int count() const { return static_cast<int>(views_[0].files.size()); }
  int flat() const { return flat_; }  ///< images loaded so far that show a flat surface and no person
  double step_s() const;              ///< between frames; 0 without usable stamps

 private:
  Expected<const ViewSurface*> At(std::size_t view, int frame);
  Status SetPlace();

  std::vector<DepthView> views_;                ///< as given
  std::vector<std::vector<DepthView>> single_;  ///< each alone
  std::vector<DepthView> bare_;                 ///< without files
  std::vector<int> frames_;
  int together_ = 1;
  std::map<std::pair<std::size_t, int>, std::unique_ptr<ViewSurface>> surfaces_;
  Vector3d centre_ = Vector3d::Zero();
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  bool placed_ = false;
  int flat_ = 0;
};

/// (views, groups) root mean square distance of a view's points to surfaces of other views in the first moment of each
/// group; mm, 0 without a common surface.
std::vector<std::vector<double>> ResidualsOfViews(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// Error kInconsistent when no view shows a person and some show a flat surface (DepthRigSampler::flat).
Status CheckPersonIsSeen(const ObservedRig& rig, int flat);

/// (views) mean of the losses of LossOfSamples over a view's pairs.
std::vector<double> LossOfViews(const ObservedRig& rig, const std::vector<double>& losses);

/// (views) share of the moments with a person in which a view shows none.
std::vector<double> WithoutPerson(const ObservedRig& rig);

/// The losses of LossOfSamples for pairs with `view` that both rigs have.
std::pair<std::vector<double>, std::vector<double>> OfView(const ObservedRig& rig, std::size_t view,
                                                           const std::vector<double>& losses,
                                                           const std::vector<double>& others);

}  // namespace mocurate
