#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/problem_list.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "ingest/formats/driver.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr long long kMostBodies = 6;  // what a Kinect follows

std::string OptionPlace(const char* option) { return std::string("ingest.source.") + option; }

Status CheckSourceUnits(const SourceOptions& s) {
  const UnitOf unit = DriverOf(s.format).unit;
  const bool by_definition = unit == UnitOf::kMetres;
  if (by_definition && !s.units.empty() && s.units != "m") {
    return Fail(ErrorCode::kConfig, "units are '" + s.units + "', but " + s.format + " files are in metres",
                OptionPlace("units"), "take `units` out");
  }
  if (unit == UnitOf::kCentimetres && !s.units.empty() && s.units != "cm") {
    return Fail(ErrorCode::kConfig, "units are '" + s.units + "', but " + s.format + " files are in centimetres",
                OptionPlace("units"), "take `units` out");
  }
  if (s.units.empty() && unit == UnitOf::kDeclaration) {
    return Fail(ErrorCode::kConfig,
                "source '" + s.name + "' does not declare its unit of length, and " + s.format + " files do not either",
                OptionPlace("units"), "write `units: m` (or cm, mm, inch) under ingest.source");
  }
  if (s.units.empty()) return {};
  const Expected<double> scale = MetresPerUnit(s.units);
  if (!scale) return Forward(scale);
  return {};
}

/// A declaration that was written by `config init` says by name what is still to be filled in.
Status CheckFilledIn(const SourceOptions& s) {
  const auto open = [](const std::string& text) { return text.rfind(kFillIn, 0) == 0; };
  const std::pair<const char*, const std::string*> texts[] = {{"files", &s.files},
                                                              {"units", &s.units},
                                                              {"axes", &s.axes},
                                                              {"skeleton", &s.skeleton},
                                                              {"skeleton_files", &s.skeleton_files},
                                                              {"depth_files", &s.depth_files},
                                                              {"mask_files", &s.mask_files},
                                                              {"recording", &s.recording},
                                                              {"person", &s.person},
                                                              {"label", &s.label}};
  ProblemList problems;
  for (const auto& [option, text] : texts) {
    if (!open(*text)) continue;
    const bool person = text == &s.person, label = text == &s.label;
    problems.Add(OptionPlace(option), "'" + *text + "' is still to be filled in",
                 person  ? "write {fields} of ingest.source.files that name the performer, or a fixed name"
                 : label ? "write {fields} of ingest.source.files that name the action, or '' for none"
                         : "the files do not declare it: take it from the set's documentation");
  }
  std::string columns;
  for (const std::string& column : s.columns) columns += column + " ";
  for (const auto& [option, text] : {std::pair{"layout", s.layout}, std::pair{"columns", columns}}) {
    if (text.find(kFillIn) == std::string::npos) continue;
    problems.Add(
        OptionPlace(option), "'" + text + "' is still to be filled in",
        "write `frame` where the column counts frames, its unit where it is a clock (time_s, time_ms, time_us, "
        "time_100ns, time_ns), `confidence` where it says whether a joint is seen, or `skip`");
  }
  for (const std::string& file : s.calibration) {
    if (!open(file)) continue;
    problems.Add(OptionPlace("calibration"), "'" + file + "' is still to be filled in",
                 "write where the calibration of the cameras lies below the folder");
  }
  for (const std::string& joint : s.joints) {
    if (!open(joint)) continue;
    problems.Add(OptionPlace("joints"), "'" + joint + "' is still to be filled in",
                 "name the joints in the order of the file, '-' for a column that is no joint");
  }
  return problems.Result();
}

/// An option of other formats that is set. Error kConfig naming it and the formats that have it.
Status CheckOwnOptions(const SourceOptions& s, const FormatDriver& driver) {
  const nlohmann::json said = OptionsToJson(s);
  static const nlohmann::json unset_options = OptionsToJson(SourceOptions());
  std::map<std::string, std::string> formats;  // of each option
  for (const FormatDriver& format : FormatDrivers()) {
    for (const std::string& option : format.options)
      formats[option] += (formats[option].empty() ? "" : ", ") + std::string(format.name);
  }
  for (const auto& [option, of] : formats) {
    if (driver.HasOption(option) || said.at(option) == unset_options.at(option)) continue;
    return Fail(ErrorCode::kConfig, "format " + std::string(driver.name) + " has no option '" + option + "'",
                OptionPlace(option.c_str()), "it is of " + of + ": remove it, or correct ingest.source.format");
  }
  return {};
}

}  // namespace

