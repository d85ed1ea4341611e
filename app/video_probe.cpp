#include "app/video_probe.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/ask_program.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kAtOnce = 100;  // files a process
constexpr const char* kProgram = "mocurate-video";

fs::path Program() {
  std::error_code ignored;
  const fs::path self = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder : {self, self.parent_path() / "libexec" / "mocurate"}) {
    if (access((folder / kProgram).c_str(), X_OK) == 0) return folder / kProgram;
  }
  return {};
}

Expected<VideoFacts> FactsOf(const nlohmann::json& line, const fs::path& file) {
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

std::vector<Expected<VideoFacts>> Ask(const std::vector<fs::path>& files) {
  std::vector<Expected<VideoFacts>> answers;
  const fs::path program = Program();
  while (answers.size() < files.size() && !program.empty()) {
    const std::size_t begin = answers.size(), end = std::min(files.size(), begin + kAtOnce);
    std::vector<std::string> arguments;
    for (std::size_t i = begin; i < end; ++i) arguments.push_back(fs::absolute(files[i]).native());
    const ProgramAnswer answer = AskProgram(program, arguments, "LC_ALL=C");
    for (const std::string_view text : SplitText(answer.text, '\n')) {
      const auto line = nlohmann::json::parse(text, nullptr, false);
      if (line.is_object() && answers.size() < end) answers.push_back(FactsOf(line, files[answers.size()]));
    }
    if (answers.size() == end) continue;
    if (answer.exit_status > 0) break;  // it does not start
    answers.push_back(Fail(ErrorCode::kMalformed, "the decoder dies of it", DisplayPath(files[answers.size()]),
                           "is it whole, and does it play?"));
  }
  while (answers.size() < files.size()) {
    answers.push_back(Fail(ErrorCode::kMissingOnHost, std::string(kProgram) + " is not there or does not start",
                           DisplayPath(files[answers.size()]), "`mocurate doctor` tells what is missing"));
  }
  return answers;
}

}  // namespace

VideoProbe AskVideoProgram() { return Ask; }

}  // namespace mocurate
