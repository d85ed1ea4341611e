#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// What a motion is, whatever its place, heading, length in frames, number of decimals and file format. A body of a
/// wrong unit is brought to a person's size by a power of ten: what follows in metres is meant so.
struct MotionSignature {
  /// (kSignatureFrames, K + 1, 3): points from the middle of the hips, which itself comes last, from its mean; turned
  /// so that the hips lie along x on average; resampled over the clip's time. Missing points are filled in time.
  std::vector<float> shape;
  std::vector<float> mirrored;       ///< of the mirror image, sides exchanged; empty where sides are not known
  std::vector<std::uint64_t> poses;  ///< (F) of the distances between joints, to 0.2 mm; 0: not all are observed
  double spread = 0.0;               ///< metres, root mean square of `shape` about its mean over time
  int points = 0;
};
constexpr int kSignatureFrames = 32;

/// Empty `shape` when fewer than two frames show any person. Metres; y up as far as the heading is concerned.
MotionSignature SignatureOf(const TrackedPoints& points);

struct DuplicateLimits {
  double distance = 0.005;  ///< metres, root mean square between signatures, below which they are one motion
  int shared_frames = 4;    ///< equal poses, each different from the others, that two recordings do not share by chance
};

/// Two clips that show the same. `frame_begin` and `frame_end` are of the first.
struct Duplicate {
  std::size_t first = 0, second = 0;  ///< indices, first < second
  bool whole = false;                 ///< else a part of one or of both
  bool mirrored = false;
  double distance = 0.0;  ///< metres; 0 where equal poses show it
  int shared = 0;         ///< equal poses
  int frame_begin = 0, frame_end = 0;
  int second_begin = 0, second_end = 0;
};

/// Near-duplicates: every pair whose signatures (or one's mirror image) are nearer than `distance`, and every pair that
/// shares at least `shared_frames` poses. Exact: pairs are skipped only by the triangle inequality.
/// Clips with different numbers of points are not compared; clips that hardly move (spread below four times
/// `distance`) are compared by their poses alone. Sorted by (first, second).
std::vector<Duplicate> FindDuplicates(const std::vector<MotionSignature>& clips, const DuplicateLimits& limits = {});

/// Motion of an index, or null; valid until the next call.
using MotionAt = std::function<const Motion*(std::size_t)>;

/// The same of `count` motions of one skeleton, and of parts of them: copies, crops, other rates and small noise, also
/// mirrored. The longest shared stretch of every two that have one (FindSharedStretches, below `distance` metres);
/// pairs of equal poses; of clips that are too short or have too few joints for a stretch, those of equal signatures.
/// Each motion is requested three times and takes about 2 kB per second. Sorted by (first, second).
std::vector<Duplicate> FindDuplicates(std::size_t count, const MotionAt& motion, double distance = 0.004);

constexpr double kLeastStretch_s = 0.6;  ///< length of a stretch

/// The longest shared stretch of every two of `count` motions that have one. Joints are compared by their distances
/// from all other joints, which do not depend on place, heading, axes or camera: at most `distance` metres apart, root
/// mean square over the stretch, of the joint that differs most. Windows of kLeastStretch_s are looked up in a k-d tree
/// of their principal components, then compared over the whole overlap at the best shift in time; at least 0.8 of the
/// overlap must be shared, as takes of one person agree in parts. Joints are smoothed by a Gaussian of 0.08 s, so that
/// interpolation and noise of millimetres do not hide a copy. Motions of one skeleton whose frames lie at most
/// kMaxGap_s apart, others match none.
std::vector<Duplicate> FindSharedStretches(std::size_t count, const MotionAt& motion, double distance);

}  // namespace mocurate
