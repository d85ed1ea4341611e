// Edited tables of joints, Kinect joints and exponential maps: an inspection and a run agree.

#include <algorithm>
#include <sstream>

#include "core/base/text.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Json = nlohmann::json;

/// Clips of KARD, 15 joints of three numbers per row.
class ChangedKard : public ChangedFiles {
 protected:
  static constexpr const char* kName = "a01_s01_e01_realworld.txt";

  static std::string Text() { return Recorded(std::string("kinect/kard/") + kName); }
  static std::vector<Vector3d> Rows(const std::string& name = kName) {
    std::istringstream in(Recorded("kinect/kard/" + name));
    std::vector<Vector3d> rows;
    for (Vector3d row; in >> row[0] >> row[1] >> row[2];) rows.push_back(row);
    return rows;
  }
  void Write(const std::vector<Vector3d>& rows, const std::string& name = kName) {
    std::ostringstream out;
    out.precision(10);
    for (const Vector3d& row : rows) out << row.x() << ' ' << row.y() << ' ' << row.z() << '\n';
    Written(name, out.str());
  }
  IngestOptions Kard() const { return From("kard"); }
  /// With the source declared, and without.
  std::vector<std::optional<SourceOptions>> Sources() const { return {Kard().source, std::nullopt}; }
  StageOutcome Run() const { return RunOne(Kard()); }
};

TEST_F(ChangedKard, RejectsASkeletonWithTheHeadBelowTheTrunk) {
  const std::vector<Vector3d> rows = Rows();
  // Order of a skeleton with arms as legs and the head in the middle of the trunk.
  const int order[] = {8, 1, 9, 10, 11, 12, 13, 14, 0, 2, 3, 4, 5, 6, 7};
  std::vector<Vector3d> reordered;
  for (std::size_t r = 0; r < rows.size(); ++r)
    reordered.push_back(rows[r / 15 * 15 + static_cast<std::size_t>(order[r % 15])]);
  Write(reordered);
  const Json inspection = Inspect();
  ASSERT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_NE(Value(inspection.at("clips")[0], "skeleton"), "openni15") << inspection.at("clips")[0].at("skeleton");
  EXPECT_THAT(ErrorCodes(Run()), Contains("joint_order_contradiction"));
}

TEST_F(ChangedKard, ReportsTwoExchangedJoints) {
  std::vector<Vector3d> rows = Rows();
  for (std::size_t r = 0; r + 15 <= rows.size(); r += 15) std::swap(rows[r], rows[r + 8]);  // head and torso
  Write(rows);
  EXPECT_EQ(Value(Inspect().at("clips")[0], "skeleton"), Json());
  EXPECT_THAT(ErrorCodes(Run()), Contains("joint_order_contradiction"));
}

TEST_F(ChangedKard, ReportsFramesInMetresAmongMillimetresAsCollapsed) {
  std::vector<Vector3d> rows = Rows();
  for (std::size_t r = 15 * 20; r < 15 * 40; ++r) rows[r] *= 0.001;
  Write(rows);
  for (const auto& source : Sources()) {
    const std::vector<Json> findings = FindingsOf(Inspect(source), "collapsed_frames");
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].at("where"), std::string(kName) + " frames 20-40");
  }
  EXPECT_THAT(FindingsOf(Run(), "collapsed_frames"), SizeIs(1));
}

TEST_F(ChangedKard, ReportsALowerRateInAFileOfAHigherOneAndKeepsTheClip) {
  std::vector<Vector3d> twice;
  const std::vector<Vector3d> rows = Rows();
  for (std::size_t r = 0; r < rows.size(); r += 15) {
    for (int copy = 0; copy < 2; ++copy) twice.insert(twice.end(), &rows[r], &rows[r] + 15);
  }
  Write(twice);
  EXPECT_THAT(Codes(Inspect(Kard().source), "warning"), ElementsAre("repeated_frames"));
  EXPECT_THAT(FindingsOf(Run(), "repeated_frames"), SizeIs(1));
  EXPECT_EQ(Run().kind, OutcomeKind::kDone);
}

