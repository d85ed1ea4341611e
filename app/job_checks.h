#pragma once

#include "app/job_options.h"
#include "app/job_stage.h"
#include "ingest/chosen_clips.h"
#include "ingest/discover.h"
#include "ingest/formats/driver.h"

namespace mocurate {

/// How what a format gives is fitted; of motion its joints.
FitMethod MethodFor(Gives gives);

/// What a configuration names must exist before any work begins: skeletons, actions of the studio, and the splits that
/// stages up to `last` ask for. Error kConfig with the option, and the nearest name there is.
Status CheckNames(const JobOptions& options, JobStage last);

/// Splits by person or style that these captures cannot meet (canon/splits), once the names of the files are known.
Status CheckSplitGroups(const AssembleOptions& options, const Discovery& discovery);

/// The joints of canon.skeleton that the unfitted tracks of the source do not give ("left_toe, right_toe"), as far as
/// its declaration tells; empty where they give all or it does not tell.
std::string JointsWithoutTrack(const JobOptions& options);

}  // namespace mocurate
