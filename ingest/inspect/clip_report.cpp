#include "ingest/inspect/clip_report.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/base/text.h"
#include "core/quality/duplicates.h"
#include "core/quality/rate.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/measure.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kUsualRate = 30.0;

/// Metres, y up, from units of the file; the heading is whatever it becomes.
Matrix3d MetresYUp(double metres, const std::string& up) {
  Matrix3d turn = Matrix3d::Identity();
  if (up.size() == 2 && up[1] >= 'x' && up[1] <= 'z') {
    Vector3d axis = Vector3d::Zero();
    axis[up[1] - 'x'] = up[0] == '-' ? -1.0 : 1.0;
    turn = SwingBetween(axis, Vector3d::UnitY()).toRotationMatrix();
  }
  return metres * turn;
}

/// What the file declares is zero stands there for the checks, as it does for whoever ingests it.
std::vector<double> CheckedConfidence(const RawClip& clip) {
  std::vector<double> confidence = clip.confidence;
  for (std::size_t i = 0; i < clip.zeros.size(); ++i) {
    if (clip.zeros[i] != 0) confidence[i] = 1.0;
  }
  return confidence;
}

/// A root that stays where it is while a joint that hangs on it carries the body through the world is no part of the
/// body.
void ExcludeIdleRoot(const RawClip& clip, std::vector<double>& confidence) {
  const int frames = clip.positions.frames, joints = clip.positions.joints;
  if (clip.parents.empty() || frames < 2) return;
  const auto moves = [&](int j) {
    const Vector3d first = clip.positions.at(0, j);
    for (int f = 1; f < frames; ++f) {
      if (clip.positions.at(f, j) != first) return true;
    }
    return false;
  };
  for (int root = 0; root < joints; ++root) {
    if (clip.parents[static_cast<std::size_t>(root)] >= 0 || moves(root)) continue;
    bool carried = false;
    for (int j = 0; j < joints && !carried; ++j)
      carried = clip.parents[static_cast<std::size_t>(j)] == root && moves(j);
    if (!carried) continue;
    if (confidence.empty()) confidence.assign(static_cast<std::size_t>(frames) * static_cast<std::size_t>(joints), 1.0);
    for (int f = 0; f < frames; ++f)
      confidence[static_cast<std::size_t>(f) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(root)] = 0.0;
  }
}

/// A clip in metres with y up.
struct ClipInMetres {
  ClipInMetres(const RawClip& clip, const std::string& units, const std::string& up, double rate_hz);
  TrackedPoints view(const RawClip& clip) const {
    return {positions, confidence, time_s, clip.names, bones.parents, bones.rest_lengths, clip.points};
  }

  bool known = false;  ///< unit and up are
  JointPositions positions;
  std::vector<double> confidence;
  std::vector<double> time_s;
  PointBones bones;
};

ClipInMetres::ClipInMetres(const RawClip& clip, const std::string& units, const std::string& up, double rate_hz)
    : positions(clip.positions.frames, clip.positions.joints), confidence(clip.confidence) {
  const auto metres = MetresPerUnit(units);
  known = metres.has_value() && !up.empty();
  const Matrix3d map = MetresYUp(metres ? *metres : 1.0, up);
  for (int f = 0; f < positions.frames; ++f) {
    time_s.push_back(f / rate_hz);
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = map * clip.positions.at(f, j);
  }
  // An order that was guessed by its bones says nothing new of them.
  if (clip.skeleton.from != Provenance::kDeclared || static_cast<int>(clip.names.size()) != clip.joints) return;
  if (const auto skeleton = KnownSkeleton(clip.skeleton.value.value_or("")))
    bones = BonesBetween(clip.names, **skeleton);
}

/// What a clip shows, to compare it with others; empty where unit or up is not known.
MotionSignature SignatureShown(const RawClip& clip, const std::string& units, const std::string& up) {
  if (clip.positions.empty()) return {};
  const ClipInMetres metres(clip, units, up, kUsualRate);
  return metres.known ? SignatureOf(metres.view(clip)) : MotionSignature();
}

/// The rates that a clip's motion allows; no limits where unit or up is not known. `units` and `up` as declared or
/// measured.
RateLimits RateShown(const RawClip& clip, const std::string& units, const std::string& up) {
  if (clip.positions.empty()) return {};
  const ClipInMetres metres(clip, units, up, kUsualRate);
  return metres.known ? MeasureRate(metres.view(clip)) : RateLimits();
}

