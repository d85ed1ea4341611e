#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/motion.h"
#include "train/options.h"

namespace mocurate {

/// n motions: features (n,30) and logits (n,classes), row-major.
struct RecogniserOutput {
  int count = 0;
  int classes = 0;
  int feature_size = 30;
  std::vector<float> features;
  std::vector<float> logits;
};

/// Initial recurrent state of a pass. Zero for reproducible results; normal as in the released code (a2m_actor.md F5),
/// here keyed by `seed` and the index of the motion.
struct RecogniserHidden {
  InitialHidden kind = InitialHidden::kZero;
  std::uint64_t seed = 0;
};

/// Writes motions [begin, end) as (end - begin, frames, dim) float32, and for each the frame whose output is used.
/// Called from several threads at once.
using MotionWriter = std::function<void(int begin, int end, float* values, int* read_out)>;

/// A trained recogniser of motions: accuracy and features of every metric.
class Recogniser {
 public:
  /// From a checkpoint of mocurate. Errors of ReadCheckpoint.
  static Expected<std::unique_ptr<Recogniser>> Load(const std::filesystem::path& path);
  /// From the published weights (a legacy PyTorch file): read as data, no code is executed. With `skeleton` they are of
  /// an ST-GCN on its joints, else of a GRU.
  static Expected<std::unique_ptr<Recogniser>> LoadPublished(const std::filesystem::path& path,
                                                             const Skeleton* skeleton = nullptr);
  ~Recogniser();

  /// `count` motions that `write` makes, chunk by chunk; dim must be input_size(). Chunks of 256 motions over
  /// `threads`, which do not change the result.
  Expected<RecogniserOutput> Run(const MotionWriter& write, int count, int frames, int dim,
                                 const RecogniserHidden& hidden = {}, int threads = 1) const;

  int input_size() const;
  /// Whether a frame is the rotations of the joints (6 numbers each, first two rows), with the root's or without.
  bool reads_rotations() const;
  int class_count() const;
  /// Of the training data; null for published weights.
  SkeletonPtr skeleton() const;
  /// SHA-256 of the training data; empty for published weights.
  const std::string& dataset_sha256() const;
  /// Class names; empty for published weights.
  const std::vector<std::string>& labels() const;
  /// Frames a second of the training data; 0: not known.
  double rate_hz() const;
  /// How clips must be prepared for it.
  RecogniserInputKind input_kind() const;
  bool reads_last_valid() const;  ///< uses its output at the last frame of the clip, not of the padding
  int input_frames() const;

 private:
  struct Impl;
  explicit Recogniser(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mocurate
