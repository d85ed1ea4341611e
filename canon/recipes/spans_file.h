#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/span_table.h"
#include "core/motion/clip.h"

namespace mocurate {

/// The table of configs/spans that is meant, "humanact12", where no such file exists; nothing for a file.
std::optional<std::string_view> BuiltInSpans(const std::filesystem::path& file_or_name);

/// Reads a table of spans (core/formats/span_table.h): a file, or one of configs/spans by its name. Errors of ReadFile
/// and ParseSpanTable.
Expected<std::vector<ListedSpan>> ReadSpans(const std::filesystem::path& file_or_name);

/// Whether a span is of the clip: it names its id, its id without frames, or its recording alone.
bool NamesClip(const ListedSpan& span, const Clip& clip);

/// Gives the clip the spans that name it, as segments (origin "listed") in place of its own; where none names it, it
/// keeps its own. A span's fine label becomes the segment's label and its label the category. Seconds and frames count
/// from the recording's first frame, also where the clip begins later. Findings: "span_outside" of a span that ends
/// after the clip (cut there) or has no frame of it (dropped, severity error). Gives the lines of the spans that were
/// taken.
std::vector<int> ApplySpans(const std::vector<ListedSpan>& spans, Clip& clip, std::vector<Finding>& findings);

}  // namespace mocurate