TEST_F(ChangedKard, ReportsRoundedAndMirroredCopies) {
  const int mirrored[] = {0, 1, 5, 6, 7, 2, 3, 4, 8, 12, 13, 14, 9, 10, 11};
  const std::vector<Vector3d> rows = Rows();
  std::vector<Vector3d> rounded = rows, mirror = rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rounded[r] = rows[r].array().round();
    mirror[r] = rows[r / 15 * 15 + static_cast<std::size_t>(mirrored[r % 15])].cwiseProduct(Vector3d(-1.0, 1.0, 1.0));
  }
  Write(rows);
  Write(rounded, "a02_s01_e01_realworld.txt");
  Write(mirror, "a03_s01_e01_realworld.txt");
  EXPECT_THAT(Places(Inspect(Kard().source), "warning"),
              ::testing::IsSupersetOf(
                  {"near_duplicate a02_s01_e01_realworld.txt", "mirrored_duplicate a03_s01_e01_realworld.txt"}));
}

TEST_F(ChangedKard, MarksJointsWithImplausibleNumbersMissing) {
  for (const auto& [row, code] :
       {std::pair<std::string, std::string>{"1e300 4 5", "number_too_large"}, {"1e300 nan inf", "not_a_number"}}) {
    std::string text = Text();
    std::size_t begin = 0;
    for (int line = 0; line < 15 * 6 + 2; ++line) begin = text.find('\n', begin) + 1;
    Written(kName, text.replace(begin, text.find('\n', begin) - begin, row));
    const StageOutcome clip = Run();
    EXPECT_EQ(clip.kind, OutcomeKind::kDone) << "only a frame is dropped";
    ASSERT_FALSE(clip.findings.empty());
    EXPECT_EQ(clip.findings[0].code, code);
    EXPECT_EQ(clip.findings[0].frame_begin, 6);
    EXPECT_THAT(clip.findings[0].message, StartsWith(std::string(kName) + ":93:"));
    for (const auto& source : Sources()) {
      const Json inspection = Inspect(source);
      EXPECT_EQ(FindingsOf(inspection, code).size(), 1u);
      for (const Json& finding : inspection.at("findings")) EXPECT_FALSE(finding.at("value").is_null()) << finding;
    }
  }
}

// Rows.

TEST_F(ChangedKard, KeepsCompleteFramesOfATruncatedTable) {
  const std::string text = Text();
  std::size_t row = 0;
  for (int line = 0; line < 200; ++line) row = text.find('\n', row) + 1;  // 13 frames of 15 rows, and 5 rows
  for (const std::string& bytes : {text.substr(0, row), text.substr(0, row + 3)}) {
    Written(kName, bytes);
    const StageOutcome clip = Run();
    EXPECT_EQ(clip.summary.at("frames"), 13);
    EXPECT_THAT(ErrorCodes(clip), Contains("cut_off"));
    for (const auto& source : Sources()) {
      const Json inspection = Inspect(source);
      ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
      EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 13);
      EXPECT_THAT(Codes(inspection, "error"), Contains("cut_off")) << source.has_value();
    }
  }
}

TEST_F(ChangedKard, SkipsAHeader) {
  const std::string text = Text();
  const std::size_t frames = Rows().size() / 15;
  const std::pair<std::string, std::size_t> headers[] = {{"", 0},
                                                         {"x y z\n", 1},
                                                         {"# frame x y z\n", 1},
                                                         {"a recording\nx,y,z\n", 2},
                                                         {"15 joints a frame\nx1 y1 z1 of version 2 (mm)\n", 2}};
  for (const auto& [header, lines] : headers) {
    SCOPED_TRACE(header);
    const fs::path file = Written(kName, header + text);
    const StageOutcome clip = Run();
    EXPECT_EQ(clip.kind, OutcomeKind::kDone);
    EXPECT_EQ(clip.summary.at("frames"), frames);
    EXPECT_EQ(clip.summary.at("missing_share"), 0.0);
    for (const auto& source : Sources()) {
      for (const fs::path& path : {folder_, file}) {
        const Json inspection = InspectPath(path, source);
        ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
        EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), frames);
        EXPECT_EQ(Value(inspection.at("clips")[0], "joints"), 15);
        EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
        EXPECT_THAT(Codes(inspection, "warning"), Not(Contains("not_a_number")));
        EXPECT_EQ(Codes(inspection, "info").size(), lines) << inspection.at("findings").dump(1);
      }
    }
  }
}

