#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "core/base/error.h"
#include "core/store/store.h"
#include "ingest/options.h"

namespace mocurate {

/// The source declaration of the studio's files (as in configs/demo.yaml).
SourceOptions StudioSource();

/// The files of a capture, by name. Error kConfig: an unknown action, no action.
Expected<std::map<std::string, std::string>> CaptureFiles(const SyntheticOptions& options);

/// The true motion, by the id of the clip that the stage `ingest` makes of each file under StudioSource, in that clip's
/// world: joints are directly comparable. Skeleton kinect20. Errors as above.
Expected<Truth> SyntheticTruth(const SyntheticOptions& options);

/// Names of the files in a capture artifact ({"files": {name: text}}). Error kUnreadable, kMalformed.
Expected<std::set<std::string>> CaptureFileNames(const std::filesystem::path& artifact);

/// Writes the files of a capture artifact into `folder`, and beside it `folder`.json, a list of the files with their
/// SHA-256. Files on an earlier list that the capture no longer contains are removed if they are unchanged; all other
/// files stay. Error kCannotWrite, also when a file that is not on the list has the name of one of the capture.
Status UnpackCapture(const std::filesystem::path& artifact, const std::filesystem::path& folder);

}  // namespace mocurate
