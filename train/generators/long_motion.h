#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "train/generators/motion_generator.h"

namespace mocurate {

/// Networks for scripts of several actions (multiact.md D).
struct LongMotionNetworks {
  /// MACVAE, which continues the previous motion by each transition and action; or a network of single actions (ACTOR),
  /// whose motions are joined.
  std::shared_ptr<const MotionGenerator> main;
  std::shared_ptr<const MotionGenerator> first;  ///< of single actions; generates the first one where `main` is MACVAE
  std::shared_ptr<const MotionGenerator> fill;   ///< SSMCT-like, fills transitions between joined actions; null:
                                                 ///< rotations by slerp, positions linearly
  bool snap = false;  ///< MACVAE's parts begin at the last frame's position and heading, as released; else where its
                      ///< stored transform puts them (multiact.md D.3)
  bool keep_previous = false;  ///< the answer begins with the motion that it continues, as a segment "recorded"
  bool align = false;  ///< rotate and move joined actions to the end of the one before; else they stay as generated

  /// Error kInconsistent where networks have other skeletons, rates or classes, or are of the wrong kind.
  Status Check() const;
};

/// A motion for each request, (frames as of MotionRequest::answered_frames). Without a previous motion, `first` (or
/// `main`) generates the first action. Transition and action of each step continue the one before, placed by the stored
/// transform of that one's last frame (multiact.md D.3). Clips as of MotionGenerator::Generate, with segments. Requests
/// without a script go to `main`. As released, MACVAE with `fill: released` generates two extra frames of each action,
/// which are dropped, except for a single one after a given motion. `proceed` receives the completed share and returns
/// whether to continue. Errors of the networks naming request and step; kInterrupted.
Expected<Dataset> GenerateLongMotions(
    const LongMotionNetworks& networks, const std::vector<MotionRequest>& requests, int threads = 1,
    const std::function<bool(double)>& proceed = [](double) { return true; });

/// `frames` frames between the end of one motion and the begin of another, in their world: rotations by slerp, the
/// root's position linearly, at (k + 1) / (frames + 1). Both have rotations and the same skeleton.
Motion Between(const Motion& before, const Motion& after, int frames);

/// The transform that starts `after` at the end of `before`: a rotation about the vertical that aligns the headings,
/// and a translation that puts its first root at the last one's position plus the last frame's step times `frames`, at
/// its own height.
RigidTransform AlignedTo(const Motion& before, const Motion& after, int frames);

}  // namespace mocurate
