// What a run says of a file an inspection says too, and the other way round.

#include <gmock/gmock.h>

#include "core/base/text.h"
#include "core/formats/openpose.h"
#include "core/formats/zip_archive.h"
#include "ingest/sense/inspect.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::vector<std::string> ToldBy(const std::filesystem::path& path, const std::optional<SourceOptions>& source) {
  std::vector<std::string> told;
  const Json inspection = InspectPath(path, source);
  for (const Json& finding : inspection.at("findings"))
    told.push_back(finding.at("code").get<std::string>() + ": " + finding.at("message").get<std::string>());
  return told;
}

TEST(ToldByBoth, FilesOfOneFrameOfACameraAreNamed) {
  const std::filesystem::path folder = FreshFolder("frame_twice");
  OpenPoseFrame frame;
  frame.people.emplace_back();
  for (int k = 0; k < 25; ++k) frame.people[0].pose.push_back({100.0 + 20.0 * k, 50.0 + 30.0 * k, 0.9});
  for (const char* name : {"cam1.0000.json", "cam1.0001.json", "cam1.0002.json"})
    ASSERT_TRUE(WriteFile(folder / name, WriteOpenPose(frame)));
  EXPECT_THAT(ToldBy(folder, std::nullopt), Not(Contains(HasSubstr("the same frame as"))));
  ASSERT_TRUE(WriteFile(folder / "cam1.2.json", WriteOpenPose(frame)));
  EXPECT_THAT(ToldBy(folder, std::nullopt), Contains(HasSubstr("malformed: cam1.2.json: the same frame as cam1.0002")));
}

TEST(ToldByBoth, PeopleWithAnotherNumberOfKeypointsAreCounted) {
  const std::filesystem::path folder = FreshFolder("keypoint_count");
  for (int f = 0; f < 6; ++f) {
    OpenPoseFrame frame;
    frame.people.emplace_back();
    for (int k = 0; k < (f == 3 ? 26 : 25); ++k)
      frame.people[0].pose.push_back({100.0 + 20.0 * k + f, 50.0 + 30.0 * k, 0.9});
    ASSERT_TRUE(WriteFile(folder / ("cam1.000" + std::to_string(f) + ".json"), WriteOpenPose(frame)));
  }
  EXPECT_THAT(ToldBy(folder, std::nullopt), Contains(HasSubstr("keypoint_count: 1 person has another number")));
  EXPECT_EQ(Json(InspectPath(folder, std::nullopt)).at("clips")[0].at("joints").at("value"), 25);
}

TEST(ToldByBoth, AConfidenceOfMsrThatIsNoneIsAnErrorOfItsFile) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const char* const name = "a01_s01_e01_skeleton3D.txt";
  const std::filesystem::path folder = FreshFolder("msr_confidence");
  std::string text = *ReadFile(std::filesystem::path(TestData()) / "kinect/msr_action3d" / name);
  ASSERT_TRUE(WriteFile(folder / name, text));
  const IngestOptions msr = Declared("msr_action3d", {"ingest.path=" + folder.string()});
  EXPECT_THAT(ToldBy(folder, msr.source), Not(Contains(HasSubstr("confidence"))));
  const std::size_t end = text.find_last_not_of(" \r\n");
  const std::size_t begin = text.find_last_of(" \t", end) + 1;
  text.replace(begin, end + 1 - begin, "7.5");
  ASSERT_TRUE(WriteFile(folder / name, text));
  EXPECT_THAT(ToldBy(folder, msr.source), Contains(HasSubstr("confidence 7.5")));
}

TEST(ToldByBoth, APickleThatWouldRunSomethingIsAnErrorOfAFolderThatNamesFileAndClass) {
  const std::filesystem::path folder = FreshFolder("hostile_pickle");
  ASSERT_TRUE(WriteFile(folder / "notes.txt", "of no format"));
  ASSERT_TRUE(WriteFile(folder / "tracks.pkl", "cos\nsystem\n(S'true'\ntR."));
  const Json inspection = InspectPath(folder, std::nullopt);
  std::vector<std::string> told;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") != "unsafe_pickle") continue;
    EXPECT_EQ(finding.at("severity"), "error");
    told.push_back(finding.at("where").get<std::string>() + " " + finding.at("message").get<std::string>());
  }
  ASSERT_EQ(told.size(), 1u) << inspection.at("findings").dump(1);
  EXPECT_THAT(told[0], HasSubstr("tracks.pkl"));
  EXPECT_THAT(told[0], HasSubstr("'os system'"));
}

