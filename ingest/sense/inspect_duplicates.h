#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/quality/duplicates.h"
#include "ingest/sense/observed_clip.h"

namespace mocurate {

/// What the clips of a folder show, kept to tell which of them show the same, as `mocurate run` does.
class SeenMotions {
 public:
  /// `report`: what the inspection says of the clip. Clips whose unit or up is unknown are compared with none.
  void Add(const ObservedClip& clip, const nlohmann::json& report);
  void Tell(const CheckOptions& options, nlohmann::json& findings) const;

 private:
  std::vector<std::string> ids_;
  std::vector<MotionSignature> signatures_;
};

}  // namespace mocurate
