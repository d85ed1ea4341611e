#include "ingest/sense/clip_report.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/quality/rate.h"
#include "ingest/clip_checks.h"
#include "ingest/format_facts.h"
#include "ingest/sense/check_report.h"
#include "ingest/sense/comparison.h"
#include "ingest/sources/pattern.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kManyMissing = 0.2;  // share of missing samples worth a warning
constexpr double kRateTold = 0.6;     // least confidence of a measured rate that is told as a value
constexpr double kSetSure = 0.5;      // files of a set may have been thinned out

using Json = nlohmann::json;

/// A declared value, with what was measured beside it.
Json DeclaredValue(Json value, const std::string& who, const Measured& measured) {
  if (value.is_string() && value.get<std::string>().empty()) return ReportValue(measured);
  Json json = ReportValue(std::move(value), "declared", 1.0, who);
  if (!measured.value.empty()) {
    json["measured"] = {
        {"value", measured.value}, {"confidence", FourDecimals(measured.confidence)}, {"evidence", measured.evidence}};
  }
  return json;
}

/// A declared unit that is none.
void TellUnknownUnits(const Statements& said, const std::string& where, Json& findings) {
  const auto declared = MetresPerUnit(said.units);
  if (declared) return;
  findings.push_back(InspectionFinding("units_unknown", Severity::kError, where, 0.0, declared.error().Message()));
}

/// A file of another format than the source declares.
void CompareFormat(const ObservedClip& clip, const SourceOptions& source, const std::string& where, Json& findings) {
  if (Reads(source.format, clip.format)) return;
  findings.push_back(
      InspectionFinding("format_contradiction", Severity::kError, where, 0.0,
                        "the format is declared " + FormatName(source.format) + ", the file is " + clip.format));
}

void CompareRates(const ObservedClip& clip, const SourceOptions& source, const std::string& where, Json& findings) {
  const auto differs = clip.rate_hz ? CompareRate(source, *clip.rate_hz) : std::nullopt;
  if (!differs) return;
  findings.push_back(InspectionFinding(differs->code, Severity::kError, where, differs->value, differs->message));
}

std::string JoinedText(const std::string& first, const std::string& second) {
  return first + (first.empty() || second.empty() ? "" : "; ") + second;
}

/// "range": [lowest, highest] Hz, null where there is no limit.
void AddRange(const RateMeasure& measure, Json& json) {
  if (!measure.Tells()) return;
  const auto limit = [](double hz) { return hz > 0.0 && std::isfinite(hz) ? Json(FourDecimals(hz)) : Json(); };
  json["range"] = {limit(measure.lowest), limit(measure.highest)};
}

/// By the file, the source, flights of the body, or the set; where none tells, the range that the motion allows.
Json ReportedRate(const ObservedClip& clip, const std::optional<SourceOptions>& source, const ClipMeasures& m,
                  const RateMeasure& measure) {
  const std::string shown = measure.Tells() ? "the motion fits " + measure.Range() + ": " + measure.Words() : "";
  Json json;
  if (source && source->rate_hz) {
    json = DeclaredValue(*source->rate_hz, "said by the source '" + source->name + "'", m.rate);
  } else if (clip.rate_hz) {
    json = ReportValue(*clip.rate_hz, "declared", 1.0, clip.rate_evidence);
  } else if (clip.set_rate_hz > 0.0 && measure.Allows(clip.set_rate_hz)) {
    json = ReportValue(clip.set_rate_hz, "declared", kSetSure, JoinedText(clip.set_says, "the file holds no times"));
  } else if (measure.rate_hz() && measure.confidence() > kRateTold) {
    json = ReportValue(std::round(*measure.rate_hz() * 10.0) / 10.0, "measured", measure.confidence(), shown);
    AddRange(measure, json);
    return json;
  } else {
    const std::string silence = clip.rate_evidence.empty() ? "the file does not say it" : clip.rate_evidence;
    json = ReportValue(Json(), "unknown", 0.0, JoinedText(silence, shown.empty() ? m.rate.evidence : shown));
    AddRange(measure, json);
    return json;
  }
  if (!measure.Tells()) return json;
  json["measured"] = {{"value", measure.rate_hz() ? Json(FourDecimals(*measure.rate_hz())) : Json()},
                      {"confidence", FourDecimals(measure.confidence())},
                      {"evidence", shown}};
  AddRange(measure, json["measured"]);
  return json;
}