TEST_F(ChangedKard, ReadsDecimalCommasAsPoints) {
  const std::vector<Vector3d> rows = Rows();
  std::ostringstream text;
  text.precision(4);
  text << std::fixed;
  for (const Vector3d& row : rows) text << row[0] << ';' << row[1] << ';' << row[2] << '\n';
  std::string commas = text.str();
  std::replace(commas.begin(), commas.end(), '.', ',');
  Written(kName, commas);
  const Json inspection = Inspect();
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
  EXPECT_EQ(Value(inspection.at("clips")[0], "skeleton"), "openni15");
  EXPECT_EQ(FindingsOf(inspection, "decimal_comma").size(), 1u);
  EXPECT_EQ(Run().summary.at("frames"), rows.size() / 15);
  std::replace(commas.begin(), commas.end(), ';', ' ');
  Written(kName, commas);
  EXPECT_THAT(Codes(Inspect(), "error"), Contains("malformed"));
}

TEST_F(ChangedKard, SkipsFrameAndJointCountersInRows) {
  const std::vector<Vector3d> rows = Rows();
  for (const bool joints : {false, true}) {
    std::ostringstream text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      text << r / 15 + 1 << ' ';
      if (joints) text << r % 15 << ' ';
      text << rows[r].transpose() << '\n';
    }
    Written(kName, text.str());
    const Json inspection = Inspect();
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
    const Json& clip = inspection.at("clips")[0];
    EXPECT_EQ(Value(clip, "skeleton"), "openni15");
    EXPECT_EQ(Value(clip, "frames"), rows.size() / 15);
    EXPECT_EQ(clip.at("facts").at("columns"), joints ? "frame, skip, x, y, z" : "frame, x, y, z");
  }
}

/// MSR-Action3D, 20 joints of position and confidence.
class ChangedMsr : public ChangedFiles {};

TEST_F(ChangedMsr, ReportsAJointMissingInEveryFrameOnce) {
  const std::string name = "a01_s03_e01_skeleton3D.txt";
  std::istringstream rows(Recorded("kinect/msr_action3d/" + name));
  std::string row, altered;
  for (int i = 0; std::getline(rows, row); ++i) altered += (i % 20 == 7 ? "0 0 0 0" : row) + "\n";
  Written(name, altered);
  const IngestOptions options = From("msr_action3d");
  EXPECT_EQ(FindingsOf(RunOne(options), "joint_never_seen").size(), 1u);
  EXPECT_EQ(FindingsOf(Inspect(options.source), "joint_never_seen").size(), 1u);
}

TEST_F(ChangedMsr, ReportsAnInvalidConfidenceAsAFileError) {
  const std::string name = "a01_s01_e01_skeleton3D.txt";
  std::string text = Recorded("kinect/msr_action3d/" + name);
  Written(name, text);
  const IngestOptions options = From("msr_action3d");
  EXPECT_THAT(Codes(Inspect(options.source), "error"), IsEmpty());
  const std::size_t end = text.find_last_not_of(" \r\n");
  const std::size_t begin = text.find_last_of(" \t", end) + 1;
  Written(name, text.replace(begin, end + 1 - begin, "7.5"));
  const Json inspection = Inspect(options.source);
  EXPECT_THAT(Places(inspection), ElementsAre("layout_contradiction " + name));
  EXPECT_THAT(inspection.at("findings").dump(), HasSubstr("7.5"));
}

TEST_F(RecordedFormats, ReportZeroFramesWithTheirRange) {
  const std::string name = "a14_s03_e01_skeleton3D.txt";
  const std::vector<Json> findings = FindingsOf(Inspect("kinect/msr_action3d/" + name), "zero_frames");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("where"), name + " frames 19-28");
  EXPECT_EQ(findings[0].at("value"), 9);
}

class ChangedExpmap : public ChangedFiles {};

TEST_F(ChangedExpmap, ReportsADamagedRow) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(TestData() + "/cmu/expmap")) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  const std::string text = *ReadFile(*std::min_element(files.begin(), files.end()));
  const std::vector<std::string_view> lines = SplitText(text, '\n');
  for (const std::string damage : {",abc", ""}) {
    std::string damaged;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string line(lines[i]);
      damaged += (i == 7 ? line.substr(0, line.rfind(',')) + damage : line) + "\n";
    }
    Written("walking_1.txt", damaged);
    const Json inspection = Inspect();
    ASSERT_EQ(inspection.at("clips").size(), 1u) << damage << inspection.at("findings").dump(1);
    EXPECT_EQ(inspection.at("clips")[0].at("format"), "expmap_table") << damage;
    EXPECT_FALSE(inspection.at("findings").empty()) << damage;
  }
}

}  // namespace
}  // namespace mocurate
