#pragma once

#include <string>
#include <vector>

#include "core/quality/duplicates.h"
#include "ingest/checks/check_options.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {

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
