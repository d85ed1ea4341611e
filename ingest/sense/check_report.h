#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/quality/duplicates.h"
#include "core/quality/rate.h"
#include "ingest/sense/measure.h"

namespace mocurate {

/// What a clip says of its own rate; nothing where unit or up is not known. `units` and `up` as told or measured.
RateMeasure RateShown(const ObservedClip& clip, const std::string& units, const std::string& up);

/// What a clip shows, to compare it with others; of nobody where unit or up is not known.
MotionSignature SignatureShown(const ObservedClip& clip, const std::string& units, const std::string& up);

/// "walk.bvh frames 3-5 joint head": where a finding is.
std::string PlaceOf(const Finding& finding, const std::string& where);

/// Appends what is wrong with a clip that no source declares, by FindDefects, as `mocurate run` finds it. Where unit or
/// up is not known, only what needs neither is asked, of images nothing; without a rate speeds are those of 30 Hz, and
/// frames may have been left out.
void ReportChecks(const ObservedClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  std::vector<Finding>& findings);

}  // namespace mocurate
