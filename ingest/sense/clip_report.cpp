#include "ingest/sense/clip_report.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/quality/rate.h"
#include "ingest/sense/check_report.h"
#include "ingest/sense/comparison.h"

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

namespace {

/// All of the answer but findings.
Json FactsOfClip(const ObservedClip& clip, const std::string& file, const std::optional<SourceOptions>& source,
                 const ClipMeasures& m, const Statements& said) {
  Json json = {{"id", file + clip.id}, {"file", file}, {"format", clip.format}};
  json["frames"] = ReportValue(clip.frames, "measured", 1.0, clip.layout_evidence);
  const bool guessed = clip.format == "joint_table" && !source;
  json["joints"] = ReportValue(clip.joints > 0 ? Json(clip.joints) : Json(), guessed ? "measured" : "declared",
                               guessed ? clip.skeleton_confidence : 1.0, clip.layout_evidence);
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
  return json;
}

void TellMissing(const ClipMeasures& m, const std::string& where, Json& findings) {
  if (m.missing_share <= kManyMissing) return;
  findings.push_back(
      InspectionFinding("many_missing", Severity::kWarning, where, FourDecimals(m.missing_share),
                        FormatDouble(FourDecimals(100.0 * m.missing_share)) + " % of the joints are missing"));
}

/// What is left of a unit and an up once what contradicts them is known.
struct Believed {
  std::string units, up;
  bool contradicted = false;  ///< nothing is told of speeds then
};

Believed BelievedOf(const Statements& said, const ClipMeasures& m, bool units_doubted) {
  Believed believed{said.units.empty() ? m.units.value : said.units, said.up.empty() ? m.up.value : said.up,
                    units_doubted};
  if (units_doubted) believed.units = "";
  for (const Comparison& comparison : CompareFrame(said, m)) {
    if (!comparison.contradicts) continue;
    const bool units = comparison.code == "units_contradiction", up = comparison.code == "up_contradiction";
    if (units) believed.units = m.units.value;
    if (up) believed.up = m.up.value;
    believed.contradicted = believed.contradicted || units || up;
  }
  return believed;
}

}  // namespace

Json DeclaredReport(const ObservedClip& clip, const std::string& file, const SourceOptions& source, Json& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  TellMissing(m, file + clip.id, findings);
  const Statements said = StatementsOf(clip, source);
  Json json = FactsOfClip(clip, file, source, m, said);
  const Believed believed = BelievedOf(said, m, false);
  json["rate_hz"] = ReportedRate(clip, source, m, RateShown(clip, believed.units, believed.up));
  return json;
}

Json ClipReport(const ObservedClip& clip, const std::string& file, Json& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  const Statements said = StatementsOf(clip, std::nullopt);
  const std::string where = file + clip.id;
  Json json = FactsOfClip(clip, file, std::nullopt, m, said);
  const auto remarked = [&](const char* code) {
    return std::any_of(clip.remarks.begin(), clip.remarks.end(),
                       [&](const Finding& remark) { return remark.code == code; });
  };
  for (const Finding& remark : clip.remarks) {
    findings.push_back(
        InspectionFinding(remark.code, remark.severity, where, FourDecimals(remark.value), remark.message));
  }
  if (clip.rate_doubt) {
    const Finding& doubt = *clip.rate_doubt;
    findings.push_back(InspectionFinding(doubt.code, doubt.severity, where, doubt.value, doubt.message));
  }
  TellMissing(m, where, findings);
  for (const Comparison& comparison : CompareFrame(said, m)) {
    if (!comparison.contradicts) continue;
    findings.push_back(
        InspectionFinding(comparison.code, Severity::kError, where, comparison.value, comparison.message));
  }
  const Believed believed = BelievedOf(said, m, remarked("units_contradiction"));
  const bool body = !remarked("not_joint_positions");
  json["rate_hz"] =
      ReportedRate(clip, std::nullopt, m, body ? RateShown(clip, believed.units, believed.up) : RateMeasure());
  const bool known = !believed.contradicted;
  ReportChecks(clip, known ? believed.units : "", known ? believed.up : "", where, findings);
  return json;
}

}  // namespace mocurate
