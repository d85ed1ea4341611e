#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/store/dataset_clips.h"
#include "core/store/dataset_writer.h"
#include "tests/store/builders.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

struct Answer {
  int status = -1;
  std::string text;
};

Answer Python(const std::string& arguments) {
  Answer answer;
  std::FILE* pipe = ::popen(("/usr/bin/python3 " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return answer;
  char block[4096];
  for (std::size_t n = 0; (n = std::fread(block, 1, sizeof(block), pipe)) > 0;) answer.text.append(block, n);
  answer.status = ::pclose(pipe);
  return answer;
}

std::string Quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

const std::filesystem::path kScripts = std::filesystem::path(kSourceFolder) / "tests/store";
const std::filesystem::path kFormatDocument = std::filesystem::path(kSourceFolder) / "docs" / "store_format.md";

/// Debian's python3-h5py, without any of our code. May be missing on a minimal machine, but not where the full suite
/// runs.
class StoreWithH5py : public ::testing::Test {
 protected:
  void SetUp() override {
    if (Python("-c 'import h5py'").status == 0) return;
    if (std::getenv("MOCURATE_DATA") != nullptr) FAIL() << "python3-h5py is not installed";
    GTEST_SKIP() << "python3-h5py is not installed";
  }
};

TEST_F(StoreWithH5py, H5pyReadsADataset) {
  const ScratchFolder folder;
  const Dataset dataset = test::MakeDataset();
  ASSERT_TRUE(WriteDataset(dataset, folder / "set.h5"));
  const Answer answer =
      Python(Quoted(kScripts / "read_store.py") + " " + Quoted(folder / "set.h5") + " " + Quoted(kFormatDocument));
  ASSERT_EQ(answer.status, 0) << answer.text;
  const auto seen = nlohmann::json::parse(answer.text, nullptr, false);
  ASSERT_TRUE(seen.is_object()) << answer.text.substr(0, 300);
  EXPECT_EQ(seen["/@schema"], "mocurate/1");
  EXPECT_EQ(seen["/@kinematics"], "tree");
  EXPECT_EQ(seen["/@rate"], "120000/1001");
  EXPECT_EQ(seen["/@content_sha256"], seen["computed_sha256"]) << "the documented recipe gives another hash";
  EXPECT_EQ(seen["/skeleton/names"][3], "left_knee");
  EXPECT_EQ(seen["/skeleton/parents"], (std::vector<int>{-1, 0, 0, 1, 2, 0}));
  EXPECT_EQ(seen["/clips/id"][1], "KARD/p1/b#5-14");
  EXPECT_EQ(seen["/clips/offset"], (std::vector<int>{0, 7, 16}));
  EXPECT_EQ(seen["/clips/class"], (std::vector<int>{2, 1, 2}));
  EXPECT_EQ(nlohmann::json::parse(seen["/clips/provenance"][0].get<std::string>())["file"], "Grüße \"1\".txt");
  EXPECT_EQ(seen["/splits/fold 2/test"], (std::vector<int>{0}));
  EXPECT_EQ(seen["/findings/value"], (std::vector<double>{0.25, 1.0, 120.0}));
  const Motion& motion = *dataset.clips[1].motion;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const auto& q = seen["/frames/rotation"][7 + 4][j];
    const Quaterniond& expected = motion.rotation_at(4, j);
    EXPECT_NEAR(q[0].get<double>(), expected.w(), 1e-6);
    EXPECT_NEAR(q[1].get<double>(), expected.x(), 1e-6);
    EXPECT_NEAR(q[2].get<double>(), expected.y(), 1e-6);
    EXPECT_NEAR(q[3].get<double>(), expected.z(), 1e-6);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(seen["/frames/joints"][7 + 4][j][k].get<double>(),
                static_cast<double>(static_cast<float>(motion.joints.at(4, j)[k])));
    }
    EXPECT_EQ(seen["/clips/bone_length"][1][j].get<double>(), motion.bone_length[static_cast<std::size_t>(j)]);
  }
}

