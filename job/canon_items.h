#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "job/job_items.h"

namespace mocurate {

/// Labels of canon.trim.drop_labels without a segment, after the stage canon.
std::vector<Finding> UnmatchedDropLabels(const CanonOptions& options, const std::vector<ItemResult>& items);

/// Warns of listed spans that end after their clips or contain no frame of them, after the stage canon.
void LogSpansOutside(const std::vector<ItemResult>& items);

/// Spans of canon.trim.spans that match no clip of the set. Error of ListedSpans.
Expected<std::vector<Finding>> UnmatchedSpans(const CanonOptions& options, const std::vector<ClipRecord>& clips);

/// The table of spans as an input of stage canon, where the options name one.
std::optional<StageInput> SpansInput(const TrimOptions& options);

/// Checks files and names in the options of canon, and options that other options disable. Error kConfig.
Status CheckCanon(const CanonOptions& options);

/// The options of canon in one line, beside a recipe's description, which does not contain what a run sets.
std::string CanonText(const CanonOptions& options);

/// The table of marked spans, the clips that it names and the floors under them, as inputs of stage canon. Error
/// kConfig for a clip that does not exist or has no motion, or a span outside its clip.
Expected<std::vector<StageInput>> ExampleInputs(const CanonOptions& options, const std::vector<ClipRecord>& clips,
                                                const std::map<std::string, ItemResult>& floors);

/// Name of the group of clips that share a floor, an item of the stage `level`.
std::string FloorGroup(const ClipRecord& clip, LevelOf of);

/// One item per floor, with the motions of at most 300 of its clips, drawn by hash of their names.
std::vector<ItemSpec> LevelItems(const std::vector<ClipRecord>& clips, const LevelOptions& options);

}  // namespace mocurate
