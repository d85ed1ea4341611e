#include "app/video_probe.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/ask_program.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kAtOnce = 100;  // files a process
constexpr double kLongest_s = 60.0;   // a file
constexpr const char* kProgram = "mocurate-video";

fs::path Program() {
  std::error_code ignored;
  const fs::path self = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder : {self, self.parent_path() / "libexec" / "mocurate"}) {
    if (access((folder / kProgram).c_str(), X_OK) == 0) return folder / kProgram;
  }
  return {};
}

Expected<VideoFacts> VideoFactsOf(const nlohmann::json& line, const fs::path& file) {
  if (line.contains("error")) {
    return Fail(ErrorCode::kMalformed, line.at("error").get<std::string>(), DisplayPath(file),
                line.value("hint", std::string()));
  }
  VideoFacts facts;
  facts.frames = line.value("frames", 0);
  facts.rate_hz = line.value("rate_hz", 0.0);
  facts.width = line.value("width", 0);
  facts.height = line.value("height", 0);
  facts.codec = line.value("codec", std::string());
  return facts;
}

using Answer = std::optional<Expected<VideoFacts>>;

/// Lines without the index of a file that was asked about are no answers: a decoder's library may print, too.
void TakeAnswers(const std::string& text, const std::vector<std::size_t>& asked, const std::vector<fs::path>& files,
                 std::vector<Answer>& answers) {
  for (const std::string_view written : SplitText(text, '\n')) {
    const auto line = nlohmann::json::parse(written, nullptr, false);
    if (!line.is_object() || !line.contains("index") || !line.at("index").is_number_unsigned()) continue;
    const auto index = line.at("index").get<std::size_t>();
    if (index >= asked.size() || answers[asked[index]]) continue;
    answers[asked[index]] = VideoFactsOf(line, files[asked[index]]);
  }
}

std::vector<Expected<VideoFacts>> Ask(const std::vector<fs::path>& files) {
  std::vector<Answer> answers(files.size());
  const auto unanswered = [&](std::size_t most) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < files.size() && found.size() < most; ++i) {
      if (!answers[i]) found.push_back(i);
    }
    return found;
  };
  const fs::path program = Program();
  while (!program.empty()) {
    const std::vector<std::size_t> asked = unanswered(kAtOnce);
    if (asked.empty()) break;
    std::vector<std::string> arguments;
    for (const std::size_t i : asked) arguments.push_back(fs::absolute(files[i]).native());
    const ProgramAnswer answer = AskProgram(program, arguments, "LC_ALL=C", Listening{false, kLongest_s});
    TakeAnswers(answer.text, asked, files, answers);
    const auto silent = std::find_if(asked.begin(), asked.end(), [&](std::size_t i) { return !answers[i]; });
    if (silent == asked.end()) continue;
    if (answer.exit_status > 0) break;  // it does not start
    const std::string what = answer.timed_out ? "the decoder does not open it within " + FormatDouble(kLongest_s) + " s"
                                              : std::string("the decoder dies of it");
    answers[*silent] = Fail(ErrorCode::kMalformed, what, DisplayPath(files[*silent]), "is it whole, and does it play?");
  }
  std::vector<Expected<VideoFacts>> told;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (answers[i]) {
      told.push_back(std::move(*answers[i]));
    } else {
      told.push_back(Fail(ErrorCode::kMissingOnHost, std::string(kProgram) + " is not there or does not start",
                          DisplayPath(files[i]), "`mocurate doctor` tells what is missing"));
    }
  }
  return told;
}

}  // namespace

VideoProbe AskVideoProgram() { return Ask; }

}  // namespace mocurate
