#include "ingest/sense/observe.h"

#include "core/formats/bandai_label.h"
#include "core/formats/camera_files.h"
#include "core/formats/pose_log.h"
#include "ingest/sense/file_kind.h"

namespace mocurate {
namespace {

Expected<ObservedFile> Clips(Expected<std::vector<ObservedClip>> clips) {
  if (!clips) return Forward(clips);
  ObservedFile file;
  file.clips = std::move(*clips);
  return file;
}

Expected<ObservedFile> Cloud(Expected<ObservedCloud> cloud) {
  if (!cloud) return Forward(cloud);
  ObservedFile file;
  file.clouds.push_back(std::move(*cloud));
  return file;
}

Expected<ObservedFile> BandaiLabelIn(const FileBytes& file) {
  const Expected<BandaiLabel> label = ParseBandaiLabel(file.bytes, file.name);
  if (!label) return Forward(label);
  return ObservedFile::Of(
      {file.name,
       "bandai_label",
       {},
       {{"content", static_cast<double>(label->content)}, {"style", static_cast<double>(label->style)}}});
}

Expected<ObservedFile> JsonIn(const FileBytes& file) {
  switch (JsonKindOf(file.bytes)) {
    case JsonKind::kDepthStill:
      return Clips(ObserveDepthStill(file.bytes, file.name));
    case JsonKind::kDepthSequence:
      return Clips(ObserveDepthSequence(file.bytes, file.name));
    case JsonKind::kBabel:
      return ObserveBabel(file);
    case JsonKind::kBandaiLabel:
      return BandaiLabelIn(file);
    case JsonKind::kOpenPose:
    case JsonKind::kPanopticBodies:
    case JsonKind::kOther:
      break;
  }
  return ObserveCalibration(file);
}

/// A trajectory of a scan looks like a table at first.
std::optional<ObservedFile> PoseLogIn(const FileBytes& file) {
  const auto poses = ParsePoseLog(file.bytes, file.name);
  if (!poses || poses->empty()) return std::nullopt;
  return ObservedFile::Of({file.name, "pose_log", {}, {{"poses", static_cast<double>(poses->size())}}});
}

Expected<ObservedFile> TableIn(const FileBytes& file) {
  if (IsOfPhspd(file.path)) return ObservePhspd(file);
  if (std::optional<ObservedFile> poses = PoseLogIn(file)) return std::move(*poses);
  return Clips(ObserveTable(file.bytes, file.name));
}

}  // namespace

Expected<ObservedFile> ObserveCalibration(const FileBytes& file) {
  Expected<Calibration> calibration = ParseCalibration(file.bytes, file.name);
  if (!calibration) return Forward(calibration);
  ObservedFile observed;
  observed.calibrations.push_back(std::move(*calibration));
  return observed;
}

Expected<ObservedFile> ObserveFile(const FileBytes& file) {
  if (IsUestcInfo(file.path)) return ObserveUestcInfo(file);
  switch (KindOf(file.bytes)) {
    case FileKind::kBvh:
      return Clips(ObserveBvh(file.bytes, file.name));
    case FileKind::kNpy:
      return Clips(ObserveNpy(file.bytes, file.name));
    case FileKind::kNumbers:
      return TableIn(file);
    case FileKind::kNtuSkeleton:
      return Clips(ObserveNtu(file));
    case FileKind::kAsf:
      return ObserveAsf(file);
    case FileKind::kAmc:
      return Clips(ObserveAmc(file));
    case FileKind::kOpenSim:
      return Clips(ObserveOpenSim(file.bytes, file.name));
    case FileKind::kZip:
      return ObserveNpz(file);
    case FileKind::kPickle:
      return ObservePickle(file);
    case FileKind::kPly:
      return Cloud(ObserveCloud(file.bytes, file.name, "ply"));
    case FileKind::kPcd:
      return Cloud(ObserveCloud(file.bytes, file.name, "pcd"));
    case FileKind::kObj:
      return Cloud(ObserveCloud(file.bytes, file.name, "obj"));
    case FileKind::kXml:
    case FileKind::kToml:
      return ObserveCalibration(file);
    case FileKind::kJson:
      return JsonIn(file);
    case FileKind::kEmpty:
      return EmptyFile(file.name);
    case FileKind::kOpenCvYaml:
    case FileKind::kPng:
    case FileKind::kJpeg:
    case FileKind::kVideo:
    case FileKind::kUestcInfo:
    case FileKind::kUnknown:
      break;
  }
  // Too little is left to tell the format by: of no frames, or cut off behind the count.
  if (file.path.extension() == ".skeleton") return Clips(ObserveNtu(file));
  return Fail(ErrorCode::kUnsupported, "the content is none of the known formats", file.name,
              "docs/inspect.md lists them");
}

}  // namespace mocurate
