#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/store/store.h"

/// The small fixed inputs of the stages. None of them is made by a stage: what one stage changes moves no other's
/// input.
namespace mocurate::versions {

/// A person of openni16 who stands, raises arms and knees with `vigour`, and stands again.
Motion Exercise(int frames, double vigour);

/// The motion as a tracker saw it: noise, missing joints, no root.
Clip TrackedClip(const std::string& person, const std::string& recording, const std::string& label,
                 const Motion& motion);

/// The same clip with its motion and no evidence, as fitting leaves it, in a set of its own.
Dataset FittedClip(const Clip& tracked, const Motion& motion);

/// Two persons who train and one who tests, two labels, two clips each; joints only.
Dataset SmallDataset();

/// A joint table of the motion: one row "x y z confidence" per joint but the root, millimetres, z away from the sensor.
std::string JointTable(const Motion& motion);

/// A BVH file of one leg, with a position on a joint that is no root.
std::string BvhText();

/// Summary of a run about one fitted clip, as the runner hands it to the report.
nlohmann::json RunSummary(const std::string& clip);

}  // namespace mocurate::versions
