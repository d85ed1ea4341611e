// A damaged row costs its frame and nothing else, in motions as in tables; arrays whose axes are exchanged are named.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "core/formats/bvh.h"
#include "core/formats/npy.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const char* const kTake = "dataset-1_bow_normal_001.bvh";
constexpr int kFrame = 40;

class DamagedFrames : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }
  static std::string Recorded() { return *ReadFile(TestData() + "/bvh/bandai1/" + kTake); }
  /// [begin, end) of the row of a frame.
  static std::pair<std::size_t, std::size_t> RowOf(const std::string& text, int frame) {
    std::size_t begin = text.find('\n', text.find("Frame Time:")) + 1;
    for (int f = 0; f < frame; ++f) begin = text.find('\n', begin) + 1;
    return {begin, text.find('\n', begin)};
  }
  static std::string WithRow(int frame, const std::function<std::string(std::string)>& change) {
    std::string text = Recorded();
    const auto [begin, end] = RowOf(text, frame);
    return text.replace(begin, end - begin, change(text.substr(begin, end - begin)));
  }
  IngestOptions Bandai() const {
    IngestOptions options = Declared("bandai1");
    options.path = folder_;
    return options;
  }
  Ingested Ingest(const std::string& text) {
    Written(kTake, text);
    const auto discovery = Discover(Bandai());
    EXPECT_TRUE(discovery && discovery->items.size() == 1);
    return RunIngest(discovery->items.at(0), "damaged");
  }
};

TEST_F(DamagedFrames, ADamagedRowOfABvhKeepsItsPlaceAndIsTakenFromItsNeighboursInARunAndMissingInAnInspection) {
  const Ingested whole = Ingest(Recorded());
  ASSERT_TRUE(whole.outcome);
  const auto shorter = [](const std::string& row) { return row.substr(0, row.find_last_of(" \t", row.size() - 4)); };
  const auto word = [](const std::string& row) { return "x" + row; };
  const auto nan = [](const std::string& row) { return row.substr(0, row.find_first_of(" \t")) + " nan" + row; };
  const auto large = [](const std::string& row) { return "1e300" + row.substr(row.find_first_of(" \t")); };
  const std::vector<std::pair<std::function<std::string(std::string)>, std::string>> damages = {
      {shorter, "row_length"}, {word, "not_a_number"}, {nan, "not_a_number"}, {large, "number_too_large"}};
  for (const auto& [damage, code] : damages) {
    const Ingested damaged = Ingest(WithRow(kFrame, damage));
    ASSERT_TRUE(damaged.outcome) << code << damaged.outcome.error().Message();
    EXPECT_EQ(damaged.outcome->kind, OutcomeKind::kDone) << code;
    const Finding& told = damaged.outcome->findings.at(0);
    EXPECT_EQ(told.code, code);
    EXPECT_EQ(told.frame_begin, kFrame);
    EXPECT_EQ(told.action, FindingAction::kInterpolated);
    const Motion &before = *whole.clip.motion, &after = *damaged.clip.motion;
    ASSERT_EQ(after.frame_count(), before.frame_count());
    for (int f = 0; f < after.frame_count(); ++f) {
      const JointState state = after.state.at(static_cast<std::size_t>(f) * after.joint_count());
      EXPECT_EQ(state, f == kFrame ? JointState::kInterpolated : JointState::kObserved) << f;
      for (int j = 0; j < after.joint_count(); ++j)
        EXPECT_LT((after.joints.at(f, j) - before.joints.at(f, j)).norm(), f == kFrame ? 0.01 : 1e-9) << f;
    }
    const Json inspection = InspectPath(folder_ / kTake, std::nullopt);
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), before.frame_count());
    EXPECT_GT(Value(inspection.at("clips")[0], "missing_share"), 0.0);
    EXPECT_THAT(Codes(inspection, "warning"), Contains(code));
    for (const Json& finding : inspection.at("findings")) EXPECT_FALSE(finding.at("value").is_null()) << finding;
  }
}

