#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/store/store.h"

/// The small fixed inputs of the stages. None of them is made by a stage, so that a change of one stage does not change
/// another's input.
namespace mocurate::versions {

/// A person of a skeleton who stands, raises arms and knees by the factor `vigour`, and stands again.
Motion Exercise(int frames, double vigour, const std::string& skeleton = "openni16");

/// The motion as from a tracker: noise, missing joints, no root.
Clip TrackedClip(const std::string& person, const std::string& recording, const std::string& label,
                 const Motion& motion);

/// The motion before three calibrated cameras: depth images of a body of bone capsules, written below `folder`, and
/// keypoints of all joints in the same cameras with 3 px of noise and missing ones, and joint tracks.
Clip RecordedClip(const std::string& person, const std::string& recording, const Motion& motion,
                  const std::filesystem::path& folder);

/// The same clip with its motion and no evidence, as after fitting, in a dataset of its own.
Dataset FittedClip(const Clip& tracked, const Motion& motion);

/// Two training persons and one test person, two labels, two clips each; joints only.
Dataset SmallDataset();

/// A joint table of the motion: one row "x y z confidence" per joint but the root, millimetres, z away from the sensor.
std::string JointTable(const Motion& motion);

/// A BVH file of one leg, with position channels on a joint other than the root.
std::string BvhText();

/// Summary of a run about one fitted clip, as the runner hands it to the report.
nlohmann::json RunSummary(const std::string& clip);

}  // namespace mocurate::versions
