#pragma once

#include <string>
#include <vector>

#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Several actions of HumanAct12 one after the other, with pauses between, like BABEL's long sequences.
struct PlannedSequence {
  int subject = 1;
  int number = 1;
  Script script;
  std::vector<const HumanAct12Variant*> kinds;  ///< of script.actions

  std::string Key() const { return std::to_string(subject) + "/" + std::to_string(number); }
  std::string Person() const;  ///< "p01"
};

/// `least` to `most` actions, drawn from those in options.actions, each in its natural time.
PlannedSequence PlanSequence(const StudioOptions& options, int subject, int number, int least, int most,
                             double rate_hz);

/// The sequence of a person in layout rendered_seq: options.clips actions (0: 4) for cameras of kDepthSequenceHz. The
/// person roughly faces the first camera.
PlannedSequence PlanDepthSequence(const StudioOptions& options, int subject);
inline constexpr std::int64_t kDepthSequenceHz = 15;

/// Error kConfig for a name in options.actions that is no label, action or code of HumanAct12, with the nearest.
Status CheckVariants(const std::vector<std::string>& wanted);

}  // namespace mocurate
