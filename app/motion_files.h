#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "eval/features/extractor_options.h"
#include "ingest/read_motions.h"

namespace mocurate {

/// How motion files are named on the command line.
struct MotionFiles {
  std::filesystem::path path;    ///< a file or a folder
  std::string source;            ///< source declaration or config; empty: what the files say of themselves
  std::filesystem::path labels;  ///< labels beside them, or empty
  std::vector<double> lie_bone_lengths;
};

/// Whether the files are bare arrays of numbers, which say neither axes nor unit nor joints: .npy, or a folder of them.
bool AreBareArrays(const std::filesystem::path& path);

/// Whether a file is a dataset or MotionSet of ours, which says everything itself.
bool IsMotionStore(const std::filesystem::path& path);

/// Declares a dataset or MotionSet of ours.
ConfigSource MotionStoreConfig(const std::filesystem::path& path);

/// Declares bare arrays as the extractor reads them: its joints, axes, unit and rate.
Expected<IngestOptions> DeclareArrays(const std::filesystem::path& path, const ExtractorOptions& extractor);

/// Declares any other motion files by --source, or by what `inspect` finds. Error kUsage names what nothing says.
Expected<IngestOptions> DeclareMotions(const std::filesystem::path& path, const std::string& source);

/// The item of the stage `motions` for these files; its input is every file of a folder.
Expected<ItemSpec> MotionsItem(const std::string& name, const MotionFiles& files, const ExtractorOptions& extractor);

/// Median length of each bone over the frames of all motions of bare arrays, in their own unit (J), 0 for the root:
/// what Lie parameters of a sibling file are laid out with.
Expected<std::vector<double>> MedianBoneLengths(const std::filesystem::path& path, const ExtractorOptions& extractor);

}  // namespace mocurate