Status CheckBodies(const SourceOptions& s) {
  for (const auto& [label, text] : s.bodies) {
    const std::optional<long long> count = ParseInteger(text);
    if (!count || *count < 1 || *count > kMostBodies) {
      return Fail(ErrorCode::kConfig, "label '" + label + "' has '" + text + "' people", OptionPlace("bodies"),
                  "write a whole number from 1 to 6");
    }
  }
  const bool has_body_field =
      s.person.find("{body}") != std::string::npos || s.recording.find("{body}") != std::string::npos;
  if ((!s.bodies.empty() || s.subjects > 1) && !has_body_field) {
    return Fail(ErrorCode::kConfig, "several people of one file would be one clip", OptionPlace("bodies"),
                "write {body} into ingest.source.person, e.g. person: 'P{person}{body}'");
  }
  return {};
}

bool HasDepthBeside(const SourceOptions& source) {
  return DriverOf(source.format).gives == EvidenceKind::kKeypoints && !source.depth_files.empty();
}

Expected<double> MetresPerUnit(const std::string& units) {
  const std::vector<std::string_view> words = SplitBlanks(units);
  const std::optional<double> factor = words.size() == 2 ? ParseDouble(words[0]) : 1.0;
  const bool is_length = (words.size() == 1 || words.size() == 2) && factor && std::isfinite(*factor) && *factor > 0.0;
  std::vector<std::string> names;
  for (const UnitSpelling& known : UnitSpellings()) {
    if (known.unit != Unit::kMetre) continue;
    names.emplace_back(known.spelling);
    if (is_length && words.back() == known.spelling) return *factor * (known.numerator / known.denominator);
  }
  return Fail(ErrorCode::kConfig, "'" + units + "' is no unit of length", OptionPlace("units"),
              DidYouMean(units, names, "write m, cm, mm, inch, or a length such as '0.05 m'"));
}

int BodiesOf(const SourceOptions& s, const std::string& label) {
  const auto bodies = s.bodies.find(label);
  if (bodies == s.bodies.end()) return static_cast<int>(s.subjects);
  return static_cast<int>(std::clamp(ParseInteger(bodies->second).value_or(1), 1LL, kMostBodies));
}

Status CheckSource(const SourceOptions& s) {
  if (Status written = CheckFilledIn(s); !written) return written;
  if (s.name.empty()) return Fail(ErrorCode::kConfig, "the source has no name", OptionPlace("name"));
  if (s.name.find_first_of("/#") != std::string::npos) {
    return Fail(ErrorCode::kConfig, "the name '" + s.name + "' holds '/' or '#'", OptionPlace("name"));
  }
  const FormatDriver& driver = DriverOf(s.format);
  if (driver.to_clip == nullptr) {
    std::vector<std::string> names;
    for (const FormatDriver& known : FormatDrivers()) {
      if (known.to_clip != nullptr) names.emplace_back(known.name);
    }
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare its format", OptionPlace("format"),
                "one of " + JoinTexts(names));
  }
  if (s.files.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' has no pattern of file names", OptionPlace("files"),
                "e.g. 'a{action}_s{person}_e{repetition}.txt'");
  }
  if (s.axes.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare its axes", OptionPlace("axes"),
                "write where its x, y and z point, e.g. axes: '+x +y +z' (right-handed, y up, a person faces +z)");
  }
  if (Status units = CheckSourceUnits(s); !units) return units;
  if (!driver.states_rate && !s.rate_hz && !HasTimes(s)) {
    return Fail(ErrorCode::kConfig,
                "source '" + s.name + "' does not declare its frame rate, and " + s.format + " files do not either",
                OptionPlace("rate"), "write e.g. `rate: 30 Hz`");
  }
  if (Status own = CheckOwnOptions(s, driver); !own) return own;
  if (driver.check != nullptr) {
    if (Status rules = driver.check(s); !rules) return rules;
  }
  if (driver.needs_skeleton && s.skeleton.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare its skeleton", OptionPlace("skeleton"),
                "an array needs one, e.g. humanact12");
  }
  for (const auto& [option, set] : {std::pair{"known_issue_lists", !s.known_issue_lists.empty()},
                                    std::pair{"label_table", !s.label_table.empty()}}) {
    if (s.container.empty() || !set) continue;
    return Fail(ErrorCode::kConfig, "it is not read of clips in one file", OptionPlace(option),
                "remove it; `exclude` and `labels` exclude clips by name");
  }
  if (driver.needs_container && s.container.empty()) {
    return Fail(ErrorCode::kConfig, "source '" + s.name + "' does not declare which file holds its clips",
                OptionPlace("container"), "e.g. 'humanact12poses.pkl'");
  }
  return {};
}

}  // namespace mocurate
