#include "ingest/inspect/read_raw.h"

#include "core/base/text.h"
#include "core/formats/bandai_label.h"
#include "core/formats/camera_files.h"
#include "ingest/formats/driver.h"

namespace mocurate {
namespace {

Expected<RawFile> BandaiLabelIn(const FileBytes& file) {
  const Expected<BandaiLabel> label = ParseBandaiLabel(file.bytes, file.name);
  if (!label) return Forward(label);
  return RawFile::Of(
      {file.name,
       "bandai_label",
       {},
       {{"content", static_cast<double>(label->content)}, {"style", static_cast<double>(label->style)}}});
}

Expected<RawFile> JsonIn(const FileBytes& file) {
  const JsonKind kind = JsonKindOf(file.bytes);
  if (kind == JsonKind::kBabel) return ReadRawBabel(file);
  const auto refuse = [&](const char* what, const char* hint) {
    return Fail(ErrorCode::kUnsupported, what, file.name, hint);
  };
  if (kind == JsonKind::kList && Trim(file.bytes).size() < 8) {
    return refuse("an empty JSON list: no person is there, as EasyMocap writes it",
                  "EasyMocap's keypoints are not read: export its motion as BVH, or the points as a table");
  }
  if (kind == JsonKind::kList) return refuse("a JSON list of no known format", "docs/inspect.md lists the formats");
  if (kind == JsonKind::kEasyMocap) {
    return refuse("a JSON list of people with keypoints, as EasyMocap and COCO's programs write them: not read",
                  "write the points as a table of a row a frame, or as OpenPose's JSON files");
  }
  if (kind == JsonKind::kAzureBodies) {
    return refuse("body tracking of the Azure Kinect: not read",
                  "write its joint positions as a table, millimetres, with the joints' names in a header");
  }
  return kind == JsonKind::kBandaiLabel ? BandaiLabelIn(file) : ReadRawCalibration(file);
}

}  // namespace

Expected<RawFile> ReadRawCalibration(const FileBytes& file) {
  Expected<Calibration> calibration = ParseCalibration(file.bytes, file.name);
  if (!calibration) return Forward(calibration);
  RawFile observed;
  observed.calibrations.push_back(std::move(*calibration));
  return observed;
}

Expected<RawFile> ReadRawFile(const FileBytes& file) {
  const FileKind kind = KindOf(file.bytes);
  const FormatDriver* format = RecogniseFormat(file);
  if (format != nullptr && format->read_raw != nullptr) return format->read_raw(file);
  switch (kind) {
    case FileKind::kOpenSim:
      return ReadRawOpenSim(file);
    case FileKind::kXml:
    case FileKind::kToml:
      return ReadRawCalibration(file);
    case FileKind::kJson:
      return JsonIn(file);
    case FileKind::kEmpty:
      return EmptyFile(file.name);
    default:
      return Fail(ErrorCode::kUnsupported, "the content is not one of the known formats", file.name,
                  "docs/inspect.md lists them");
  }
}

}  // namespace mocurate
