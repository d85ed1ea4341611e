#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A source declaration as YAML, with a comment at every value: declared by the file, measured (how sure, and from
/// what), or unknown and to be filled in.
struct WrittenDeclaration {
  std::string yaml;
  std::vector<std::string> unknown;  ///< options that CheckSource refuses until they are filled in: "units", "rate"
};

/// From what InspectPath said of `path` without a source: of the clips, those of the most frequent format and count of
/// joints; the others are named in a comment. `name`: of the source. Error kUnsupported where no clip is of a format
/// that a source can be.
Expected<WrittenDeclaration> DeclareSource(const nlohmann::json& inspection, const std::filesystem::path& path,
                                           const std::string& name);

}  // namespace mocurate
