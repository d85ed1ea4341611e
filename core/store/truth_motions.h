#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/motion/clip.h"

namespace mocurate {

/// Moves a clip back to the world of its source.
void UndoCanonical(Clip& clip);

/// True motions of recordings, in the world of their source, by clip id.
class TruthMotions {
 public:
  /// A file of ground truth, or a dataset or MotionSet as the truth. Errors of ReadTruth.
  Status Add(const std::filesystem::path& path);

  /// The truth of a fitted clip, at its rate: of the same id, or frames of the truth of its whole recording.
  std::optional<Motion> Of(const Clip& fitted) const;

  /// "none", or the first id in quotes.
  std::string FirstId() const;

 private:
  std::map<std::string, Motion> motions_;
};

}  // namespace mocurate
