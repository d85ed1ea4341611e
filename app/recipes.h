#pragma once

#include <optional>
#include <string>

#include "core/base/config.h"

namespace mocurate {

/// The recipe of configs/sources that a name without a slash and without the ending of a file means, whatever lies in
/// the folder; nothing: there is none of that name, or a path is meant ("./kard", "kard.yaml").
std::optional<ConfigSource> NamedRecipe(const std::string& name);

/// The text of a recipe of configs/sources by its name ("kard"), or of a config file. Error kUsage lists the recipes.
Expected<ConfigSource> RecipeOf(const std::string& name);

}  // namespace mocurate
