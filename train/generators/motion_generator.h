#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/rigid.h"
#include "core/motion/request.h"
#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// The continuation of a motion: a transition and an action, or the transition that leads to a given action.
struct Continuation {
  const Motion* previous = nullptr;      ///< with rotations; its last frames are read
  RigidTransform canonical_from_source;  ///< of its clip, for networks trained in the source's world
  const Motion* next = nullptr;          ///< the action, in the same world, for networks that fill transitions
  int label = 0;
  int transition_frames = 0;
  int frames = 0;  ///< of the action
  std::uint64_t seed = 0;
  std::vector<double> bone_length;  ///< (J) metres; empty: the training set's
};

/// A trained generator of motions.
class MotionGenerator {
 public:
  /// From a checkpoint of any generating network. Errors of ReadCheckpoint.
  static Expected<std::unique_ptr<MotionGenerator>> Load(const std::filesystem::path& path);
  ~MotionGenerator();

  /// Joints of every request, (n, frames, 3J) float32 metres, not re-centred (a2m_actor.md B.7). All requests must have
  /// the same number of frames. Errors kInconsistent naming the request (invalid label, bone lengths or frames). The
  /// result does not depend on `threads`.
  Expected<std::vector<float>> Joints(const std::vector<MotionRequest>& requests, int threads = 1) const;

  /// The same as a MotionSet, with rotations where the network outputs them: clip ids "generated/network/000000#0-60"
  /// in the order of the requests, label from the request. Frames may differ between requests.
  Expected<Dataset> Generate(const std::vector<MotionRequest>& requests, int threads = 1) const;

  /// A generated motion in place of every clip of a set, with its label and length (a2m_actor.md C.5, D.9): the clips
  /// in their order, rotations of the network. Interpolation is with another clip of the same class in the set. Draws
  /// are keyed by the seed, the rule and the clip's id; `training_windows` is not used. `proceed` receives the
  /// completed share and returns whether to continue. Errors kInconsistent: a network without an encoder, a set on
  /// another skeleton or without rotations, a clip with a label the network lacks; kInterrupted.
  Expected<Dataset> Remake(
      Dataset set, const RemakeOptions& options, int threads = 1,
      const std::function<bool(double)>& proceed = [](double) { return true; }) const;

  /// For networks that continue motions: transition and action; for those that fill: the transition, in the world of
  /// the previous motion. Errors of CheckContinuation.
  Expected<std::vector<Motion>> Continue(const std::vector<Continuation>& asked, int threads = 1) const;
  /// Whether the network can continue a motion of `previous_frames` in this way. Error kInconsistent with value, rule
  /// and remedy: an unknown class, parts without frames, more frames than the network's maximum, too short a motion.
  Status CheckContinuation(int label, int previous_frames, int transition_frames, int frames,
                           const std::string& where) const;

  /// Options of its training.
  const NetworkOptions& options() const;

  SkeletonPtr skeleton() const;
  FrameRate rate() const;
  const std::vector<std::string>& labels() const;

 private:
  struct Impl;
  /// Output of each request, frame after frame.
  struct Rows {
    std::vector<float> joints;    ///< (n, frames, 3J) metres
    std::vector<float> rotation;  ///< (n, frames, J, 3, 3) parent_from_joint; empty: the network outputs joints only
  };
  Expected<Rows> Answer(const std::vector<MotionRequest>& requests, int threads) const;
  void AddRotations(const float* rotation, const std::vector<double>& bone_length, Motion& motion) const;
  Expected<std::vector<int>> LabelsOf(const Dataset& set) const;
  explicit MotionGenerator(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The clip of a generated motion, "generated/network/000000#0-60", with the request's metadata.
Clip GeneratedClip(std::size_t index, const std::string& label, const MotionRequest& request, Motion motion);

}  // namespace mocurate
