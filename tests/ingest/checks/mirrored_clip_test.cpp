// One mirrored clip in a folder: it is reported as an outlier and gets no handedness from the other clips.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "core/base/text.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class MirroredClip : public WrittenFormats {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }

  /// UTKinect's first `count` clips; in the one named `mirrored`, x is negated.
  Json InspectClips(std::size_t count, const std::string& mirrored) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(std::getenv("MOCURATE_DATA")) / "kinect/utkinect")) {
      if (DisplayPath(entry.path().filename()).rfind("carry", 0) == 0) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    files.resize(std::min(files.size(), count));
    for (const fs::path& file : files) {
      const std::string name = DisplayPath(file.filename());
      Written(name, name == mirrored ? Mirrored(*ReadFile(file)) : *ReadFile(file));
    }
    return InspectPath(folder_, std::nullopt);
  }

  /// Lines of x y z, one per joint.
  static std::string Mirrored(const std::string& table) {
    std::istringstream in(table);
    std::ostringstream out;
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      int column = 0;
      for (double value = 0.0; words >> value; ++column) out << (column == 0 ? -value : value) << ' ';
      out << '\n';
    }
    return out.str();
  }

  static std::vector<std::string> Outliers(const Json& inspection) {
    std::vector<std::string> outliers;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == "handedness_outlier") outliers.push_back(finding.at("where"));
    }
    return outliers;
  }
  static const Json& Clip(const Json& inspection, const std::string& id) {
    for (const Json& clip : inspection.at("clips")) {
      if (clip.at("id") == id) return clip;
    }
    ADD_FAILURE() << id;
    return inspection;
  }
};

TEST_F(MirroredClip, IsReportedInAFolderOfSixteenOrEight) {
  for (const std::size_t count : {16u, 8u}) {
    const Json inspection = InspectClips(count, "carry_s03_e01.txt");
    EXPECT_THAT(Outliers(inspection), ::testing::ElementsAre("carry_s03_e01.txt")) << count;
    EXPECT_EQ(Value(Clip(inspection, "carry_s03_e01.txt"), "handedness"), Json());
    EXPECT_EQ(Value(Clip(inspection, "carry_s01_e01.txt"), "handedness"), "right") << "inferred from the other clips";
  }
}

TEST_F(MirroredClip, KeepsUnknownHandednessWhenItsFeetContradictTheFolder) {
  const Json inspection = InspectClips(16, "carry_s02_e02.txt");
  EXPECT_THAT(Outliers(inspection), ::testing::ElementsAre("carry_s02_e02.txt"));
  const Json& handedness = Clip(inspection, "carry_s02_e02.txt").at("handedness");
  EXPECT_TRUE(handedness.at("value").is_null()) << handedness;
}

TEST_F(MirroredClip, IsNotReportedInAnUnchangedFolder) {
  for (const std::size_t count : {16u, 8u, 5u}) {
    const Json inspection = InspectClips(count, "");
    EXPECT_TRUE(Outliers(inspection).empty()) << count;
    for (const Json& clip : inspection.at("clips")) EXPECT_NE(Value(clip, "handedness"), "left") << clip.at("id");
  }
}

}  // namespace
}  // namespace mocurate
