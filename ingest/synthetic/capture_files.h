#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Names of the files in a capture artifact ({"files": {name: text}}). Error kUnreadable, kMalformed.
Expected<std::set<std::string>> CaptureFileNames(const std::filesystem::path& artifact);

/// Writes the files of a capture artifact into `folder`, and beside it `folder`.json, a list of what was written with
/// the SHA-256 of each. Files of that list which the capture does not hold any more are removed if nobody has changed
/// them; every other file of the folder is left alone, whoever put it there. Error kCannotWrite, also when a file that
/// is not ours has the name of one of the capture.
Status UnpackCapture(const std::filesystem::path& artifact, const std::filesystem::path& folder);

}  // namespace mocurate
