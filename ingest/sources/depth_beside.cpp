#include "ingest/sources/depth_beside.h"

#include <algorithm>

#include "ingest/sources/depth_header.h"

namespace mocurate {
namespace {

constexpr const char* kMissing = "depth_images_missing";

std::string Numbers(const FrameSpan& span) {
  return std::to_string(span.first) + " to " + std::to_string(span.first + span.frames - 1);
}

}  // namespace

Expected<FrameSpan> SpanOfBoth(const std::map<std::string, FilesOfCamera>& keypoints,
                               const std::map<std::string, FilesOfCamera>& depth, const std::string& name) {
  const Expected<FrameSpan> seen = SpanOf(keypoints, name);
  if (!seen || depth.empty()) return seen;
  const Expected<FrameSpan> images = SpanOf(depth, name);
  if (!images) return images;
  const long long first = std::min(seen->first, images->first);
  const long long end = std::max(seen->first + seen->frames, images->first + images->frames);
  if (end - first >= static_cast<long long>(seen->frames) + images->frames) {
    return Fail(
        ErrorCode::kInconsistent,
        "keypoints are numbered " + Numbers(*seen) + ", depth images " + Numbers(*images) + ": they share no frame",
        name, "number both alike; see {frame} of ingest.source.files and depth_files");
  }
  return FrameSpan{first, static_cast<int>(end - first)};
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
