#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/quality/duplicates.h"
#include "core/quality/rate.h"
#include "ingest/inspect/measure.h"

namespace mocurate {

/// The rates that a clip's motion allows; no limits where unit or up is not known. `units` and `up` as declared or
/// measured.
RateLimits RateShown(const RawClip& clip, const std::string& units, const std::string& up);

/// What a clip shows, to compare it with others; empty where unit or up is not known.
MotionSignature SignatureShown(const RawClip& clip, const std::string& units, const std::string& up);

/// "walk.bvh frames 3-5 joint head": where a finding is.
std::string PlaceOf(const Finding& finding, const std::string& where);

/// Appends what is wrong with a clip that no source declares, by FindDefects, as `mocurate run` finds it. Where unit or
/// up is not known, only what needs neither is asked, of images nothing; without a rate speeds are those of 30 Hz, and
/// frames may have been excluded.
void ReportChecks(const RawClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  std::vector<Finding>& findings);

}  // namespace mocurate
