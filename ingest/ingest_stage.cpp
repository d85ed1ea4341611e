#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"

namespace mocurate {
namespace {

Expected<IngestedClip> ReadClip(const SourceFile& file) {
  switch (file.source.format) {
    case SourceFormat::kJointTable:
      return ReadJointTableClip(file);
    case SourceFormat::kBvh:
      return ReadBvhClip(file);
    case SourceFormat::kNpy:
      return ReadNpyClip(file);
    case SourceFormat::kDepthSequence:
      return ReadDepthSequenceClip(file);
    case SourceFormat::kNtuSkeleton:
      return ReadNtuSkeletonClip(file);
    case SourceFormat::kAsfAmc:
      return ReadAsfAmcClip(file);
    case SourceFormat::kAmass:
      return ReadAmassClip(file);
    case SourceFormat::kNone:
      break;
  }
  return Fail(ErrorCode::kConfig, "the source does not say its format", "ingest.source.format");
}

int FrameCount(const Clip& clip) {
  if (clip.evidence.tracks) return clip.evidence.tracks->positions.frames;
  if (clip.motion) return clip.motion->frame_count();
  return clip.evidence.depth_views.empty() ? 0 : static_cast<int>(clip.evidence.depth_views[0].files.size());
}

double MissingShare(const Clip& clip) {
  if (!clip.evidence.tracks) return 0.0;
  const std::vector<double>& confidence = clip.evidence.tracks->confidence;
  const auto missing = std::count(confidence.begin(), confidence.end(), 0.0);
  return static_cast<double>(missing) / static_cast<double>(std::max<std::size_t>(1, confidence.size()));
}

/// Farther from the origin than any capture volume: the unit is wrong, or the number is.
Status CheckExtent(const Clip& clip, const std::string& name) {
  constexpr double kFarthest = 1000.0;
  const JointPositions none;
  const JointPositions& joints = clip.evidence.tracks ? clip.evidence.tracks->positions
                                 : clip.motion        ? clip.motion->joints
                                                      : none;
  for (std::size_t i = 0; i < joints.xyz.size(); ++i) {
    if (std::abs(joints.xyz[i]) <= kFarthest) continue;
    const std::size_t point = i / 3;
    return Fail(ErrorCode::kInconsistent,
                "a joint is " + RoundedText(joints.xyz[i], 6) + " m from the origin in frame " +
                    std::to_string(point / static_cast<std::size_t>(joints.joints)),
                name, "is ingest.source.units right? Captures reach at most 1000 m");
  }
  return {};
}

int JointCount(const Clip& clip) {
  if (clip.evidence.tracks) return clip.evidence.tracks->positions.joints;
  return clip.motion ? clip.motion->joint_count() : 0;
}

/// Of the source file, followed by its .asf if it has one; with depth views, of the hashes of that file and of every
/// image, view after view.
std::string EvidenceHash(const std::string& bytes, const Evidence& evidence) {
  std::string hash = Sha256Hex(bytes);
  if (evidence.depth_views.empty()) return hash;
  for (const DepthView& view : evidence.depth_views) {
    for (const std::string& image : view.sha256) hash += '\n' + image;
  }
  return Sha256Hex(hash);
}

void Complete(const SourceOptions& source, const NamedFile& named, const std::string& bytes, IngestedClip& ingested) {
  Clip& clip = ingested.clip;
  clip.identity = named.identity;
  clip.identity.begin_frame = 0;
  clip.identity.end_frame = FrameCount(clip);
  clip.label = named.label;
  clip.role = named.role;
  clip.evidence_sha256 = EvidenceHash(bytes, clip.evidence);
  clip.provenance["file"] = named.fields.at("file");
  clip.provenance["source_axes"] = source.axes;
  if (!source.units.empty()) clip.provenance["source_units"] = source.units;
  if (!named.style.empty()) clip.provenance["style"] = named.style;
  for (Finding& finding : ingested.findings) finding.clip = clip.id();
}

nlohmann::json Summary(const Clip& clip, const std::string& style) {
  nlohmann::json summary = {{"clip", clip.id()},
                            {"person", clip.identity.person},
                            {"label", clip.label},
                            {"frames", FrameCount(clip)},
                            {"joints", JointCount(clip)},
                            {"rate_hz", clip.rate.hz()},
                            {"missing_share", MissingShare(clip)}};
  if (!style.empty()) summary["style"] = style;
  if (!clip.evidence.depth_views.empty()) summary["views"] = clip.evidence.depth_views.size();
  return summary;
}

}  // namespace

Expected<StageOutcome> IngestStage(const StageRequest& request) {
  nlohmann::json declared = request.options;
  const int body = declared.value("body", 1);
  const std::string annotation = declared.value("annotation", std::string());
  declared.erase("body");
  declared.erase("annotation");
  const Expected<SourceOptions> source = OptionsFromJson<SourceOptions>(declared);
  if (!source) return Forward(source);
  if (Status ok = CheckSource(*source); !ok) return Forward(ok);
  const auto input = std::find_if(request.inputs.begin(), request.inputs.end(),
                                  [](const StageInput& candidate) { return candidate.role == "source"; });
  if (input == request.inputs.end()) return Fail(ErrorCode::kInternal, "no input with the role 'source'", request.item);
  const Expected<NamedFile> named = ReadName(*source, input->name, body);
  if (!named) return Forward(named);
  const Expected<std::string> bytes = ReadFile(input->path);
  if (!bytes) return Forward(bytes);
  SourceFile file{*source, *named, input->name, *bytes, {}};
  file.annotation = annotation;
  std::string read = *bytes;
  for (const StageInput& candidate : request.inputs) {
    if (candidate.role == "depth") file.depth_files.push_back(candidate);
    if (candidate.role != "skeleton_file") continue;
    Expected<std::string> skeleton = ReadFile(candidate.path);
    if (!skeleton) return Forward(skeleton);
    file.skeleton_name = candidate.name;
    file.skeleton_bytes = *std::move(skeleton);
    read += file.skeleton_bytes;
  }
  Expected<IngestedClip> ingested = ReadClip(file);
  if (!ingested) return Forward(ingested);
  if (Status near = CheckExtent(ingested->clip, input->name); !near) return Forward(near);
  CheckBody(*source, *ingested);
  Complete(*source, *named, read, *ingested);

  StageOutcome outcome;
  outcome.findings = ingested->findings;
  outcome.summary = Summary(ingested->clip, named->style);
  for (const auto& [code, shown] : ingested->shown) {
    outcome.summary["shown"][code] = {{"contradicts", shown.contradicts}, {"weight", shown.weight}};
  }
  for (const Finding& finding : outcome.findings) {
    if (finding.severity == Severity::kError) outcome.kind = OutcomeKind::kDoubtful;
    if (finding.action != "refused") continue;
    outcome.kind = OutcomeKind::kRefused;
    outcome.error = Error{ErrorCode::kInconsistent, finding.message, input->name,
                          "set ingest.source.on_contradiction: flag to keep such clips"};
    return outcome;
  }
  if (Status written = WriteEvidence(ingested->clip, request.output, outcome.findings); !written)
    return Forward(written);
  return outcome;
}

}  // namespace mocurate
