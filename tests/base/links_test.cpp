#include "core/base/links.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr ::uid_t kNobody = 65534;

TEST(Links, OfAnotherUserInASharedFolderAreNotFollowed) {
  const ScratchFolder folder;
  const fs::path shared = folder / "shared", victim = folder / "victim", link = shared / "link.h5";
  ASSERT_TRUE(MakeFolder(shared) && WriteFile(victim, "old"));
  ASSERT_EQ(::chmod(shared.c_str(), 01777), 0);
  fs::create_symlink("../victim", link);
  ASSERT_TRUE(WriteFile(link, "own link"));
  EXPECT_EQ(ReadFile(victim).value(), "own link");
  if (::geteuid() != 0 || ::lchown(link.c_str(), kNobody, kNobody) != 0) GTEST_SKIP() << "needs the administrator";
  fs::create_symlink("shared/link.h5", folder / "chain");
  for (const fs::path& path : {link, folder / "chain"}) {
    bool called = false;
    const Status written = WriteFile(path, "x");
    const Status with = WriteFileWith(path, [&](const fs::path&) -> Status {
      called = true;
      return {};
    });
    ASSERT_FALSE(written || with || called);
    EXPECT_EQ(written.error().code, ErrorCode::kCannotWrite);
    EXPECT_EQ(written.error().where, link.native()) << "the link at fault, not the path that leads there";
  }
  EXPECT_EQ(ReadFile(victim).value(), "own link");
  ASSERT_EQ(::chmod(shared.c_str(), 0755), 0);
  EXPECT_TRUE(WriteFile(link, "a folder of ours")) << "nobody else puts links there";
  EXPECT_EQ(ReadFile(victim).value(), "a folder of ours");
}

TEST(Links, APipeOfAnotherUserInASharedFolderIsNotWritten) {
  const ScratchFolder folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0666), 0);
  if (::geteuid() != 0 || ::lchown((folder / "pipe").c_str(), kNobody, kNobody) != 0)
    GTEST_SKIP() << "needs the administrator";
  EXPECT_EQ(WriteFile(folder / "pipe", "x").error().code, ErrorCode::kCannotWrite);
}

TEST(Links, ALoopIsRefusedAndALinkToNothingMakesItsTarget) {
  const ScratchFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_EQ(WriteFile(folder / "a", "x").error().code, ErrorCode::kCannotWrite);
  fs::create_symlink("none", folder / "first");
  ASSERT_TRUE(WriteFile(folder / "first", "x"));
  EXPECT_EQ(ReadFile(folder / "none").value(), "x");
}

TEST(Links, AreFollowedInTheFolderThatTheUserNamesAndNotBelowIt) {
  const ScratchFolder folder;
  ASSERT_TRUE(MakeFolder(folder / "disk") && MakeFolder(folder / "outside"));
  fs::create_directory_symlink("disk", folder / "named");
  const auto file = FileBelow(folder / "named", "a/b/c.txt");
  ASSERT_TRUE(file && WriteFile(*file, "x"));
  EXPECT_EQ(ReadFile(folder / "disk/a/b/c.txt").value(), "x");
  EXPECT_TRUE(FileBelow(folder / "named", "a/b/c.txt")) << "an earlier file is replaced";
  EXPECT_TRUE(CheckNoLinks(folder / "disk"));

  fs::create_directory_symlink("../outside", folder / "disk/link");
  fs::create_symlink("../../outside/new", folder / "disk/a/dangling");
  ASSERT_EQ(::mkfifo((folder / "disk/a/pipe").c_str(), 0666), 0);
  for (const char* name : {"link/c.txt", "link/d/c.txt", "link", "a/dangling", "a/pipe"}) {
    const auto refused = FileBelow(folder / "named", name);
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::kCannotWrite) << name;
  }
  EXPECT_FALSE(FolderBelow(folder / "named", "link"));
  EXPECT_TRUE(fs::is_empty(folder / "outside"));
  for (const char* below : {"disk", "disk/a", "disk/link"}) EXPECT_FALSE(CheckNoLinks(folder / below)) << below;
  EXPECT_TRUE(CheckNoLinks(folder / "disk/a/b"));
  EXPECT_TRUE(CheckNoLinks(folder / "none"));
}

TEST(Links, OnlyAFileWithOneNameIsOpenedInPlace) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "victim", "old") && WriteFile(folder / "plain", "old"));
  fs::create_symlink("victim", folder / "link");
  fs::create_symlink("new", folder / "dangling");
  fs::create_hard_link(folder / "victim", folder / "hard");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0666), 0);
  for (const char* name : {"link", "dangling", "hard", "pipe"}) {
    const auto opened = OpenInPlace(folder / name, 0);
    ASSERT_FALSE(opened) << name;
    EXPECT_EQ(opened.error().code, ErrorCode::kCannotWrite) << name;
    EXPECT_EQ(opened.error().where, (folder / name).native());
  }
  EXPECT_FALSE(fs::exists(folder / "new"));
  for (const char* name : {"plain", "made"}) {
    const auto opened = OpenInPlace(folder / name, O_APPEND);
    ASSERT_TRUE(opened) << name;
    EXPECT_EQ(::write(*opened, "x", 1), 1);
    ::close(*opened);
  }
  EXPECT_EQ(ReadFile(folder / "plain").value(), "oldx");
  EXPECT_EQ(ReadFile(folder / "made").value(), "x");
}

}  // namespace
}  // namespace mocurate
