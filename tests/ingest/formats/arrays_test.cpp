// Array files with several clips, and selection of clips by name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "core/formats/npz.h"
#include "ingest/chosen_clips.h"
#include "ingest/sources/array_clips.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
/// An array of increasing numbers from `first`, in metres within the range of a person.
NpyArray Counting(std::vector<std::size_t> shape, double first = 0.0) {
  NpyArray array;
  array.dtype = "<f8";
  std::size_t count = 1;
  for (const std::size_t extent : shape) count *= extent;
  array.shape = std::move(shape);
  for (std::size_t i = 0; i < count; ++i) array.values.push_back(1e-4 * static_cast<double>(i) + first);
  return array;
}

class ArrayClips : public ::testing::Test {
 protected:
  void SetUp() override { folder = FreshFolder("array_clips"); }
  void TearDown() override { fs::remove_all(folder); }

  IngestOptions Source(const fs::path& path) {
    IngestOptions options = Declared("humanact12_npy");
    options.path = path;
    options.source.files = "{clip}.np{kind}";
    options.source.person = "p";
    options.source.recording = "{clip}";
    options.source.label = "";
    options.source.labels.clear();
    options.source.fine_label.clear();
    options.source.session.clear();
    options.source.frames_in_name.clear();
    options.source.roles.clear();
    options.source.exclude.clear();
    options.source.known_issue_lists.clear();
    options.source.checks.actions["not_joint_positions"] = OnFinding::kReport;  // increasing numbers form no body
    return options;
  }
  static std::vector<std::string> Items(const Discovery& discovery) {
    std::vector<std::string> items;
    for (const ItemSpec& item : discovery.items) items.push_back(item.item.substr(item.item.rfind('/') + 1));
    return items;
  }

  fs::path folder;
};

