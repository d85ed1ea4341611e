#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/ingest/sources.h"

namespace mocurate {

/// Items of a source as the stage `ingest` leaves them.
inline std::vector<ItemResult> RunAll(const IngestOptions& options) {
  std::vector<ItemResult> results;
  const auto discovery = Discover(options);
  if (!discovery) ADD_FAILURE() << discovery.error().Message();
  for (std::size_t i = 0; discovery && i < discovery->items.size(); ++i) {
    const ItemSpec& item = discovery->items[i];
    StageRequest request;
    request.stage = "ingest";
    request.item = item.item;
    request.options = item.options;
    request.inputs = item.inputs;
    request.output =
        std::filesystem::path(::testing::TempDir()) / ("run_and_inspect_" + std::to_string(getpid()) + ".h5");
    std::filesystem::remove(request.output);
    ItemResult result;
    result.item = item.item;
    auto outcome = IngestStage(request);
    if (outcome)
      result.outcome = *std::move(outcome);
    else
      ADD_FAILURE() << outcome.error().Message();
    results.push_back(std::move(result));
  }
  return results;
}

/// Codes of the findings of severity error.
inline std::vector<std::string> ErrorCodes(const StageOutcome& outcome) {
  std::vector<std::string> codes;
  for (const Finding& finding : outcome.findings) {
    if (finding.severity == Severity::kError) codes.push_back(finding.code);
  }
  return codes;
}

/// Clips with an error of that code.
inline std::size_t CountCode(const std::vector<ItemResult>& clips, const std::string& code) {
  return static_cast<std::size_t>(std::count_if(clips.begin(), clips.end(), [&](const ItemResult& clip) {
    const auto codes = ErrorCodes(clip.outcome);
    return std::find(codes.begin(), codes.end(), code) != codes.end();
  }));
}

}  // namespace mocurate
