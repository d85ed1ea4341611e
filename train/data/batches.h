#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "train/data/training_set.h"
#include "train/options.h"

namespace mocurate {

/// Rows of a training set in the parts of a training.
struct TrainingRows {
  std::vector<int> train;
  std::vector<int> validation;  ///< drawn from the training part of the split, never from its test part
  std::string split;            ///< name, or empty without one
  std::string validation_rule;  ///< as text
};

/// Clips of the training part of the split in the options, reduced by `fraction`. With `held_out`, the split's own
/// validation part, or all clips of one training person (by `seed`), or a fraction `smallest_validation` of the clips
/// becomes the validation part. Errors: kConfig (unknown split), kInconsistent (a clip without label or motion, fewer
/// than 2 training clips).
Expected<TrainingRows> SelectTrainingRows(const TrainingSet& set, const TrainingDataOptions& options, bool held_out,
                                          std::uint64_t seed, double smallest_validation);

/// Generated clips, except those of the recordings of held-out rows, which would leak into the validation.
std::vector<int> MadeWithout(const TrainingSet& set, const std::vector<int>& held_out);

/// The clips of each step: passes over the rows in shuffled order, by class where the options balance them.
class BatchOrder {
 public:
  /// `keep_last`: a pass ends with a smaller batch; else that is dropped (a2m_actor.md B.6). Draws are keyed by
  /// (`seed`, `purpose`, pass).
  BatchOrder(const TrainingSet& set, const TrainingDataOptions& options, std::vector<int> rows, std::int64_t batch,
             bool keep_last, std::uint64_t seed, std::string purpose = "train.order");

  std::int64_t batches_per_pass() const { return per_pass_; }
  std::vector<int> RowsOf(std::int64_t step) const;

 private:
  std::vector<int> PassOf(std::int64_t pass) const;

  std::vector<int> rows_;
  std::vector<std::vector<int>> by_class_;  ///< positions in rows_, where classes are balanced
  std::int64_t batch_, per_pass_;
  std::uint64_t seed_;
  std::string purpose_;
  mutable std::int64_t pass_ = -1;  ///< of `order_`
  mutable std::vector<int> order_;
};

/// The same with a given share of each batch from the rows `made` (of TrainingSet::made), in their own order. Every
/// batch has that share of both; the last of a pass is dropped where it would be smaller. A pass is one over the
/// recorded rows. Without `made`, recorded clips only.
class MixedOrder {
 public:
  MixedOrder(const TrainingSet& set, const TrainingDataOptions& options, std::vector<int> rows, std::vector<int> made,
             std::int64_t batch, bool keep_last, double made_share, std::uint64_t seed);

  std::int64_t batches_per_pass() const { return recorded_.batches_per_pass(); }
  std::vector<int> RowsOf(std::int64_t step) const;

 private:
  BatchOrder recorded_;
  std::optional<BatchOrder> made_;
};

/// Windows of clips, frame-major.
struct MotionRows {
  int frames = 0;
  std::vector<float> motion;        ///< (T,B,3J) metres, first root at the origin
  std::vector<std::int64_t> label;  ///< (B)
  std::vector<float> rotation;      ///< (T,B,J,3,3) where the set has rotations; else empty
  std::vector<std::int64_t> parts;  ///< (B,3) frames of the three parts of samples; or empty
  std::vector<std::int64_t> word;   ///< (B,3) their labels in TrainingSet::words
  std::vector<int> length;          ///< (B) frames before the padding, which is 0; empty: no padding
};

/// Windows of `rows` by the options. Draws are keyed by (seed, `key`, index); without `augment` there are no random
/// changes.
MotionRows MakeMotionRows(const TrainingSet& set, const TrainingDataOptions& options, const std::vector<int>& rows,
                          std::uint64_t seed, const std::string& key, bool augment);

/// Pose of a sample for a network (multiact.md B): network_from_world from its anchor, the last frame of the previous
/// motion. `rest_axes` of the skeleton (core/motion/heading.h), `root` world_from_root, `place` of the root;
/// `canonical_from_source` of the sample, whose inverse kNone uses.
RigidTransform NetworkFromWorld(CanonicalChoice choice, const Matrix3d& rest_axes, const Quaterniond& root,
                                const Vector3d& place, const RigidTransform& canonical_from_source);

/// Samples of three parts, padded to `frames`: joints and rotations in the network's frame, identities after the end.
/// The parts of a clip must have at most that many frames together.
MotionRows PlacedSamples(const TrainingSet& set, CanonicalChoice choice, int frames, const std::vector<int>& rows);

/// The training clips of a network, cut into consecutive windows of its `frames`; the remainder is dropped. Of a clip
/// with inferred frames the longest stretch without them is cut; one of nothing else is left out. Of these the set's
/// one finding states the number, "inferred_frames". A shorter clip stays whole, or is excluded where the network has a
/// fixed length. They are the training part of the set's one
/// split; clips of the validation part become its validation part, and with `test` those of the test part its test
/// part. Clips of these two without a motion or a label of the set are excluded. Errors of SelectTrainingRows.
Expected<Dataset> TrainingWindows(Dataset set, const NetworkOptions& network, bool test);

/// Positions 0..count-1 in the order of one pass, drawn by Fisher-Yates.
std::vector<int> ShuffledOrder(int count, Random random);

/// Chains of a skeleton: its own, or derived from the tree where it declares none (the first child continues a chain,
/// raw offsets are the directions of the rest pose).
LieChains ChainsOf(const Skeleton& skeleton);

}  // namespace mocurate
