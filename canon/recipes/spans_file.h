#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/formats/span_table.h"
#include "core/motion/clip.h"

namespace mocurate {

/// A table of configs/spans by its name, "humanact12"; nothing for an unknown name.
std::optional<std::string_view> BuiltInSpans(const std::string& name);

/// Reads a table of spans (core/formats/span_table.h). Errors of ReadFile and ParseSpanTable.
Expected<std::vector<ListedSpan>> ReadSpans(const std::filesystem::path& file);

/// The spans of the options: of the file, else of the built-in table, else none. Errors of ReadSpans; kConfig for an
/// unknown table.
Expected<std::vector<ListedSpan>> ListedSpans(const TrimOptions& options);

/// Segment::origin of listed spans.
inline constexpr const char* kListedOrigin = "listed";

/// Replaces the clip's segments by the spans that name it (by its id, its id without frames, or its recording alone;
/// origin "listed"); without any, it keeps its own. A span's
/// fine label becomes the segment's label and its label the category. Seconds and frames count from the recording's
/// first frame, also where the clip begins later. Findings: "span_outside" of a span that ends after the clip (cut
/// there) or has no frame of it (dropped, severity error).
void ApplySpans(const std::vector<ListedSpan>& spans, Clip& clip, std::vector<Finding>& findings);

}  // namespace mocurate
