#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/store/builders.h"

namespace mocurate {
namespace {

TEST(StoreFaults, AMissingFileAnEmptyOneAndTextHaveDifferentErrors) {
  const ScratchFolder folder;
  EXPECT_EQ(ReadDataset(folder / "none.h5").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadDataset(folder.path()).error().code, ErrorCode::kUnreadable);
  test::PutBytes(folder / "empty.h5", "");
  EXPECT_EQ(ReadDataset(folder / "empty.h5").error().code, ErrorCode::kMalformed);
  EXPECT_NE(ReadDataset(folder / "empty.h5").error().what.find("is empty"), std::string::npos);
  test::PutBytes(folder / "text.h5", "HIERARCHY\nROOT Hips\n");
  EXPECT_EQ(ReadDataset(folder / "text.h5").error().code, ErrorCode::kMalformed);
  EXPECT_EQ(DescribeStore(folder / "text.h5").error().code, ErrorCode::kMalformed);
}

TEST(StoreFaults, AFileCutShortAnywhereIsMalformed) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "whole.h5"));
  const std::string bytes = ReadFile(folder / "whole.h5").value();
  for (std::size_t size = 1; size < bytes.size(); size += bytes.size() / 61) {
    test::PutBytes(folder / "cut.h5", bytes.substr(0, size));
    const auto read = ReadDataset(folder / "cut.h5");
    ASSERT_FALSE(read) << size << " of " << bytes.size();
    EXPECT_EQ(read.error().code, ErrorCode::kMalformed) << read.error().Message();
    EXPECT_NE(read.error().where.find("cut.h5"), std::string::npos);
  }
}

TEST(StoreFaults, AFolderThatDoesNotExistCannotBeWrittenTo) {
  const ScratchFolder folder;
  const Status written = WriteDataset(test::MakeDataset(), folder.path() / "none" / "set.h5");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kCannotWrite);
}

/// Runs `body` in a child process and returns its exit status.
template <class Body>
int InChild(const Body& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 255;
}

TEST(StoreFaults, AReadOnlyFolderStaysEmpty) {
  const ScratchFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const int code = InChild([&] {
    if (::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) return 3;
    const Status written = WriteDataset(test::MakeDataset(), folder / "set.h5");
    return written || written.error().code != ErrorCode::kCannotWrite ? 1 : 0;
  });
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(code, 0);
  EXPECT_EQ(folder.FileCount(), 0);
}

TEST(StoreFaults, AFullDiskLeavesNoFileAndTheProcessContinues) {
  const ScratchFolder folder;
  const int code = InChild([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{4096, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &full);
    for (int i = 0; i < 3; ++i) {
      const Status written = WriteDataset(test::MakeDataset(), folder / "set.h5");
      if (written || written.error().code != ErrorCode::kCannotWrite) return 1;
    }
    const rlimit free{RLIM_INFINITY, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &free);
    return folder.FileCount() == 0 && WriteDataset(test::MakeDataset(), folder / "after.h5") ? 0 : 2;
  });
  EXPECT_EQ(code, 0);
  EXPECT_EQ(folder.FileCount(), 1);
  EXPECT_TRUE(ReadDataset(folder / "after.h5"));
}

