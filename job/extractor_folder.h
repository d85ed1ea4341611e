#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {

/// A trained recogniser for others to score with: weights.safetensors, extractor.yaml (what it reads: joints, frame,
/// length, labels; for people and other programs) and manifest.json, "mocurate-extractor/1", with size and SHA-256 of
/// both. Error kUsage for a network that is no recogniser; kCannotWrite.
Status WriteExtractorFolder(const Checkpoint& checkpoint, const std::string& name, const std::filesystem::path& folder);

struct ExtractorFolder {
  std::string name;
  std::filesystem::path weights;
};

/// Error kMalformed for a manifest that is none; kNotFound for a file that is missing; kInconsistent for one whose
/// content is not that of the manifest, or a description of another network than the weights'.
Expected<ExtractorFolder> OpenExtractorFolder(const std::filesystem::path& folder);

}  // namespace mocurate
