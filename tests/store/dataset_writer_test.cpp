// A dataset written clip by clip has the same bytes as with WriteDataset, and as in earlier versions.

#include "core/store/dataset_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/sha256.h"
#include "core/store/dataset_clips.h"
#include "tests/store/fixed_dataset.h"

namespace mocurate {
namespace {

using test::FixedDataset;
using ::testing::HasSubstr;

constexpr int kLargeClips = 40, kLargeFrames = 400;  // 7.7 MB

std::string HashOf(const std::filesystem::path& path) { return Sha256OfFile(path).value_or(""); }

/// The dataset of a file, read and written clip by clip.
Status CopyByClips(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto clips = DatasetClips::Open(from, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  std::vector<std::uint8_t> optional_fields;
  for (std::size_t row = 0; row < clips->size(); ++row) optional_fields.push_back(clips->OptionalFields(row));
  auto writer = DatasetWriter::Create(*outline, optional_fields, to);
  if (!writer) return Forward(writer);
  for (std::size_t row = 0; row < clips->size(); ++row) {
    const auto clip = clips->Read(row);
    if (!clip) return Forward(clip);
    if (Status written = writer->Append(*clip); !written) return written;
  }
  return writer->Finish();
}

// Hashes of files written by WriteDataset.
TEST(DatasetWriter, WritesTheSameBytesAsEarlierVersions) {
  const ScratchFolder folder;
  const struct {
    Dataset dataset;
    const char* sha256;
  } sets[] = {
      {FixedDataset(1, 1), "8ac6772e6fa241b5831d75d17b52c66bf8c18484f4001eed8371a6bd0a16fe11"},
      {FixedDataset(12, 9), "d4b978200e0d93c737cda4d6899af1bfa20b7011927bca2a42079011c2ecd847"},
      {FixedDataset(12, 9, true), "e16813ef3b903c1353cc7b382e471eb2b5ecbfd4e03d2a00b1d5e8e235c0ed22"},
      {FixedDataset(kLargeClips, kLargeFrames), "8a7db7acd4949a9c335a7563938ab5964ffd0628c5426d73e97d5c7796bcd609"}};
  for (const auto& [dataset, sha256] : sets) {
    const Status written = WriteDataset(dataset, folder / "whole.h5");
    ASSERT_TRUE(written) << written.error().Message();
    EXPECT_EQ(HashOf(folder / "whole.h5"), sha256) << dataset.clips.size() << " clips";
    const Status copied = CopyByClips(folder / "whole.h5", folder / "clips.h5");
    ASSERT_TRUE(copied) << copied.error().Message();
    EXPECT_EQ(HashOf(folder / "clips.h5"), sha256) << dataset.clips.size() << " clips";
    EXPECT_EQ(folder.FileCount(), 2);
  }
}

TEST(DatasetWriter, ReadsTheOutlineOfADataset) {
  const ScratchFolder folder;
  const Dataset whole = test::MakeDataset();
  ASSERT_TRUE(WriteDataset(whole, folder / "set.h5"));
  const auto clips = DatasetClips::Open(folder / "set.h5", DatasetClips::Check::kNone);
  const auto outline = clips->Outline();
  ASSERT_TRUE(outline) << outline.error().Message();
  EXPECT_EQ(outline->labels, whole.labels);
  EXPECT_EQ(outline->fine_labels.size(), whole.fine_labels.size());
  EXPECT_EQ(outline->findings, whole.findings);
  EXPECT_EQ(outline->splits.size(), whole.splits.size());
  EXPECT_EQ(outline->recipe, whole.recipe);
  for (std::size_t row = 0; row < whole.clips.size(); ++row) {
    const Motion& motion = *outline->clips[row].motion;
    EXPECT_EQ(outline->clips[row].id(), whole.clips[row].id());
    EXPECT_EQ(motion.frame_count(), whole.clips[row].motion->frame_count());
    EXPECT_EQ(motion.bone_length, whole.clips[row].motion->bone_length);
    EXPECT_TRUE(SameRestOffsets(*motion.skeleton, *whole.clips[row].motion->skeleton));
    EXPECT_TRUE(motion.joints.empty());
  }
}

TEST(DatasetWriter, EqualMotionsHaveEqualHashesInEveryFile) {
  const ScratchFolder folder;
  Dataset dataset = test::MakeDataset();
  ASSERT_TRUE(WriteDataset(dataset, folder / "a.h5"));
  dataset.clips.erase(dataset.clips.begin());
  dataset.splits.clear();
  dataset.clips[0].label = "walk";
  dataset.clips[1].motion->rotation_sigma[3] += 0.01f;
  ASSERT_TRUE(WriteDataset(dataset, folder / "b.h5"));
  const auto a = DatasetClips::Open(folder / "a.h5", DatasetClips::Check::kNone);
  const auto b = DatasetClips::Open(folder / "b.h5", DatasetClips::Check::kNone);
  EXPECT_EQ(*a->MotionSha256(1), *b->MotionSha256(0)) << "another label, another place";
  EXPECT_NE(*a->MotionSha256(2), *b->MotionSha256(1)) << "one sigma differs";
}

TEST(DatasetWriter, RefusesAMotionThatIsNotInTheOutlineAndLeavesNoFile) {
  const ScratchFolder folder;
  for (const Dataset& dataset : {FixedDataset(3, 5), FixedDataset(kLargeClips, kLargeFrames)}) {
    std::vector<std::uint8_t> optional_fields;
    for (const Clip& clip : dataset.clips) optional_fields.push_back(OptionalFieldsOf(*clip.motion));
    const auto refusal = [&](std::size_t good, const std::function<void(Clip&)>& change) {
      auto writer = DatasetWriter::Create(dataset, optional_fields, folder / "set.h5");
      EXPECT_TRUE(writer) << writer.error().Message();
      for (std::size_t row = 0; row < good; ++row) EXPECT_TRUE(writer->Append(dataset.clips[row]));
      if (change == nullptr) return writer->Finish();
      Clip clip = dataset.clips[good];
      change(clip);
      return writer->Append(clip);
    };
    const std::string second = dataset.clips[1].id();
    const std::pair<std::size_t, std::function<void(Clip&)>> wrong[] = {
        {1, nullptr},
        {1, [](Clip& clip) { clip.identity.person = "else"; }},
        {1, [](Clip& clip) { clip.motion->contact.clear(); }},
        {1, [](Clip& clip) { clip.motion->joints.frames -= 1; }},
        {1, [](Clip& clip) { clip.motion->joints.at(2, 4).x() += 0.01; }},
        {1, [](Clip& clip) { clip.motion->rotation_at(1, 1).coeffs() *= 2; }},
        {1, [](Clip& clip) { clip.motion.reset(); }}};
    for (const auto& [good, change] : wrong) {
      const Status refused = refusal(good, change);
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent) << refused.error().Message();
      EXPECT_EQ(folder.FileCount(), 0) << refused.error().Message();
    }
    EXPECT_THAT(refusal(1, wrong[4].second).error().Message(), HasSubstr(second));
  }
}

TEST(DatasetWriter, ALargeFileFailsOnAFullDiskAndCanBeWrittenElsewhere) {
  const ScratchFolder folder;
  const Dataset large = FixedDataset(kLargeClips, kLargeFrames);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{5u << 20, RLIM_INFINITY}, free{RLIM_INFINITY, RLIM_INFINITY};
    for (int i = 0; i < 3; ++i) {
      ::setrlimit(RLIMIT_FSIZE, &full);
      const Status written = WriteDataset(large, folder / "set.h5");
      if (written || written.error().code != ErrorCode::kCannotWrite || folder.FileCount() != 0) ::_exit(1);
      ::setrlimit(RLIMIT_FSIZE, &free);
    }
    const Status nowhere = WriteDataset(large, folder.path() / "none" / "set.h5");
    if (nowhere || nowhere.error().code != ErrorCode::kCannotWrite) ::_exit(2);
    ::_exit(WriteDataset(large, folder / "after.h5") ? 0 : 3);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0);
  EXPECT_EQ(folder.FileCount(), 1);
  EXPECT_TRUE(ReadDataset(folder / "after.h5"));
}

TEST(DatasetWriter, FollowsALinkAndKeepsFilePermissions) {
  const ScratchFolder folder;
  const Dataset large = FixedDataset(kLargeClips, kLargeFrames);
  test::PutBytes(folder / "old.h5", "old");
  std::filesystem::create_symlink("old.h5", folder / "link.h5");
  ASSERT_TRUE(WriteDataset(large, folder / "link.h5"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.h5"));
  EXPECT_TRUE(ReadDataset(folder / "old.h5"));
  ASSERT_TRUE(WriteFile(folder / "small", "small"));
  struct ::stat small = {}, written = {};
  ::stat((folder / "small").c_str(), &small);
  ::stat((folder / "old.h5").c_str(), &written);
  EXPECT_EQ(written.st_mode, small.st_mode);
}

}  // namespace
}  // namespace mocurate
