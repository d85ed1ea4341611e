#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/motion/skeleton.h"

namespace mocurate {

/// All fields of a Skeleton, so that a checkpoint can generate motions without the skeleton's file.
nlohmann::json SkeletonToJson(const Skeleton& skeleton);

/// Error kMalformed (a field is missing or has another type), or that of Skeleton::Check; `where` is for messages.
Expected<SkeletonPtr> SkeletonFromJson(const nlohmann::json& json, const std::string& where);

}  // namespace mocurate
