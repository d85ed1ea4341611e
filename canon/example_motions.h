#pragma once

#include <map>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/motion/motion.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// The marked spans of the rule by_example: motions by label, at the dataset's rate. Inputs: the table of spans (role
/// kExamplesRole) and the clips that it names (role kExampleRole). Error kConfig where a span is outside its clip;
/// those of reading.
Expected<std::map<std::string, std::vector<Motion>>> ReadExamples(const CanonOptions& options,
                                                                  const std::vector<StageInput>& inputs);

}  // namespace mocurate
