#pragma once

#include "ingest/inspect/inspection.h"

namespace mocurate {

/// Fills `groups`: clips of one folder, format and joint count together, as what one clip cannot tell, the others may.
///
/// Handedness belongs to the recording, not to the clip: in a group of one known skeleton where at least 5 clips show
/// it and agree, all but one or 95 % of what they say, the others (standing still, arms down) get it too. A
/// clip that says otherwise gets a finding "handedness_outlier", facing and axes unknown, and the group's value;
/// unknown where it has a confidence of at least 60 % itself. Declared values stay. Measured units that are a power of
/// ten from those of the others are "units_outlier", with two axes exchanged "axes_outlier", rates that motions deny
/// "rate_suspect" of the folder.
void CompareGroups(Inspection& inspection);

}  // namespace mocurate
