#pragma once

#include <string>

#include "core/base/config.h"

namespace mocurate {

/// The text of a recipe of configs/sources by its name ("kard"), or of a config file. Error kUsage lists the recipes.
Expected<ConfigSource> RecipeOf(const std::string& name);

}  // namespace mocurate
