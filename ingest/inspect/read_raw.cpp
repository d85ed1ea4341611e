#include "ingest/inspect/read_raw.h"

#include <algorithm>
#include <optional>

#include "core/base/text.h"
#include "core/formats/bandai_label.h"
#include "core/formats/camera_files.h"
#include "core/formats/line_reader.h"
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

/// Why a text whose second line is nearly all numbers is no table: words between them, or semicolons.
std::optional<Error> FaultOfTable(const FileBytes& file) {
  constexpr int kFewestNumbers = 6;
  std::string_view text = file.bytes.substr(0, kKindHead);
  for (int line = 1; line <= 2 && !text.empty(); ++line) {
    const std::string_view row = Trim(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(text.size(), std::min(text.find('\n'), text.size() - 1) + 1));
    const std::size_t first = row.find_first_of(",;\t");
    if (line == 1 || first == std::string_view::npos) continue;
    int numbers = 0, words = 0, column = 0, at = 0;
    std::string word;
    for (const std::string_view cell : SplitText(row, row[first])) {
      ++at;
      if (Trim(cell).empty()) continue;
      const bool number = ParseDouble(Trim(cell)).has_value();
      (number ? numbers : words) += 1;
      if (!number && word.empty()) word = Shown(Trim(cell)), column = at;
    }
    if (numbers < kFewestNumbers || words > numbers) return std::nullopt;
    const std::string place = file.name + ":2";
    if (words > 0)
      return Error{ErrorCode::kUnsupported,
                   "a table with words among its numbers: '" + word + "' in column " + std::to_string(column), place,
                   "leave that column out; write times as numbers (a column time_s)"};
    if (row[first] == ';')
      return Error{ErrorCode::kUnsupported, "numbers with decimal points between semicolons", place,
                   "write commas, tabs or blanks between them"};
  }
  return std::nullopt;
}

}  // namespace

Expected<RawFile> ReadRawCalibration(const FileBytes& file) {
  Expected<Calibration> calibration = ParseCalibration(file.bytes, file.name);
  if (!calibration) return Forward(calibration);
  RawFile observed;
  observed.calibrations.push_back(std::move(*calibration));
  return observed;
}

Expected<RawFile> ReadRawFile(const FileBytes& file, FileKind kind, const FormatDriver* format) {
  if (format != nullptr && format->open != nullptr) return format->open(file);
  const auto refuse = [&](const char* what, const char* hint) {
    return Fail(ErrorCode::kUnsupported, what, file.name, hint);
  };
  switch (kind) {
    case FileKind::kOpenSim:
      return ReadRawOpenSim(file);
    case FileKind::kXml:
    case FileKind::kToml:
    case FileKind::kJson:
      return ReadRawCalibration(file);
    case FileKind::kBabel:
      return ReadRawBabel(file);
    case FileKind::kBandaiLabel:
      return BandaiLabelIn(file);
    case FileKind::kJsonList:
      if (Trim(file.bytes).size() < 8)
        return refuse("an empty JSON list: no person is there, as EasyMocap writes it",
                      "EasyMocap's keypoints are not read: export its motion as BVH, or the points as a table");
      return refuse("a JSON list of no known format", "docs/inspect.md lists the formats");
    case FileKind::kEasyMocap:
      return refuse("a JSON list of people with keypoints, as EasyMocap and COCO's programs write them: not read",
                    "write the points as a table of a row a frame, or as OpenPose's JSON files");
    case FileKind::kAzureBodies:
      return refuse("body tracking of the Azure Kinect: not read",
                    "write its joint positions as a table, millimetres, with the joints' names in a header");
    case FileKind::kEmpty:
      return EmptyFile(file.name);
    default:
      if (auto fault = FaultOfTable(file)) return tl::unexpected<Error>(*std::move(fault));
      return refuse("the content is not one of the known formats", "docs/inspect.md lists them");
  }
}

}  // namespace mocurate
