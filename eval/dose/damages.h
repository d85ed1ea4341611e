#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// Known faults of motions, each with a numeric dose.
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

/// Definition of one damage. Doses lie in [low, high].
struct DamageInfo {
  Damage damage;
  const char* name;  ///< with the unit: "jitter_mm"
  const char* unit;
  double none;  ///< the dose without effect: 0, for factors 1
  double low, high;
  std::vector<double> doses;  ///< by default, without `none`
  const char* help;
};

/// The table of all damages, in the order of `Damage`.
const std::array<DamageInfo, kDamageCount>& Damages();
const DamageInfo& InfoOf(Damage damage);

/// The input of the network that scores the motions. Noise is added to that input.
enum class DamagedValues { kJoints, kRotations };

/// One damage and its scored doses, in their order, without `none`.
struct DoseSeries {
  Damage damage = Damage::kJitter;
  std::vector<double> doses;
};

/// "jitter_mm=1,5,20", or "jitter_mm" for its default doses; empty: all damages. Error kUsage: an unknown or repeated
/// damage; a dose that is not a number, or outside the damage's range.
Expected<std::vector<DoseSeries>> ParseDoses(const std::vector<std::string>& texts);

/// White noise of `millimetres` (standard deviation per axis, joint and frame). kJoints: on each position; the result
/// has joints only. kRotations: on the root's position and on every joint's rotation, with one angle for all joints, so
/// that the joints move by the same root mean square, sqrt(3) * millimetres, and bones keep their lengths.
Motion AddJitter(const Motion& motion, double millimetres, DamagedValues values, std::uint64_t seed,
                 const std::string& item);

/// The whole motion drifts at a constant horizontal velocity of `millimetres_per_second`; its direction is drawn.
Motion AddSliding(const Motion& motion, double millimetres_per_second, std::uint64_t seed, const std::string& item);

/// Every frame is the first.
Motion Frozen(const Motion& motion);

/// The first frames, without the last `share` of them, rounded; at least one.
Motion Truncated(const Motion& motion, double share);

/// Every bone grows by `percent_per_second` of its length each second; directions and root stay. The result has joints
/// only, because a motion with rotations has constant bone lengths.
Motion DriftBones(const Motion& motion, double percent_per_second);

/// Rotated about the vertical through the root's first position, with a random sign.
Motion Turned(const Motion& motion, double degrees, std::uint64_t seed, const std::string& item);

/// Played `factor` times as fast at the same frame rate: floor((frames - 1) / factor) + 1 frames.
Motion PlayedFaster(const Motion& motion, double factor);

/// Bones and path `factor` times as long, about the root's first position.
Motion Scaled(const Motion& motion, double factor);

/// The damaged items at this share: round(share * items), drawn by (seed, damage, item); a larger share includes the
/// items of a smaller one. (items)
std::vector<bool> DamagedShare(const std::vector<std::string>& items, double share, Damage damage, std::uint64_t seed);

/// Whether clips can have the damage. Errors: kInconsistent for swapped labels with fewer than two labels; kUnsupported
/// for bone drift where rotations are read, which contain no lengths.
Status CheckDamage(const std::vector<Clip>& clips, Damage damage, DamagedValues values);

/// The clips of `rows` with one damage: motions, or labels, and data in time (segments). Ids stay. Splits and findings
/// are removed, for damaged motions also their frames' states, covariances and contacts. Noise and drawn directions
/// depend on (seed, damage, clip): a larger dose scales the same noise. `none` changes nothing. Requires CheckDamage of
/// those clips.
Dataset DamagedDataset(const Dataset& dataset, const std::vector<int>& rows, Damage damage, double dose,
                       DamagedValues values, std::uint64_t seed);

}  // namespace mocurate
