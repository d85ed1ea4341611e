// Bad input through the whole program: the message has file, place, value, rule and remedy, and the exit code is the
// documented one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;

constexpr const char* kTable = R"(name: bad
skeleton: openni16
ingest:
  path: data
  source:
    name: bad
    format: joint_table
    files: "a{action}_s{person}.txt"
    UNITS
    axes: "+x +y -z"
    rate: 30 Hz
    skeleton: openni15
    rows_per_frame: 3
    joints: [JOINTS]
)";

constexpr const char* kBvh = R"(name: bad
fitting: {method: none}
ingest:
  path: data
  source:
    name: bad
    format: bvh
    files: "{action}_{person}.bvh"
    units: cm
    axes: "+x +y +z"
)";

constexpr const char* kBvhHead =
    "HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\n";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

std::string TableConfig(const std::string& units = "units: mm", const std::string& joints = "head, neck, torso") {
  return Replaced(Replaced(kTable, "UNITS", units), "JOINTS", joints);
}

Result RunFolder(const ScratchFolder& folder, const std::string& config) {
  WriteText(folder / "job.yaml", config);
  return RunProgram(
      folder, {"run", (folder / "job.yaml").string(), "-o", (folder / "run").string(), "--to", "assemble", "--json"});
}

std::string Rows(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "100 " + std::to_string(100 * i) + " 2000\n";
  return text;
}

/// The exit code, and every part of the message on stderr and in the JSON document.
void ExpectError(const Result& result, int exit_code, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
  const nlohmann::json document = nlohmann::json::parse(result.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << result.out;
  if (document.contains("error")) {
    EXPECT_EQ(document["error"]["exit_code"], exit_code);
  }
  for (const std::string& part : parts) EXPECT_THAT(result.err, HasSubstr(part));
}

TEST(BadInput, AnEmptyFileIsNamed) {
  const ScratchFolder folder;
  WriteText(folder / "data/a01_s01.txt", "");
  ExpectError(
      RunFolder(folder, TableConfig()), 3,
      {(folder / "data").string(), "a01_s01.txt", "the file is empty", "was it copied whole?", "curation_log.jsonl"});
  WriteText(folder / "empty.bvh", "");
  ExpectError(RunProgram(folder, {"inspect", (folder / "empty.bvh").string(), "--json"}), 3,
              {"empty.bvh", "the file is empty", "was it copied whole?"});
}

TEST(BadInput, ARowCountThatDoesNotDivideNamesFileLineAndCounts) {
  const ScratchFolder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(7));
  ExpectError(RunFolder(folder, TableConfig("units: mm\n    damaged_rows: refuse")), 3,
              {"a01_s01.txt:8", "7 rows are not a whole number of frames of 3 rows (1 left over)"});
}

TEST(BadInput, AMissingUnitIsAConfigErrorWithTheOptionToWrite) {
  const ScratchFolder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(6));
  ExpectError(RunFolder(folder, TableConfig("licence: none")), 2,
              {"ingest.source.units", "source 'bad' does not declare its unit of length", "write `units: m`"});
}

TEST(BadInput, AnUnknownJointIsNamedWithTheSkeletonThatLacksIt) {
  const ScratchFolder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(6));
  ExpectError(RunFolder(folder, TableConfig("units: mm", "head, neck, third_elbow")), 2,
              {"ingest.source.joints", "joint 'third_elbow' is unknown to skeleton 'openni15'",
               "use the skeleton's names or synonyms"});
}

TEST(BadInput, AFileNameOutsideThePatternIsReportedWithPatternAndRemedy) {
  const ScratchFolder folder;
  WriteText(folder / "data/walk.txt", Rows(6));
  ExpectError(RunFolder(folder, TableConfig()), 3,
              {(folder / "data").string(), "no file matches the pattern 'a{action}_s{person}.txt'",
               "'walk.txt' does not match", "ingest.source.files"});
}

TEST(BadInput, ATruncatedBvhNamesLineAndCountsInARunAndInInspect) {
  const ScratchFolder folder;
  const std::string cut = std::string(kBvhHead) + "Frames: 3\nFrame Time: 0.033\n0 0 0\n";
  WriteText(folder / "data/walk_p1.bvh", cut);
  ExpectError(RunFolder(folder, std::string(kBvh) + "    damaged_rows: refuse\n"), 3,
              {"walk_p1.bvh:8", "Frames announces 3, the file holds 1",
               "the file is cut off, or its header is wrong: copy it again"});
  const Result inspected = RunProgram(folder, {"inspect", (folder / "data/walk_p1.bvh").string(), "--json"});
  const nlohmann::json finding = nlohmann::json::parse(inspected.out).at("findings").at(0);
  EXPECT_EQ(finding.at("code"), "count_contradiction");
  EXPECT_EQ(finding.at("value"), 3);
  EXPECT_NE(finding.at("message").get<std::string>().find("walk_p1.bvh:8: Frames announces 3, the file holds 1"),
            std::string::npos);
}

