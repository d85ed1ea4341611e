// Two joints of one limb that changed places all through a clip: the other side shows it.

#include <gmock/gmock.h>

#include <numeric>
#include <random>
#include <sstream>

#include "core/formats/npy.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::HasSubstr;

/// Messages of "joint_order_contradiction" under a declaration.
std::vector<std::string> OrderDoubts(const fs::path& path, const std::string& declaration) {
  std::vector<std::string> messages;
  const Json inspection = InspectPath(path, Declared(declaration).source);
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") == "joint_order_contradiction") messages.push_back(finding.at("message"));
  }
  return messages;
}

class ExchangedLimbs : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options;
    options.layout = StudioLayout::kHumanAct12;
    options.subjects = 2;
    Write(options);
    for (const auto& entry : fs::directory_iterator(folder / "HumanAct12")) clips.push_back(entry.path());
    std::sort(clips.begin(), clips.end());
  }

  static void Exchange(const fs::path& clip, std::size_t first, std::size_t second) {
    NpyArray array = *ParseNpy(*ReadFile(clip), "clip.npy");
    for (std::size_t f = 0; f < array.shape[0]; ++f) {
      const auto at = [&](std::size_t joint) {
        return array.values.begin() + static_cast<std::ptrdiff_t>((f * array.shape[1] + joint) * 3);
      };
      std::swap_ranges(at(first), at(first) + 3, at(second));
    }
    ASSERT_TRUE(WriteFile(clip, WriteNpy(array)));
  }

  std::vector<fs::path> clips;
};

TEST_F(ExchangedLimbs, OfStudioClipsAsTheyAreNothingIsToldAndOfExchangedOnesTheTwoJoints) {
  ASSERT_GE(clips.size(), 40u);
  EXPECT_EQ(OrderDoubts(folder / "HumanAct12", "humanact12_npy").size(), 0u);
  const std::tuple<std::size_t, std::size_t, const char*> limbs[] = {{4, 7, "'left_knee' and 'left_ankle'"},
                                                                     {5, 11, "'right_knee' and 'right_foot'"},
                                                                     {18, 20, "'left_elbow' and 'left_wrist'"},
                                                                     {19, 23, "'right_elbow' and 'right_hand'"}};
  std::size_t found = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const auto& [first, second, names] = limbs[i % 4];
    Exchange(clips[i], first, second);
    const std::vector<std::string> told = OrderDoubts(clips[i], "humanact12_npy");
    if (told.empty()) continue;  // of arms that are bent all the time a hand is as far as an elbow
    ++found;
    EXPECT_THAT(told[0], HasSubstr(std::string("with ") + names + " exchanged bones of that limb"));
  }
  EXPECT_GE(found, 38u);
}

class ExchangedKard : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }
};

TEST_F(ExchangedKard, AKneeAndItsAnkleAreToldByARunAndAnInspection) {
  const std::string name = "a01_s01_e01_realworld.txt";
  std::istringstream in(*ReadFile(TestData() + "/kinect/kard/" + name));
  std::vector<std::string> rows;
  for (std::string row; std::getline(in, row);) {
    if (!row.empty()) rows.push_back(row);
  }
  std::ostringstream out;
  for (std::size_t r = 0; r + 15 <= rows.size(); r += 15) std::swap(rows[r + 13], rows[r + 14]);
  for (const std::string& row : rows) out << row << '\n';
  Written(name, out.str());
  ASSERT_EQ(OrderDoubts(folder_, "kard").size(), 1u);
  EXPECT_THAT(OrderDoubts(folder_, "kard")[0], HasSubstr("with 'left_knee' and 'left_foot' exchanged"));
  IngestOptions options = Declared("kard");
  options.path = folder_;
  EXPECT_EQ(CountCode(RunAll(options), "joint_order_contradiction"), 1u);
}

TEST(ShuffledJoints, OfRecordedTablesAreInNoKnownOrder) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  constexpr std::size_t kJoints = 15;
  std::mt19937 random(3);
  const fs::path folder = FreshFolder("shuffled");
  int tables = 0;
  for (const char* name : {"a01_s01_e01", "a05_s03_e02", "a12_s04_e03", "a14_s08_e01", "a18_s06_e03"}) {
    std::istringstream in(*ReadFile(fs::path(TestData()) / "kinect/kard" / (std::string(name) + "_realworld.txt")));
    std::vector<std::string> rows;
    for (std::string row; std::getline(in, row);) rows.push_back(row);
    for (int time = 0; time < 12; ++time, ++tables) {
      std::vector<std::size_t> order(kJoints);
      std::iota(order.begin(), order.end(), 0u);
      for (std::size_t k = kJoints - 1; k > 0; --k) std::swap(order[k], order[random() % (k + 1)]);
      std::string text;
      for (std::size_t row = 0; row + kJoints <= rows.size(); row += kJoints) {
        for (const std::size_t joint : order) text += rows[row + joint] + "\n";
      }
      Put(folder / (std::to_string(tables) + ".txt"), text);
    }
  }
  const Json inspection = InspectPath(folder, std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 60u);
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_TRUE(Value(clip, "skeleton").is_null()) << clip.at("id") << clip.at("skeleton");
    EXPECT_TRUE(Value(clip, "up").is_null()) << clip.at("up");
  }
  EXPECT_EQ(Codes(inspection, "warning"), std::vector<std::string>(60, "layout_unknown"));
}

}  // namespace
}  // namespace mocurate
