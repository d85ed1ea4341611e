#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/job_items.h"

namespace mocurate {

/// Labels of canon.trim.drop_labels that no segment has, after the stage canon.
std::vector<Finding> UnmatchedDropLabels(const CanonOptions& options, const std::vector<ItemResult>& items);

/// Warns of listed spans that end after their clips or have no frame of them, after the stage canon.
void LogSpansOutside(const std::vector<ItemResult>& items);

/// Spans of canon.trim.spans that name no clip of the set. Error of ListedSpans.
Expected<std::vector<Finding>> UnmatchedSpans(const CanonOptions& options, const std::vector<ClipRecord>& clips);

/// The table of spans as an input of stage canon, where the options name one.
std::optional<StageInput> SpansInput(const TrimOptions& options);

/// What the options of canon name and is not there, and options that others leave unread. Error kConfig.
Status CheckCanon(const CanonOptions& options);

/// What canon does to clips, in a line, beside a recipe's words: they cannot know what a run sets.
std::string CanonText(const CanonOptions& options);

/// The table of marked spans, the clips that it names and the floors under them, as inputs of stage canon. Error
/// kConfig where it names a clip that is not there or has no motion, or a span that is not inside it.
Expected<std::vector<StageInput>> ExampleInputs(const CanonOptions& options, const std::vector<ClipRecord>& clips,
                                                const std::map<std::string, ItemResult>& floors);

/// What a clip's floor is shared with: the group's name, an item of the stage `level`.
std::string FloorGroup(const ClipRecord& clip, LevelOf of);

/// One item per floor, with the motions of at most options.most_clips of its clips, drawn by hash of their names.
std::vector<ItemSpec> LevelItems(const std::vector<ClipRecord>& clips, const LevelOptions& options);

}  // namespace mocurate