TEST_F(StoreWithH5py, ASetWrittenWithH5pyIsRead) {
  const ScratchFolder folder;
  for (const char* storage : {"", " gzip"}) {
    const Answer answer = Python(Quoted(kScripts / "write_store.py") + " " + Quoted(folder / "made.h5") + " " +
                                 Quoted(kFormatDocument) + storage);
    ASSERT_EQ(answer.status, 0) << answer.text;
    const auto read = ReadDataset(folder / "made.h5");
    ASSERT_TRUE(read) << read.error().Message();
    ASSERT_EQ(read->clips.size(), 2u);
    EXPECT_TRUE(read->joints_only);
    EXPECT_EQ(read->clips[1].label, "grüßen");
    EXPECT_EQ(read->clips[1].provenance.at("by"), "h5py");
    EXPECT_NEAR(read->clips[1].motion->joints.at(0, 2).z(), 3.5, 1e-6);
    EXPECT_EQ(read->skeleton->joints[2].name, "top");
    const Status again = WriteDataset(*read, folder / "again.h5");
    EXPECT_TRUE(again) << again.error().Message();
  }
}

TEST_F(StoreWithH5py, FieldsBeyondTheTableAreReadAndWrittenAsTheyAre) {
  const ScratchFolder folder;
  const std::filesystem::path given = folder / "given.h5", copy = folder / "copy.h5";
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), given));
  const Answer made = Python(Quoted(kScripts / "write_other_fields.py") + " " + Quoted(given));
  ASSERT_EQ(made.status, 0) << made.text;
  EXPECT_TRUE(ReadDataset(given)) << "content_sha256 is of the table alone";
  const auto clips = DatasetClips::Open(given, DatasetClips::Check::kHashes);
  ASSERT_TRUE(clips) << clips.error().Message();
  const OtherFields others = clips->ReadOtherFields();
  const auto paths = [](const auto& fields) {
    std::vector<std::string> listed;
    for (const auto& [path, field] : fields) listed.push_back(path);
    return listed;
  };
  EXPECT_EQ(paths(others.of_clips),
            (std::vector<std::string>{"/clips/big_endian", "/clips/checked", "/clips/complex", "/clips/fixed",
                                      "/clips/none", "/clips/small", "/clips/text"}));
  EXPECT_EQ(paths(others.of_frames), (std::vector<std::string>{"/frames/half", "/frames/phase", "/frames/table"}));
  EXPECT_EQ(paths(others.of_set), (std::vector<std::string>{"/@doi", "/clips/small/@range", "/clips/small/@unit",
                                                            "/clips/two_rows_more", "/mine/deep/one", "/mine/text"}));
  EXPECT_EQ(paths(others.unreadable),
            (std::vector<std::string>{"/clips/link", "/clips/lists", "/frames/joints/@mine"}));

  ExtraFields all = others.of_clips;
  all.insert(others.of_frames.begin(), others.of_frames.end());
  all.insert(others.of_set.begin(), others.of_set.end());
  const auto outline = clips->Outline();
  ASSERT_TRUE(outline);
  for (int i = 0; i < 2; ++i) {
    auto writer = DatasetWriter::Create(
        *outline, {clips->OptionalFields(0), clips->OptionalFields(1), clips->OptionalFields(2)}, copy, all);
    ASSERT_TRUE(writer) << writer.error().Message();
    for (std::size_t row = 0; row < clips->size(); ++row) {
      ExtraFields frames;
      for (const auto& [path, field] : others.of_frames) {
        const int count = outline->clips[row].motion->frame_count();
        auto rows = clips->ReadOtherFrames(path, row, 0, count);
        ASSERT_TRUE(rows) << rows.error().Message();
        frames[path] = *rows;
      }
      const Status written = writer->Append(*clips->Read(row), frames);
      ASSERT_TRUE(written) << written.error().Message();
    }
    const Status finished = writer->Finish();
    ASSERT_TRUE(finished) << finished.error().Message();
    if (i == 0) std::filesystem::rename(copy, folder / "first.h5");
  }
  EXPECT_EQ(*ReadFile(copy), *ReadFile(folder / "first.h5")) << "same content, same bytes";
  std::string kept;
  for (const auto& [path, field] : all) kept += path.find('@') == std::string::npos ? " " + path : "";
  const Answer compared =
      Python(Quoted(kScripts / "compare_other_fields.py") + " " + Quoted(given) + " " + Quoted(copy) + kept);
  EXPECT_EQ(compared.status, 0) << compared.text;
  EXPECT_EQ(compared.text, "");
  EXPECT_TRUE(ReadDataset(copy));
}

}  // namespace
}  // namespace mocurate
