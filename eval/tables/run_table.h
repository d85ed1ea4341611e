#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "eval/tables/table.h"

namespace mocurate {

/// The table of a run from what stage `evaluate` gave ({"rows": {name: {"fid": [...], ...}}, "notes": [...]}): the row
/// Real first, then one per generator.
Table RunTable(const nlohmann::json& metrics, const std::string& title);

struct WrittenTables {
  std::string markdown;
  std::vector<std::filesystem::path> files;
};

/// That table as table.md, .csv, .tex and .json below `folder`. Error kCannotWrite.
Expected<WrittenTables> WriteTables(const nlohmann::json& metrics, const std::string& title,
                                    const std::filesystem::path& folder);

}  // namespace mocurate
