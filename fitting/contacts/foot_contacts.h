#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/base/error.h"
#include "core/motion/motion.h"
#include "core/quality/contacts.h"
#include "fitting/options.h"

namespace mocurate {

struct ProcessNoiseScale;
struct TrackProblem;

/// The joints of one leg, each the parent of the next; `toe` (LimbsOf's tip) is -1 where the skeleton has none.
struct Leg {
  int hip = -1;
  int knee = -1;
  int ankle = -1;
  int toe = -1;
};

/// Left and right leg. Error kUnsupported for a skeleton in which hip, knee and ankle are no chain.
Expected<std::vector<Leg>> LegsOf(const Skeleton& skeleton);

/// The limits of contacts that the options give.
inline ContactLimits LimitsOf(const ContactOptions& options) {
  return {options.height, options.speed, options.min_time_s};
}

/// Measures of the removal of foot sliding.
struct SlidingRemoval {
  double sliding_before = 0.0;  ///< m/s, mean horizontal speed of ankles and toes in contact
  double sliding_after = 0.0;   ///< m/s, in the same frames
  double fastest_before = 0.0;  ///< m/s, the fastest of these steps
  double fastest_after = 0.0;
  double contact_share = 0.0;     ///< of the frames of both feet
  double largest_shift = 0.0;     ///< metres, largest shift of a joint
  double largest_rotation = 0.0;  ///< radians, largest rotation of a joint about its parent
  int frame = -1;                 ///< where the largest shift is
  int joint = -1;                 ///< of it
  int unreachable = 0;            ///< frames of a foot whose corrected place is beyond the leg's length
};

/// Keeps each foot in contact with the floor at its place in the middle of the contact. Only hip, knee and ankle of its
/// leg rotate (two-bone inverse kinematics in the plane of the leg; the foot keeps its orientation). The roll from heel
/// to toe stays. The correction fades over `blend` seconds. Where a leg is too short, the correction is reduced, so
/// that no foot gets faster in a contact. Fills motion.contact (left, right). Adds the correction to stated
/// uncertainties. An observed joint moved by more than a millimetre gets state repaired. Needs rotations. Error
/// kUnsupported of LegsOf.
Expected<SlidingRemoval> RemoveFootSliding(const ContactOptions& options, Motion& motion);

/// {"sliding_before", "sliding_after", "fastest_before", "fastest_after" (m/s), "contact_share", "largest_shift_mm",
/// "largest_turn_deg", "frame", "joint", "unreachable_frames"}.
nlohmann::json SlidingJson(const SlidingRemoval& removal, const Skeleton& skeleton);

/// Ground contact as a prior: where `pose`, the current fit of all frames, has an ankle or toe in contact, its process
/// noise is at most `options.contact_process_noise` (which must be set). The prior states that such a foot hardly
/// moves, not where the floor is. Skeletons without legs are not changed.
void HoldStandingFeet(const Motion& pose, const TrackProblem& window, ProcessNoiseScale& factors);

}  // namespace mocurate
