// Everything that needs OpenCV's video coders. It is a separate program because they load some 200 libraries, and a
// damaged file may crash them. mocurate-video FILE ... reports video files for `mocurate inspect`: a line of JSON per
// file, flushed at once, with the file's index among the arguments ("index", from 0). Without arguments it is the
// worker that writes the videos of a report.

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/terminal.h"
#include "core/base/version.h"
#include "core/pipeline/worker.h"
#include "ingest/sources/video.h"
#include "report/options.h"
#include "report/stages.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc == 2 && std::strcmp(argv[1], "--version") == 0) {
    Print("%s\n", std::string(CreatedBy()).c_str());
    return 0;
  }
  if (argc == 1)
    return RunWorker(
        {{ClipVideoDeclaration().name, ClipVideoStage}, {MotionVideoDeclaration().name, MotionVideoStage}});
  for (int i = 1; i < argc; ++i) {
    const Expected<VideoFacts> video = ReadVideoFacts(argv[i]);
    nlohmann::json line;
    if (video) {
      line = {{"frames", video->frames},
              {"rate_hz", video->rate_hz},
              {"width", video->width},
              {"height", video->height},
              {"codec", video->codec}};
    } else {
      line = {{"error", video.error().what}, {"hint", video.error().hint}};
    }
    line["index"] = i - 1;
    PrintJson(line, -1);
    std::fflush(stdout);
  }
  return 0;
}
