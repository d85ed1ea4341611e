#include "core/base/file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

std::size_t EntriesOf(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Runs `check` in a child process; true when it returns true there.
template <class Check>
bool InChild(const Check& check) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(check() ? 0 : 1);
  int state = 0;
  ::waitpid(child, &state, 0);
  return WIFEXITED(state) && WEXITSTATUS(state) == 0;
}

TEST(File, WhatIsWrittenIsReadBackAndNothingElseIsLeft) {
  const ScratchFolder folder;
  const std::string bytes("a\0b\n", 4);
  ASSERT_TRUE(WriteFile(folder / "x.bin", "old and longer than the new text"));
  ASSERT_TRUE(WriteFile(folder / "x.bin", bytes));
  EXPECT_EQ(ReadFile(folder / "x.bin").value(), bytes);
  EXPECT_EQ(EntriesOf(folder.path()), 1u);
}

TEST(File, NamesWithBlanksAndForeignBytesWork) {
  const ScratchFolder folder;
  const std::string name = "a b \xff\xc3\xa9.txt";
  ASSERT_TRUE(WriteFile(folder / name, "x"));
  EXPECT_EQ(ReadFile(folder / name).value(), "x");
  EXPECT_EQ(DisplayPath(name), "a b \\xff\xc3\xa9.txt");
}

TEST(File, EveryPathSurvivesItsText) {
  for (const std::string name : {"plain", "a\\b", "a\\xff", "\\x5cx", "\xff\xfe", "line\nbreak", "\xed\xa0\x80",
                                 "\xc0\xaf", "\xf4\x90\x80\x80", "\xe2\x82", "\xf0\x9f\x99\x82"}) {
    EXPECT_EQ(PathFromText(DisplayPath(name)).native(), name) << DisplayPath(name);
    EXPECT_FALSE(FirstNotUtf8(DisplayPath(name))) << DisplayPath(name);
  }
}

TEST(File, AMissingFileAndAFolderAreDistinguished) {
  const ScratchFolder folder;
  const Error missing = ReadFile(folder / "none").error();
  EXPECT_EQ(missing.code, ErrorCode::kNotFound);
  EXPECT_EQ(missing.Message(), (folder / "none").native() + ": no such file");
  const Error is_folder = ReadFile(folder.path()).error();
  EXPECT_EQ(is_folder.code, ErrorCode::kUnreadable);
  EXPECT_EQ(is_folder.what, "is a folder, a file is expected");
  EXPECT_EQ(WriteFile(folder.path(), "x").error().what, "cannot be written: Is a directory");
}

TEST(File, AFullDiskIsNamed) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const Error error = WriteFile("/dev/full", "x").error();
  EXPECT_EQ(error.code, ErrorCode::kCannotWrite);
  EXPECT_EQ(error.Message(),
            "/dev/full: cannot be written: No space left on device, the disk is full (free space there, or write to "
            "another folder)");
  EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device is written, not replaced";
}

TEST(File, AWriteThatFailsHalfwayLeavesTheOldFileAndNoTrace) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "x", "old"));
  EXPECT_TRUE(InChild([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const Status written = WriteFile(folder / "x", std::string(100000, 'n'));
    return !written && written.error().code == ErrorCode::kCannotWrite &&
           written.error().what == "cannot be written: File too large";
  }));
  EXPECT_EQ(ReadFile(folder / "x").value(), "old");
  EXPECT_EQ(EntriesOf(folder.path()), 1u);
}

TEST(File, AReadOnlyFolderIsRefusedInWords) {
  const ScratchFolder folder;
  fs::permissions(folder.path(),
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  EXPECT_TRUE(InChild([&] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) return false;  // the administrator may write everywhere
    bool called = false;
    const Status with = WriteFileWith(folder / "x", [&](const fs::path&) -> Status {
      called = true;
      return {};
    });
    const Status written = WriteFile(folder / "x", "x");
    return !written && !with && !called && written.error() == with.error() &&
           written.error().what == "cannot be written: Permission denied" &&
           written.error().hint == "write to a folder that you may change";
  }));
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(File, AMissingFolderIsReportedByTheHint) {
  const ScratchFolder folder;
  EXPECT_EQ(WriteFile(folder / "none/x", "x").error().hint, "its folder does not exist");
}

