// NTU RGB+D skeleton files with one defect.

#include "core/formats/ntu_skeleton.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using Json = nlohmann::json;

class DamagedNtu : public ChangedFiles {
 protected:
  static constexpr const char* kOne = "S001C001P001R001A011.skeleton";
  static constexpr const char* kTwo = "S001C003P008R002A058.skeleton";
  static std::string Ntu(const std::string& name) { return Recorded("ntu/" + name); }
};

TEST_F(DamagedNtu, ReportsANumberOfPeopleThatContradictsTheName) {
  const SourceOptions source = From("ntu").source;
  const auto count = [&](const std::string& name, const std::string& bytes, const char* code) {
    std::filesystem::remove_all(folder_);
    Written(name, bytes);
    return FindingsOf(Inspect(source), code).size();
  };
  EXPECT_EQ(count("S001C001P001R001A050.skeleton", Ntu(kOne), "people_missing"), 1u);
  EXPECT_EQ(count("S001C003P008R002A001.skeleton", Ntu(kTwo), "bodies_skipped"), 1u);
  EXPECT_EQ(count("S001C003P008R002A001.skeleton", Ntu(kTwo), "second_person"), 1u);
  for (const char* code : {"people_missing", "bodies_skipped"}) {
    EXPECT_EQ(count(kOne, Ntu(kOne), code), 0u);
    EXPECT_EQ(count(kTwo, Ntu(kTwo), code), 0u);
  }
}

TEST_F(DamagedNtu, JoinsAPersonWhoReturnsUnderAnotherId) {
  NtuSkeleton skeleton = *ParseNtuSkeleton(Ntu(kOne), "a");
  for (std::size_t f = 40; f < skeleton.frames.size(); ++f) {
    if (f < 46) skeleton.frames[f].clear();
    for (NtuBody& body : skeleton.frames[f]) ++body.id;
  }
  Written(kOne, WriteNtuSkeleton(skeleton));
  const IngestOptions options = From("ntu");
  EXPECT_EQ(FindingsOf(Inspect(options.source), "ids_stitched").size(), 1u);
  const std::vector<Finding> findings = FindingsOf(RunOne(options), "ids_stitched");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].value, 6.0);
}

TEST_F(DamagedNtu, ReportsATrackedJointAtZeroAsMissing) {
  NtuSkeleton skeleton = *ParseNtuSkeleton(Ntu(kOne), "a");
  for (std::size_t f = 20; f < 25; ++f) {
    NtuJoint& hand = skeleton.frames[f].at(0).joints[7];
    hand.x_m = hand.y_m = hand.z_m = 0.0;
    hand.tracking = 2;
  }
  Written(kOne, WriteNtuSkeleton(skeleton));
  const IngestOptions options = From("ntu");
  EXPECT_THAT(Codes(Inspect(options.source), "warning"), Contains("zero_joint"));
  const std::vector<Finding> findings = FindingsOf(RunOne(options), "zero_joint");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].joint, "left_hand");
  EXPECT_EQ(findings[0].frame_begin, 20);
  EXPECT_EQ(findings[0].frame_end, 25);
  EXPECT_EQ(findings[0].action, FindingAction::kMissing);
}

TEST_F(DamagedNtu, RejectsAnotherJointCountWithItsLine) {
  std::string text = Ntu(kOne);
  text.replace(text.find("\n25") + 1, 2, "24");
  for (const std::string name : {kOne, "take.txt"}) {
    const Json inspection = InspectPath(Written(name, text), std::nullopt);
    EXPECT_TRUE(inspection.at("clips").empty()) << name;
    ASSERT_EQ(inspection.at("findings").size(), 1u) << inspection.dump(1);
    EXPECT_THAT(Places(inspection), ElementsAre("malformed " + name + ":4"));
  }
}

TEST_F(WrittenFormats, RejectASkeletonFileWithoutFrames) {
  const std::string name = "S001C001P001R001A001.skeleton";
  EXPECT_THAT(Places(InspectPath(Written(name, "0\n"), std::nullopt)), ElementsAre("malformed " + name));
}

}  // namespace
}  // namespace mocurate