TEST(ToldByBoth, AnArchiveWhosePickleWouldRunSomethingNamesMemberAndClass) {
  const std::string evil = "cos\nsystem\n(S'true'\ntR.";
  const std::string archive = WriteStoredZip({{"archive/data.pkl", evil}, {"archive/version", "3"}}, "z").value();
  const std::filesystem::path folder = FreshFolder("hostile_archive");
  ASSERT_TRUE(WriteFile(folder / "notes.txt", "of no format"));
  for (const char* name : {"weights.pt", "tracks.zip", "clip.npz"}) ASSERT_TRUE(WriteFile(folder / name, archive));
  const std::vector<std::string> told = ToldBy(folder, std::nullopt);
  for (const char* name : {"weights.pt", "tracks.zip", "clip.npz"}) {
    EXPECT_THAT(told, Contains(AllOf(HasSubstr("unsafe_pickle: "), HasSubstr("'os system'"))));
    const Json inspection = InspectPath(folder / name, std::nullopt);
    EXPECT_EQ(inspection.at("findings").at(0).at("code"), "unsafe_pickle");
    EXPECT_EQ(inspection.at("findings").at(0).at("severity"), "error");
    EXPECT_THAT(inspection.at("findings").dump(), HasSubstr(std::string(name) + ":archive/data.pkl"));
  }
  EXPECT_EQ(
      std::count_if(told.begin(), told.end(), [](const std::string& t) { return t.rfind("unsafe_pickle", 0) == 0; }),
      3);
  const std::filesystem::path run = FreshFolder("hostile_run");
  ASSERT_TRUE(WriteFile(run / "P01G01R01F0001T0064A0101.npy", archive));
  EXPECT_THAT(RefusalOf(Declared("humanact12_npy", {"ingest.path=" + run.string()}), "hostile_archive"),
              AllOf(HasSubstr("A0101.npy:archive/data.pkl"), HasSubstr("'os system'")));
}

/// One member is left out, the motion is read.
TEST(ToldByBoth, AMemberBesideTheMotionThatWouldRunSomethingIsAWarning) {
  const std::filesystem::path folder = FreshFolder("hostile_member");
  StudioOptions studio;
  studio.layout = StudioLayout::kAmass;
  ASSERT_TRUE(WriteStudioLayout(studio, folder / "written", 1));
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "written/amass"))
    if (entry.path().extension() == ".npz") file = entry.path();
  const std::string bytes = *ReadFile(file);
  ZipArchive archive = *ZipArchive::Open(bytes, "a");
  std::vector<std::pair<std::string, std::string>> members = {{"extra.pkl", "cos\nsystem\n(S'true'\ntR."}};
  for (std::size_t i = 0; i < archive.members().size(); ++i)
    members.emplace_back(archive.members()[i], *archive.Read(i));
  ASSERT_TRUE(WriteFile(folder / "walk.npz", *WriteStoredZip(members, "z")));
  const Json inspection = InspectPath(folder / "walk.npz", std::nullopt);
  EXPECT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_THAT(inspection.at("findings").dump(), AllOf(HasSubstr("unsafe_pickle"), HasSubstr("walk.npz:extra.pkl")));
}

TEST(ToldByBoth, ADamagedTableOfExponentialMapsIsNamedAsSuchWithItsRow) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  std::filesystem::path sound;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(TestData() + "/cmu/expmap")) {
    if (entry.is_regular_file() && (sound.empty() || entry.path() < sound)) sound = entry.path();
  }
  const std::filesystem::path folder = FreshFolder("damaged_expmap");
  const std::string text = *ReadFile(sound);
  const std::vector<std::string_view> lines = SplitText(text, '\n');
  for (const std::string damage : {"a word", "cut", "large"}) {
    std::string damaged;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::string line(lines[i]);
      const std::size_t last = line.rfind(',');
      if (i == 7 && last != std::string::npos)
        line = line.substr(0, last) + (damage == "a word" ? ",abc" : damage == "large" ? ",5e5" : "");
      damaged += line + "\n";
    }
    ASSERT_TRUE(WriteFile(folder / "walking_1.txt", damaged));
    const Json inspection = InspectPath(folder, std::nullopt);
    ASSERT_EQ(inspection.at("clips").size(), 1u) << damage << inspection.at("findings").dump(1);
    EXPECT_EQ(inspection.at("clips")[0].at("format"), "expmap_table") << damage;
    EXPECT_FALSE(inspection.at("findings").empty()) << damage;
  }
}

}  // namespace
}  // namespace mocurate
