// What the body itself says against the declaration of its source: the measure of `mocurate inspect`, on the clip as it
// will be kept.

#include "ingest/sources/body_check.h"

#include "core/base/text.h"
#include "ingest/sense/comparison.h"
#include "ingest/sense/path_sense.h"
#include "ingest/sense/remark.h"
#include "ingest/sense/tree_points.h"

namespace mocurate {
namespace {

constexpr int kFewestBodyFrames = 8;  // fewer tell nothing about the order of joints

/// Back to the units and axes of the file, in which the declaration speaks.
JointPositions InFile(const SourceOptions& source, JointPositions positions) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  const Expected<double> scale = MetresPerUnit(source.units.empty() ? "m" : source.units);
  if (!axes || !scale) return positions;
  const Matrix3d file_from_metres = axes->canonical_from_source.transpose() / *scale;
  for (int f = 0; f < positions.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) {
      positions.at(f, j) = (file_from_metres * Vector3d(positions.at(f, j))).eval();
    }
  }
  return positions;
}

/// Whether files of the format hold a path of the root beside the body's own poses.
bool PathIsRead(SourceFormat format) {
  return format == SourceFormat::kAmass || format == SourceFormat::kExpmap || format == SourceFormat::kBvh ||
         format == SourceFormat::kAsfAmc;
}

/// The clip as an inspection of its file would see it; nothing where it has no joints.
std::optional<ObservedClip> Observed(const SourceOptions& source, const Clip& clip) {
  ObservedClip observed;
  const bool listed = source.format == SourceFormat::kJointTable || source.format == SourceFormat::kNpy;
  if (clip.evidence.tracks) {
    observed.positions = InFile(source, clip.evidence.tracks->positions);
    observed.confidence = clip.evidence.tracks->confidence;
  } else if (clip.motion) {
    observed.positions = InFile(source, clip.motion->joints);
  } else {
    return std::nullopt;
  }
  observed.frames = observed.positions.frames;
  observed.joints = observed.positions.joints;
  observed.rate_hz = clip.rate.hz();
  if (listed && !source.skeleton.empty() && observed.frames >= kFewestBodyFrames) DeclareOrder(source, observed);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  observed.points = clip.evidence.tracks
                        ? PointsOfBody(clip.evidence.tracks->names, skeleton ? skeleton->get() : nullptr)
                        : PointsOfBody(*clip.motion->skeleton);
  if (source.format == SourceFormat::kAmass || source.format == SourceFormat::kExpmap) {
    observed.lengths_assumed = true;  // the skeleton's: only the path of the root is the file's
    observed.root_scale = MeasureRootScale(observed.positions, observed.points);
  }
  if (PathIsRead(source.format)) {
    if (const auto path = DoubtPathAxes(observed.positions, observed.points))
      observed.remarks.push_back(RemarkOf(*path));
  }
  if (observed.units.empty()) observed.units = "m";
  return observed;
}

/// What to do about a contradiction, in the words of the declaration.
std::string Advice(const SourceOptions& source, const Comparison& comparison) {
  if (comparison.code == "units_contradiction" && source.units.empty())
    return comparison.message + "; files of this format are in metres: repair the files";
  if (comparison.code == "units_contradiction") return comparison.message + "; mend ingest.source.units";
  if (comparison.code == "up_contradiction") {
    return "with axes '" + source.axes + "' " + comparison.message + "; mend ingest.source.axes";
  }
  return comparison.message + ": with axes '" + source.axes + "' the motion is " + comparison.measured +
         "-handed, or left and right are exchanged; mend ingest.source.axes";
}

}  // namespace

void CheckPoints(const SourceOptions& source, const ObservedClip& observed, IngestedClip& ingested) {
  const auto contradict = [&](const std::string& code, double value, std::string message) {
    Finding finding;
    finding.code = code;
    finding.severity = Severity::kError;
    finding.value = value;
    finding.message = std::move(message);
    finding.action =
        source.on_contradiction == OnContradiction::kRefuse ? FindingAction::kRefused : FindingAction::kFlagged;
    ingested.findings.push_back(finding);
  };
  for (const Comparison& comparison : CompareFrame(StatementsOf(observed, source), Measure(observed))) {
    const auto told = ingested.shown.find(comparison.code);
    if (told != ingested.shown.end() && told->second.contradicts) continue;
    ingested.shown[comparison.code] = {comparison.contradicts, comparison.weight};
    if (comparison.contradicts) contradict(comparison.code, comparison.value, Advice(source, comparison));
  }
  for (const Remark& remark : observed.remarks) {
    if (remark.code == "path_contradiction") contradict(remark.code, remark.value, remark.message);
    if (remark.code != "joint_order_contradiction") continue;
    contradict(remark.code, remark.value, remark.message + "; mend ingest.source.joints");
  }
}

void CheckBody(const SourceOptions& source, IngestedClip& ingested) {
  const std::optional<ObservedClip> observed = Observed(source, ingested.clip);
  if (!observed) return;
  CheckPoints(source, *observed, ingested);
  if (observed->skeleton_from == "declared" && !observed->skeleton_evidence.empty()) {
    ingested.shown["joint_order_contradiction"] = {!observed->remarks.empty(), 1.0};
  }
}

}  // namespace mocurate
