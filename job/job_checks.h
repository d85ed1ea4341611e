#pragma once

#include <map>
#include <string>

#include "ingest/chosen_clips.h"
#include "ingest/discover.h"
#include "ingest/formats/driver.h"
#include "job/job_options.h"
#include "job/job_stage.h"

namespace mocurate {

/// Method for a format's evidence; for motion, that of its joints.
FitMethod MethodFor(EvidenceKind gives);

/// Checks before any work that names in a configuration exist: skeletons, actions of the studio, splits for stages up
/// to `last`. Error kConfig with the option and the nearest name.
Status CheckNames(const JobOptions& options, JobStage last);

/// Checks splits against these captures before they are read (canon/splits): persons and styles, where the file names
/// contain them, and the persons of `roles`. Error kConfig; `findings`: those about roles, as the stage `assemble`
/// reports all others.
Status CheckSplitGroups(const AssembleOptions& options, const std::map<std::string, std::string>& roles,
                        const Discovery& discovery, std::vector<Finding>& findings);

/// Joints of canon.skeleton that the unfitted tracks of the source do not have ("left_toe, right_toe"), by its
/// declaration; empty without any, or where the declaration lists no joints.
std::string JointsWithoutTrack(const JobOptions& options);

}  // namespace mocurate