TEST(StoreFaults, AnExistingFileIsKeptWhenTheNewOneIsRefused) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "set.h5"));
  const std::string before = ReadFile(folder / "set.h5").value();
  Dataset bad = test::MakeDataset();
  bad.clips[1].motion->joints.at(3, 2).x() = NAN;
  const Status written = WriteDataset(bad, folder / "set.h5");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().where.find("set.h5:/frames/joints"), std::string::npos) << written.error().Message();
  EXPECT_TRUE(ReadFile(folder / "set.h5").value() == before);
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(StoreFaults, AViolatedRulePreventsWriting) {
  const ScratchFolder folder;
  const auto refused = [&](const std::function<void(Dataset&)>& change, const std::string& part) {
    Dataset dataset = test::MakeDataset();
    change(dataset);
    const Status written = WriteDataset(dataset, folder / "set.h5");
    ASSERT_FALSE(written) << part;
    EXPECT_EQ(written.error().code, ErrorCode::kInconsistent);
    EXPECT_NE(written.error().Message().find(part), std::string::npos) << written.error().Message();
    EXPECT_EQ(folder.FileCount(), 0);
  };
  refused([](Dataset& d) { std::swap(d.clips[0], d.clips[1]); }, "/clips/id");
  refused([](Dataset& d) { d.clips[1] = d.clips[0]; }, "/clips/id");
  refused([](Dataset& d) { d.splits[0].test = {0}; }, "/splits/by_person/test");
  refused([](Dataset& d) { d.splits[0].test = {3}; }, "/splits/by_person/test");
  refused([](Dataset& d) { d.splits[0].name = "a/b"; }, "not a name for a split");
  refused([](Dataset& d) { d.splits[1].name = d.splits[0].name; }, "two splits");
  refused([](Dataset& d) { d.clips[2].motion.reset(); }, "KARD/p2/a#5-10");
  refused([](Dataset& d) { d.clips[2].motion->bone_length.pop_back(); }, "bone_length");
  refused([](Dataset& d) { d.clips[2].motion->contact.pop_back(); }, "contact");
  refused([](Dataset& d) { d.clips[2].motion->rate = {30, 1}; }, "its motion's 30");
  refused([](Dataset& d) { d.clips[2].rate = d.clips[2].motion->rate = {0, 1}; }, "/clips/rate");
  refused([](Dataset& d) { d.clips[2].rate = d.clips[2].motion->rate = {1, 5000}; }, "/clips/rate");
  refused([](Dataset& d) { d.joints_only = true; }, "has rotations");
  refused([](Dataset& d) { d.clips[0].motion->rotation_at(1, 1).coeffs() *= 2; }, "/frames/rotation");
  refused([](Dataset& d) { d.clips[0].motion->joints.at(1, 4).x() += 0.01; }, "right_knee");
  refused([](Dataset& d) { d.findings[0].value = INFINITY; }, "/findings/value");
  refused([](Dataset& d) { d.findings[0].message = std::string("a\0b", 3); }, "/findings/message");
  refused([](Dataset& d) { d.labels.push_back("walk"); }, "/labels/name");
  refused([](Dataset& d) { d.skeleton.reset(); }, "no skeleton");
}

/// The content of a file as text, or the error.
std::string Outcome(const std::filesystem::path& path, const std::filesystem::path& again) {
  const auto read = ReadDataset(path);
  if (!read) return read.error().code == ErrorCode::kInternal ? "internal error" : "error";
  if (!WriteDataset(*read, again)) return "cannot be written again";
  return ReadFile(again).value();
}

TEST(StoreFaults, ChangedBytesGiveTheSameContentOrAnError) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "good.h5"));
  const std::string good = ReadFile(folder / "good.h5").value();
  Random random(3, "fuzz");
  int errors = 0;
  for (int i = 0; i < 600; ++i) {
    std::string changed = good;
    const std::uint64_t changes = 1 + random.Below(4);
    for (std::uint64_t k = 0; k < changes; ++k) {
      const std::size_t limit = i % 2 == 0 ? good.size() : good.size() / 3;  // metadata lie mostly in front
      changed[random.Below(limit)] = static_cast<char>(random.Below(256));
    }
    test::PutBytes(folder / "changed.h5", changed);
    const std::string outcome = Outcome(folder / "changed.h5", folder / "again.h5");
    ASSERT_TRUE(outcome == "error" || outcome == good) << "case " << i << ": " << outcome.substr(0, 40);
    errors += outcome == "error" ? 1 : 0;
  }
  EXPECT_GT(errors, 400);
}

}  // namespace
}  // namespace mocurate
