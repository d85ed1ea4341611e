// Compares the body with the declaration of its source, by the measures of `mocurate inspect` on the clip that will be
// kept.

#include "ingest/sources/source_file.h"

#include "core/base/text.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {
namespace {

constexpr int kFewestBodyFrames = 8;  // fewer do not determine the order of joints

/// Back to the units and axes of the file, which the declaration refers to.
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

/// The advice about a contradiction, by the declaration's option.
std::string Advice(const SourceOptions& source, const Comparison& comparison) {
  const std::string &code = comparison.finding.code, &message = comparison.finding.message;
  if (code == "units_contradiction" && source.units.empty())
    return message + "; files of this format are in metres: repair the files";
  if (code == "units_contradiction") return message + "; correct ingest.source.units";
  if (code == "up_contradiction") return "with axes '" + source.axes + "' " + message + "; correct ingest.source.axes";
  return message + ": with axes '" + source.axes + "' the motion is " + comparison.measured +
         "-handed, or left and right are exchanged; correct ingest.source.axes";
}

/// For a clip without positions.
void SilenceOf(const Clip& clip, RawClip& observed) {
  observed.joints = static_cast<int>(clip.evidence.keypoint_names.size());
  observed.units = clip.evidence.keypoint_views.empty() ? "m" : "px";
  observed.silence = clip.evidence.clouds                   ? "point clouds, no joints"
                     : clip.evidence.keypoint_views.empty() ? "depth views, no joints"
                                                            : "keypoints without depth";
  const std::size_t views = clip.evidence.keypoint_views.size() + clip.evidence.depth_views.size();
  observed.layout_evidence = clip.evidence.clouds ? "one file a frame" : Counted(static_cast<long long>(views), "view");
}

}  // namespace

RawClip ReadRawClip(const SourceOptions& source, const Clip& clip) {
  RawClip observed;
  observed.frames = FrameCount(clip);
  observed.rate_hz = clip.rate.hz();
  observed.rate_evidence = "of the clip";
  observed.layout_evidence = "declared by the source";
  observed.skeleton = AsDeclared(source.skeleton, "");
  for (const auto& [key, text] : clip.provenance) observed.facts.emplace_back(key, text);
  const FormatDriver& driver = DriverOf(source.format);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (clip.evidence.tracks) {
    const JointTracks& tracks = *clip.evidence.tracks;
    observed.positions = InFile(source, tracks.positions);
    observed.confidence = tracks.confidence;
    observed.names = tracks.names;
    observed.points = PointsOfBody(tracks.names, skeleton ? skeleton->get() : nullptr);
  } else if (clip.motion) {
    observed.positions = InFile(source, clip.motion->joints);
    for (const Joint& joint : clip.motion->skeleton->joints) {
      observed.names.push_back(joint.name);
      observed.parents.push_back(joint.parent);
    }
    observed.points = PointsOfBody(*clip.motion->skeleton);
    if (source.skeleton.empty())
      observed.skeleton = AsDeclared("own tree of " + std::to_string(observed.names.size()) + " joints", "");
  } else {
    SilenceOf(clip, observed);
    return observed;
  }
  observed.joints = observed.positions.joints;
  observed.units = "m";
  if (driver.lists_joints && !source.skeleton.empty() && observed.frames >= kFewestBodyFrames)
    CompareOrder(source, observed);
  if (driver.lengths_assumed) {
    observed.lengths_assumed = true;  // the skeleton's: only the path of the root is the file's
    observed.root_scale = MeasureRootScale(observed.positions, observed.points);
  }
  return observed;
}

void CheckPoints(const SourceOptions& source, const RawClip& observed, IngestedClip& ingested) {
  for (const Comparison& comparison : CompareFrame(DeclaredFrameOf(observed, source), Measure(observed))) {
    const Finding& finding = comparison.finding;
    const auto shown = ingested.shown.find(finding.code);
    if (shown != ingested.shown.end() && shown->second.contradicts) continue;
    ingested.shown[finding.code] = {comparison.contradicts, comparison.weight};
    if (!comparison.contradicts) continue;
    ingested.findings.push_back(Contradiction(source, finding.code, finding.value, Advice(source, comparison)));
  }
  for (const Finding& remark : observed.remarks) {
    if (remark.code != "joint_order_contradiction") continue;
    ingested.findings.push_back(
        Contradiction(source, remark.code, remark.value, remark.message + "; correct ingest.source.joints"));
  }
}

void CheckBody(const SourceOptions& source, IngestedClip& ingested) {
  if (!ingested.clip.evidence.tracks && !ingested.clip.motion) return;
  const RawClip observed = ReadRawClip(source, ingested.clip);
  CheckPoints(source, observed, ingested);
  if (!observed.skeleton.evidence.empty())
    ingested.shown["joint_order_contradiction"] = {!observed.remarks.empty(), 1.0};
}

}  // namespace mocurate
