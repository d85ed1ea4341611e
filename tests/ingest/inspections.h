#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "ingest/inspect/inspect.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {

/// The reported value of a field.
inline nlohmann::json Value(const nlohmann::json& entry, const char* field) { return entry.at(field).at("value"); }

/// Codes of the findings of one severity.
inline std::vector<std::string> Codes(const nlohmann::json& inspection, const std::string& severity) {
  std::vector<std::string> codes;
  for (const nlohmann::json& finding : inspection.at("findings")) {
    if (finding.at("severity") == severity) codes.push_back(finding.at("code"));
  }
  return codes;
}

/// Findings of one code, in order.
inline std::vector<nlohmann::json> FindingsOf(const nlohmann::json& inspection, const std::string& code) {
  std::vector<nlohmann::json> findings;
  for (const nlohmann::json& finding : inspection.at("findings")) {
    if (finding.at("code") == code) findings.push_back(finding);
  }
  return findings;
}

/// "code where" of the findings of one severity.
inline std::vector<std::string> Places(const nlohmann::json& inspection, const std::string& severity = "error") {
  std::vector<std::string> places;
  for (const nlohmann::json& finding : inspection.at("findings")) {
    if (finding.at("severity") != severity) continue;
    places.push_back(finding.at("code").get<std::string>() + " " + finding.at("where").get<std::string>());
  }
  return places;
}

inline void ExpectFrame(const nlohmann::json& clip, const nlohmann::json& units, const nlohmann::json& up,
                        const nlohmann::json& handedness) {
  EXPECT_EQ(Value(clip, "units"), units) << clip.at("id") << clip.at("units");
  EXPECT_EQ(Value(clip, "up"), up) << clip.at("id") << clip.at("up");
  EXPECT_EQ(Value(clip, "handedness"), handedness) << clip.at("id") << clip.at("handedness");
}

/// Tests on the recorded sets.
class RecordedFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
  static nlohmann::json Inspect(const std::string& path) {
    return InspectPath(std::filesystem::path(std::getenv("MOCURATE_DATA")) / path, std::nullopt);
  }
};

/// Files that the test writes.
class WrittenFormats : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  std::filesystem::path Written(const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    EXPECT_TRUE(WriteFile(folder_ / name, bytes));
    return folder_ / name;
  }
  const ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_ / "formats";
};

}  // namespace mocurate
