#pragma once

#include <string>
#include <vector>

#include "core/quality/duplicates.h"
#include "ingest/checks/finding_table.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/measure.h"
#include "ingest/inspect/raw_clip.h"
#include "ingest/options.h"

namespace mocurate {

/// One clip as it stands in an inspection without a source; what is wrong with it is appended to `findings`.
InspectedClip ClipReport(const RawClip& clip, const std::string& file, std::vector<Finding>& findings);

/// The same of a clip that a run of `source` gives (ReadRawClip): its statements are the values, and the measured ones
/// stand beside them. What is wrong with it are the run's findings; "many_missing" is appended.
InspectedClip DeclaredReport(const RawClip& clip, const std::string& file, const SourceOptions& source,
                             std::vector<Finding>& findings);

Reported<std::string> MeasuredText(const Measured& measured);

/// "walk.bvh frames 3-5 joint head": where a finding is.
std::string PlaceOf(const Finding& finding, const std::string& where);

/// What the clips of a folder show, kept to tell which of them show the same, as `mocurate run` does.
class InspectedMotions {
 public:
  /// `report`: what the inspection says of the clip. Clips whose unit or up is unknown are compared with none.
  void Add(const RawClip& clip, const InspectedClip& report);
  void Compare(const CheckOptions& options, std::vector<Finding>& findings) const;

 private:
  std::vector<std::string> ids_;
  std::vector<MotionSignature> signatures_;
};

}  // namespace mocurate