TEST_F(DamagedFrames, OfABvhWhoseRowsMayBeSplitOrJoinedNothingAfterHasItsPlaceAndTheFileIsRefused) {
  const auto split = [](std::string row) { return row.replace(row.find_first_of(" \t", row.size() / 2), 1, "\n"); };
  std::string joined = Recorded();
  joined[RowOf(joined, kFrame).second] = ' ';
  for (const std::string& text : {WithRow(kFrame, split), joined}) {
    const Ingested refused = Ingest(text);
    ASSERT_FALSE(refused.outcome);
    EXPECT_THAT(refused.outcome.error().Message(), AllOf(HasSubstr("frame 40 has"), HasSubstr("split or joined")));
    EXPECT_THAT(Codes(InspectPath(folder_ / kTake, std::nullopt), "error"), Contains("malformed"));
  }
}

TEST_F(DamagedFrames, AFirstFrameThatIsThatOfTheNextIsNotToldAsFrozen) {
  const Ingested damaged = Ingest(WithRow(0, [](const std::string& row) { return "x" + row; }));
  ASSERT_TRUE(damaged.outcome) << damaged.outcome.error().Message();
  ASSERT_EQ(damaged.outcome->findings.size(), 1u);
  EXPECT_EQ(damaged.outcome->findings[0].code, "not_a_number");
}

TEST_F(DamagedFrames, MoreThanHalfASecondIsNotBridged) {
  std::string text = Recorded();
  for (int f = kFrame; f < kFrame + 16; ++f) text[RowOf(text, f).first] = 'x';
  const Ingested refused = Ingest(text);
  ASSERT_FALSE(refused.outcome);
  EXPECT_THAT(refused.outcome.error().Message(), HasSubstr("16 frames on end, from frame 40"));
}

NpyArray Sample() { return *ParseNpy(*ReadFile(TestData() + "/humanact12/humanml3d_sample/012314_joints.npy"), "a"); }

/// Axes as numpy's transpose(a, b, c) has them.
NpyArray Transposed(const NpyArray& array, const std::array<std::size_t, 3>& axes) {
  NpyArray result = array;
  for (std::size_t i = 0; i < 3; ++i) result.shape[i] = array.shape[axes[i]];
  std::array<std::size_t, 3> at{};
  std::size_t to = 0;
  for (at[axes[0]] = 0; at[axes[0]] < result.shape[0]; ++at[axes[0]])
    for (at[axes[1]] = 0; at[axes[1]] < result.shape[1]; ++at[axes[1]])
      for (at[axes[2]] = 0; at[axes[2]] < result.shape[2]; ++at[axes[2]])
        result.values[to++] = array.values[(at[0] * array.shape[1] + at[1]) * array.shape[2] + at[2]];
  return result;
}