TEST(BadInput, ABvhWithNanNamesLineFrameAndChannelInARunAndInInspect) {
  const ScratchFolder folder;
  WriteText(folder / "data/walk_p1.bvh", std::string(kBvhHead) + "Frames: 1\nFrame Time: 0.033\n0 nan 0\n");
  const std::vector<std::string> parts = {"walk_p1.bvh:10", "'nan' in frame 0, channel 1 is no finite number"};
  ExpectError(RunFolder(folder, kBvh), 3, parts);
  ExpectError(RunProgram(folder, {"inspect", (folder / "data/walk_p1.bvh").string(), "--json"}), 3, parts);
}

TEST(BadInput, AStoreWithOneFieldCorruptedIsAnErrorThatNamesTheField) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, program::SmallJob(folder, "r"), program::SharedCache()).exit_code, 0);
  const std::string bytes = ReadText(folder / "r/dataset.h5");
  std::string label = bytes;
  label.replace(label.find("clap"), 4, "Xlap");
  std::string middle = bytes;
  middle[middle.size() / 2] = static_cast<char>(middle[middle.size() / 2] ^ 0x10);
  for (const auto& [text, field] :
       {std::pair<std::string, std::string>{label, "broken.h5:/clips/"}, {middle, "broken.h5:/frames/"}}) {
    WriteText(folder / "broken.h5", text);
    ExpectError(RunProgram(folder, {"inspect", (folder / "broken.h5").string(), "--json"}), 3,
                {field, "its values do not have the stored sha256", "copy it again"});
  }
  WriteText(folder / "broken.h5", bytes.substr(0, bytes.size() / 2));
  ExpectError(RunProgram(folder, {"inspect", (folder / "broken.h5").string(), "--json"}), 3,
              {"broken.h5", "truncated", "make the file again"});
}

/// Lines of the curation log of a run that bear a finding of `code`.
std::vector<nlohmann::json> Flagged(const fs::path& run, const std::string& code, std::size_t& clips) {
  std::vector<nlohmann::json> flagged;
  std::ifstream log(run / "curation_log.jsonl");
  std::string line;
  for (clips = 0; std::getline(log, line); ++clips) {
    const nlohmann::json clip = nlohmann::json::parse(line);
    for (const nlohmann::json& finding : clip["findings"]) {
      if (finding["code"] == code) flagged.push_back(finding);
    }
  }
  return flagged;
}

void ExpectMistakenAxes(const std::vector<nlohmann::json>& findings, const std::string& axes) {
  for (const nlohmann::json& finding : findings) {
    EXPECT_EQ(finding["severity"], "error");
    EXPECT_EQ(finding["action"], "flagged");
    const std::string message = finding["message"];
    EXPECT_THAT(message, HasSubstr("with axes '" + axes + "' the motion is left-handed"));
    EXPECT_THAT(message, HasSubstr("ingest.source.axes"));
  }
}

TEST(LeftHandedDeclaredRightHanded, ASyntheticCaptureIsFlaggedFromItsMotionAndNotMirrored) {
  const ScratchFolder folder;
  const auto run = [&](const std::string& axes, const std::string& on_contradiction) {
    std::vector<std::string> arguments = program::SmallJob(folder, "r");
    std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("ingest"));
    arguments.insert(arguments.end(), {"--set", "ingest.source.axes=" + axes, "--set",
                                       "ingest.source.on_contradiction=" + on_contradiction, "--json"});
    return RunProgram(folder, arguments);
  };
  std::size_t clips = 0;
  ASSERT_EQ(run("+x +y -z", "flag").exit_code, 0);
  EXPECT_TRUE(Flagged(folder / "r", "handedness_contradiction", clips).empty());

  const Result mistaken = run("+x +y +z", "flag");
  ExpectError(mistaken, 1, {"are suspect, tolerated_suspect is"});
  const auto flagged = Flagged(folder / "r", "handedness_contradiction", clips);
  EXPECT_GE(flagged.size(), clips * 2 / 3) << "of " << clips;
  ExpectMistakenAxes(flagged, "+x +y +z");
  bool by_knees = false;
  for (const auto& finding : flagged)
    by_knees |= finding["message"].get<std::string>().find("knees") != std::string::npos;
  EXPECT_TRUE(by_knees);

  const Result refused = run("+x +y +z", "refuse");
  ExpectError(refused, 1, {"with axes '+x +y +z' the motion is left-handed", "on_contradiction: flag"});
}

