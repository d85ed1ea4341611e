// Findings on Acclaim skeletons.

#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class AsfChecks : public ChangedFiles {};

TEST_F(AsfChecks, ReportAnIncompleteRootOrderOnceAsASkeletonError) {
  std::string five = Recorded("cmu/asf_amc/01.asf");
  Written("01_01.amc", Recorded("cmu/asf_amc/01_01.amc"));
  Written("01.asf", five.replace(five.find("TX TY TZ RX RY RZ"), 17, "TX TY TZ RX RY"));
  const Json inspection = Inspect();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("malformed", "no_clips"));
  EXPECT_THAT(Places(inspection), Contains("malformed 01.asf:14"));
}

TEST_F(AsfChecks, ReportNothingOnRecordedSkeletons) {
  int skeletons = 0;
  for (const char* set : {"cmu", "hdm05"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(TestData()) / set)) {
      if (entry.path().extension() != ".asf" || entry.path().stem() == "skel") continue;
      ++skeletons;
      const Json inspection = InspectPath(entry.path(), std::nullopt);
      EXPECT_THAT(Codes(inspection, "error"), IsEmpty()) << entry.path() << inspection.at("findings").dump(1);
    }
  }
  EXPECT_EQ(skeletons, 7);
}

}  // namespace
}  // namespace mocurate
