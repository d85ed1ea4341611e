#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "job/job_stage.h"

namespace mocurate {

/// Findings about the set, as a list of JSON: an input of the stage `assemble`, whose dataset holds them too.
inline constexpr const char* kSetFindings = "set_findings.json";

/// A file that a run wrote into its folder, and which version of it: files are replaced whole.
struct OutputFile {
  JobStage stage = JobStage::kReport;  ///< that writes it
  std::uintmax_t bytes = 0;
  std::filesystem::file_time_type written;

  bool operator==(const OutputFile& other) const { return bytes == other.bytes && written == other.written; }
};

/// The outputs in a run folder, by path below it; of a run over several sets also those of each ("data/SET/..."). Not
/// the synthetic capture, nor the record of runs (run.json, journal.jsonl, lock).
std::map<std::string, OutputFile> OutputsIn(const std::filesystem::path& folder);

/// The files of a folder that have the name of an output, including the record of runs (run.json, journal.jsonl, lock)
/// and the list of the capture; relative to the folder, in order of name.
std::vector<std::string> RunFilesIn(const std::filesystem::path& folder);

/// The last journal entry of each item of a stage that was processed.
std::map<std::string, nlohmann::json> JournalOf(const std::filesystem::path& folder, const std::string& stage);

/// Copies a file atomically: it appears complete.
Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace mocurate
