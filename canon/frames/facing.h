#pragma once

#include "canon/options.h"
#include "core/motion/clip.h"
#include "core/motion/heading.h"

namespace mocurate {

/// Whether a rule uses a heading.
bool ReadsHeading(FacingRule rule);

/// HeadingOfAxes of one frame; rules without a heading use the hips. Error of BodyAxes.
Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, const FacingOptions& options);

/// The anchor frame. Error kConfig for a frame that the clip lacks, or the end of a first segment where it has none.
Expected<int> AnchorFrame(const FacingOptions& options, const Clip& clip);

/// Moves the clip into its canonical frame: x -> Q (x - x_anchor), Q by options.rule, so that the anchor's root is at
/// the origin (with kFloor: above it, at its height over y = 0; kMeasured is kFloor where the clip's world has the
/// floor at y = 0 and the rotation keeps it level, else kRoot). kNone moves nothing. Transforms all fields;
/// canonical_from_source stores the inverse, the provenance what height 0 is (kHeightOrigin). Errors of BodyAxes and
/// AnchorFrame; kConfig where kGiven has no rotation for the clip, or two.
Expected<Heading> FaceFront(const FacingOptions& options, Clip& clip);

/// The options of FaceFront in a clip's provenance, JSON.
inline constexpr const char* kFacingNoted = "facing";

/// FaceFront with the options in the clip's provenance, for a part of a canonicalised clip; where its anchor was cut
/// away, the first frame is the anchor. Nothing for a clip without such options. Errors of FaceFront.
Status FaceAgain(Clip& clip);

}  // namespace mocurate
