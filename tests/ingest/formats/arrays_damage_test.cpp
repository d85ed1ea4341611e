// Damaged and implausible arrays: a run and an inspection report the same finding once, with its value.

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/formats/npy.h"
#include "ingest/checks/clip_checks.h"
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

/// Arrays of takes with 22 joints, and the findings of a run and of an inspection.
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
  struct Reports {
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
  Reports Of(const std::string& bytes) {
    Reports reports;
    reports.inspection = InspectPath(Written("take.npy", bytes), options_.source);
    const auto discovery = Discover(options_);
    EXPECT_TRUE(discovery && discovery->items.size() == 1);
    const ItemSpec& item = discovery->items.at(0);
    StageRequest request;
    request.stage = "ingest";
    request.item = item.item;
    request.options = item.options.Whole();
    request.inputs = item.inputs;
    request.output = folder_ / "clip.h5";
    reports.run = IngestStage(request);
    return reports;
  }
  Reports Of(const std::function<void(NpyArray&)>& change) {
    NpyArray array = Take();
    change(array);
    return Of(WriteNpy(array));
  }
  /// Without a source declaration.
  Json InspectArray(const NpyArray& array) { return InspectPath(Written("take.npy", WriteNpy(array)), std::nullopt); }

  IngestOptions options_;
};

TEST_F(Arrays, ReportNonFiniteNumbersOnceWithCountAndFirstPlace) {
  const Reports reports = Of([](NpyArray& array) {
    for (std::size_t f = 10; f < 100; ++f) {
      array.values[(f * 22 + 3) * 3 + 1] = kNan;
      array.values[(f * 22 + 4) * 3] = kInfinite;
    }
  });
  ASSERT_TRUE(reports.run) << reports.run.error().Message();
  EXPECT_THAT(reports.run_codes(), ElementsAre("not_a_number"));
  EXPECT_THAT(reports.codes(), ElementsAre("not_a_number"));
  const Finding& finding = reports.run->findings[0];
  EXPECT_EQ(finding.value, 180.0);
  EXPECT_EQ(reports.inspection.at("findings")[0].at("value"), 180.0);
  EXPECT_EQ(finding.frame_begin, 10);
  EXPECT_EQ(finding.frame_end, 100);
  EXPECT_THAT(finding.message, HasSubstr("frame 10, joint 3, y"));
}

TEST_F(Arrays, ReportAnImplausibleNumberAsMissingOrInterpolated) {
  NpyArray tracks = Take();
  tracks.values[(10 * 22 + 3) * 3 + 1] = 1e300;
  NpyArray motion = tracks;  // SMPL's 24 joints, with the hands at the wrists
  motion.shape[1] = 24;
  motion.values.clear();
  for (std::size_t f = 0; f < tracks.shape[0]; ++f) {
    const auto row = tracks.values.begin() + static_cast<std::ptrdiff_t>(f * 66);
    motion.values.insert(motion.values.end(), row, row + 66);
    motion.values.insert(motion.values.end(), row + 60, row + 66);
  }
  for (const bool whole : {false, true}) {
    if (whole) options_.source.joints.insert(options_.source.joints.end(), {"left_hand", "right_hand"});
    const Reports reports = Of(WriteNpy(whole ? motion : tracks));
    ASSERT_TRUE(reports.run) << reports.run.error().Message();
    ASSERT_FALSE(reports.run->findings.empty()) << reports.run->error.Message();
    const Finding& finding = reports.run->findings[0];
    EXPECT_EQ(finding.code, "number_too_large");
    EXPECT_EQ(finding.value, 1.0);
    EXPECT_EQ(finding.frame_begin, 10);
    EXPECT_EQ(finding.action, whole ? FindingAction::kInterpolated : FindingAction::kMissing);
    EXPECT_THAT(finding.message, HasSubstr("frame 10, joint 3, y"));
    EXPECT_EQ(FindingsOf(reports.inspection, "number_too_large").size(), 1u);
    for (const Finding& other : reports.run->findings) EXPECT_TRUE(std::isfinite(other.value)) << other.code;
  }
  const Json alone = InspectArray(tracks);
  EXPECT_THAT(Codes(alone, "warning"), ElementsAre("number_too_large"));
  EXPECT_EQ(alone.at("findings")[0].at("value"), 1);
}

TEST_F(Arrays, ReportASingleFrameAsAPoseOnly) {
  const Reports reports = Of([](NpyArray& array) {
    array.shape[0] = 1;
    array.values.resize(66);
  });
  EXPECT_THAT(reports.run_codes(), ElementsAre("single_frame"));
  EXPECT_THAT(reports.codes(), ElementsAre("single_frame"));
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), IsEmpty()) << alone.at("findings");
}