TEST_F(DamagedFrames, NumbersBeyondAnyPersonCostTheirFrameOfAnArray) {
  NpyArray array = Sample();
  array.values[(10 * 22 + 3) * 3 + 1] = 1e300;
  array.dtype = "<f8";
  const Json inspection = InspectPath(Written("walk.npy", WriteNpy(array)), std::nullopt);
  EXPECT_THAT(Codes(inspection, "warning"), Contains("number_too_large"));
  for (const Json& finding : inspection.at("findings")) {
    EXPECT_TRUE(finding.at("value").is_number()) << finding;
    EXPECT_THAT(finding.at("message").get<std::string>(), ::testing::Not(HasSubstr("inf m"))) << finding;
    if (finding.at("code") != "number_too_large") continue;
    EXPECT_THAT(finding.at("message"), HasSubstr("frame 10, joint 3, y: 1e+300"));
  }
  IngestOptions options = Declared("humanact12_npy");
  options.path = folder_;
  options.source.files = "{clip}.npy";
  options.source.person = "p";
  options.source.recording = "{clip}";
  options.source.label = "";
  options.source.labels.clear();
  options.source.fine_label.clear();
  options.source.session.clear();
  options.source.frames_in_name.clear();
  options.source.roles.clear();
  options.source.known_issue_lists.clear();
  options.source.exclude.clear();
  NpyArray wide = array;  // the hands at the wrists, for SMPL's 24
  wide.shape[1] = 24;
  wide.values.clear();
  for (std::size_t f = 0; f < array.shape[0]; ++f) {
    const auto row = array.values.begin() + static_cast<std::ptrdiff_t>(f * 66);
    wide.values.insert(wide.values.end(), row, row + 66);
    wide.values.insert(wide.values.end(), row + 60, row + 66);
  }
  Written("walk.npy", WriteNpy(wide));
  const auto clips = RunAll(options);
  ASSERT_EQ(clips.size(), 1u);
  ASSERT_FALSE(clips[0].outcome.findings.empty()) << clips[0].outcome.error.Message();
  EXPECT_EQ(clips[0].outcome.findings[0].code, "number_too_large");
  EXPECT_EQ(clips[0].outcome.findings[0].frame_begin, 10);
  EXPECT_EQ(clips[0].outcome.findings[0].action, FindingAction::kInterpolated);
  for (const Finding& finding : clips[0].outcome.findings) EXPECT_TRUE(std::isfinite(finding.value)) << finding.code;
  // The same clip with its first two axes exchanged.
  Written("walk.npy", WriteNpy(Transposed(wide, {1, 0, 2})));
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery);
  const Ingested refused = RunIngest(discovery->items.at(0), "transposed");
  ASSERT_FALSE(refused.outcome);
  EXPECT_THAT(refused.outcome.error().Message(),
              AllOf(HasSubstr("(joints, frames, 3)"), HasSubstr("transpose(1, 0, 2)")));
}

TEST_F(DamagedFrames, ExchangedAxesOfAnArrayAreNamedWithTheWayBack) {
  const std::vector<std::tuple<std::array<std::size_t, 3>, std::string, std::string>> cases = {
      {{1, 0, 2}, "(joints, frames, 3)", "transpose(1, 0, 2)"},
      {{0, 2, 1}, "(frames, 3, joints)", "transpose(0, 2, 1)"},
      {{1, 2, 0}, "(joints, 3, frames)", "transpose(2, 0, 1)"},
      {{2, 0, 1}, "(3, frames, joints)", "transpose(1, 2, 0)"}};
  for (const auto& [axes, held, way_out] : cases) {
    const Json inspection = InspectPath(Written("walk.npy", WriteNpy(Transposed(Sample(), axes))), std::nullopt);
    EXPECT_TRUE(inspection.at("clips").empty()) << held;
    ASSERT_EQ(Codes(inspection, "error"), std::vector<std::string>{"layout_contradiction"}) << inspection.dump(1);
    EXPECT_THAT(inspection.at("findings")[0].at("message"), AllOf(HasSubstr(held), HasSubstr(way_out)));
  }
  EXPECT_TRUE(Codes(InspectPath(Written("walk.npy", WriteNpy(Sample())), std::nullopt), "error").empty());
}

TEST_F(DamagedFrames, AnNtuFileOfAnotherCountOfJointsIsAnErrorThatNamesTheField) {
  std::string text = *ReadFile(TestData() + "/ntu/S001C001P001R001A011.skeleton");
  const std::size_t at = text.find("\n25");
  text.replace(at + 1, 2, "24");
  for (const char* name : {"S001C001P001R001A011.skeleton", "take.txt"}) {
    const Json inspection = InspectPath(Written(name, text), std::nullopt);
    EXPECT_TRUE(inspection.at("clips").empty()) << name;
    ASSERT_EQ(inspection.at("findings").size(), 1u) << inspection.dump(1);
    EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("joint count 24 is not 25"));
  }
}

}  // namespace
}  // namespace mocurate
