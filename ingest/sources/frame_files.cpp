#include "ingest/sources/frame_files.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {

void NoteMissingFrames(const std::string& camera, const FrameSpan& span, const MissingFrameList& lacking,
                       std::vector<Finding>& findings) {
  constexpr std::size_t kNamed = 5;  // maximum number of files named in a message
  const auto note = [&](const std::vector<int>& frames, const char* code, const std::string& what) {
    Finding finding = CameraFinding(code, static_cast<double>(frames.size()), what, FindingAction::kMissing);
    finding.frame_begin = frames.front();
    finding.frame_end = frames.back() + 1;
    findings.push_back(std::move(finding));
  };
  const std::string of = " of " + Counted(span.frames, "frame");
  if (!lacking.missing.empty()) {
    note(lacking.missing, "frames_missing",
         (camera.empty() ? "there is" : "camera '" + camera + "' has") + " no file for " +
             std::to_string(lacking.missing.size()) + of + ", the first is number " +
             std::to_string(span.first + lacking.missing.front()));
  }
  if (lacking.broken.empty()) return;
  std::string others;
  for (std::size_t i = 1; i < std::min(kNamed, lacking.problems.size()); ++i)
    others += (i == 1 ? "; then " : ", ") + lacking.problems[i].first;
  note(lacking.broken, "unreadable_frames",
       (camera.empty() ? "" : "camera '" + camera + "': ") + "the files of " + std::to_string(lacking.broken.size()) +
           of + " cannot be read; the first: " + lacking.problems[0].second.Message() + others);
}

void ReadFrameFiles(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, const TakeFrame& take,
                    IngestedClip& ingested) {
  MissingFrameList lacking;
  for (int f = 0; f < span.frames; ++f) {
    const auto file = files.find(span.first + f);
    if (file == files.end()) {
      lacking.missing.push_back(f);
      continue;
    }
    const std::string& name = file->second->name;
    const Expected<std::string> bytes = ReadFile(file->second->path);
    ingested.content += name + ' ' + (bytes ? Sha256Hex(*bytes) : "unreadable") + '\n';
    const Status taken = bytes ? take(f, *bytes, name) : Status(Forward(bytes));
    if (taken) continue;
    lacking.broken.push_back(f);
    lacking.problems.emplace_back(name, taken.error());
  }
  NoteMissingFrames(camera, span, lacking, ingested.findings);
}

}  // namespace mocurate
