// A capture becomes a folder of files, and nobody else's file in that folder is touched.

#include "ingest/synthetic/capture_files.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

class CapturedFiles : public testing::Test {
 protected:
  CapturedFiles() {
    std::string pattern = (fs::temp_directory_path() / "mocurate_capture_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~CapturedFiles() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  Status Unpack(const nlohmann::json& files) const {
    EXPECT_TRUE(WriteFile(folder_ / "artifact", nlohmann::json{{"files", files}}.dump()));
    return UnpackCapture(folder_ / "artifact", folder_ / "capture");
  }
  std::string Text(const std::string& name) const { return ReadFile(folder_ / "capture" / name).value_or("(none)"); }
  void Write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(MakeFolder(folder_ / "capture"));
    ASSERT_TRUE(WriteFile(folder_ / "capture" / name, text));
  }

  fs::path folder_;
};

TEST_F(CapturedFiles, LieInTheFolderAndFollowTheCapture) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}, {"b.txt", "2"}}));
  EXPECT_EQ(Text("a.txt"), "1");
  ASSERT_TRUE(Unpack({{"a.txt", "3"}, {"c.txt", "4"}}));
  EXPECT_EQ(Text("a.txt"), "3");
  EXPECT_EQ(Text("b.txt"), "(none)") << "of the capture before";
  EXPECT_EQ(Text("c.txt"), "4");
}

TEST_F(CapturedFiles, FilesOfOthersStayWhateverHappens) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}, {"b.txt", "2"}}));
  Write("notes.txt", "mine");
  Write("b.txt", "2, corrected by hand");
  ASSERT_TRUE(Unpack({{"a.txt", "3"}}));
  EXPECT_EQ(Text("notes.txt"), "mine");
  EXPECT_EQ(Text("b.txt"), "2, corrected by hand");
}

TEST_F(CapturedFiles, AFileOfAnotherInTheWayIsNamedAndNotOverwritten) {
  Write("a.txt", "mine");
  const Status refused = Unpack({{"a.txt", "1"}});
  ExpectError(refused, ErrorCode::kCannotWrite, (folder_ / "capture/a.txt").string());
  EXPECT_EQ(Text("a.txt"), "mine");
}

TEST_F(CapturedFiles, ALostFileIsWrittenAgain) {
  ASSERT_TRUE(Unpack({{"a.txt", "1"}}));
  fs::remove(folder_ / "capture/a.txt");
  ASSERT_TRUE(Unpack({{"a.txt", "1"}}));
  EXPECT_EQ(Text("a.txt"), "1");
  EXPECT_EQ(CaptureFileNames(folder_ / "artifact").value(), std::set<std::string>{"a.txt"});
}

TEST_F(CapturedFiles, BytesThatAreNoCaptureAreAnError) {
  ASSERT_TRUE(WriteFile(folder_ / "artifact", "[]"));
  EXPECT_EQ(UnpackCapture(folder_ / "artifact", folder_ / "capture").error().code, ErrorCode::kMalformed);
}

}  // namespace
}  // namespace mocurate
