#include <set>

#include "canon/frames/facing.h"
#include "canon/options.h"
#include "canon/stage_parts.h"
#include "canon/stages.h"
#include "canon/trim/trim.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/operations.h"
#include "core/motion/tracks.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

/// The clip with a motion that canonicalising starts from.
Expected<Clip> ReadInputClip(const StageRequest& request, const CanonOptions& options, std::vector<Finding>& findings) {
  if (const StageInput* fitted = FindInput(request, "motion")) {
    auto dataset = ReadDataset(fitted->path);
    if (dataset) {
      if (dataset->clips.size() != 1) {
        return Fail(ErrorCode::kInconsistent,
                    Counted(static_cast<long long>(dataset->clips.size()), "clip") + ", one expected", fitted->name);
      }
      findings = dataset->findings;
      return dataset->clips.front();
    }
    auto given = ReadEvidence(fitted->path, &findings);
    if (!given) return Forward(dataset);
    if (!given->motion) {
      return Fail(ErrorCode::kInconsistent, "the clip has no motion, only evidence", fitted->name,
                  "set fitting.method to something other than none");
    }
    return given;
  }
  const StageInput* tracked = FindInput(request, "tracks");
  if (tracked == nullptr) return Fail(ErrorCode::kInternal, "canon got neither 'motion' nor 'tracks'", request.item);
  auto clip = ReadEvidence(tracked->path, &findings);
  if (!clip) return Forward(clip);
  const auto skeleton = LoadSkeleton(options.skeleton);
  if (!skeleton) return Forward(skeleton);
  if (!clip->evidence.tracks) {
    return Fail(ErrorCode::kInconsistent, "the clip has no joint tracks", tracked->name);
  }
  auto motion = MotionFromTracks(*clip->evidence.tracks, *skeleton, clip->rate);
  if (!motion) return Forward(motion);
  clip->motion = std::move(*motion);
  return clip;
}

Finding DoubtfulHeading(const Clip& clip, const Heading& heading) {
  Finding finding;
  finding.clip = clip.id();
  finding.code = "heading_from_forward_axis";
  finding.value = heading.horizontal;
  finding.message = "the hip axis is nearly vertical in the anchor frame; yaw was read from the forward axis";
  finding.action = "kept";
  return finding;
}

Expected<std::vector<Clip>> Canonicalise(const CanonOptions& options, Clip clip, std::vector<Finding>& findings) {
  clip.evidence = Evidence();
  if (!options.rate.empty()) {
    const auto rate = FrameRate::Parse(options.rate);
    if (!rate) return Forward(rate);
    clip = Resample(clip, *rate);
  }
  std::vector<Clip> kept;
  for (const KeptSpan& span : FindSpans(options.trim, clip, findings)) {
    auto cut = Cut(clip, span.begin, span.end);
    if (!cut) return Forward(cut);
    cut->label = span.label;
    const auto heading = FaceFront(options.facing, *cut);
    if (!heading) return Forward(heading);
    if (heading->source == YawSource::kForwardAxis) findings.push_back(DoubtfulHeading(*cut, *heading));
    cut->provenance["heading"] = heading->source == YawSource::kHipAxis ? "hip_axis" : "forward_axis";
    kept.push_back(std::move(*cut));
  }
  SortById(kept);
  return kept;
}

}  // namespace

Expected<StageOutcome> CanonStage(const StageRequest& request) {
  const auto options = OptionsFromJson<CanonOptions>(request.options, "canon");
  if (!options) return Forward(options);
  Dataset dataset;
  auto clip = ReadInputClip(request, *options, dataset.findings);
  if (!clip) return Forward(clip);
  dataset.skeleton = clip->motion->rest_pose();
  dataset.joints_only = clip->motion->joints_only();
  dataset.created_by = CreatedBy();
  StageOutcome outcome;
  std::set<std::string> labels;
  for (const Segment& segment : clip->segments) labels.insert(segment.label);
  if (options->trim.rule == TrimRule::kAnnotated) outcome.summary["labels"] = labels;
  auto kept = Canonicalise(*options, std::move(*clip), outcome.findings);
  if (!kept) return Forward(kept);
  if (kept->empty()) {
    // FindSpans says of every span that it leaves out which rule did so.
    outcome.kind = OutcomeKind::kLeftOut;
    const std::string reason = outcome.findings.empty() ? "nothing left" : outcome.findings.back().message;
    outcome.error = Error{ErrorCode::kInconsistent, reason, request.item, "canon.trim holds the rule"};
    const auto limit =
        outcome.findings.empty() ? std::nullopt : LimitOfTrim(options->trim, outcome.findings.back().code);
    if (limit) outcome.summary["threshold"] = *limit;
    return outcome;
  }
  dataset.clips = std::move(*kept);
  dataset.findings.insert(dataset.findings.end(), outcome.findings.begin(), outcome.findings.end());
  int frames = 0;
  for (const Clip& c : dataset.clips) frames += c.motion->frame_count();
  outcome.summary["clips"] = dataset.clips.size();
  outcome.summary["frames"] = frames;
  if (Status written = WriteDataset(dataset, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
