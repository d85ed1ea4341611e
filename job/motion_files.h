#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/config.h"
#include "core/pipeline/runner.h"
#include "eval/options.h"
#include "ingest/read_motions.h"

namespace mocurate {

/// Motion files as given on the command line.
struct MotionFiles {
  std::filesystem::path path;    ///< a file or a folder
  std::string source;            ///< source declaration or config; empty: declared by the files themselves
  std::filesystem::path labels;  ///< labels beside them, or empty
  std::vector<double> lie_bone_lengths;
  std::filesystem::path lengths = {};  ///< numbers of frames beside them, or empty
  PaddingAction padding = PaddingAction::kNone;
  ConfigRules rules = {};                  ///< of `source`
  std::vector<std::string> tolerate = {};  ///< codes of findings for which no clip is refused
};

/// Error kUsage for a code that no finding has.
Status CheckTolerated(const std::vector<std::string>& codes);

/// Whether the files are bare arrays of numbers, without axes, unit and joints: .npy, or a folder of them.
bool AreBareArrays(const std::filesystem::path& path);

/// The declaration `source.yaml` in a folder, as `mocurate export` writes it beside its files.
std::optional<std::filesystem::path> DeclarationBeside(const std::filesystem::path& path);

/// Whether a file is a dataset or MotionSet of mocurate, which declares everything itself.
bool IsMotionStore(const std::filesystem::path& path);

/// Declares a dataset or MotionSet of mocurate.
ConfigSource MotionStoreConfig(const std::filesystem::path& path);

/// Declares bare arrays as the extractor reads them: its joints, axes, unit and rate.
Expected<IngestOptions> DeclareArrays(const std::filesystem::path& path, const ExtractorOptions& extractor);

/// Declaration of files, and files that are unusable although their format matches.
struct DeclaredMotions {
  IngestOptions ingest;
  std::vector<RefusedClip> unreadable;
};

/// Declares any other motion files by --source, or by an inspection. Error kUsage names what remains undeclared.
Expected<DeclaredMotions> DeclareMotions(const std::filesystem::path& path, const std::string& source,
                                         const ConfigRules& rules);

/// An item of the stage `motions`; its inputs are every file of a folder.
struct MotionsItem {
  ItemSpec item;
  std::vector<RefusedClip> unreadable;
};

Expected<MotionsItem> MakeMotionsItem(const std::string& name, const MotionFiles& files,
                                      const ExtractorOptions& extractor);

/// Median length of each bone over the frames of all motions of bare arrays, in their own unit (J), 0 for the root:
/// bone lengths for the Lie parameters of a related file.
Expected<std::vector<double>> MedianBoneLengths(const std::filesystem::path& path, const ExtractorOptions& extractor);

}  // namespace mocurate
