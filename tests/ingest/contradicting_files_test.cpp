// Files whose parts contradict each other, or their names: told by an inspection and by a run alike.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/formats/amass.h"
#include "core/formats/amc.h"
#include "core/formats/babel.h"
#include "core/formats/bvh.h"
#include "ingest/sense/source_declaration.h"
#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::json;

class ContradictingFiles : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }
  static std::string Recorded(const std::string& name) { return *ReadFile(TestData() + "/" + name); }
  Json Look() const { return InspectPath(folder_, std::nullopt); }
  std::vector<ItemResult> Run(IngestOptions options) const {
    options.path = folder_;
    return RunAll(options);
  }
  static const Json& Told(const Json& inspection, const std::string& code) {
    static const Json none;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == code) return finding;
    }
    ADD_FAILURE() << "no " << code << " in " << inspection.at("findings").dump(1);
    return none;
  }
  static std::vector<std::string> AllCodes(const Json& inspection) {
    std::vector<std::string> codes;
    for (const Json& finding : inspection.at("findings")) codes.push_back(finding.at("code"));
    return codes;
  }
};

/// The recorded motion, changed.
class ChangedAmass : public ContradictingFiles {
 protected:
  template <class Change>
  void Write(const Change& change) {
    Amass amass = *ParseAmass(Recorded("amass_babel/amass_sample.npz"), "sample");
    change(amass);
    Written("CMU/141/141_05_poses.npz", *EncodeAmass(amass, "sample"));
  }
  static IngestOptions Source() {
    IngestOptions options = Declared("amass");
    options.source.annotations.clear();
    return options;
  }
};

/// Motions of the studio, in which people walk.
class StudiosAmass : public ContradictingFiles {
 protected:
  template <class Change>
  void Write(const Change& change) {
    StudioOptions options;
    options.layout = StudioLayout::kAmass;
    options.subjects = 1;
    ASSERT_TRUE(WriteStudioLayout(options, folder_ / "studio", 2, [](const StudioFolder::Counts&) {}));
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "studio")) {
      if (entry.path().extension() != ".npz") continue;
      Amass amass = *ParseAmass(*ReadFile(entry.path()), "studio");
      change(amass);
      Written("made/p1/take_poses.npz", *EncodeAmass(amass, "studio"));
    }
    fs::remove_all(folder_ / "studio");
  }
  std::size_t ToldByRun() const {
    IngestOptions options = Declared("amass");
    options.source.annotations.clear();
    return CountCode(Run(options), "path_contradiction");
  }
};

TEST_F(ChangedAmass, FramesWithoutNumbersCostThemselvesAlone) {
  Write([](Amass& amass) {
    for (const std::size_t f : {std::size_t{100}, std::size_t{101}, std::size_t{300}})
      amass.poses[f * amass.pose_columns + 7] = std::nan("");
    amass.translation_m[3 * 300] = std::numeric_limits<double>::infinity();
  });
  const Json inspection = Look();
  EXPECT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_THAT(AllCodes(inspection), Not(Contains("no_joint_seen")));
  const auto clips = Run(Source());
  ASSERT_EQ(clips.size(), 1u);
  std::vector<int> begins, ends;
  for (const Finding& finding : clips[0].outcome.findings) {
    if (finding.code != "not_a_number") continue;
    begins.push_back(finding.frame_begin);
    ends.push_back(finding.frame_end);
    EXPECT_EQ(finding.action, FindingAction::kInterpolated) << finding.message;
  }
  EXPECT_THAT(begins, ElementsAre(100, 300));
  EXPECT_THAT(ends, ElementsAre(102, 301));
  EXPECT_EQ(CountCode(clips, "teleport"), 0u);
}

TEST_F(ChangedAmass, ADeclarationOfAFolderThatHoldsBabelUsesIt) {
  Write([](Amass&) {});
  BabelSequence sequence;
  sequence.key = "1";
  sequence.babel_sid = 1;
  sequence.feat_p = "CMU/CMU/141/141_05_poses.npz";
  sequence.dur = 5.0;
  Written("babel/train.json", EncodeBabel({sequence}));
  const auto declared = DeclareSource(InspectPath(folder_, std::nullopt), folder_, "mine");
  ASSERT_TRUE(declared) << declared.error().Message();
  EXPECT_THAT(declared->yaml, HasSubstr("annotations: [\"babel/train.json\"]"));
  EXPECT_THAT(declared->yaml, HasSubstr("names 1 of the 1 motion"));
}

/// A clip of KARD, 15 joints of three numbers a row.
class ChangedKard : public ContradictingFiles {
 protected:
  static std::vector<Vector3d> Rows(const std::string& name) {
    std::istringstream in(Recorded("kinect/kard/" + name));
    std::vector<Vector3d> rows;
    for (Vector3d row; in >> row[0] >> row[1] >> row[2];) rows.push_back(row);
    return rows;
  }
  void Write(const std::string& name, const std::vector<Vector3d>& rows, const char* separator = " ") {
    std::ostringstream out;
    out.precision(10);
    for (const Vector3d& row : rows) out << row[0] << separator << row[1] << separator << row[2] << '\n';
    Written(name, out.str());
  }
  static constexpr const char* kName = "a01_s01_e01_realworld.txt";
};

