#include "ingest/sources/frame_files.h"

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {

void ReadFrameFiles(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, const TakeFrame& take,
                    IngestedClip& ingested) {
  std::vector<int> missing, broken;
  std::string problem;
  for (int f = 0; f < span.frames; ++f) {
    const auto file = files.find(span.first + f);
    if (file == files.end()) {
      missing.push_back(f);
      continue;
    }
    const std::string& name = file->second->name;
    const Expected<std::string> bytes = ReadFile(file->second->path);
    ingested.content += name + ' ' + (bytes ? Sha256Hex(*bytes) : "unreadable") + '\n';
    const Status taken = bytes ? take(f, *bytes, name) : Status(Forward(bytes));
    if (taken) continue;
    if (broken.empty()) problem = taken.error().Message();
    broken.push_back(f);
  }
  const auto note = [&](const std::vector<int>& frames, const char* code, const std::string& what) {
    if (frames.empty()) return;
    Finding finding = CameraFinding(code, static_cast<double>(frames.size()), what, "nobody is seen there");
    finding.frame_begin = frames.front();
    finding.frame_end = frames.back() + 1;
    ingested.findings.push_back(std::move(finding));
  };
  const std::string of = " of " + Counted(span.frames, "frame");
  note(missing, "frames_missing",
       (camera.empty() ? "there is" : "camera '" + camera + "' has") + " no file for " +
           std::to_string(missing.size()) + of + ", the first is number " +
           std::to_string(span.first + (missing.empty() ? 0 : missing.front())));
  note(broken, "unreadable_frames",
       (camera.empty() ? "" : "camera '" + camera + "': ") + "the files of " + std::to_string(broken.size()) + of +
           " cannot be read; the first: " + problem);
}

}  // namespace mocurate
