#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// Known faults of motions, each with a dose that is a number.
enum class Damage {
  kJitter,
  kSliding,
  kFrozen,
  kMirrored,
  kTruncated,
  kSwappedLabels,
  kBoneDrift,
  kYaw,
  kRate,
  kScale
};
inline constexpr int kDamageCount = 10;

/// What one damage is. Doses lie in [low, high].
struct DamageInfo {
  Damage damage;
  const char* name;  ///< with the unit: "jitter_mm"
  const char* unit;
  double none;  ///< the dose that changes nothing: 0, of factors 1
  double low, high;
  std::vector<double> doses;  ///< by default, without `none`
  const char* help;
};

/// The table of all damages, in the order of `Damage`.
const std::array<DamageInfo, kDamageCount>& Damages();
const DamageInfo& InfoOf(Damage damage);

/// What the network reads that scores the motions. Noise goes where it is read.
enum class DamagedValues { kJoints, kRotations };

/// One damage and the doses that are scored, in their order, without `none`.
struct DoseSeries {
  Damage damage = Damage::kJitter;
  std::vector<double> doses;
};

/// "jitter_mm=1,5,20", or "jitter_mm" for its default doses; nothing gives all damages. Error kUsage: a damage that
/// there is not, or that is named twice; a dose that is no number, or outside the damage's range.
Expected<std::vector<DoseSeries>> ParseDoses(const std::vector<std::string>& texts);

/// White noise of `millimetres` (standard deviation per axis, joint and frame). kJoints: on each position; what remains
/// is joints alone. kRotations: on the root's place and on every joint's rotation, of one angle for all joints, such
/// that the joints move by the same root mean square, sqrt(3) * millimetres, and bones keep their lengths.
Motion AddJitter(const Motion& motion, double millimetres, DamagedValues values, std::uint64_t seed,
                 const std::string& item);

/// The whole motion drifts at a constant horizontal velocity of `millimetres_per_second`; its direction is drawn.
Motion AddSliding(const Motion& motion, double millimetres_per_second, std::uint64_t seed, const std::string& item);

/// Every frame is the first.
Motion Frozen(const Motion& motion);

/// The first frames, without the last `share` of them, rounded; at least one.
Motion Truncated(const Motion& motion, double share);

/// Every bone grows by `percent_per_second` of its length each second, directions and root stay; joints alone remain,
/// for a motion with rotations has one length of each bone.
Motion DriftBones(const Motion& motion, double percent_per_second);

/// Turned about the vertical through the root's first place, to a side that is drawn.
Motion Turned(const Motion& motion, double degrees, std::uint64_t seed, const std::string& item);

/// Played `factor` times as fast at the same frame rate: floor((frames - 1) / factor) + 1 frames.
Motion PlayedFaster(const Motion& motion, double factor);

/// Bones and path `factor` times as long, about the root's first place.
Motion Scaled(const Motion& motion, double factor);

/// Which of the items are damaged at this share: round(share * items), drawn by (seed, damage, item), in such a way
/// that a larger share holds all of a smaller one. (items)
std::vector<bool> DamagedShare(const std::vector<std::string>& items, double share, Damage damage, std::uint64_t seed);

/// Whether clips can have the damage. Error kInconsistent: labels are to be swapped, and there are not two;
/// kUnsupported: bones are to drift, and rotations are read, which say no lengths.
Status CheckDamage(const std::vector<Clip>& clips, Damage damage, DamagedValues values);

/// The clips of `rows` with one damage: motions, or labels, and what lies in time (segments). Ids stay. Splits and
/// findings are left out, and of damaged motions what was said of their frames (states, covariances, contacts). Noise
/// and drawn directions are those of (seed, damage, clip): a larger dose is more of the same. `none` changes nothing.
/// Requires CheckDamage of those clips.
Dataset DamagedDataset(const Dataset& dataset, const std::vector<int>& rows, Damage damage, double dose,
                       DamagedValues values, std::uint64_t seed);

}  // namespace mocurate