TEST_F(Arrays, ReportAllZerosAsOneError) {
  const Reports reports = Of([](NpyArray& array) { std::fill(array.values.begin(), array.values.end(), 0.0); });
  ASSERT_TRUE(reports.run);
  EXPECT_EQ(reports.run_codes(), reports.codes());
  EXPECT_THAT(Codes(reports.inspection, "error"), ElementsAre("motionless_clip"));
  EXPECT_EQ(FindingsOf(reports.inspection, "motionless_clip")[0].at("value"), 1.0) << "share of the frames";
  EXPECT_THAT(Codes(reports.inspection, "warning"), IsEmpty());
  const Json alone = InspectPath(folder_ / "take.npy", std::nullopt);
  EXPECT_THAT(Codes(alone, "error"), ElementsAre("motionless_clip"));
}

TEST_F(Arrays, ReportAWrongUnitWithoutItsConsequences) {
  for (const auto& [factor, metres] : {std::pair{1000.0, 1504.08}, {1e-3, 0.0015}}) {
    const Reports reports = Of([factor = factor](NpyArray& array) {
      for (double& value : array.values) value *= factor;
    });
    ASSERT_TRUE(reports.run) << reports.run.error().Message();
    EXPECT_THAT(reports.run_codes(), ElementsAre("units_contradiction"));
    EXPECT_THAT(reports.codes(), ElementsAre("units_contradiction"));
    EXPECT_NEAR(reports.run->findings[0].value, metres, 1e-2 * metres);
    EXPECT_NEAR(reports.inspection.at("findings")[0].at("value"), metres, 5e-2 * metres);
    if (factor > 1.0) {
      EXPECT_EQ(reports.run->kind, OutcomeKind::kRefused) << "the person would be a kilometre away";
    }
  }
}

TEST_F(Arrays, ReportOneCodeForAFileWithoutAClip) {
  const std::string whole = WriteNpy(Take());
  const auto filled = [](double value) {
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
                                                       {filled(kNan), "no_joint_seen"},
                                                       {filled(kInfinite), "no_joint_seen"},
                                                       {"", "empty_file"},
                                                       {WriteNpy(transposed), "layout_contradiction"}};
  for (const auto& [bytes, code] : cases) {
    const Reports reports = Of(bytes);
    const Error error = reports.run ? reports.run->error : reports.run.error();
    EXPECT_EQ(FaultCode(error, "npy"), code) << error.Message();
    EXPECT_THAT(reports.codes(), ElementsAre(code)) << error.Message();
    EXPECT_THAT(Codes(InspectPath(folder_ / "take.npy", std::nullopt), "error"), ElementsAre(code)) << "undeclared";
    EXPECT_FALSE(error.hint.empty()) << error.Message();
    EXPECT_FALSE(error.where.empty()) << error.Message();
  }
}

/// Axes as in numpy's transpose(a, b, c).
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

TEST_F(Arrays, ReportExchangedAxesWithTheCorrectTranspose) {
  const std::pair<std::array<std::size_t, 3>, const char*> cases[] = {
      {{1, 0, 2}, "(1, 0, 2)"}, {{0, 2, 1}, "(0, 2, 1)"}, {{1, 2, 0}, "(2, 0, 1)"}, {{2, 0, 1}, "(1, 2, 0)"}};
  for (const auto& [axes, way_out] : cases) {
    const NpyArray array = Transposed(Take(), axes);
    const Json inspection = InspectArray(array);
    EXPECT_TRUE(inspection.at("clips").empty()) << way_out;
    EXPECT_THAT(Places(inspection), ElementsAre("layout_contradiction take.npy")) << way_out;
    EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr(way_out));
    const Reports reports = Of(WriteNpy(array));
    ExpectError(reports.run, ErrorCode::kInconsistent, "take.npy");
    EXPECT_THAT(reports.run.error().Message(), HasSubstr(way_out));
  }
  EXPECT_THAT(Codes(InspectArray(Take()), "error"), IsEmpty());
}

TEST_F(Arrays, ReportHumanMl3dFeaturesWithTheConversionToJoints) {
  NpyArray array;
  array.shape = {20, 263};
  array.dtype = "<f4";
  array.values.assign(20 * 263, 0.5);
  const Json inspection = InspectArray(array);
  EXPECT_THAT(Places(inspection), ElementsAre("no_motion take.npy"));
  EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("recover_from_ric"));
}

}  // namespace
}  // namespace mocurate
