#include "ingest/sense/observe.h"

#include "core/formats/bandai_label.h"
#include "core/formats/camera_files.h"
#include "core/formats/pose_log.h"
#include "ingest/sense/file_kind.h"
#include "ingest/sense/name_sense.h"
#include "ingest/sense/remark.h"

namespace mocurate {
namespace {

Expected<ObservedFile> Clips(Expected<std::vector<ObservedClip>> clips) {
  if (!clips) return Forward(clips);
  ObservedFile file;
  file.clips = std::move(*clips);
  return file;
}

/// Motions on a tree, which a source of `format` has to know.
Expected<ObservedFile> Trees(Expected<std::vector<ObservedClip>> clips, const std::optional<SourceOptions>& source,
                             SourceFormat format) {
  if (!clips) return Forward(clips);
  for (ObservedClip& clip : *clips) {
    if (source && source->format == format) CompareTree(*source, clip);
  }
  return Clips(std::move(clips));
}

Expected<ObservedFile> Cloud(Expected<ObservedCloud> cloud) {
  if (!cloud) return Forward(cloud);
  ObservedFile file;
  file.clouds.push_back(std::move(*cloud));
  return file;
}

Expected<ObservedFile> CalibrationIn(const FileBytes& file) {
  Expected<Calibration> calibration = ParseCalibration(file.bytes, file.name);
  if (!calibration) return Forward(calibration);
  ObservedFile observed;
  observed.calibrations.push_back(std::move(*calibration));
  return observed;
}

Expected<ObservedFile> BandaiLabelIn(const FileBytes& file) {
  const Expected<BandaiLabel> label = ParseBandaiLabel(file.bytes, file.name);
  if (!label) return Forward(label);
  ObservedFile observed;
  observed.companions.push_back(
      {file.name,
       "bandai_label",
       {},
       {{"content", static_cast<double>(label->content)}, {"style", static_cast<double>(label->style)}}});
  if (const auto doubt = DoubtBandaiLabel(file.path, *label))
    observed.remarks.push_back({"name_contradiction", Severity::kWarning, 0.0, *doubt});
  return observed;
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
  return CalibrationIn(file);
}

/// A trajectory of a scan looks like a table at first.
std::optional<ObservedFile> PoseLogIn(const FileBytes& file) {
  const auto poses = ParsePoseLog(file.bytes, file.name);
  if (!poses || poses->empty()) return std::nullopt;
  ObservedFile observed;
  observed.companions.push_back({file.name, "pose_log", {}, {{"poses", static_cast<double>(poses->size())}}});
  return observed;
}

Expected<ObservedFile> TableIn(const FileBytes& file, const std::optional<SourceOptions>& source) {
  if (IsOfPhspd(file.path) || (source && source->format == SourceFormat::kPhspd)) return ObservePhspd(file);
  if (std::optional<ObservedFile> poses = PoseLogIn(file)) return std::move(*poses);
  return Clips(ObserveTable(file.bytes, file.name, source));
}

}  // namespace

Remark RemarkOf(const Finding& finding) {
  const bool lost = finding.action == FindingAction::kDropped;
  return {finding.code,
          finding.severity,
          finding.value,
          finding.message,
          lost ? finding.frame_begin : 0,
          lost ? finding.frame_end : 0};
}

void AddRemarks(const std::vector<Finding>& findings, ObservedClip& clip, int rows) {
  for (const Finding& finding : findings) {
    Remark remark = RemarkOf(finding);
    remark.frame_begin /= rows;
    remark.frame_end = (remark.frame_end + rows - 1) / rows;
    clip.remarks.push_back(std::move(remark));
  }
}

Expected<ObservedFile> ObserveFile(const FileBytes& file, const std::optional<SourceOptions>& source) {
  if (IsUestcInfo(file.path)) return ObserveUestcInfo(file);
  switch (KindOf(file.bytes)) {
    case FileKind::kBvh:
      return Trees(ObserveBvh(file.bytes, file.name), source, SourceFormat::kBvh);
    case FileKind::kNpy:
      return Clips(ObserveNpy(file.bytes, file.name, source));
    case FileKind::kNumbers:
      return TableIn(file, source);
    case FileKind::kNtuSkeleton:
      return Clips(ObserveNtu(file, source));
    case FileKind::kAsf:
      return ObserveAsf(file);
    case FileKind::kAmc:
      return Trees(ObserveAmc(file), source, SourceFormat::kAsfAmc);
    case FileKind::kOpenSim:
      return Clips(ObserveOpenSim(file.bytes, file.name));
    case FileKind::kZip:
      return ObserveNpz(file, source);
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
      return CalibrationIn(file);
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
  if (file.path.extension() == ".skeleton") return Clips(ObserveNtu(file, source));
  // What is declared as a table is read as one, as a run does.
  if (source && source->format == SourceFormat::kJointTable) return Clips(ObserveTable(file.bytes, file.name, source));
  return Fail(ErrorCode::kUnsupported, "the content is none of the known formats", file.name,
              "docs/inspect.md lists them");
}

}  // namespace mocurate