TEST(LeftHandedDeclaredRightHanded, RealKinectClipsAreFlaggedFromTheirMotion) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  fs::create_directories(folder / "kard");
  for (const char* clip : {"a12_s01_e01", "a12_s01_e02", "a17_s01_e01", "a17_s01_e02", "a18_s01_e01", "a18_s01_e02"}) {
    const std::string name = std::string(clip) + "_realworld.txt";
    fs::copy_file(fs::path(data) / "kinect/kard" / name, folder / ("kard/" + name));
  }
  const std::string declaration = std::string(kSourceFolder) + "/configs/kard.yaml";
  WriteText(folder / "mistaken.yaml", "include: resource:kard.yaml\ningest:\n  source:\n    axes: \"+x +y +z\"\n");
  std::size_t clips = 0;
  for (const bool mistaken : {false, true}) {
    const std::filesystem::path output = folder / (mistaken ? "mistaken" : "r");  // a folder for each configuration
    const Result result =
        RunProgram(folder, {"run", mistaken ? (folder / "mistaken.yaml").string() : declaration, "--set",
                            "ingest.path=" + (folder / "kard").string(), "-o", output.string(), "--to", "ingest"});
    EXPECT_EQ(result.exit_code, mistaken ? 1 : 0) << result.err;
    const auto flagged = Flagged(output, "handedness_contradiction", clips);
    EXPECT_EQ(clips, 6u);
    if (!mistaken) {
      EXPECT_TRUE(flagged.empty());
      continue;
    }
    EXPECT_EQ(flagged.size(), 6u) << "four that sit down and stand up decide, also for the two that bend";
    ExpectMistakenAxes(flagged, "+x +y +z");
  }
  const Result inspected = RunProgram(
      folder, {"inspect", (folder / "kard").string(), "--source", (folder / "mistaken.yaml").string(), "--json"});
  EXPECT_THAT(inspected.Json()["findings"].dump(), HasSubstr("handedness_contradiction")) << inspected.out;
}

/// A few real Kinect clips through the stage `ingest`, with the declaration of KARD changed.
class MistakenDeclaration : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    fs::create_directories(folder_ / "kard");
    for (const char* clip :
         {"a01_s01_e01", "a03_s02_e01", "a12_s01_e01", "a12_s01_e02", "a17_s01_e01", "a17_s01_e02", "a18_s01_e01",
          "a18_s01_e02", "a17_s02_e01", "a18_s02_e01", "a17_s03_e01", "a18_s03_e01"}) {
      const std::string name = std::string(clip) + "_realworld.txt";
      fs::copy_file(fs::path(data) / "kinect/kard" / name, folder_ / ("kard/" + name));
    }
  }

  Result Run(const std::vector<std::string>& assignments, const std::string& to = "ingest") {
    std::vector<std::string> arguments = {"run",   std::string(kSourceFolder) + "/configs/kard.yaml",
                                          "--set", "ingest.path=" + (folder_ / "kard").string(),
                                          "-o",    (folder_ / "r").string(),
                                          "--to",  to,
                                          "--json"};
    for (const std::string& assignment : assignments) arguments.insert(arguments.end(), {"--set", assignment});
    return RunProgram(folder_, arguments);
  }

  std::size_t FlaggedClips(const std::string& code) {
    std::size_t clips = 0;
    return Flagged(folder_ / "r", code, clips).size();
  }

  ScratchFolder folder_;
};

TEST_F(MistakenDeclaration, AWrongUpAxisIsFoundInEveryClipAndInTheSet) {
  const Result honest = Run({});
  EXPECT_EQ(honest.exit_code, 0) << honest.err;
  EXPECT_TRUE(honest.Json()["set_findings"].empty()) << honest.out;
  const Result lying = Run({"ingest.source.axes=+x +z +y"});
  EXPECT_EQ(FlaggedClips("up_contradiction"), 12u);
  EXPECT_EQ(lying.exit_code, 1) << lying.err;
  EXPECT_EQ(lying.Json()["suspect"], 12) << lying.out;
  EXPECT_THAT(lying.err, HasSubstr("12 of 12 clips are suspect, tolerated_suspect is 6 clips"));
  EXPECT_EQ(Run({"ingest.source.axes=+x +z +y", "tolerated_suspect=1"}).exit_code, 0);
  EXPECT_EQ(lying.Json()["set_findings"][0]["code"], "up_contradiction") << lying.out;
  EXPECT_THAT(lying.err, HasSubstr("error: the whole source contradicts its declaration: 12 of the 12 clips"));
}

