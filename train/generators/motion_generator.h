#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "train/options.h"

namespace mocurate {

/// A trained generator of motions: answers Requests.
class MotionGenerator {
 public:
  /// From a checkpoint of any network that generates. Errors of ReadCheckpoint.
  static Expected<std::unique_ptr<MotionGenerator>> Load(const std::filesystem::path& path);
  ~MotionGenerator();

  /// Joints of every request, (n, frames, 3J) float32 metres, not re-centred (a2m_actor.md B.7). All requests must ask
  /// for the same number of frames. Errors kInconsistent naming the request (label, bone lengths or frames do not fit).
  /// `threads` do not change a motion.
  Expected<std::vector<float>> Joints(const std::vector<MotionRequest>& requests, int threads = 1) const;

  /// The same as a MotionSet, with rotations where the network gives them: clip ids "generated/network/000000#0-60" in
  /// the order of the requests, label from the request. Frames may differ between requests.
  Expected<Dataset> Generate(const std::vector<MotionRequest>& requests, int threads = 1) const;

  /// A motion in the place of every clip of a set, with its label and length (a2m_actor.md C.5, D.9): the set's clips
  /// in their order, rotations of the network. A clip is interpolated with another one of its class in the set. Draws
  /// are keyed by the seed, the rule and the clip's id; `training_windows` is not read. `proceed` gets the part that is
  /// done and says whether to go on. Errors kInconsistent: a network that encodes nothing, a set on another skeleton or
  /// without rotations, a clip with a label the network lacks; kInterrupted.
  Expected<Dataset> Remake(
      Dataset set, const RemakeOptions& options, int threads = 1,
      const std::function<bool(double)>& proceed = [](double) { return true; }) const;

  /// What it was trained with.
  const NetworkOptions& options() const;

  SkeletonPtr skeleton() const;
  const std::vector<std::string>& labels() const;
  /// Frames it was trained on.
  int training_frames() const;

 private:
  struct Impl;
  /// Of each request, frame after frame.
  struct Rows {
    std::vector<float> joints;    ///< (n, frames, 3J) metres
    std::vector<float> rotation;  ///< (n, frames, J, 3, 3) parent_from_joint; empty: the network gives joints alone
  };
  Expected<Rows> Answer(const std::vector<MotionRequest>& requests, int threads) const;
  void AddRotations(const float* rotation, const MotionRequest& request, Motion& motion) const;
  Expected<std::vector<int>> LabelsOf(const Dataset& set) const;
  explicit MotionGenerator(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mocurate
