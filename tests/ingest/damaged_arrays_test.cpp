// Arrays that are damaged, odd or no motion: a run and an inspection report the same, once, with its number.

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/formats/npy.h"
#include "ingest/sense/fault_codes.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Takes of 22 joints as arrays, and what a run and an inspection say of them.
class Arrays : public ChangedFiles {
 protected:
  void SetUp() override {
    ChangedFiles::SetUp();
    options_ = SmallArrays(folder_);
    options_.source.joints = {"pelvis",     "left_hip",      "right_hip",      "spine1",      "left_knee",
                              "right_knee", "spine2",        "left_ankle",     "right_ankle", "spine3",
                              "left_foot",  "right_foot",    "neck",           "left_collar", "right_collar",
                              "head",       "left_shoulder", "right_shoulder", "left_elbow",  "right_elbow",
                              "left_wrist", "right_wrist"};
  }
  static NpyArray Take() {
    NpyArray array = *ParseNpy(Recorded("humanact12/humanml3d_sample/012314_joints.npy"), "a");
    array.dtype = "<f8";
    return array;
  }
  struct Told {
    Expected<StageOutcome> run = tl::unexpected<Error>(Error());
    Json inspection;

    std::vector<std::string> run_codes() const {
      std::vector<std::string> codes;
      if (run) {
        for (const Finding& finding : run->findings) codes.push_back(finding.code);
      }
      return codes;
    }
    std::vector<std::string> codes() const {
      std::vector<std::string> codes;
      for (const Json& finding : inspection.at("findings")) codes.push_back(finding.at("code"));
      return codes;
    }
  };
  Told Of(const std::string& bytes) {
    Told told;
    told.inspection = InspectPath(Written("take.npy", bytes), options_.source);
    const auto discovery = Discover(options_);
    EXPECT_TRUE(discovery && discovery->items.size() == 1);
    const ItemSpec& item = discovery->items.at(0);
    StageRequest request;
    request.stage = "ingest";
    request.item = item.item;
    request.options = item.options;
    request.inputs = item.inputs;
    request.output = folder_ / "told.h5";
    told.run = IngestStage(request);
    return told;
  }
  Told Of(const std::function<void(NpyArray&)>& change) {
    NpyArray array = Take();
    change(array);
    return Of(WriteNpy(array));
  }
  /// Without a source.
  Json LookAt(const NpyArray& array) { return InspectPath(Written("take.npy", WriteNpy(array)), std::nullopt); }

  IngestOptions options_;
};

TEST_F(Arrays, NumbersThatAreNotFiniteAreOneFindingWithTheirCountAndTheFirstPlace) {
  const Told told = Of([](NpyArray& array) {
    for (std::size_t f = 10; f < 100; ++f) {
      array.values[(f * 22 + 3) * 3 + 1] = kNan;
      array.values[(f * 22 + 4) * 3] = kInfinite;
    }
  });
  ASSERT_TRUE(told.run) << told.run.error().Message();
  EXPECT_THAT(told.run_codes(), ElementsAre("not_a_number"));
  EXPECT_THAT(told.codes(), ElementsAre("not_a_number"));
  const Finding& finding = told.run->findings[0];
  EXPECT_EQ(finding.value, 180.0);
  EXPECT_EQ(told.inspection.at("findings")[0].at("value"), 180.0);
  EXPECT_EQ(finding.frame_begin, 10);
  EXPECT_EQ(finding.frame_end, 100);
  EXPECT_THAT(finding.message, HasSubstr("frame 10, joint 3, y"));
}

TEST_F(Arrays, ANumberBeyondAnyPersonIsMissingAndInterpolatedWhereEveryJointIsThere) {
  NpyArray tracks = Take();
  tracks.values[(10 * 22 + 3) * 3 + 1] = 1e300;
  NpyArray motion = tracks;  // the hands at the wrists, for SMPL's 24
  motion.shape[1] = 24;
  motion.values.clear();
  for (std::size_t f = 0; f < tracks.shape[0]; ++f) {
    const auto row = tracks.values.begin() + static_cast<std::ptrdiff_t>(f * 66);
    motion.values.insert(motion.values.end(), row, row + 66);
    motion.values.insert(motion.values.end(), row + 60, row + 66);
  }
  for (const bool whole : {false, true}) {
    if (whole) options_.source.joints.insert(options_.source.joints.end(), {"left_hand", "right_hand"});
    const Told told = Of(WriteNpy(whole ? motion : tracks));
    ASSERT_TRUE(told.run) << told.run.error().Message();
    ASSERT_FALSE(told.run->findings.empty()) << told.run->error.Message();
    const Finding& finding = told.run->findings[0];
    EXPECT_EQ(finding.code, "number_too_large");
    EXPECT_EQ(finding.value, 1.0);
    EXPECT_EQ(finding.frame_begin, 10);
    EXPECT_EQ(finding.action, whole ? FindingAction::kInterpolated : FindingAction::kMissing);
    EXPECT_THAT(finding.message, HasSubstr("frame 10, joint 3, y"));
    EXPECT_EQ(FindingsOf(told.inspection, "number_too_large").size(), 1u);
    for (const Finding& other : told.run->findings) EXPECT_TRUE(std::isfinite(other.value)) << other.code;
  }
  const Json alone = LookAt(tracks);
  EXPECT_THAT(Codes(alone, "warning"), ElementsAre("number_too_large"));
  EXPECT_EQ(alone.at("findings")[0].at("value"), 1);
}