TEST_F(ArrayClips, ReadAStackAsOneClipPerEntry) {
  Put(folder / "stack.npy", WriteNpy(Counting({3, 10, 24, 3})));
  const auto discovery = Discover(Source(folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_THAT(Items(*discovery), ElementsAre("stack.0000", "stack.0001", "stack.0002"));
  const Ingested second = RunIngest(discovery->items[1], "stack");
  ASSERT_TRUE(second.outcome) << second.outcome.error().Message();
  EXPECT_EQ(second.clip.identity.recording, "stack.0001");
  ASSERT_EQ(second.clip.motion->frame_count(), 10);
  const Vector3d first = second.clip.motion->joints.at(0, 0);
  EXPECT_NEAR(first.cwiseAbs().maxCoeff(), 1e-4 * 722, 1e-6) << "the second entry starts at value 720";
  const Ingested third = RunIngest(discovery->items[2], "stack");
  EXPECT_NE(third.clip.evidence_sha256, second.clip.evidence_sha256);
}

TEST_F(ArrayClips, ReadAnArchiveAsOneClipPerJointArray) {
  Npz archive;
  archive.members.push_back({"walk", Counting({12, 24, 3}), ""});
  archive.members.push_back({"runs", Counting({2, 7, 72}), ""});
  archive.members.push_back({"kinect", Counting({12, 25, 3}), ""});
  archive.members.push_back({"times", Counting({12}), ""});
  Put(folder / "clips.npz", *EncodeNpz(archive, "clips.npz"));
  const auto discovery = Discover(Source(folder / "clips.npz"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_THAT(Items(*discovery), ElementsAre("clips.runs.0000", "clips.runs.0001", "clips.walk"));
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.error.where, "clips.npz[kinect]");
  EXPECT_EQ(discovery->excluded[0].outcome.findings.at(0).code, "other_joints");
  const Ingested run = RunIngest(discovery->items[1], "archive");
  ASSERT_TRUE(run.outcome) << run.outcome.error().Message();
  EXPECT_EQ(run.clip.motion->frame_count(), 7);
}

TEST_F(ArrayClips, RefuseAFileShorterThanItsHeaderDeclares) {
  std::string bytes = WriteNpy(Counting({1, 60, 24, 3}));
  const std::string shape = "(1, 60, 24, 3)", announced = "(1000000000000, 60, 24, 3)";
  const std::size_t at = bytes.find(shape);
  ASSERT_NE(at, std::string::npos);
  const std::size_t padding = bytes.find(", }", at) + 3;
  bytes.erase(padding, announced.size() - shape.size());
  bytes.replace(at, shape.size(), announced);
  ASSERT_TRUE(ParseNpyHeader(bytes, "long.npy"));
  Put(folder / "long.npy", bytes);
  EXPECT_TRUE(ArrayClipsOf(folder / "long.npy", "long.npy").empty());
  const auto discovery = Discover(Source(folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  ExpectError(RunIngest(discovery->items[0], "long").outcome, ErrorCode::kInconsistent, "long.npy");
  EXPECT_FALSE(ShapeOfJoints({2, SIZE_MAX / 3 + 1, 3}));
}

TEST_F(ArrayClips, RefuseADamagedArchiveAsOneItem) {
  Npz archive;
  archive.members.push_back({"walk", Counting({12, 24, 3}), ""});
  const std::string whole = *EncodeNpz(archive, "clips.npz");
  const std::string cut = whole.substr(0, whole.size() / 2);
  Put(folder / "clips.npz", cut);
  const auto discovery = Discover(Source(folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  ExpectMalformed(RunIngest(discovery->items[0], "cut").outcome, "clips.npz");
  Npz times;
  times.members.push_back({"times", Counting({12}), ""});
  ExpectError(ReadArrayClip(*EncodeNpz(times, "times.npz"), "", "times.npz"), ErrorCode::kInconsistent, "times.npz");
}

TEST_F(ArrayClips, KeepIdsValidForAnyMemberName) {
  EXPECT_EQ(RecordingSuffix("[walk][3]"), ".walk.0003");
  EXPECT_EQ(RecordingSuffix("[3]"), ".0003");
  EXPECT_EQ(RecordingSuffix("[a/b#1]"), ".a.b.1");
  EXPECT_EQ(RecordingSuffix("[a]b[c]][12]"), ".a]b[c].0012");
  EXPECT_EQ(RecordingSuffix(""), "");
  Npz archive;
  archive.members.push_back({"a]b", Counting({2, 12, 24, 3}), ""});
  const std::string bytes = *EncodeNpz(archive, "clips.npz");
  const auto second = ReadArrayClip(bytes, "[a]b][1]", "clips.npz");
  ASSERT_TRUE(second) << second.error().Message();
  EXPECT_THAT(second->array.shape, ElementsAre(12u, 24u, 3u));
}

TEST_F(ArrayClips, AreSelectedByIndexNameOrFile) {
  Put(folder / "a.npy", WriteNpy(Counting({2, 10, 24, 3})));
  Put(folder / "b.npy", WriteNpy(Counting({10, 24, 3})));
  const IngestOptions options = Source(folder);
  for (const auto& [wanted, count] : {std::pair<std::string, std::size_t>{"[1]", 1},
                                      {"1", 1},
                                      {"a.npy[0]", 1},
                                      {"a.0001", 1},
                                      {"a", 2},
                                      {"b.npy", 1},
                                      {"humanact12/p/b", 1}}) {
    auto discovery = Discover(options);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    const Status taken = TakeOnly({wanted}, *discovery);
    ASSERT_TRUE(taken) << taken.error().Message();
    EXPECT_EQ(discovery->items.size(), count) << wanted;
  }
  auto discovery = Discover(options);
  ASSERT_TRUE(discovery);
  ExpectError(TakeOnly({"c"}, *discovery), ErrorCode::kUsage, "--clip");
}

TEST(ArrayEntries, AreEqualInBothOrdersAndEndWithTheArray) {
  const std::string c = WriteNpy(Counting({3, 2, 4}));
  const auto entry = ParseNpyEntry(c, 2, "c.npy");
  ASSERT_TRUE(entry) << entry.error().Message();
  EXPECT_THAT(entry->shape, ElementsAre(2u, 4u));
  EXPECT_NEAR(entry->values.front(), 1e-4 * 16, 1e-12);
  EXPECT_EQ(entry->values.size(), 8u);
  std::string fortran = c;
  fortran.replace(fortran.find("False"), 5, "True ");
  const auto whole = ParseNpy(fortran, "f.npy");
  const auto last = ParseNpyEntry(fortran, 2, "f.npy");
  ASSERT_TRUE(whole && last);
  EXPECT_EQ(last->values, (std::vector<double>(whole->values.begin() + 16, whole->values.end())));
  ExpectError(ParseNpyEntry(c, 3, "c.npy"), ErrorCode::kInconsistent, "c.npy");
  EXPECT_FALSE(ParseNpyEntry(c.substr(0, c.size() - 8), 0, "c.npy"));
  EXPECT_FALSE(ShapeOfJoints({5, 2, 3}));
  EXPECT_FALSE(ShapeOfJoints({170, 263}));
}

TEST(FoldersOfAClip, AreNotReportedAsOtherFiles) {
  const fs::path folder = FreshFolder("parts");
  Put(folder / "pose/subject01_group1_time1/pose.txt", "0\n");
  Put(folder / "depth/view1/subject01_group1_time1/depth_0.png", "x");
  Put(folder / "depth/view1/subject02_group1_time1/depth_0.png", "x");
  const auto discovery =
      Discover(Declared("phspd", {"ingest.path=" + folder.string(), "ingest.source.other_files=finding"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->excluded.size(), 1u) << "only the folder without a clip";
  EXPECT_EQ(discovery->excluded[0].item, "depth/view1/subject02_group1_time1");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace mocurate
