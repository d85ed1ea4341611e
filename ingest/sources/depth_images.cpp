#include "ingest/sources/depth_images.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {
namespace {

constexpr const char* kMissing = "depth_images_missing";

}  // namespace

Status SetImageSize(const StageInput& input, Camera& camera) {
  std::string head;
  const Status read = ReadFileInParts(input.path, [&](std::string_view part) {
    head.append(part.substr(0, kPngHeaderBytes - std::min(kPngHeaderBytes, head.size())));
  });
  if (!read) return read;
  const Expected<PngHeader> header = ReadPngHeader(head, input.name);
  if (!header) return Forward(header);
  if (header->bits != 16 || header->channels != 1) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(header->channels) + " channels of " + std::to_string(header->bits) + " bits", input.name,
                "depth images are 16-bit grey PNG");
  }
  camera.width = header->width;
  camera.height = header->height;
  return {};
}

Status AddDepthBeside(const SourceFile& file, const Rig& rig, const std::map<std::string, FilesOfCamera>& depth,
                      const std::map<std::string, FilesOfCamera>& keypoints, const FrameSpan& span,
                      IngestedClip& ingested) {
  if (!HasDepthBeside(file.source)) return {};
  if (depth.empty()) {
    ingested.findings.push_back(CameraFinding(
        kMissing, span.frames, "the clip has no depth images; only its keypoints are used", FindingAction::kKept));
    return {};
  }
  std::vector<Finding> findings;
  const auto partners = PartnersOf(file, rig, depth, findings, keypoints);
  if (!partners) return Forward(partners);
  for (Finding& finding : findings) {  // cameras without any files are reported already
    if (finding.code == "camera_not_calibrated") ingested.findings.push_back(std::move(finding));
  }
  for (const auto& [name, camera] : *partners) {
    const FilesOfCamera& images = depth.at(name);
    DepthView view;
    view.camera = *camera;
    view.camera.name = name;
    view.metres_per_unit = file.source.depth_unit;
    if (Status sized = SetImageSize(*images.begin()->second, view.camera); !sized) return sized;
    int missing = 0;
    for (int f = 0; f < span.frames; ++f) {
      const double time_s = ingested.clip.rate.FrameTime(f);
      const auto image = images.find(span.first + f);
      if (image != images.end()) {
        if (Status added = AddDepthImage(*image->second, time_s, view); !added) return added;
        continue;
      }
      ++missing;
      view.files.emplace_back();
      view.sha256.emplace_back();
      view.time_s.push_back(time_s);
    }
    if (missing > 0) {
      ingested.findings.push_back(MakeFinding(kMissing, Severity::kInfo, missing,
                                              "camera '" + name + "' has no depth image of " + std::to_string(missing) +
                                                  " of " + std::to_string(span.frames) + " frames",
                                              FindingAction::kMissing));
    }
    ingested.clip.evidence.depth_views.push_back(std::move(view));
  }
  return {};
}

}  // namespace mocurate