TEST_F(Arrays, OneFrameIsAPoseAndNothingIsSaidOfBonesThatChange) {
  const Told told = Of([](NpyArray& array) {
    array.shape[0] = 1;
    array.values.resize(66);
  });
  EXPECT_THAT(told.run_codes(), ElementsAre("single_frame"));
  EXPECT_THAT(told.codes(), ElementsAre("single_frame"));
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), IsEmpty()) << alone.at("findings");
}

TEST_F(Arrays, ZerosAreOneError) {
  const Told told = Of([](NpyArray& array) { std::fill(array.values.begin(), array.values.end(), 0.0); });
  ASSERT_TRUE(told.run);
  EXPECT_EQ(told.run_codes(), told.codes());
  EXPECT_THAT(Codes(told.inspection, "error"), ElementsAre("lifeless_clip"));
  EXPECT_EQ(FindingsOf(told.inspection, "lifeless_clip")[0].at("value"), 1.0) << "of the frames";
  EXPECT_THAT(Codes(told.inspection, "warning"), IsEmpty());
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), ElementsAre("lifeless_clip"));
}

TEST_F(Arrays, PointsOfAPlaneAreNoBodiesInSpace) {
  const Told told = Of([](NpyArray& array) {
    for (std::size_t i = 2; i < array.values.size(); i += 3) array.values[i] = 1.5;
  });
  EXPECT_THAT(told.run_codes(), ElementsAre("flat_body"));
  EXPECT_THAT(told.codes(), ElementsAre("flat_body"));
}

TEST_F(Arrays, AWrongUnitIsReportedByBothHoweverFarItPutsThePersonAndItsConsequencesAreNot) {
  for (const auto& [factor, metres] : {std::pair{1000.0, 1504.08}, {1e-3, 0.0015}}) {
    const Told told = Of([factor = factor](NpyArray& array) {
      for (double& value : array.values) value *= factor;
    });
    ASSERT_TRUE(told.run) << told.run.error().Message();
    EXPECT_THAT(told.run_codes(), ElementsAre("units_contradiction"));
    EXPECT_THAT(told.codes(), ElementsAre("units_contradiction"));
    EXPECT_NEAR(told.run->findings[0].value, metres, 1e-2 * metres);
    EXPECT_NEAR(told.inspection.at("findings")[0].at("value"), metres, 5e-2 * metres);
    if (factor > 1.0) {
      EXPECT_EQ(told.run->kind, OutcomeKind::kRefused) << "nobody is a kilometre away";
    }
  }
}

TEST_F(Arrays, AFileThatGivesNoClipHasOneCodeAndEveryErrorAWayOut) {
  const std::string whole = WriteNpy(Take());
  const auto nobody = [](double value) {
    NpyArray array = Take();
    std::fill(array.values.begin(), array.values.end(), value);
    return WriteNpy(array);
  };
  NpyArray transposed = Take();
  std::swap(transposed.shape[1], transposed.shape[2]);
  const std::pair<std::string, const char*> cases[] = {{whole.substr(0, 60), "malformed"},
                                                       {whole.substr(0, 5000), "count_contradiction"},
                                                       {whole.substr(0, 9), "malformed"},
                                                       {whole + "more", "count_contradiction"},
                                                       {nobody(kNan), "no_joint_seen"},
                                                       {nobody(kInfinite), "no_joint_seen"},
                                                       {"", "empty_file"},
                                                       {WriteNpy(transposed), "layout_contradiction"}};
  for (const auto& [bytes, code] : cases) {
    const Told told = Of(bytes);
    const Error error = told.run ? told.run->error : told.run.error();
    EXPECT_EQ(FaultCode(error, "npy"), code) << error.Message();
    EXPECT_THAT(told.codes(), ElementsAre(code)) << error.Message();
    EXPECT_THAT(Codes(InspectPath(folder_ / "take.npy", std::nullopt), "error"), ElementsAre(code)) << "undeclared";
    EXPECT_FALSE(error.hint.empty()) << error.Message();
    EXPECT_FALSE(error.where.empty()) << error.Message();
  }
}

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

TEST_F(Arrays, ExchangedAxesAreAnErrorThatNamesTheWayBack) {
  const std::pair<std::array<std::size_t, 3>, const char*> cases[] = {
      {{1, 0, 2}, "(1, 0, 2)"}, {{0, 2, 1}, "(0, 2, 1)"}, {{1, 2, 0}, "(2, 0, 1)"}, {{2, 0, 1}, "(1, 2, 0)"}};
  for (const auto& [axes, way_out] : cases) {
    const NpyArray array = Transposed(Take(), axes);
    const Json inspection = LookAt(array);
    EXPECT_TRUE(inspection.at("clips").empty()) << way_out;
    EXPECT_THAT(Places(inspection), ElementsAre("layout_contradiction take.npy")) << way_out;
    EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr(way_out));
    const Told told = Of(WriteNpy(array));
    ExpectError(told.run, ErrorCode::kInconsistent, "take.npy");
    EXPECT_THAT(told.run.error().Message(), HasSubstr(way_out));
  }
  EXPECT_THAT(Codes(LookAt(Take()), "error"), IsEmpty());
}

TEST_F(Arrays, FeaturesOfHumanMl3dAreNoMotionAndTheWayToJointsIsNamed) {
  NpyArray array;
  array.shape = {20, 263};
  array.dtype = "<f4";
  array.values.assign(20 * 263, 0.5);
  const Json inspection = LookAt(array);
  EXPECT_THAT(Places(inspection), ElementsAre("no_motion take.npy"));
  EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("recover_from_ric"));
}

}  // namespace
}  // namespace mocurate
