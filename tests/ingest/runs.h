#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/ingest/sources.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {

/// The outcome of an item after the stage `ingest`.
inline std::vector<ItemResult> RunAll(const IngestOptions& options) {
  std::vector<ItemResult> results;
  const auto discovery = Discover(options);
  if (!discovery) ADD_FAILURE() << discovery.error().Message();
  for (std::size_t i = 0; discovery && i < discovery->items.size(); ++i) {
    const ItemSpec& item = discovery->items[i];
    StageRequest request;
    request.stage = "ingest";
    request.item = item.item;
    request.options = item.options.Whole();
    request.inputs = item.inputs;
    request.output = SharedScratch("run.h5");
    std::filesystem::remove(request.output);
    ItemResult result;
    result.item = item.item;
    auto outcome = IngestStage(request);
    if (outcome) {
      result.summary = outcome->summary;
      result.outcome = *std::move(outcome);
    } else {
      ADD_FAILURE() << outcome.error().Message();
    }
    results.push_back(std::move(result));
  }
  return results;
}

/// The stage `ingest` of a whole source. Its artifacts are deleted with the value.
struct SourceRun {
  Expected<Discovery> discovery;
  std::vector<Expected<StageOutcome>> outcomes;  ///< of each item of `discovery`
  std::filesystem::path folder;

  explicit SourceRun(const IngestOptions& options) : discovery(Discover(options)) {
    static int runs = 0;
    folder = FreshFolder("source_run_" + std::to_string(runs++));
    for (std::size_t i = 0; discovery && i < discovery->items.size(); ++i) {
      const ItemSpec& item = discovery->items[i];
      outcomes.push_back(IngestStage({"ingest", item.item, item.options.Whole(), item.inputs, Artifact(i), {}}));
    }
  }
  SourceRun(const SourceRun&) = delete;
  SourceRun& operator=(const SourceRun&) = delete;
  ~SourceRun() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }

  std::filesystem::path Artifact(std::size_t item) const { return folder / (std::to_string(item) + ".h5"); }
};

/// A recorded source, run once per process.
inline const SourceRun& RunOnce(const IngestOptions& options) {
  static std::map<std::string, SourceRun> runs;
  return runs.try_emplace(options.path.string() + OptionsToJson(options).dump(), options).first->second;
}

/// RunAll of a recorded source that no test changes, from RunOnce.
inline std::vector<ItemResult> RunAllOnce(const IngestOptions& options) {
  std::vector<ItemResult> results;
  const SourceRun& run = RunOnce(options);
  if (!run.discovery) ADD_FAILURE() << run.discovery.error().Message();
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    ItemResult result;
    result.item = run.discovery->items[i].item;
    if (run.outcomes[i]) {
      result.summary = run.outcomes[i]->summary;
      result.outcome = *run.outcomes[i];
    } else {
      ADD_FAILURE() << run.outcomes[i].error().Message();
    }
    results.push_back(std::move(result));
  }
  return results;
}

/// The recorded sets; test cases share their runs.
class RecordedSets : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

/// Codes of the findings of severity error.
inline std::vector<std::string> ErrorCodes(const Outcome& outcome) {
  std::vector<std::string> codes;
  for (const Finding& finding : outcome.findings) {
    if (finding.severity == Severity::kError) codes.push_back(finding.code);
  }
  return codes;
}

/// Clips with an error of this code.
inline std::size_t CountCode(const std::vector<ItemResult>& clips, const std::string& code) {
  return static_cast<std::size_t>(std::count_if(clips.begin(), clips.end(), [&](const ItemResult& clip) {
    const auto codes = ErrorCodes(clip.outcome);
    return std::find(codes.begin(), codes.end(), code) != codes.end();
  }));
}

}  // namespace mocurate
