#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/config.h"

namespace mocurate {

/// The items of papers that can be reproduced, by their configs below configs/papers: "actor/table3".
std::vector<std::string> PaperIds();

/// The job of configs/ that a name means ("kard", "reannotate/kard", "papers/actor/table3"), embedded, whatever lies in
/// the folder. Nothing: no job has that name, or a path is meant ("./kard", "kard.yaml").
std::optional<ConfigSource> NamedJob(const std::string& name);

/// Error kConfig about a name that no job has: the jobs, the nearest one first.
Error NoJob(const std::string& name);

/// The source declaration of configs/sources that a name means ("kard"); nothing as above.
std::optional<ConfigSource> NamedSource(const std::string& name);

/// What `--source` means: a source declaration by its name, or a config file. Error kUsage lists the declarations.
Expected<ConfigSource> SourceOf(const std::string& name);

}  // namespace mocurate
