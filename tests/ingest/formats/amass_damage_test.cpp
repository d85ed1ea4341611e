// The AMASS sample and BABEL labels with one defect. Synthetic motions: amass_findings_test.cpp.

#include <cmath>
#include <limits>

#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "core/formats/npz.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/changed_files.h"
#include "tests/support/amass_writer.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::json;

class DamagedAmass : public ChangedFiles {
 protected:
  static constexpr const char* kSample = "amass_babel/amass_sample.npz";

  template <class Change>
  void Write(const Change& change) {
    Amass amass = *ParseAmass(Recorded(kSample), "sample");
    change(amass);
    Written("CMU/01/walk_poses.npz", *EncodeNpz(AmassWithMarkers(amass), "sample"));
  }
};

TEST_F(DamagedAmass, InterpolatesOnlyNonFiniteFrames) {
  Write([](Amass& amass) {
    for (const std::size_t f : {std::size_t{100}, std::size_t{101}, std::size_t{300}})
      amass.poses[f * amass.pose_columns + 7] = std::nan("");
    amass.translation_m[3 * 300] = std::numeric_limits<double>::infinity();
  });
  const Json inspection = Inspect();
  EXPECT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_THAT(FindingsOf(inspection, "no_joint_seen"), IsEmpty());
  const StageOutcome clip = RunOne(From("amass"));
  const std::vector<Finding> findings = FindingsOf(clip, "not_a_number");
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].frame_begin, 100);
  EXPECT_EQ(findings[0].frame_end, 102);
  EXPECT_EQ(findings[1].frame_begin, 300);
  EXPECT_EQ(findings[1].frame_end, 301);
  for (const Finding& finding : findings) EXPECT_EQ(finding.action, FindingAction::kInterpolated);
  EXPECT_THAT(ErrorCodes(clip), Not(Contains("position_jump")));
}

TEST_F(DamagedAmass, RejectsSecondsPerFrameAsRate) {
  Write([](Amass& amass) { amass.rate_hz = 1.0 / 120.0; });
  const std::vector<Json> findings = FindingsOf(Inspect(), "rate_implausible");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_NEAR(findings[0].at("value"), 1.0 / 120.0, 1e-6);
  EXPECT_THAT(findings[0].at("message"), HasSubstr(" 120")) << "the corrected rate";
  EXPECT_EQ(RunOne(From("amass")).kind, OutcomeKind::kRefused);
}

TEST_F(DamagedAmass, ReportsRotationsInDegreesWithoutTheirConsequences) {
  Write([&](Amass& amass) {
    for (double& angle : amass.poses) angle *= 180.0 / M_PI;
  });
  const Json inspection = Inspect();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
  EXPECT_GT(FindingsOf(inspection, "angle_unit_contradiction").at(0).at("value"), 90.0);
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty()) << inspection.at("findings").dump(1);
  const StageOutcome clip = RunOne(From("amass"));
  EXPECT_THAT(ErrorCodes(clip), ElementsAre("angle_unit_contradiction"));
  EXPECT_EQ(clip.findings.size(), 2u) << "the unit and the skeleton in use";
  EXPECT_EQ(clip.kind, OutcomeKind::kSuspect);
}

TEST_F(DamagedAmass, ReportsARootPathInCentimetresOfAStandingPerson) {
  for (const double factor : {1.0, 100.0}) {
    Write([&](Amass& amass) {
      for (double& value : amass.translation_m) value *= factor;
    });
    EXPECT_EQ(Codes(Inspect(), "error"),
              factor == 1.0 ? std::vector<std::string>{} : std::vector<std::string>{"units_contradiction"});
  }
}

TEST(AmassPaths, InCentimetresAreReportedByRunAndInspect) {
  for (const double factor : {1.0, 100.0}) {
    IngestOptions options = Declared("amass");
    const fs::path folder = FreshFolder("amass_unit");
    StudioOptions studio;
    studio.layout = StudioLayout::kAmass;
    studio.seed = 3;
    ASSERT_TRUE(WriteStudioLayout(studio, folder / "written", 1));
    options.path = folder / "written/amass";
    for (const auto& entry : fs::recursive_directory_iterator(options.path)) {
      if (entry.path().extension() != ".npz") continue;
      Npz archive = *ParseNpz(*ReadFile(entry.path()), "a");
      for (NpzMember& member : archive.members) {
        for (double& value : member.array.values) value *= member.name == "trans" ? factor : 1.0;
      }
      Put(entry.path(), *EncodeNpz(archive, "a"));
    }
    const std::size_t expected = factor == 1.0 ? 0 : 2;
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 2u);
    EXPECT_EQ(CountCode(clips, "units_contradiction"), expected);
    const auto errors = Codes(InspectPath(options.path, options.source), "error");
    EXPECT_EQ(errors, std::vector<std::string>(expected, "units_contradiction"));
  }
}

TEST_F(DamagedAmass, ReportsABodyThatLeavesItsPathAsAPositionJump) {
  Write([&](Amass& amass) {
    for (std::size_t f = 20; f < 25; ++f) amass.translation_m[3 * f] += 1000.0;
  });
  const std::vector<Json> findings = FindingsOf(Inspect(), "position_jump");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("where"), "CMU/01/walk_poses.npz frames 20-25");
}

// Labels.

TEST_F(DamagedAmass, ReportsDamagedLabelsAndLabelsOfAnotherDuration) {
  Write([](Amass&) {});
  const auto labels = [&](const std::string& duration, const std::string& end) {
    return R"({"1": {"babel_sid": 1, "url": "u", "feat_p": "CMU/CMU/01/walk_poses.npz", "dur": )" + duration +
           R"(, "seq_ann": null, "frame_ann": {"babel_lid": "l", "anntr_id": "a", "mul_act": true, "labels": [)" +
           R"({"raw_label": "walk", "proc_label": "walk", "seg_id": "s", "act_cat": ["walk"], "start_t": 0, "end_t": )" +
           end + "}]}}}";
  };
  Written("train.json", labels("5.01", "\"2\""));
  EXPECT_THAT(Places(Inspect()), ElementsAre("malformed train.json:/1/frame_ann/labels/0/end_t"));
  Written("train.json", labels("5.01", "2").substr(0, 150));
  EXPECT_THAT(Codes(Inspect(), "error"), ElementsAre("malformed"));
  IngestOptions options = From("amass");
  options.source.annotations = {"train.json"};
  for (const auto& [duration, expected] : {std::pair{"5.01", 0u}, {"5.2", 0u}, {"50.1", 1u}}) {
    Written("train.json", labels(duration, "2"));
    EXPECT_THAT(Codes(Inspect(), "error"), IsEmpty());
    EXPECT_EQ(FindingsOf(RunOne(options), "annotation_duration").size(), expected) << duration;
  }
}

TEST_F(DamagedAmass, DeclaresBabelWhenTheFolderHoldsIt) {
  Write([](Amass&) {});
  BabelSequence sequence;
  sequence.key = "1";
  sequence.babel_sid = 1;
  sequence.feat_p = "CMU/CMU/01/walk_poses.npz";
  sequence.dur = 5.0;
  Written("babel/train.json", EncodeBabel({sequence}));
  const auto declared = DeclareSource(InspectPath(folder_, std::nullopt), folder_, "mine");
  ASSERT_TRUE(declared) << declared.error().Message();
  EXPECT_THAT(declared->yaml, HasSubstr("annotations: [\"babel/train.json\"]"));
  EXPECT_THAT(declared->yaml, HasSubstr("names 1 of the 1 motion"));
}

}  // namespace
}  // namespace mocurate
