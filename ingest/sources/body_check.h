#pragma once

#include "ingest/sense/observed_clip.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// A clip as the inspection of a file sees one: in the units and axes of its source, with the names that it declares.
ObservedClip ObserveClip(const SourceOptions& source, const Clip& clip);

/// What CheckBody does, on points of the file that the clip does not keep, in the units and axes of the file. What was
/// told of the clip already is not told again.
void CheckPoints(const SourceOptions& source, const ObservedClip& observed, IngestedClip& ingested);

}  // namespace mocurate
