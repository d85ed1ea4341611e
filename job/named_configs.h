#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/config.h"

namespace mocurate {

/// Names of the embedded files of a folder below configs/ ("protocols/"), without it and without extension.
std::vector<std::string> NamesIn(const std::string& folder);

/// The embedded configuration FOLDER/NAME.yaml, or a file. Error kUsage lists them; `what` they are: "recipe".
Expected<ConfigNode> LoadNamed(const std::string& folder, const std::string& what, const std::string& name,
                               const std::vector<std::string>& assignments, const ConfigRules& rules);

/// The items of papers that can be reproduced, by their configs below configs/papers: "actor/table3".
std::vector<std::string> PaperIds();

/// The embedded job of configs/ with that name ("kard", "reannotate/kard", "papers/actor/table3"), whatever files
/// exist. Empty for an unknown name, or a path ("./kard", "kard.yaml").
std::optional<ConfigSource> NamedJob(const std::string& name);

/// The name of the job in that text ("kard"); the source's own name where it is not one of configs/.
std::string JobNameOf(const ConfigSource& source);

/// Error kConfig for an unknown name: lists the jobs, the nearest one first.
Error NoJob(const std::string& name);

/// The source declaration of configs/sources with that name ("kard"); empty as above.
std::optional<ConfigSource> NamedSource(const std::string& name);

/// The source of `--source`: a source declaration by its name, or a config file. Error kUsage lists the declarations.
Expected<ConfigSource> SourceOf(const std::string& name);

}  // namespace mocurate