TEST_F(ChangedKard, NoSkeletonIsClaimedWhoseHeadLiesBelowItsTrunk) {
  const std::vector<Vector3d> rows = Rows(kName);
  // As if arms were legs and the head the middle of the trunk.
  const int order[] = {8, 1, 9, 10, 11, 12, 13, 14, 0, 2, 3, 4, 5, 6, 7};
  std::vector<Vector3d> turned;
  for (std::size_t r = 0; r < rows.size(); ++r)
    turned.push_back(rows[r / 15 * 15 + static_cast<std::size_t>(order[r % 15])]);
  Write(kName, turned);
  const Json inspection = Look();
  ASSERT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_NE(Value(inspection.at("clips")[0], "skeleton"), "openni15") << inspection.at("clips")[0].at("skeleton");
  EXPECT_EQ(CountCode(Run(Declared("kard")), "joint_order_contradiction"), 1u);
  const Json declared = InspectPath(folder_, Declared("kard").source);
  for (const Json& finding : declared.at("findings"))
    EXPECT_THAT(finding.at("message"), Not(HasSubstr("within pi"))) << "millimetres are no rotations";
}

TEST_F(ChangedKard, TwoJointsThatChangedPlacesAreNamed) {
  std::vector<Vector3d> rows = Rows(kName);
  for (std::size_t r = 0; r + 15 <= rows.size(); r += 15) std::swap(rows[r], rows[r + 8]);  // head and torso
  Write(kName, rows);
  EXPECT_EQ(Value(Look().at("clips")[0], "skeleton"), Json());
  const auto clips = Run(Declared("kard"));
  EXPECT_EQ(CountCode(clips, "joint_order_contradiction"), 1u);
}

TEST_F(ChangedKard, PartOfAClipInAnotherUnitIsOneFinding) {
  std::vector<Vector3d> rows = Rows(kName);
  for (std::size_t r = 15 * 20; r < 15 * 40; ++r) rows[r] *= 0.001;
  Write(kName, rows);
  for (const bool declared : {false, true}) {
    const Json inspection =
        InspectPath(folder_, declared ? std::optional<SourceOptions>(Declared("kard").source) : std::nullopt);
    const Json& told = Told(inspection, "units_change");
    EXPECT_EQ(told.at("value"), 0.001);
    EXPECT_THAT(told.at("where"), HasSubstr("frames 20-40"));
    EXPECT_THAT(AllCodes(inspection), Not(Contains("teleport")));
  }
  const auto clips = Run(Declared("kard"));
  EXPECT_EQ(CountCode(clips, "units_change"), 1u);
  EXPECT_EQ(CountCode(clips, "teleport"), 0u);
}

TEST_F(ChangedKard, HalfOfAClipUpsideDownIsOneFindingAndItsUpIsNotGuessed) {
  std::vector<Vector3d> rows = Rows(kName);
  const std::size_t half = rows.size() / 30;
  for (std::size_t r = 15 * half; r < rows.size(); ++r) rows[r][1] *= -1.0;
  Write(kName, rows);
  const Json inspection = Look();
  const Json& told = Told(inspection, "axes_change");
  EXPECT_THAT(told.at("where"), HasSubstr("frames " + std::to_string(half) + "-"));
  EXPECT_EQ(Value(inspection.at("clips")[0], "up"), Json());
  EXPECT_THAT(inspection.at("clips")[0].at("up").at("evidence"), HasSubstr("at frame " + std::to_string(half)));
  const auto clips = Run(Declared("kard"));
  EXPECT_EQ(CountCode(clips, "axes_change"), 1u);
}

TEST_F(ChangedKard, OneClipOfAFolderWithTwoAxesExchangedIsTold) {
  for (int action = 1; action <= 8; ++action) {
    const std::string name = "a0" + std::to_string(action) + "_s01_e01_realworld.txt";
    std::vector<Vector3d> rows = Rows(name);
    for (Vector3d& row : rows) {
      if (action == 3) std::swap(row[0], row[2]);
    }
    Write(name, rows);
  }
  const Json inspection = Look();
  const Json& told = Told(inspection, "axes_outlier");
  EXPECT_EQ(told.at("where"), "a03_s01_e01_realworld.txt");
  EXPECT_THAT(told.at("message"), HasSubstr("x and z exchanged"));
  const auto codes = AllCodes(inspection);
  EXPECT_EQ(std::count(codes.begin(), codes.end(), "axes_outlier"), 1);
}

TEST_F(ChangedKard, ADecimalCommaIsReadAsAPoint) {
  const std::vector<Vector3d> rows = Rows(kName);
  std::ostringstream text;
  text.precision(4);
  text << std::fixed;
  for (const Vector3d& row : rows) text << row[0] << ';' << row[1] << ';' << row[2] << '\n';
  std::string commas = text.str();
  std::replace(commas.begin(), commas.end(), '.', ',');
  Written(kName, commas);
  const Json inspection = Look();
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
  EXPECT_EQ(Value(inspection.at("clips")[0], "skeleton"), "openni15");
  EXPECT_THAT(AllCodes(inspection), Contains("decimal_comma"));
  const auto clips = Run(Declared("kard"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].outcome.summary.at("frames"), rows.size() / 15);
}

