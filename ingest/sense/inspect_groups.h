#pragma once

#include "ingest/sense/inspection.h"

namespace mocurate {

/// Fills `groups`: clips of one folder, format and joint count together, as what one clip cannot tell, the others may.
///
/// Handedness belongs to the recording, not to the clip: in a group of one known skeleton where at least 5 clips tell
/// and agree, all but one or 95 % of what they say, it is told of those that do not tell (standing still, arms down). A
/// clip that says otherwise gets a finding "handedness_outlier", facing and axes unknown, and the group's value;
/// unknown where it is at least 60 % sure itself. Declared values stay. Measured units that are a power of ten from
/// those of the others are "units_outlier", with two axes exchanged "axes_outlier", rates that motions deny
/// "rate_doubtful" of the folder.
///
/// "cut_off": an OBJ without faces in a folder where most, and at least two, have some. The format announces no counts:
/// cut at the end of a line it is a smaller mesh, which only the others show.
void CompareGroups(Inspection& inspection);

}  // namespace mocurate
