#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/motion/skeleton.h"

namespace mocurate {

/// Everything a Skeleton says, so that a checkpoint can make motions without the file it came from.
nlohmann::json SkeletonToJson(const Skeleton& skeleton);

/// Error kMalformed (a field is missing or of another type), or what Skeleton::Check says; `where` is shown.
Expected<SkeletonPtr> SkeletonFromJson(const nlohmann::json& json, const std::string& where);

}  // namespace mocurate
