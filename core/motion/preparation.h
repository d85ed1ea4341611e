#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/random.h"
#include "core/motion/motion.h"

namespace mocurate {

/// Action2Motion's clip preparation (a2m_actor.md A.7): a window of `length` frames.
struct Window {
  int start = 0;
  bool padded = false;  ///< clip shorter than the window: the last pose is repeated
};

/// Released: start uniform in [0, n-length-1] (the last start never occurs, F15), 0 when n == length. Inclusive: the
/// last start occurs too.
enum class LastStart { kExcluded, kIncluded };

/// Exclusive upper bound of the start for a clip of n frames; 0 when no draw is made.
int WindowBound(int frame_count, int length, LastStart last_start);

Window DrawWindow(int frame_count, int length, LastStart last_start, Random& random);

/// The frames of a window flattened joint-major, (length, 3*J): the crop's first root subtracted from every joint when
/// the clip is at least as long as the window; a padded clip repeats its last pose and keeps its offset (its first root
/// is already at the origin after loading). `joints` has the first root of the *clip* subtracted before if
/// `centre_clip` (the loader's rule, A.1).
std::vector<double> PrepareWindow(const JointPositions& joints, const Window& window, int length, bool centre_clip);

/// Returns a whole number in [low, high], both included.
using DrawInteger = std::function<std::int64_t(std::int64_t low, std::int64_t high)>;

/// ACTOR's consecutive frames of a clip (a2m_actor.md A.7): first their number in [`shortest`, `longest`] is drawn,
/// then where they begin. A clip shorter than that repeats its last frame. `frame_count` and `shortest` at least 1.
std::vector<int> SampleFrames(int shortest, int longest, int frame_count, const DrawInteger& draw);
std::vector<int> SampleFrames(int shortest, int longest, int frame_count, Random& random);

}  // namespace mocurate
