// What the reader of a run refuses, an inspection tells as an error of the same file, with a source and without.

#include "ingest/sense/reader_check.h"

#include <gmock/gmock.h>

#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "ingest/sense/inspect.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

class ReaderCheck : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kPhspd);
    options.subjects = 1;
    options.actions = {"boxing"};
    options.depth.enabled = false;
    Write(options);
    rows_ = SplitText(text_ = Bytes(kRecording), '\n');
  }

  std::vector<std::string> Errors(bool declared) const {
    const IngestOptions phspd = Declared("phspd", {"ingest.path=" + (folder / "phspd").string()});
    const Json inspection =
        InspectPath(folder / "phspd", declared ? std::optional<SourceOptions>(phspd.source) : std::nullopt);
    std::vector<std::string> told;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") == "error")
        told.push_back(finding.at("where").get<std::string>() + ": " + finding.at("message").get<std::string>());
    }
    return told;
  }

  /// Replaces the number of the frame in a row.
  std::string WithFrame(std::size_t row, const std::string& number) const {
    std::string text;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::string line(rows_[i]);
      if (line.empty()) continue;
      text += (i == row ? number + line.substr(line.find(' ')) : line) + "\n";
    }
    return text;
  }

  static constexpr const char* kRecording = "phspd/pose/subject01_group3_time1/pose.txt";
  std::string text_;
  std::vector<std::string_view> rows_;
};

TEST_F(ReaderCheck, SoundFilesHaveNoErrors) {
  EXPECT_THAT(Errors(true), IsEmpty());
  EXPECT_THAT(Errors(false), IsEmpty());
}

TEST_F(ReaderCheck, FramesThatNoRunTakesAreErrorsOfTheirLine) {
  std::string reversed;
  for (const std::string_view row : rows_) reversed = row.empty() ? reversed : std::string(row) + "\n" + reversed;
  const std::vector<std::pair<std::string, std::string>> damaged = {{reversed, "does not come after"},
                                                                    {WithFrame(3, "2"), "does not come after"},
                                                                    {WithFrame(3, "-3"), "is no index of a frame"},
                                                                    {WithFrame(3, "2.5"), "is no index of a frame"}};
  for (const auto& [text, words] : damaged) {
    ASSERT_TRUE(WriteFile(folder / kRecording, text));
    for (const bool declared : {false, true}) {
      const std::vector<std::string> told = Errors(declared);
      EXPECT_THAT(told, Contains(::testing::AllOf(HasSubstr("time1/pose.txt:"), HasSubstr(words))))
          << words << (declared ? ", declared" : "");
    }
  }
}

}  // namespace
}  // namespace mocurate
