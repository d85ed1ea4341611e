#include "ingest/inspect/clip_report.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/quality/rate.h"
#include "ingest/inspect/check_report.h"
#include "ingest/inspect/comparison.h"

namespace mocurate {
namespace {

constexpr double kManyMissing = 0.2;  // share of missing samples worth a warning
constexpr double kSetSure = 0.5;      // files of a set may have been thinned out
constexpr double kClockSure = 0.9;    // of a column that steps as a clock does

/// A declared text, with what was measured beside it; without one the measured one.
Reported<std::string> DeclaredText(const std::string& text, const std::string& who, const Measured& measured) {
  if (text.empty()) return MeasuredText(measured);
  Reported<std::string> reported = AsDeclared(text, who);
  if (!measured.value.empty()) {
    reported.measured = Estimate<std::string>{measured.value, FourDecimals(measured.confidence), measured.evidence};
  }
  return reported;
}

std::string JoinedText(const std::string& first, const std::string& second) {
  return first + (first.empty() || second.empty() ? "" : "; ") + second;
}

std::optional<RateRange> RangeOf(const RateLimits& limits) {
  if (!limits.IsConclusive()) return std::nullopt;
  RateRange range;
  if (limits.lowest > 0.0) range.lowest = FourDecimals(limits.lowest);
  range.highest = FourDecimals(limits.highest);
  return range;
}

/// By the file, the source or the set; beside it, or without it, the range that the motion allows.
Reported<double> ReportedRate(const RawClip& clip, const std::optional<SourceOptions>& source,
                              const RateLimits& limits) {
  const std::string shown = limits.IsConclusive() ? "the motion fits " + limits.Range() + ": " + limits.evidence : "";
  Reported<double> rate;
  if (source && source->rate_hz) {
    rate = Report(source->rate_hz, Provenance::kDeclared, 1.0, "declared by the source '" + source->name + "'");
  } else if (clip.rate_hz) {
    rate = Report(clip.rate_hz, clip.rate_measured ? Provenance::kMeasured : Provenance::kDeclared,
                  clip.rate_measured ? kClockSure : 1.0, clip.rate_evidence);
  } else if (clip.set_rate_hz > 0.0 && limits.Allows(clip.set_rate_hz)) {
    rate = Report<double>(clip.set_rate_hz, Provenance::kDeclared, kSetSure,
                          JoinedText(clip.set_evidence, "the file holds no times"));
  } else {
    const std::string silence = clip.rate_evidence.empty() ? "the file does not declare it" : clip.rate_evidence;
    return Unknown<double>(JoinedText(silence, shown));
  }
  if (limits.IsConclusive()) rate.measured = Estimate<double>{std::nullopt, 0.0, shown};
  return rate;
}

Reported<std::vector<std::optional<Vector3d>>> FirstFrame(const RawClip& clip) {
  if (clip.positions.empty()) return Unknown<std::vector<std::optional<Vector3d>>>(clip.silence);
  std::vector<std::optional<Vector3d>> points(static_cast<std::size_t>(clip.positions.joints));
  for (std::size_t j = 0; j < points.size(); ++j) {
    const bool seen = clip.confidence.empty() || clip.confidence[j] > 0.0;
    if (seen) points[j] = Vector3d(clip.positions.at(0, static_cast<int>(j))).unaryExpr(&FourDecimals);
  }
  return Report(std::optional(std::move(points)), Provenance::kDeclared, 1.0, "in the file's own unit and axes");
}

Reported<double> ReportedMissingShare(const RawClip& clip, const ClipMeasures& m) {
  const auto share = [](double value, const std::string& evidence) {
    return Report<double>(FourDecimals(value), Provenance::kMeasured, 1.0, evidence);
  };
  if (clip.missing_share) {
    const bool stated = !clip.missing_evidence.empty();
    return share(*clip.missing_share, stated ? clip.missing_evidence : "of the numbers of the file");
  }
  if (!clip.missing_evidence.empty()) return Unknown<double>(clip.missing_evidence);
  if (clip.positions.empty()) return Unknown<double>(clip.silence);
  return share(m.missing_share, clip.zeros.empty() ? "joints that are no numbers, or have confidence 0"
                                                   : "joints that are zero, no numbers, or have confidence 0");
}

/// Measures, with the reason where there was nothing to measure.
ClipMeasures MeasuresOf(const RawClip& clip) {
  ClipMeasures m = Measure(clip);
  if (!clip.positions.empty()) return m;
  for (Measured* measured : {&m.units, &m.up, &m.handedness, &m.facing, &m.axes}) measured->evidence = clip.silence;
  return m;
}

/// All of the report but the rate.
InspectedClip FactsOfClip(const RawClip& clip, const std::string& file, const std::optional<SourceOptions>& source,
                          const ClipMeasures& m, const DeclaredFrame& said) {
  InspectedClip report;
  report.id = file + clip.id;
  report.file = file;
  report.format = clip.format;
  report.frames = Report<int>(clip.frames, Provenance::kMeasured, 1.0, clip.layout_evidence);
  const bool guessed = clip.format == "joint_table" && !source;
  report.joints = Report(clip.joints > 0 ? std::optional(clip.joints) : std::nullopt,
                         guessed ? Provenance::kMeasured : Provenance::kDeclared,
                         guessed ? clip.skeleton.confidence : 1.0, clip.layout_evidence);
  report.people = Report<int>(clip.people, Provenance::kDeclared, 1.0, clip.people_evidence);
  report.fewest_people = clip.fewest_people;
  report.skeleton = Report(clip.skeleton.value, clip.skeleton.from, clip.skeleton.confidence, clip.skeleton.evidence);
  report.units = DeclaredText(said.units, said.who, m.units);
  report.up = DeclaredText(said.up, said.who, m.up);
  report.handedness = DeclaredText(said.handedness, said.who, m.handedness);
  report.facing = DeclaredText(said.facing, said.who, m.facing);
  report.axes = DeclaredText(said.axes, said.who, m.axes);
  report.missing_share = ReportedMissingShare(clip, m);
  report.joint_names = clip.names;
  report.first_frame = FirstFrame(clip);
  report.facts = clip.facts;
  return report;
}

void ReportMissing(const ClipMeasures& m, const std::string& where, std::vector<Finding>& findings) {
  const auto zeros = [](const Finding& finding) { return finding.code == "zero_frames"; };
  if (m.missing_share <= kManyMissing || std::any_of(findings.begin(), findings.end(), zeros)) return;  // one cause
  findings.push_back(FindingAt(where, "many_missing", Severity::kWarning, FourDecimals(m.missing_share),
                               FormatDouble(FourDecimals(100.0 * m.missing_share)) + " % of the joints are missing"));
}

/// What is left of a unit and an up once what contradicts them is known.
struct Believed {
  std::string units, up;
  bool contradicted = false;  ///< speeds are not reported then
};

Believed BelievedOf(const DeclaredFrame& said, const ClipMeasures& m, bool units_suspect) {
  Believed believed{said.units.empty() ? m.units.value : said.units, said.up.empty() ? m.up.value : said.up,
                    units_suspect};
  if (units_suspect) believed.units = "";
  for (const Comparison& comparison : CompareFrame(said, m)) {
    if (!comparison.contradicts) continue;
    const bool units = comparison.finding.code == "units_contradiction",
               up = comparison.finding.code == "up_contradiction";
    if (units) believed.units = m.units.value;
    if (up) believed.up = m.up.value;
    believed.contradicted = believed.contradicted || units || up;
  }
  return believed;
}

}  // namespace

Reported<std::string> MeasuredText(const Measured& measured) {
  return Report<std::string>(measured.value, Provenance::kMeasured, measured.confidence, measured.evidence);
}

InspectedClip DeclaredReport(const RawClip& clip, const std::string& file, const SourceOptions& source,
                             std::vector<Finding>& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  ReportMissing(m, file + clip.id, findings);
  const DeclaredFrame said = DeclaredFrameOf(clip, source);
  InspectedClip report = FactsOfClip(clip, file, source, m, said);
  const Believed believed = BelievedOf(said, m, false);
  const RateLimits rate = RateShown(clip, believed.units, believed.up);
  report.rate_hz = ReportedRate(clip, source, rate);
  report.rate_range = RangeOf(rate);
  return report;
}

InspectedClip ClipReport(const RawClip& clip, const std::string& file, std::vector<Finding>& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  const DeclaredFrame said = DeclaredFrameOf(clip, std::nullopt);
  const std::string where = file + clip.id;
  InspectedClip report = FactsOfClip(clip, file, std::nullopt, m, said);
  for (const Finding& remark : clip.remarks) findings.push_back(FindingAt(where, Rounded(remark)));
  if (clip.rate_finding) findings.push_back(FindingAt(where, *clip.rate_finding));
  ReportMissing(m, where, findings);
  for (const Comparison& comparison : CompareFrame(said, m)) {
    if (comparison.contradicts) findings.push_back(FindingAt(where, comparison.finding));
  }
  const Believed believed = BelievedOf(said, m, HasFinding(clip.remarks, "units_contradiction"));
  const bool body = !HasFinding(clip.remarks, "not_joint_positions");
  const RateLimits rate = body ? RateShown(clip, believed.units, believed.up) : RateLimits();
  report.rate_hz = ReportedRate(clip, std::nullopt, rate);
  report.rate_range = RangeOf(rate);
  const bool known = !believed.contradicted;
  ReportChecks(clip, known ? believed.units : "", known ? believed.up : "", where, findings);
  return report;
}

}  // namespace mocurate