Json FirstFrame(const ObservedClip& clip) {
  if (clip.positions.empty()) return ReportValue(Json(), "unknown", 0.0, clip.silence);
  Json points = Json::array();
  for (int j = 0; j < clip.positions.joints; ++j) {
    const bool seen = clip.confidence.empty() || clip.confidence[j] > 0.0;
    const auto at = clip.positions.at(0, j);
    points.push_back(
        {{"joint", clip.names.empty() ? Json() : Json(clip.names[j])},
         {"position", seen ? Json({FourDecimals(at.x()), FourDecimals(at.y()), FourDecimals(at.z())}) : Json()}});
  }
  return ReportValue(std::move(points), "declared", 1.0, "in the file's own unit and axes");
}

/// Returns how many frames the name speaks of that the clip does not hold.
int AddNameFields(const ObservedClip& clip, const SourceOptions& source, const std::string& file,
                  const std::string& declared_name, Json& json, Json& findings) {
  const auto named = ReadName(source, declared_name);
  if (!named) {
    TellUnread(source, file, named.error(), findings);
    return 0;
  }
  std::vector<Finding> contradictions;
  JudgeName(source, *named, clip.frames, contradictions);
  for (const Finding& finding : contradictions) {
    findings.push_back(
        InspectionFinding(finding.code, finding.severity, file + clip.id, finding.value, finding.message));
  }
  json["item"] = named->item();
  json["person"] = ReportValue(named->identity.person, "declared", 1.0, "name of the file");
  json["label"] = ReportValue(named->label, "declared", 1.0, "name of the file");
  return FramesLost(source, *named, clip.frames);
}

Json ReportedMissingShare(const ObservedClip& clip, const ClipMeasures& m) {
  if (clip.missing_share) {
    const bool told = !clip.missing_evidence.empty();
    return ReportValue(FourDecimals(*clip.missing_share), "measured", 1.0,
                       told ? clip.missing_evidence : "of the numbers of the file");
  }
  if (!clip.missing_evidence.empty()) return ReportValue(Json(), "unknown", 0.0, clip.missing_evidence);
  if (clip.positions.empty()) return ReportValue(Json(), "unknown", 0.0, clip.silence);
  return ReportValue(FourDecimals(m.missing_share), "measured", 1.0,
                     clip.zeros.empty() ? "joints that are no numbers, or have confidence 0"
                                        : "joints that are zero, no numbers, or have confidence 0");
}

/// Measures, with the reason where there was nothing to measure.
ClipMeasures MeasuresOf(const ObservedClip& clip) {
  ClipMeasures m = Measure(clip);
  if (!clip.positions.empty()) return m;
  for (Measured* measured : {&m.units, &m.up, &m.handedness, &m.facing, &m.axes}) measured->evidence = clip.silence;
  return m;
}

}  // namespace

Json ReportValue(Json value, const char* from, double confidence, const std::string& evidence) {
  const bool unknown = value.is_null() || (value.is_string() && value.get<std::string>().empty());
  if (unknown) return {{"value", nullptr}, {"from", "unknown"}, {"confidence", 0.0}, {"evidence", evidence}};
  return {
      {"value", std::move(value)}, {"from", from}, {"confidence", FourDecimals(confidence)}, {"evidence", evidence}};
}

Json ReportValue(const Measured& measured) {
  return ReportValue(measured.value, "measured", measured.confidence, measured.evidence);
}

Json InspectionFinding(const std::string& code, Severity severity, const std::string& where, double value,
                       const std::string& message) {
  return {{"code", code}, {"severity", Name(severity)}, {"where", where}, {"value", value}, {"message", message}};
}

void TellUnread(const SourceOptions& source, const std::string& file, const Error& why, Json& findings) {
  const auto pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (pattern && why.code == ErrorCode::kInconsistent && pattern->Match(why.where)) {
    const bool by_rule = source.other_labels == OtherLabels::kLeaveOut;
    findings.push_back(InspectionFinding(by_rule ? "label_left_out" : "label_unknown",
                                         by_rule ? Severity::kInfo : Severity::kWarning, file, 0.0, why.Message()));
    return;
  }
  if (source.other_files == OtherFiles::kIgnore) return;
  findings.push_back(InspectionFinding("name_mismatch", Severity::kWarning, file, 0.0, why.Message()));
}

