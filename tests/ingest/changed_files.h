#pragma once

#include <gmock/gmock.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {

/// Edited copies of recorded files in a test folder, with the findings of an inspection and of a run.
class ChangedFiles : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }

  static std::string Recorded(const std::string& path) { return *ReadFile(TestData() + "/" + path); }

  nlohmann::json Inspect(const std::optional<SourceOptions>& source = {}) const { return InspectPath(folder_, source); }

  /// A source declaration of configs/sources for the files of the test, without annotations.
  IngestOptions From(const std::string& declaration) const {
    IngestOptions options = Declared(declaration);
    options.path = folder_;
    options.source.annotations.clear();
    return options;
  }

  /// The only clip of a run.
  static StageOutcome RunOne(const IngestOptions& options) {
    const std::vector<ItemResult> clips = RunAll(options);
    EXPECT_EQ(clips.size(), 1u);
    StageOutcome outcome;
    if (clips.empty()) return outcome;
    static_cast<Outcome&>(outcome) = clips[0].outcome;
    outcome.summary = clips[0].summary;
    return outcome;
  }
};

/// Findings of one code, in order.
inline std::vector<Finding> FindingsOf(const Outcome& outcome, const std::string& code) {
  std::vector<Finding> findings;
  for (const Finding& finding : outcome.findings) {
    if (finding.code == code) findings.push_back(finding);
  }
  return findings;
}

}  // namespace mocurate
