// Frame rates that motion allows: recorded files marked with wrong rates.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Value of the finding "rate_suspect", 0 without it.
double SuspectRate(const Json& inspection) {
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") == "rate_suspect") return finding.at("value");
  }
  return 0.0;
}

class MarkedRates : public WrittenFormats {
 protected:
  void SetUp() override {
    WrittenFormats::SetUp();
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    data_ = std::getenv("MOCURATE_DATA");
  }

  /// The inspection of a recorded BVH with another Frame Time.
  Json Marked(const std::string& file, double rate_hz) {
    std::string text = *ReadFile(data_ / file);
    const std::size_t begin = text.find("Frame Time:");
    const std::size_t end = text.find_first_of("\r\n", begin);
    text.replace(begin, end - begin, "Frame Time: " + std::to_string(1.0 / rate_hz));
    return InspectPath(Written("marked.bvh", text), std::nullopt);
  }
  fs::path data_;
};

TEST_F(MarkedRates, AreSuspectWhenTooHighForJumps) {
  EXPECT_EQ(SuspectRate(Marked("cmu/asf_amc/01_01.bvh", 120.0)), 0.0);
  for (const double rate : {240.0, 480.0}) {
    const double suspect = SuspectRate(Marked("cmu/asf_amc/01_01.bvh", rate));
    EXPECT_GT(suspect, 120.0) << "marked " << rate;
    EXPECT_LT(suspect, rate);
  }
}

TEST_F(MarkedRates, AreSuspectWhenTooLowOrTooHighForAWalk) {
  const char* walk = "bvh/bandai2/dataset-2_walk-turn-left_masculine_001.bvh";
  EXPECT_EQ(SuspectRate(Marked(walk, 30.0)), 0.0);
  for (const double rate : {7.5, 90.0, 120.0}) EXPECT_GT(SuspectRate(Marked(walk, rate)), 0.0) << "marked " << rate;
}

TEST_F(MarkedRates, AreSuspectOnlyWhenTooHighForRaisingHands) {
  const char* hands = "bvh/bandai2/dataset-2_raise-up-both-hands_active_001.bvh";
  for (const double rate : {3.75, 15.0, 30.0}) EXPECT_EQ(SuspectRate(Marked(hands, rate)), 0.0) << "marked " << rate;
  EXPECT_GT(SuspectRate(Marked(hands, 240.0)), 0.0);
}

TEST_F(MarkedRates, AreLimitedAndNotGuessedWhereTheFileHasNone) {
  fs::copy_file(data_ / "cmu/asf_amc/01.asf", folder_ / "01.asf");
  fs::copy_file(data_ / "cmu/asf_amc/01_01.amc", folder_ / "01_01.amc");
  const Json rate = Json(InspectPath(folder_ / "01_01.amc", std::nullopt)).at("clips").at(0).at("rate_hz");
  EXPECT_EQ(rate.at("from"), "unknown");
  EXPECT_GT(rate.at("range")[1], 120.0);
  EXPECT_LT(rate.at("range")[1], 240.0);
}

}  // namespace
}  // namespace mocurate
