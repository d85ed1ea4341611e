#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/pipeline/runner.h"
#include "ingest/options.h"

namespace mocurate {

/// What the clips of a source, after the stage `ingest`, say together against its declaration. Unit, axes and order of
/// joints belong to the source, not to a clip: where at least 3 clips show one of them and contradict the declaration
/// to 95 % (by how much each tells), that is one finding (error) about all of them, and all are suspect; with
/// on_contradiction: refuse all are refused. Those that show nothing come from the same files. So is a rate, declared
/// or of the files, that the motions of enough clips deny (RateDenials).
std::vector<Finding> FindSetContradictions(const SourceOptions& source, std::vector<ItemResult>& clips);

}  // namespace mocurate