TEST(File, AWriterWithAPathGetsTheExtensionAndItsErrorIsPassedOn) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFileWith(folder / "x.png", [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".png");
    EXPECT_EQ(temporary.parent_path(), folder.path());
    EXPECT_FALSE(fs::exists(folder / "x.png"));
    return WriteFile(temporary, "bytes");
  }));
  EXPECT_EQ(ReadFile(folder / "x.png").value(), "bytes");
  const Status failed =
      WriteFileWith(folder / "y", [](const fs::path&) -> Status { return Fail(ErrorCode::kInternal, "no"); });
  EXPECT_EQ(failed.error().what, "no");
  EXPECT_EQ(EntriesOf(folder.path()), 1u);
}

TEST(File, NoNameOfATemporaryFileFollowsFromAnother) {
  const ScratchFolder folder;
  std::string names[2];
  for (std::string& name : names) {
    ASSERT_TRUE(WriteFileWith(folder / "x", [&](const fs::path& temporary) -> Status {
      name = temporary.filename().native();
      return {};
    }));
  }
  const auto alike = std::mismatch(names[0].begin(), names[0].end(), names[1].begin(), names[1].end()).first;
  EXPECT_LT(alike - names[0].begin(), 12) << names[0] << " " << names[1];
}

TEST(File, PermissionsFollowTheUmask) {
  const ScratchFolder folder;
  for (const auto& [mask, mode] : {std::pair<::mode_t, ::mode_t>(077, 0600), {002, 0664}}) {
    EXPECT_TRUE(InChild([&, masked = mask, expected = mode] {
      ::umask(masked);
      struct ::stat whole = {}, pending = {};
      Expected<PendingFile> file = PendingFile::Create(folder / "pending");
      return WriteFile(folder / "whole", "x") && file && file->PublishUnsynced() &&
             ::stat((folder / "whole").c_str(), &whole) == 0 && ::stat((folder / "pending").c_str(), &pending) == 0 &&
             (whole.st_mode & 0777u) == expected && (pending.st_mode & 0777u) == expected;
    }));
  }
}

TEST(File, APendingFileReplacesALinkAndIsRemovedUnlessPublished) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "target", "old"));
  fs::create_symlink("target", folder / "link");
  {
    Expected<PendingFile> file = PendingFile::Create(folder / "link");
    ASSERT_TRUE(file && file->Write("new"));
  }
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(EntriesOf(folder.path()), 2u);
  Expected<PendingFile> file = PendingFile::Create(folder / "link");
  ASSERT_TRUE(file && file->Write("new") && file->Publish());
  EXPECT_FALSE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(ReadFile(folder / "link").value(), "new");
  EXPECT_EQ(ReadFile(folder / "target").value(), "old");
  EXPECT_EQ(EntriesOf(folder.path()), 2u);
}

TEST(File, ALinkIsFollowed) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "target", "old"));
  fs::create_symlink("target", folder / "link");
  ASSERT_TRUE(WriteFile(folder / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(ReadFile(folder / "target").value(), "new");
}

TEST(File, FoldersAreMadeWithTheirParents) {
  const ScratchFolder folder;
  EXPECT_TRUE(MakeFolder(folder / "a/b/c"));
  EXPECT_TRUE(MakeFolder(folder / "a/b/c"));
  ASSERT_TRUE(WriteFile(folder / "file", "x"));
  EXPECT_EQ(MakeFolder(folder / "file/below").error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(MakeFolder(folder / "file").error().code, ErrorCode::kCannotWrite);
}

}  // namespace
}  // namespace mocurate
