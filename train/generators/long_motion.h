#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "train/generators/motion_generator.h"

namespace mocurate {

/// What answers scripts of several actions (multiact.md D).
struct LongMotionNetworks {
  /// MACVAE, which makes each transition and action from what came before; or a network of single actions (ACTOR),
  /// whose motions are joined.
  std::shared_ptr<const MotionGenerator> main;
  std::shared_ptr<const MotionGenerator> first;  ///< of single actions; makes the first one where `main` is MACVAE
  std::shared_ptr<const MotionGenerator> fill;   ///< SSMCT-like, fills transitions between joined actions; null:
                                                 ///< rotations by slerp, places linearly
  bool snap = false;   ///< MACVAE's parts begin at the last frame's place and heading, as released; else where its
                       ///< stored transform puts them (multiact.md D.3)
  bool align = false;  ///< turn and move joined actions to where the one before ends; else they stay as generated

  /// Error kInconsistent where networks have other skeletons, rates or classes, or are of the wrong kind.
  Status Check() const;
};

/// A motion for each request, (frames as of MotionRequest::answered_frames): without a previous motion its first action
/// of `first` (or `main`), then transition and action of each step, each made from the one before and placed by the
/// stored transform of that one's last frame (multiact.md D.3). Clips as of MotionGenerator::Generate, with segments.
/// Requests without a script are answered by `main`. As released, MACVAE with `fill: released` is asked for two frames
/// more of each action, which are dropped, but for a single one after a given motion. `proceed` gets the part that is
/// done and says whether to go on. Errors of the networks naming request and step; kInterrupted.
Expected<Dataset> GenerateLongMotions(
    const LongMotionNetworks& networks, const std::vector<MotionRequest>& requests, int threads = 1,
    const std::function<bool(double)>& proceed = [](double) { return true; });

/// `frames` frames between the end of one motion and the begin of another, in their world: rotations by slerp, the
/// root's place linearly, at (k + 1) / (frames + 1) of the way. Both have rotations and the same skeleton.
Motion Between(const Motion& before, const Motion& after, int frames);

/// The transform that lets `after` begin where `before` ends: about the vertical so that headings agree, and so that
/// its first root stands at the last one's place plus the last frame's step times `frames`, at its own height.
RigidTransform AlignedTo(const Motion& before, const Motion& after, int frames);

}  // namespace mocurate
