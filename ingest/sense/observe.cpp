#include "ingest/sense/observe.h"

#include "core/formats/bandai_label.h"
#include "core/formats/camera_files.h"
#include "ingest/formats/driver.h"

namespace mocurate {
namespace {

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
  const JsonKind kind = JsonKindOf(file.bytes);
  if (kind == JsonKind::kBabel) return ObserveBabel(file);
  return kind == JsonKind::kBandaiLabel ? BandaiLabelIn(file) : ObserveCalibration(file);
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
  const FileKind kind = KindOf(file.bytes);
  const FormatDriver* format = RecogniseFormat(file);
  if (format != nullptr && format->observe != nullptr) return format->observe(file);
  switch (kind) {
    case FileKind::kOpenSim:
      return ObserveOpenSim(file);
    case FileKind::kXml:
    case FileKind::kToml:
      return ObserveCalibration(file);
    case FileKind::kJson:
      return JsonIn(file);
    case FileKind::kEmpty:
      return EmptyFile(file.name);
    default:
      return Fail(ErrorCode::kUnsupported, "the content is none of the known formats", file.name,
                  "docs/inspect.md lists them");
  }
}

}  // namespace mocurate
