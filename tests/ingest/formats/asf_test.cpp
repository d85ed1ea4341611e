// Findings on Acclaim skeletons that no body can have, and on the recorded ones.

#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class AsfChecks : public ChangedFiles {
 protected:
  void SetUp() override {
    ChangedFiles::SetUp();
    if (IsSkipped()) return;
    skeleton_ = Recorded("cmu/asf_amc/01.asf");
    Written("01_01.amc", Recorded("cmu/asf_amc/01_01.amc"));
  }

  /// Sets `key` of bone `bone` to `value`.
  std::string With(const std::string& bone, const std::string& key, const std::string& value) const {
    const std::size_t at = skeleton_.find(key, skeleton_.find("name " + bone));
    return std::string(skeleton_).replace(at, skeleton_.find('\r', at) - at, key + " " + value);
  }

  /// Errors of a run whose codes the inspection reports at the skeleton file; `joint` is the bone.
  std::vector<Finding> Errors(const std::string& skeleton) {
    Written("01.asf", skeleton);
    const Json inspection = Inspect();
    std::vector<std::string> codes;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") == "error" && finding.at("where") == "01.asf") codes.push_back(finding.at("code"));
    }
    std::vector<Finding> errors;
    for (const Finding& finding : RunOne(From("cmu_amc")).findings) {
      if (std::count(codes.begin(), codes.end(), finding.code) > 0) errors.push_back(finding);
    }
    EXPECT_EQ(errors.size(), codes.size());
    return errors;
  }

  std::string skeleton_;
};

TEST_F(AsfChecks, ReportABoneWithoutLengthWithItsLine) {
  for (const auto& [bone, line] : {std::pair<std::string, int>{"lfemur", 26}, {"upperback", 122}}) {
    const std::vector<Finding> errors = Errors(With(bone, "length", "0"));
    ASSERT_EQ(errors.size(), 1u) << bone;
    EXPECT_EQ(errors[0].code, "bone_length");
    EXPECT_EQ(errors[0].joint, bone);
    EXPECT_EQ(errors[0].value, 0.0);
    EXPECT_THAT(errors[0].message, StartsWith("01.asf:" + std::to_string(line) + ":"));
  }
}

TEST_F(AsfChecks, ReportAnIncompleteRootOrderOnceAsASkeletonError) {
  std::string five = skeleton_;
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