TEST_F(ChangedKard, RowsThatCountFramesAndJointsAreReadBehindTheirCounts) {
  const std::vector<Vector3d> rows = Rows(kName);
  for (const bool joints : {false, true}) {
    std::ostringstream text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      text << r / 15 + 1 << ' ';
      if (joints) text << r % 15 << ' ';
      text << rows[r].transpose() << '\n';
    }
    Written(kName, text.str());
    const Json inspection = Look();
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
    const Json& clip = inspection.at("clips")[0];
    EXPECT_EQ(Value(clip, "skeleton"), "openni15");
    EXPECT_EQ(Value(clip, "frames"), rows.size() / 15);
    EXPECT_EQ(clip.at("facts").at("columns"), joints ? "skip, skip, x, y, z" : "skip, x, y, z");
  }
}

TEST_F(ChangedKard, AHeaderMayHoldANumber) {
  const std::vector<Vector3d> rows = Rows(kName);
  Write(kName, rows);
  Written(kName, "15 joints a frame\nx1 y1 z1 of version 2 (mm)\n" + *ReadFile(folder_ / kName));
  const Json inspection = Look();
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
  EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), rows.size() / 15);
  EXPECT_THAT(Codes(inspection, "warning"), Not(Contains("not_a_number")));
  const auto clips = Run(Declared("kard"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].outcome.summary.at("frames"), rows.size() / 15);
  EXPECT_EQ(clips[0].outcome.summary.at("missing_share"), 0.0);
}

TEST_F(ContradictingFiles, ABvhWithoutBonesIsRefusedByBoth) {
  Bvh bvh = *ParseBvh(Recorded("bvh/bandai1/dataset-1_bow_active_001.bvh"), "bow");
  for (BvhJoint& joint : bvh.joints) {
    joint.offset.setZero();
    joint.end_site.setZero();
    for (std::size_t c = 0; &joint != &bvh.joints[0] && c < joint.channels.size(); ++c) {
      for (int f = 0; IsPosition(joint.channels[c]) && f < bvh.frames; ++f)
        bvh.values[static_cast<std::size_t>(f) * bvh.channel_count + joint.first_channel + c] = 0.0;
    }
  }
  Written("dataset-1_bow_active_001.bvh", WriteBvh(bvh));
  EXPECT_THAT(Told(Look(), "malformed").at("message"), HasSubstr("no bone has a length"));
  IngestOptions options = Declared("bandai1");
  options.path = folder_;
  EXPECT_THAT(RefusalOf(options, "no_bones"), HasSubstr("no bone has a length"));
}

TEST_F(ContradictingFiles, ADamagedSkeletonFileIsToldOnceHoweverManyMotionsNeedIt) {
  const std::string asf = Recorded("cmu/asf_amc/01.asf");
  Written("01.asf", asf.substr(0, asf.size() / 2));
  Written("01_01.amc", Recorded("cmu/asf_amc/01_01.amc"));
  Written("01_02.amc", Recorded("cmu/asf_amc/01_01.amc"));
  const Json inspection = Look();
  int told = 0;
  for (const Json& finding : inspection.at("findings")) {
    told += finding.at("where").get<std::string>().rfind("01.asf", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(told, 1) << inspection.at("findings").dump(1);
}

TEST_F(ContradictingFiles, AFrameNumberThatIsDamagedOrMissingIsOneFinding) {
  Written("01.asf", Recorded("cmu/asf_amc/01.asf"));
  const std::string amc = WriteAmc(*ParseAmc(Recorded("cmu/asf_amc/01_01.amc"), {}, "01_01.amc"));
  const std::size_t at = amc.find("\n12\n") + 1;
  ASSERT_NE(at, 0u);
  for (const std::string number : {"1x2", "1.2", ""}) {
    std::string damaged = amc;
    damaged.replace(at, number.empty() ? 3 : 2, number);
    Written("01_01.amc", damaged);
    const Json inspection = Look();
    EXPECT_THAT(AllCodes(inspection), ElementsAre("frame_number")) << number << inspection.at("findings").dump(1);
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 2751);
  }
}

TEST_F(ContradictingFiles, ADamagedRowIsToldOnce) {
  Written("01.asf", Recorded("cmu/asf_amc/01.asf"));
  std::string amc = WriteAmc(*ParseAmc(Recorded("cmu/asf_amc/01_01.amc"), {}, "01_01.amc"));
  const std::size_t row = amc.find("lfemur", amc.find("\n12\n"));
  amc.replace(row, amc.find('\n', row) - row, "lfemur 1.0");
  Written("01_01.amc", amc);
  EXPECT_THAT(AllCodes(Look()), ElementsAre("row_length"));
}

}  // namespace
}  // namespace mocurate