TEST_F(MistakenDeclaration, AWrongOrderOfJointsIsFound) {
  Run(
      {"ingest.source.joints=[neck, head, right_shoulder, right_wrist, right_elbow, left_shoulder, left_wrist, "
       "left_elbow, torso, right_hip, right_ankle, right_knee, left_hip, left_ankle, left_knee]"});
  EXPECT_GE(FlaggedClips("joint_order_contradiction"), 10u);
}

TEST_F(MistakenDeclaration, UndecidedClipsAreRefusedWithTheirSource) {
  const Result refused = Run({"ingest.source.axes=+x +y +z", "ingest.source.on_contradiction=refuse"});
  EXPECT_EQ(refused.exit_code, 1) << refused.err;
  EXPECT_EQ(refused.Json()["failed"], 12) << refused.out;
}

TEST_F(MistakenDeclaration, ValuesThatAreWrongByThemselvesAreReportedAtOnceBeforeAnyWork) {
  ExpectError(Run({"ingest.source.units=furlong", "ingest.source.axes=+x +x +z", "canon.rate=abc",
                   "ingest.source.roles={s01: tset}"}),
              2,
              {"ingest.source.units: 'furlong' is no unit of length", "ingest.source.axes: ",
               "canon.rate: 'abc' is no frame rate", "there is no role 'tset' (did you mean 'test'?)"});
  ExpectError(Run({"canon.rate=0"}), 2, {"canon.rate"});
  ExpectError(Run({"fitting.method=point_clouds"}, "fitting"), 2, {"fitting.method", "write `method: joint_tracks`"});
  ExpectError(Run({"fitting.method=joints_and_clouds", "fitting.joint_tracks.uncertainty=false"}, "fitting"), 2,
              {"fitting.joint_tracks.uncertainty"});
  ExpectError(Run({"audit.split=foo"}), 2, {"audit.split: there is no split 'foo'"});
  EXPECT_FALSE(fs::exists(folder_ / "r"));
  EXPECT_EQ(Run({"canon.rate=25fps"}).exit_code, 0);
}

TEST(GivenMotion, IsNotRetargetedToAnotherSkeletonSilently) {
  const ScratchFolder folder;
  WriteText(folder / "data/walk_p1.bvh", std::string(kBvhHead) + "Frames: 1\nFrame Time: 0.033\n0 0 0\n");
  ExpectError(RunFolder(folder, std::string(kBvh) + "skeleton: smpl24\n"), 2,
              {"job.yaml:", "skeleton: motion of format bvh is kept on the skeleton of its files"});
}

TEST(BadInput, AHeaderThatContradictsTheRowsIsAFindingOfTheRunWithItsNumber) {
  const ScratchFolder folder;
  std::string rows;
  for (int i = 0; i < 40; ++i) rows += std::to_string(i) + " 90 0\n";
  WriteText(folder / "data/walk_p1.bvh", std::string(kBvhHead) + "Frames: 60\nFrame Time: 0.033\n" + rows);
  WriteText(folder / "data/walk_p2.bvh", std::string(kBvhHead) + "Frames: 40\nFrame Time: 0.033\n" + rows);
  std::size_t clips = 0;
  RunFolder(folder, std::string(kBvh) + "    damaged_rows: refuse\n");
  std::vector<nlohmann::json> flagged = Flagged(folder / "run", "count_contradiction", clips);
  EXPECT_EQ(clips, 2u);
  ASSERT_EQ(flagged.size(), 1u);
  EXPECT_EQ(flagged[0]["value"], 60);
  EXPECT_THAT(flagged[0]["message"].get<std::string>(), HasSubstr("walk_p1.bvh:8: Frames announces 60"));
  RunFolder(folder, kBvh);
  flagged = Flagged(folder / "run", "count_contradiction", clips);
  ASSERT_EQ(flagged.size(), 1u);
  EXPECT_EQ(flagged[0]["value"], 60);
  EXPECT_THAT(flagged[0]["clip"].get<std::string>(), HasSubstr("#0-40"));
}

}  // namespace
}  // namespace mocurate
