// Choices of a generated declaration where the files are ambiguous.

#include <gmock/gmock.h>

#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/source_declaration.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Declaration(const fs::path& folder) {
  const auto declared = DeclareSource(InspectPath(folder, std::nullopt), folder, "mine");
  EXPECT_TRUE(declared) << declared.error().Message();
  return declared ? declared->yaml : "";
}

TEST(ImageNames, MatchASingleLetterCameraOnlyAsAWholeWord) {
  const std::vector<std::string> names = {"p_depth_0001.png", "p_depth_0002.png"};
  EXPECT_EQ(EstimateImages(names, {"p"}, "camera"), "{camera}_depth_{frame:4}.png");
  EXPECT_EQ(EstimateImages({"depth/0001.png"}, {"p"}, "camera"), "");
  EXPECT_EQ(EstimateImages({"depth/p0001.png"}, {"p"}, "camera"), "depth/{camera}{frame:4}.png");
  EXPECT_EQ(EstimateImages({"cam10_0001.png"}, {"cam1", "cam10"}, "camera"), "{camera}_{frame:4}.png");
  EXPECT_EQ(EstimateImages({"cam10_0001.png"}, {"cam1"}, "camera"), "");
}

class DeclaredNtu : public Layouts {};

TEST_F(DeclaredNtu, DoesNotDeclareAFalseTrackAsASecondPerson) {
  StudioOptions options = Perfect(StudioLayout::kNtu);
  options.subjects = 1;
  options.false_track_share = 1.0;
  Write(options);
  const std::string yaml = Declaration(folder / "nturgb+d_skeletons");
  EXPECT_THAT(yaml, Not(HasSubstr("\n    bodies:"))) << yaml;
  EXPECT_THAT(yaml, HasSubstr("the others are false tracks or bystanders"));
}

class RecordedDeclarations : public RecordedFormats {};

TEST_F(RecordedDeclarations, OfferAChoiceForUnexplainedZeroConfidences) {
  const std::string name = "a01_s01_e01_skeleton3D.txt";
  const fs::path folder = FreshFolder("msr_choice");
  fs::copy_file(TestData() + "/kinect/msr_action3d/" + name, folder / name);
  EXPECT_THAT(Declaration(folder), HasSubstr("least_confidence: 0.1 takes joints of confidence 0 as seen"));
}

}  // namespace
}  // namespace mocurate
