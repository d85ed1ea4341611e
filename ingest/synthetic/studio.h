#pragma once

#include <map>
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

}  // namespace mocurate
