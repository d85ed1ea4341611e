#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Names of the files in a capture artifact ({"files": {name: text}}). Error kUnreadable, kMalformed.
Expected<std::set<std::string>> CaptureFileNames(const std::filesystem::path& artifact);

/// Writes the files of a capture artifact into `folder`, and beside it `folder`.json, a list of the files with their
/// SHA-256. Files on an earlier list that the capture no longer contains are removed if they are unchanged; all other
/// files stay. Error kCannotWrite, also when a file that is not on the list has the name of one of the capture.
Status UnpackCapture(const std::filesystem::path& artifact, const std::filesystem::path& folder);

}  // namespace mocurate
