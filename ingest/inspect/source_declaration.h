#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {

/// ingest.source.person of a declaration of files that do not say who performs.
inline constexpr const char* kUnknownPerson = "unknown";

/// A source declaration as YAML, with a comment at every value: declared by the file, measured (how sure, and from
/// what), or unknown and to be filled in. Of files that hold rotations also `fitting: {method: none}`, which keeps
/// them.
struct WrittenDeclaration {
  std::string yaml;
  std::vector<std::string> others;   ///< clips that are not of this source: "3 clips of format npz of 19 joints"
  std::vector<std::string> unknown;  ///< options that CheckSource refuses until they are filled in: "units", "rate"
};

/// Who performs what, where the format does not declare it: to be filled in, or no one's (kUnknownPerson, no label)
/// where clips are looked at once.
enum class NamesOfClips { kToFillIn, kNone };

/// From what InspectPath said of `path` without a source: of the clips, those of the most frequent format and count of
/// joints; the others are named in a comment. Where there are no clips but depth images of calibrated cameras, of
/// these. `name`: of the source. Error kUnsupported where no clip is of a format that a source can be.
Expected<WrittenDeclaration> DeclareSource(const Inspection& inspection, const std::filesystem::path& path,
                                           const std::string& name, NamesOfClips names = NamesOfClips::kToFillIn);

/// Keeps the clips that any of the names chooses (ingest/chosen_clips.h); all without names. Error kUsage of the first
/// name that chooses none.
Status ChooseClips(const std::vector<std::string>& names, Inspection& inspection);

}  // namespace mocurate
