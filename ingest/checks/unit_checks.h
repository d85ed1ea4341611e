#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/amass.h"
#include "core/formats/amc.h"
#include "core/formats/asf.h"
#include "core/formats/bvh.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/opensim_table.h"
#include "core/formats/vibe_pickle.h"

namespace mocurate {

/// "angle_unit_contradiction", an error whose value is the longest of them: rotation vectors, which are radians in
/// AMASS, where at least one in twenty of the joints' is longer than a whole turn. Radians of people are not; degrees
/// are. One in 22 may be: a root that is never wrapped.
std::optional<Finding> CheckAngleUnits(const Amass& amass);

/// The same of a clip of `humanact12poses.pkl`.
std::optional<Finding> CheckAngleUnits(const HumanAct12Clip& clip);

/// The same of a person whom VIBE or SPIN followed.
std::optional<Finding> CheckAngleUnits(const VibeTrack& track);

/// The same of a BVH, which is in degrees: at least 10 joints that turn, and none of them but the root by more than
/// what pi is in radians.
std::optional<Finding> CheckAngleUnits(const Bvh& bvh);

/// The same of OpenSim's "Coordinates" whose header says `inDegrees`, of columns that are no translation ("_tx",
/// "_t1"), at least 10 of them: said to be radians, and at least one in twenty numbers, of 3 columns or more, over a
/// whole turn; said to be degrees, and none over what pi is in radians.
std::optional<Finding> CheckAngleUnits(const OpenSimTable& table);

/// Why nothing is measured of poses whose angles are of another unit than their file says.
inline constexpr const char* kInvalidPoses = "the angles are of another unit than the file says";

/// The same of angles in an AMC, whose header (else its skeleton, if any) says the unit: said to be radians, and more
/// than whole turns; said to be degrees, and no joint of at least 10 turned by more than what pi is in radians, nor the
/// root by more than 4 pi. Nothing is doubted of a person whom the numbers show within 0.5 of the rest pose.
std::optional<Finding> CheckAngleUnits(const Amc& amc, const Asf* skeleton);

/// The same of a skeleton that says `angle rad` under :units: the first `axis` number of a bone, else finite number of
/// its limits, of more than a whole turn, 2 pi. The header of `amc`, if any, is named with it.
std::optional<Finding> CheckAngleUnits(const Asf& asf, const Amc* amc = nullptr);

/// What a skeleton cannot be, as errors; `file` is for messages. "length_unit_contradiction", value metres: a body of
/// at least 15 bones whose rest pose is no person's by the file's own unit (`length` under :units; inches), outside 1
/// to 3 m from end to end; or which is one, but of another length by `declared_m`, the metres of a unit that the source
/// says, by more than 5 %. "bone_length", value 0: a bone has no length, and its partner of the other side
/// (lfemur, rfemur) has one, or all others of a person.
std::vector<Finding> CheckAsfSkeleton(const Asf& asf, const std::string& file,
                                      std::optional<double> declared_m = std::nullopt);

}  // namespace mocurate