Json ClipReport(const ObservedClip& clip, const std::string& file, const std::optional<SourceOptions>& source,
                const std::string& declared_name, Json& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  const Statements said = StatementsOf(clip, source);
  const std::string where = file + clip.id;
  Json json = {{"id", where}, {"file", file}, {"format", clip.format}};
  const bool by_name = source && !declared_name.empty();
  const int lost_frames = by_name ? AddNameFields(clip, *source, file, declared_name, json, findings) : 0;
  json["frames"] = ReportValue(clip.frames, "measured", 1.0, clip.layout_evidence);
  const bool has_joints = clip.joints > 0;
  json["joints"] = ReportValue(
      has_joints ? Json(clip.joints) : Json(), clip.format == "joint_table" && !source ? "measured" : "declared",
      clip.format == "joint_table" && !source ? clip.skeleton_confidence : 1.0, clip.layout_evidence);
  json["people"] = ReportValue(clip.people, "declared", 1.0, clip.people_evidence);
  json["people_per_frame"] =
      ReportValue(Json{{"min", clip.fewest_people}, {"max", clip.people}}, "declared", 1.0, clip.people_evidence);
  json["skeleton"] =
      ReportValue(clip.skeleton, clip.skeleton_from.c_str(), clip.skeleton_confidence, clip.skeleton_evidence);
  json["units"] = DeclaredValue(said.units, said.who, m.units);
  json["up"] = DeclaredValue(said.up, said.who, m.up);
  json["handedness"] = DeclaredValue(said.handedness, said.who, m.handedness);
  json["facing"] = DeclaredValue(said.facing, said.who, m.facing);
  json["axes"] = DeclaredValue(said.axes, said.who, m.axes);
  json["missing_share"] = ReportedMissingShare(clip, m);
  json["first_frame"] = FirstFrame(clip);
  if (!clip.facts.empty()) {
    Json facts = Json::object();
    for (const auto& [key, text] : clip.facts) facts[key] = text;
    json["facts"] = std::move(facts);
  }

  for (const Remark& remark : clip.remarks) {
    findings.push_back(
        InspectionFinding(remark.code, remark.severity, where, FourDecimals(remark.value), remark.message));
  }
  if (clip.rate_doubt && !(source && source->rate_hz)) {
    const Finding& doubt = *clip.rate_doubt;
    findings.push_back(InspectionFinding(doubt.code, doubt.severity, where, doubt.value, doubt.message));
  }
  if (m.missing_share > kManyMissing) {
    findings.push_back(
        InspectionFinding("many_missing", Severity::kWarning, where, FourDecimals(m.missing_share),
                          FormatDouble(FourDecimals(100.0 * m.missing_share)) + " % of the joints are missing"));
  }
  const bool pixels = clip.positions.empty() && clip.units == "px" && said.units == "px";
  if (!said.units.empty() && !pixels && (source || !clip.positions.empty())) TellUnknownUnits(said, where, findings);
  std::string units = said.units.empty() ? m.units.value : said.units;
  std::string up = said.up.empty() ? m.up.value : said.up;
  bool contradicted = std::any_of(clip.remarks.begin(), clip.remarks.end(),
                                  [](const Remark& remark) { return remark.code == "units_contradiction"; });
  if (contradicted) units = "";  // the path is of another unit than the body: nothing is told of its speed
  for (const Comparison& comparison : CompareFrame(said, m)) {
    if (!comparison.contradicts) continue;
    // Otherwise one wrong word would make a defect of every frame.
    contradicted = contradicted || comparison.code == std::string("units_contradiction") ||
                   comparison.code == std::string("up_contradiction");
    if (comparison.code == std::string("units_contradiction")) units = m.units.value;
    if (comparison.code == std::string("up_contradiction")) up = m.up.value;
    findings.push_back(
        InspectionFinding(comparison.code, Severity::kError, where, comparison.value, comparison.message));
  }
  if (source) CompareFormat(clip, *source, where, findings);
  if (source) CompareRates(clip, *source, where, findings);
  const bool no_body = std::any_of(clip.remarks.begin(), clip.remarks.end(),
                                   [](const Remark& remark) { return remark.code == "not_joint_positions"; });
  json["rate_hz"] = ReportedRate(clip, source, m, no_body ? RateMeasure() : RateShown(clip, units, up));
  ReportChecks(clip, source, contradicted ? "" : units, contradicted ? "" : up, lost_frames, where, findings);
  return json;
}

}  // namespace mocurate
