#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/comparison.h"
#include "ingest/item_facts.h"
#include "ingest/read_motions.h"
#include "ingest/sources/array_clips.h"
#include "ingest/sources/damaged_frames.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"

namespace mocurate {
namespace {

double MissingShare(const Clip& clip) {
  std::size_t points = 0, unseen = 0;
  for (const KeypointView& view : clip.evidence.keypoint_views) {
    for (std::size_t i = 2; i < view.values.size(); i += 3) ++points, unseen += view.values[i] == 0.0 ? 1 : 0;
  }
  if (points > 0) return static_cast<double>(unseen) / static_cast<double>(points);
  if (!clip.evidence.tracks) return 0.0;
  const std::vector<double>& confidence = clip.evidence.tracks->confidence;
  const auto missing = std::count(confidence.begin(), confidence.end(), 0.0);
  return static_cast<double>(missing) / static_cast<double>(std::max<std::size_t>(1, confidence.size()));
}

/// Farther from the origin than any capture volume in most frames: the unit is wrong. In fewer it is a position jump.
Status CheckExtent(const Clip& clip, const std::string& name) {
  constexpr double kFarthest = 1000.0;
  const JointPositions none;
  const JointPositions& joints = clip.evidence.tracks ? clip.evidence.tracks->positions
                                 : clip.motion        ? clip.motion->joints
                                                      : none;
  int far = 0, first = -1;
  double value = 0.0;
  for (int f = 0; f < joints.frames; ++f) {
    const auto columns = std::ptrdiff_t{3} * joints.joints;
    const auto begin = joints.xyz.begin() + f * columns, end = begin + columns;
    const auto found = std::find_if(begin, end, [](double x) { return std::abs(x) > kFarthest; });
    if (found == end) continue;
    if (first < 0) first = f, value = *found;
    ++far;
  }
  if (2 * far <= joints.frames) return {};
  return Fail(ErrorCode::kInconsistent,
              "a joint is " + RoundedText(value, 6) + " m from the origin in frame " + std::to_string(first), name,
              "is ingest.source.units right? Captures reach at most 1000 m");
}

/// A unit that the body contradicts explains how far it is; the clip is refused for that.
bool RefuseUnit(std::vector<Finding>& findings) {
  bool refused = false;
  for (Finding& finding : findings) {
    if (finding.code != "units_contradiction") continue;
    finding.action = FindingAction::kRefused;
    refused = true;
  }
  return refused;
}

int JointCount(const Clip& clip) {
  if (clip.evidence.tracks) return clip.evidence.tracks->positions.joints;
  if (!clip.evidence.keypoint_names.empty()) return static_cast<int>(clip.evidence.keypoint_names.size());
  return clip.motion ? clip.motion->joint_count() : 0;
}

/// Of the source file, followed by its .asf if it has one; with depth views, of the hashes of that file and of every
/// image, view after view.
std::string EvidenceHash(const std::string& bytes, const Evidence& evidence) {
  std::string hash = Sha256Hex(bytes);
  if (evidence.depth_views.empty()) return hash;
  for (const DepthView& view : evidence.depth_views) {
    for (const std::string& image : view.sha256) hash += '\n' + image;
    for (const std::string& mask : view.mask_sha256) hash += '\n' + mask;
  }
  return Sha256Hex(hash);
}

/// `name`: of the file or entry, with its ending; of a clip of many files its recording.
void Complete(const SourceOptions& source, const NamedFile& named, const std::string& name, const std::string& bytes,
              IngestedClip& ingested) {
  Clip& clip = ingested.clip;
  if (DriverOf(source.format).stored) {
    if (!source.licence.empty()) clip.identity.licence = source.licence;
  } else {
    clip.identity = named.identity;
    clip.identity.begin_frame = 0;
    clip.identity.end_frame = FrameCount(clip);
    clip.role = named.role;
  }
  clip.label = named.label;
  if (!DriverOf(source.format).stored || !named.fine_label.empty()) clip.fine_label = named.fine_label;
  clip.evidence_sha256 = EvidenceHash(bytes, clip.evidence);
  clip.provenance["file"] = name;
  clip.provenance["source_axes"] = source.axes;
  if (!source.units.empty()) clip.provenance["source_units"] = source.units;
  if (!source.skeleton.empty()) clip.provenance["source_skeleton"] = source.skeleton;
  if (!source.markers.empty()) {
    nlohmann::json markers = nlohmann::json::array();
    for (const MarkerPlace& marker : source.markers)
      markers.push_back(
          {{"point", marker.point}, {"joint", marker.joint}, {"offset", marker.offset}, {"spread", marker.spread}});
    clip.provenance["markers"] = markers.dump();
  }
  if (!named.style.empty()) clip.provenance["style"] = named.style;
  if (!named.performance.empty()) clip.provenance["performance"] = named.performance;
}

nlohmann::json Summary(const Clip& clip, const std::string& style) {
  nlohmann::json summary = {
      {"clip", clip.id()},         {"person", clip.identity.person},     {"recording", clip.identity.recording},
      {"label", clip.label},       {"frames", FrameCount(clip)},         {"joints", JointCount(clip)},
      {"rate_hz", clip.rate.hz()}, {"missing_share", MissingShare(clip)}};
  if (!style.empty()) summary["style"] = style;
  if (const auto first = clip.provenance.find("first_frame"); first != clip.provenance.end()) {
    summary["first_frame"] = ParseDouble(first->second).value_or(0.0) + clip.identity.begin_frame;
  }
  if (!clip.identity.session.empty()) summary["session"] = clip.identity.session;
  if (!clip.identity.view.empty()) summary["view"] = clip.identity.view;
  const std::size_t views = clip.evidence.depth_views.size() + clip.evidence.keypoint_views.size();
  if (views > 0) summary["views"] = views;
  return summary;
}

/// A file that cannot be used. What its numbers contradict is a finding as well.
Expected<StageOutcome> Unusable(const SourceOptions& source, const Error& error, const std::string& item) {
  const bool contradicts = error.reason == Reason::kCount || error.reason == Reason::kOtherLayout ||
                           error.reason == Reason::kOtherRate || error.reason == Reason::kViewNumbering;
  if (!contradicts) return tl::unexpected<Error>(error);
  StageOutcome outcome;
  outcome.kind = OutcomeKind::kRefused;
  outcome.error = error;
  if (error.reason == Reason::kCount && source.damaged_rows == DamagedRows::kRefuse) {
    outcome.error.hint +=
        std::string(error.hint.empty() ? "" : ", or ") + "set ingest.source.damaged_rows: report to take what it holds";
  }
  outcome.findings.push_back(MakeFinding(FaultCode(error, source.format), Severity::kError, error.number,
                                         error.where + ": " + error.what, FindingAction::kRefused));
  outcome.findings.back().clip = item;
  return outcome;
}

/// The files of a clip that several cameras saw; `named` is of all of them then.
Expected<std::vector<ViewFile>> ReadViewFiles(const SourceOptions& source, const std::vector<StageInput>& inputs,
                                              NamedFile& named) {
  std::vector<ViewFile> views;
  std::string together;
  for (const StageInput& input : inputs) {
    if (input.role != "source") continue;
    const Expected<NamedFile> own = ReadName(source, input.name, named.body);
    if (!own) return Forward(own);
    Expected<std::string> bytes = ReadFile(input.path);
    if (!bytes) return Forward(bytes);
    together += (together.empty() ? "" : "+") + own->identity.view;
    views.push_back({own->identity.view, input.name, *std::move(bytes), own->fields});
  }
  named.identity.view = together;
  return views;
}

/// No artifact: the last finding names the rule.
StageOutcome Excluded(const DroppedClip& dropped, const std::string& name, const std::string& way_out,
                      StageOutcome outcome) {
  Finding rule = dropped.finding;
  rule.clip = outcome.findings.empty() ? name : outcome.findings.front().clip;
  const auto at = std::find(outcome.findings.begin(), outcome.findings.end(), rule);
  if (at != outcome.findings.end()) outcome.findings.erase(at);
  outcome.findings.push_back(rule);
  outcome.kind = OutcomeKind::kExcluded;
  outcome.summary["threshold"] = dropped.threshold;
  outcome.error = Error{ErrorCode::kInconsistent, rule.message, name, way_out};
  return outcome;
}

}  // namespace

Expected<ReadItem> ReadSourceItem(const StageRequest& request) {
  nlohmann::json declared = request.options;
  const Expected<ItemFacts> item_facts = TakeFacts(declared);
  if (!item_facts) return Forward(item_facts);
  const ItemFacts& facts = *item_facts;
  const Expected<SourceOptions> source = OptionsFromJson<SourceOptions>(declared);
  if (!source) return Forward(source);
  if (Status ok = CheckSource(*source); !ok) return Forward(ok);
  auto input = std::find_if(request.inputs.begin(), request.inputs.end(),
                            [](const StageInput& candidate) { return candidate.role == "source"; });
  const bool gathered = DriverOf(source->format).gathered();
  if (gathered && input == request.inputs.end()) input = request.inputs.begin();  // depth images
  if (input == request.inputs.end()) return Fail(ErrorCode::kInternal, "no input with the role 'source'", request.item);
  const std::string& name = facts.entry_name.empty() ? input->name : facts.entry_name;
  Expected<NamedFile> named = ReadName(*source, name, std::max(1, static_cast<int>(facts.body)));
  if (!named) return Forward(named);
  if (facts.labelled) named->label = facts.label;
  if (!facts.role.empty()) named->role = facts.role;
  named->identity.recording += RecordingSuffix(facts.array);
  if (gathered) named->fields["file"] = named->identity.recording;
  const bool whole = source->container.empty() && !gathered && !DriverOf(source->format).holds_clips;
  const Expected<std::string> bytes = whole ? ReadFile(input->path) : std::string();
  if (!bytes) return Forward(bytes);
  if (whole && Trim(*bytes).empty()) return EmptyFile(name);
  SourceFile file{*source, *named, name, *bytes, {}};
  file.facts = facts;
  file.container = input->path;
  std::string read = *bytes;
  if (source->views.multi_view) {
    Expected<std::vector<ViewFile>> views = ReadViewFiles(*source, request.inputs, *named);
    if (!views) return Forward(views);
    file.views = std::move(*views);
    for (std::size_t i = 1; i < file.views.size(); ++i) read += file.views[i].bytes;
  }
  for (const StageInput& candidate : request.inputs) {
    if (candidate.role == "depth") file.depth_files.push_back(candidate);
    if (candidate.role == "calibration") file.calibrations.push_back(candidate);
    if (candidate.role == "source" && gathered) file.frame_files.push_back(candidate);
    if (candidate.role != "skeleton_file") continue;
    Expected<std::string> skeleton = ReadFile(candidate.path);
    if (!skeleton) return Forward(skeleton);
    file.skeleton_name = candidate.name;
    file.skeleton_bytes = *std::move(skeleton);
    read += file.skeleton_bytes;
  }
  Expected<IngestedClip> ingested = DriverOf(source->format).to_clip(file);
  if (!ingested) {
    Expected<StageOutcome> unusable = Unusable(*source, ingested.error(), request.item);
    if (!unusable) return Forward(unusable);
    return ReadItem{{}, std::move(*unusable)};
  }
  const bool checks = !source->checks.IgnoresAll();
  if (checks && !InvalidatesPoses(ingested->findings)) CheckBody(*source, *ingested);
  if (Status near = CheckExtent(ingested->clip, name); !near && !RefuseUnit(ingested->findings)) return Forward(near);
  const std::optional<DroppedClip> dropped = checks ? CheckClip(*source, *named, *ingested) : std::nullopt;
  if (!facts.known_issue.empty()) {
    ingested->findings.push_back(FrameFinding("known_issue", 0, 0, "", 0.0, facts.known_issue));
  }
  Complete(*source, *named, gathered ? named->identity.recording : name,
           ingested->content.empty() ? read : ingested->content, *ingested);
  if (!facts.label_text.empty()) ingested->clip.provenance["label_text"] = facts.label_text;
  const std::optional<Finding> missing = dropped ? std::nullopt : ApplyGapRule(*source, *ingested);
  if (missing) ingested->findings.push_back(*missing);
  for (Finding& finding : ingested->findings) finding.clip = ingested->clip.id();

  StageOutcome outcome;
  outcome.findings = ingested->findings;
  outcome.summary = Summary(ingested->clip, named->style);
  if (!facts.label_text.empty()) outcome.summary["label_text"] = facts.label_text;
  outcome.summary["source_sha256"] = ingested->clip.evidence_sha256;
  for (const auto& [code, shown] : ingested->shown) {
    outcome.summary["shown"][code] = {{"contradicts", shown.contradicts}, {"weight", shown.weight}};
  }
  if (dropped) {
    const std::string way_out = "ingest.source.checks." + dropped->finding.code + ".action: report keeps such clips";
    return ReadItem{std::move(ingested->clip), Excluded(*dropped, input->name, way_out, std::move(outcome))};
  }
  if (missing) {
    return ReadItem{std::move(ingested->clip),
                    Excluded({*missing, missing->limit}, input->name,
                             "a larger ingest.source.max_missing keeps such clips", std::move(outcome))};
  }
  for (const Finding& finding : outcome.findings) {
    if (finding.severity == Severity::kError) outcome.kind = OutcomeKind::kSuspect;
    if (finding.action != FindingAction::kRefused) continue;
    outcome.kind = OutcomeKind::kRefused;
    outcome.summary["threshold"] =
        finding.limit > 0.0 ? finding.limit : ContradictionThreshold(finding.code, finding.value, *source);
    outcome.error = Error{ErrorCode::kInconsistent, finding.message, name,
                          source->on_contradiction == OnContradiction::kRefuse
                              ? "set ingest.source.on_contradiction: flag to keep such clips"
                              : "captures reach at most 1000 m from the origin"};
    // Its message says the place and the ways out.
    if (finding.code == "rate_implausible") outcome.error = {ErrorCode::kInconsistent, finding.message, "", ""};
    break;
  }
  return ReadItem{std::move(ingested->clip), std::move(outcome)};
}

Expected<StageOutcome> IngestStage(const StageRequest& request) {
  Expected<ReadItem> read = ReadSourceItem(request);
  if (!read) return Forward(read);
  if (!HasArtifact(read->outcome.kind)) return std::move(read->outcome);
  if (Status written = WriteEvidence(read->clip, request.output, read->outcome.findings); !written) {
    return Forward(written);
  }
  return std::move(read->outcome);
}

}  // namespace mocurate