/// Appends what is wrong with a clip that no source declares, by FindDefects, as `mocurate run` finds it. Where unit or
/// up is not known, only what needs neither is asked, of images nothing; without a rate speeds are those of 30 Hz, and
/// frames may have been excluded.
void ReportChecks(const RawClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  std::vector<Finding>& findings) {
  if (clip.positions.empty() || units == "px") return;
  const std::optional<double> rate = clip.rate_finding ? std::nullopt : clip.rate_hz;
  ClipInMetres metres(clip, units, up, rate.value_or(kUsualRate));
  metres.confidence = CheckedConfidence(clip);
  std::vector<Finding> unseen = FindNeverObserved(metres.view(clip));
  ExcludeIdleRoot(clip, metres.confidence);
  const CheckOptions options;
  std::vector<Finding> found = FindDefects(options, metres.view(clip), rate, metres.known, rate ? 0 : kLostWithoutRate);
  ExplainZeros(clip.format, found);
  found.insert(found.end(), std::make_move_iterator(unseen.begin()), std::make_move_iterator(unseen.end()));
  if (!HasFinding(clip.remarks, "no_joint_seen")) {
    std::vector<Finding> remarks = clip.remarks;
    const auto before = static_cast<std::ptrdiff_t>(remarks.size());
    NoteEmptyFrames(metres.confidence, metres.positions.frames, remarks);
    found.insert(found.end(), remarks.begin() + before, remarks.end());
  }
  for (const Finding& finding : found) {
    if (options.ActionFor(finding.code) == OnFinding::kIgnore || HasFinding(clip.remarks, finding.code)) continue;
    // A tree's joint may lie at its origin, and a root whose path is not there does.
    if (finding.code == "zero_joint" && (!clip.parents.empty() || HasFinding(clip.remarks, "path_missing"))) continue;
    findings.push_back(FindingAt(PlaceOf(finding, where), Rounded(finding)));
  }
}

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
InspectedClip FactsOfClip(const RawClip& clip, const std::string& file, const ClipMeasures& m,
                          const DeclaredFrame& said) {
  InspectedClip report;
  report.id = file + clip.id;
  report.file = file;
  report.format = clip.format;
  report.frames = Report<int>(clip.frames, Provenance::kMeasured, 1.0, clip.layout_evidence);
  report.joints = Report(clip.joints > 0 ? std::optional(clip.joints) : std::nullopt,
                         clip.joints_measured ? Provenance::kMeasured : Provenance::kDeclared,
                         clip.joints_measured ? clip.skeleton.confidence : 1.0, clip.layout_evidence);
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
  if (m.missing_share <= kManyMissing || HasFinding(findings, "zero_frames")) return;  // one cause
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

std::string PlaceOf(const Finding& finding, const std::string& where) {
  std::string place = where;
  if (finding.frame_end > finding.frame_begin) {
    place += " frames " + std::to_string(finding.frame_begin) + "-" + std::to_string(finding.frame_end);
  }
  if (!finding.joint.empty()) place += " joint " + finding.joint;
  return place;
}

Reported<std::string> MeasuredText(const Measured& measured) {
  return Report<std::string>(measured.value, Provenance::kMeasured, measured.confidence, measured.evidence);
}

InspectedClip DeclaredReport(const RawClip& clip, const std::string& file, const SourceOptions& source,
                             std::vector<Finding>& findings) {
  const ClipMeasures m = MeasuresOf(clip);
  ReportMissing(m, file + clip.id, findings);
  const DeclaredFrame said = DeclaredFrameOf(clip, source);
  InspectedClip report = FactsOfClip(clip, file, m, said);
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
  InspectedClip report = FactsOfClip(clip, file, m, said);
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

void InspectedMotions::Add(const RawClip& clip, const InspectedClip& report) {
  const std::optional<std::string>&units = report.units.value, &up = report.up.value;
  if (clip.positions.empty() || !units || !up || *units == "px") return;
  ids_.push_back(report.id);
  signatures_.push_back(SignatureShown(clip, *units, *up));
}

void InspectedMotions::Compare(const CheckOptions& options, std::vector<Finding>& findings) const {
  for (const Duplicate& pair : FindDuplicates(signatures_, DuplicateLimitsOf(options))) {
    const Finding finding = DuplicateFinding(pair, ids_[pair.first], signatures_[pair.first], signatures_[pair.second]);
    if (options.ActionFor(finding.code) == OnFinding::kIgnore) continue;
    findings.push_back(FindingAt(PlaceOf(finding, ids_[pair.second]), finding));
  }
}

}  // namespace mocurate
