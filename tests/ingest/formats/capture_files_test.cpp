// A capture is unpacked into a folder; other files of the folder stay unchanged.

#include "ingest/synthetic/studio.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/formats/expect_error.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

class CapturedFiles : public testing::Test {
 protected:
  Status Unpack(const nlohmann::json& files) const {
    EXPECT_TRUE(WriteFile(folder_ / "artifact", nlohmann::json{{"files", files}}.dump()));
    return UnpackCapture(folder_ / "artifact", folder_ / "capture");
  }
  std::string Text(const std::string& name) const { return ReadFile(folder_ / "capture" / name).value_or("(none)"); }
  void Write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(MakeFolder(folder_ / "capture"));
    ASSERT_TRUE(WriteFile(folder_ / "capture" / name, text));
  }

  const ScratchFolder folder_;
};

TEST_F(CapturedFiles, AreUnpackedAndUpdatedWithTheCapture) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}, {"b.txt", "2"}}));
  EXPECT_EQ(Text("a.txt"), "1");
  ASSERT_TRUE(Unpack({{"a.txt", "3"}, {"c.txt", "4"}}));
  EXPECT_EQ(Text("a.txt"), "3");
  EXPECT_EQ(Text("b.txt"), "(none)") << "a file of the previous capture is removed";
  EXPECT_EQ(Text("c.txt"), "4");
}

TEST_F(CapturedFiles, LeaveOtherFilesUntouched) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}, {"b.txt", "2"}}));
  Write("notes.txt", "mine");
  Write("b.txt", "2, corrected by hand");
  ASSERT_TRUE(Unpack({{"a.txt", "3"}}));
  EXPECT_EQ(Text("notes.txt"), "mine");
  EXPECT_EQ(Text("b.txt"), "2, corrected by hand");
}

TEST_F(CapturedFiles, RefuseToOverwriteAnotherFile) {
  Write("a.txt", "mine");
  const Status refused = Unpack({{"a.txt", "1"}});
  ExpectError(refused, ErrorCode::kCannotWrite, (folder_ / "capture/a.txt").string());
  EXPECT_EQ(Text("a.txt"), "mine");
}

TEST_F(CapturedFiles, AreNotWrittenThroughLinks) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}}));
  ASSERT_TRUE(WriteFile(folder_ / "victim", "old"));
  for (const char* target : {"../victim", "../none"}) {
    fs::remove(folder_ / "capture/a.txt");
    fs::create_symlink(target, folder_ / "capture/a.txt");
    EXPECT_EQ(Unpack({{"a.txt", "1"}}).error().code, ErrorCode::kCannotWrite);
  }
  EXPECT_EQ(ReadFile(folder_ / "victim").value(), "old");
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(CapturedFiles, AreRestoredWhenMissing) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}}));
  fs::remove(folder_ / "capture/a.txt");
  ASSERT_TRUE(Unpack({{"a.txt", "1"}}));
  EXPECT_EQ(Text("a.txt"), "1");
  EXPECT_EQ(CaptureFileNames(folder_ / "artifact").value(), std::set<std::string>{"a.txt"});
}

TEST_F(CapturedFiles, RejectBytesThatAreNoCapture) {
  ASSERT_TRUE(WriteFile(folder_ / "artifact", "[]"));
  EXPECT_EQ(UnpackCapture(folder_ / "artifact", folder_ / "capture").error().code, ErrorCode::kMalformed);
  for (const char* name : {"../out", "/out", "..", "a/b", "x\\u0000y"}) {
    ASSERT_TRUE(WriteFile(folder_ / "artifact", std::string("{\"files\": {\"") + name + "\": \"text\"}}"));
    EXPECT_EQ(UnpackCapture(folder_ / "artifact", folder_ / "capture").error().code, ErrorCode::kMalformed) << name;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
  ASSERT_TRUE(WriteFile(folder_ / "artifact", "{\"files\": {\"a.txt\": 7}}"));
  EXPECT_EQ(UnpackCapture(folder_ / "artifact", folder_ / "capture").error().code, ErrorCode::kMalformed);
}

}  // namespace
}  // namespace mocurate
