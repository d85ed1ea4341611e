#pragma once

#include "ingest/inspect/raw_clip.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// A clip as inspection sees a file: in the units and axes of its source, with the declared names.
RawClip ReadRawClip(const SourceOptions& source, const Clip& clip);

/// CheckBody on points of the file that the clip does not keep, in the units and axes of the file. A contradiction that
/// the clip has already is not reported again.
void CheckPoints(const SourceOptions& source, const RawClip& observed, IngestedClip& ingested);

}  // namespace mocurate
