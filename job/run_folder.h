#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "job/job_stage.h"

namespace mocurate {

struct LoadedJob;

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

/// Output folder of a run: the given one, else `name` below runs/. Error kUsage for an empty path, kConfig for an
/// invalid name (empty, '.', '..', with a '/').
Expected<std::filesystem::path> RunFolder(const std::optional<std::filesystem::path>& named, const std::string& name);

/// Error kCannotWrite for a link, a pipe or a device among the files and folders that verbs write in a run folder,
/// which somebody else may have sent. The folder itself may be a link.
Status CheckRunFiles(const std::filesystem::path& folder);

/// Checks that a run may write there: CheckRunFiles, also of the sets of the job. A folder with the run.json of a run
/// must be of the same job: the same name, from the same configuration file, whatever its options; `replace` allows
/// another. A folder without one must not contain a file with the name of an output. Changes nothing. Error kUsage
/// names both jobs, or the first such file.
Status CheckRunFolder(const std::filesystem::path& folder, const LoadedJob& job, bool replace);

}  // namespace mocurate
