#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "canon/frames/facing.h"
#include "canon/options.h"
#include "canon/recipes/action_triples.h"
#include "canon/recipes/spans_file.h"
#include "canon/stage_parts.h"
#include "canon/stages.h"
#include "canon/trim/by_example.h"
#include "canon/trim/trim.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/gaps.h"
#include "core/motion/motion.h"
#include "core/motion/operations.h"
#include "core/pipeline/stage.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

/// The marked spans of the rule by_example: motions by label, at the dataset's rate. Inputs: the table of spans (role
/// kExamplesRole) and the clips that it names (role kExampleRole). Error kConfig where a span is outside its clip;
/// those of reading.
Expected<std::map<std::string, std::vector<Motion>>> ReadExamples(const CanonOptions& options,
                                                                  const std::vector<StageInput>& inputs) {
  std::vector<ListedSpan> spans;
  for (const StageInput& input : inputs) {
    if (input.role != kExamplesRole) continue;
    auto read = ReadSpans(input.path);
    if (!read) return Forward(read);
    spans = *std::move(read);
  }
  std::map<std::string, std::vector<Motion>> examples;
  for (const StageInput& input : inputs) {
    if (input.role != kExampleRole) continue;
    auto clip = ReadMotionClip(input, nullptr);
    if (!clip) return Forward(clip);
    clip->evidence = Evidence();
    if (Status near = CheckFrameSteps(*clip); !near) return Forward(near);
    for (const StageInput& floor : inputs) {
      if (floor.role != kExampleFloorRole || floor.name != input.name) continue;
      if (Status levelled = LevelByFloor(floor, *clip); !levelled) return Forward(levelled);
    }
    std::vector<Finding> outside;
    ApplySpans(spans, *clip, outside);
    if (Status few = CheckOverlap(*clip, clip->id()); !few) return Forward(few);
    for (const Finding& finding : outside) {
      if (finding.severity != Severity::kError) continue;
      return Fail(ErrorCode::kConfig, finding.message, finding.clip, "repair canon.trim.by_example.examples");
    }
    if (!options.rate.empty()) {
      const auto rate = FrameRate::Parse(options.rate);
      if (!rate) return Forward(rate);
      *clip = Resample(*clip, *rate);
    }
    TrimOptions marked;
    marked.rule = TrimRule::kAnnotated;
    marked.min_length_s = 0.0;
    for (const KeptSpan& span : FindSpans(marked, *clip, outside)) {
      if (span.end - span.begin < 2) {
        return Fail(ErrorCode::kConfig,
                    "the marked span of '" + span.label + "' at " +
                        RoundedText(clip->motion->rate.FrameTime(span.begin)) + " s is shorter than two frames",
                    clip->id(), "mark a longer span in canon.trim.by_example.examples");
      }
      const auto cut = Cut(*clip, span.begin, span.end);
      if (!cut) return Forward(cut);
      examples[span.label].push_back(*cut->motion);
    }
  }
  return examples;
}

/// The clip with the motion to canonicalise.
Expected<Clip> ReadInputClip(const StageRequest& request, const CanonOptions& options, std::vector<Finding>& findings) {
  if (const StageInput* fitted = FindInput(request, "motion")) return ReadMotionClip(*fitted, &findings);
  const StageInput* tracked = FindInput(request, "tracks");
  if (tracked == nullptr)
    return Fail(ErrorCode::kInternal, "the stage canon has neither 'motion' nor 'tracks'", request.item);
  auto clip = ReadEvidence(tracked->path, &findings);
  if (!clip) return Forward(clip);
  const auto skeleton = LoadSkeleton(options.skeleton);
  if (!skeleton) return Forward(skeleton);
  if (!clip->evidence.tracks) {
    return Fail(ErrorCode::kInconsistent, "the clip has no joint tracks", tracked->name);
  }
  auto motion = MotionFromTracks(*clip->evidence.tracks, *skeleton, clip->rate, MaxGapOf(*clip));
  if (!motion) return Forward(motion);
  clip->motion = std::move(*motion);
  return clip;
}

/// Why a heading is suspect: its axis is nearly vertical in the anchor frame. Nothing for a reliable one.
std::optional<Finding> SuspectHeading(const FacingOptions& options, const Clip& clip, const Heading& heading) {
  const auto about = [&](const char* code, const std::string& message) {
    return MakeFinding(code, Severity::kWarning, heading.horizontal, message, FindingAction::kKept, clip.id());
  };
  if (heading.source == YawSource::kForwardAxis) {
    return about("heading_from_forward_axis",
                 "the hip axis is nearly vertical in the anchor frame; yaw was read from the forward axis");
  }
  if (heading.horizontal >= options.min_horizontal) return std::nullopt;
  return about("heading_ill_conditioned",
               std::string(heading.source == YawSource::kTwist ? "the person is nearly upside down"
                                                               : "the hip axis is nearly vertical") +
                   " in the anchor frame, where yaw is unstable; set facing.anchor to another frame");
}

std::string WhatIsMissing(const TrimOptions& options) {
  return options.rule == TrimRule::kTriples
             ? "no two labelled segments touch, nor a '" + options.triples.transition + "' between them"
             : "no span";
}

/// A cut of which no frame was observed, or a sample of two actions with such frames: its parts would not be whole.
std::optional<Finding> Unobserved(const Clip& clip, TrimRule rule) {
  const std::vector<bool> inferred = InferredFrames(*clip.motion);
  const auto count = static_cast<int>(std::count(inferred.begin(), inferred.end(), true));
  if (count == 0 || (rule != TrimRule::kTriples && count < clip.motion->frame_count())) return std::nullopt;
  return DroppedSpan(clip, "frames_inferred", 0, clip.motion->frame_count(), count,
                     Counted(count, "frame") + " of the clip lie in gaps longer than ingest.source.max_gap");
}

using Examples = std::map<std::string, std::vector<Motion>>;

/// The clips of a recording, with their frames in it.
Expected<std::vector<Clip>> CutClips(const TrimOptions& options, const Examples& examples, const Clip& clip,
                                     std::vector<Finding>& findings) {
  std::vector<Clip> cuts;
  if (options.rule == TrimRule::kTriples) {
    std::set<std::pair<int, int>> taken;
    std::vector<Finding> rejected;
    const auto triples =
        FindTriples(options.triples, clip.segments, clip.motion->rate, clip.motion->frame_count(), rejected);
    for (Finding& finding : rejected) {
      finding.clip = clip.id();
      findings.push_back(std::move(finding));
    }
    for (const ActionTriple& triple : triples) {
      if (!taken.emplace(triple.first_frame, triple.end_frame()).second) {
        // Clip ids contain the frames, so that only one can stay.
        findings.push_back(DroppedSpan(clip, "same_frames", triple.first_frame, triple.end_frame(), 0.0,
                                       "'" + triple.previous + "' to '" + triple.current +
                                           "' has the same frames as another sample, which was kept"));
        continue;
      }
      auto sample = TakeTriple(options.triples, triple, clip);
      if (!sample) return Forward(sample);
      cuts.push_back(*std::move(sample));
    }
    return cuts;
  }
  std::vector<KeptSpan> spans;
  if (options.rule == TrimRule::kByExample) {
    auto found = SpansByExample(options.by_example, examples, *clip.motion);
    if (!found) return Forward(found);
    if (found->empty()) {
      findings.push_back(
          DroppedSpan(clip, "no_example_found", 0, clip.motion->frame_count(), 0.0,
                      "no span is similar enough to the marked ones; lower trim.by_example.min_confidence"));
    }
    spans = LongEnough(options, clip, *found, findings);
  } else {
    spans = FindSpans(options, clip, findings);
  }
  if (options.as_segments) {
    Clip whole = clip;
    whole.segments.clear();
    const FrameRate rate = clip.motion->rate;
    std::string confidences;
    for (const KeptSpan& span : spans) {
      const bool fine = !span.fine_label.empty();
      whole.segments.push_back({rate.FrameTime(span.begin), rate.FrameTime(span.end),
                                fine ? span.fine_label : span.label, fine ? span.label : "", "proposed"});
      confidences += (confidences.empty() ? "" : " ") + RoundedText(std::round(100.0 * span.confidence) / 100.0);
    }
    if (EstimatesCuts(options.rule)) whole.provenance["cut_confidence"] = confidences;
    return std::vector<Clip>{std::move(whole)};
  }
  for (const KeptSpan& span : spans) {
    auto cut = Cut(clip, span.begin, span.end);
    if (!cut) return Forward(cut);
    cut->label = span.label;
    cut->fine_label = span.fine_label;
    if (EstimatesCuts(options.rule)) {
      cut->provenance["cut_confidence"] = RoundedText(std::round(100.0 * span.confidence) / 100.0);
    }
    cuts.push_back(*std::move(cut));
  }
  return cuts;
}

Expected<std::vector<Clip>> Canonicalise(const CanonOptions& options, const Examples& examples, Clip clip,
                                         std::vector<Finding>& findings) {
  clip.evidence = Evidence();
  if (!options.rate.empty()) {
    const auto rate = FrameRate::Parse(options.rate);
    if (!rate) return Forward(rate);
    if (Status near = rate->hz() > clip.rate.hz() ? CheckFrameSteps(clip) : Status(); !near) return Forward(near);
    clip = Resample(clip, *rate);
  }
  if (Status near = EstimatesCuts(options.trim.rule) ? CheckFrameSteps(clip) : Status(); !near) return Forward(near);
  auto cuts = CutClips(options.trim, examples, clip, findings);
  if (!cuts) return Forward(cuts);
  std::vector<Clip> faced;
  for (Clip& cut : *cuts) {
    if (auto unobserved = Unobserved(cut, options.trim.rule)) {
      findings.push_back(*std::move(unobserved));
      continue;
    }
    if (const auto anchor = AnchorFrame(options.facing, cut); !anchor && options.facing.rule != FacingRule::kNone) {
      const int frames = cut.motion->frame_count();
      findings.push_back(
          DroppedSpan(cut, "no_anchor_frame", 0, frames, frames, anchor.error().what + "; " + anchor.error().hint));
      continue;
    }
    const auto heading = FaceFront(options.facing, cut);
    if (!heading) return Forward(heading);
    faced.push_back(std::move(cut));
    if (!ReadsHeading(options.facing.rule)) continue;
    if (auto suspect = SuspectHeading(options.facing, faced.back(), *heading)) findings.push_back(*std::move(suspect));
    faced.back().provenance["heading"] = Name(heading->source);
  }
  SortById(faced);
  return faced;
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
  const StageInput* listed = FindInput(request, kSpansRole);
  if (listed != nullptr) {
    TrimOptions tables = options->trim;
    tables.spans = listed->path;
    const auto spans = ListedSpans(tables);
    if (!spans) return Forward(spans);
    ApplySpans(*spans, *clip, outcome.findings);
  }
  if (Status few = CheckOverlap(*clip, listed != nullptr ? listed->name : request.item); !few) return Forward(few);
  if (const StageInput* floor = FindInput(request, kFloorRole)) {
    if (Status levelled = LevelByFloor(*floor, *clip); !levelled) return Forward(levelled);
  }
  std::set<std::string> labels;
  for (const Segment& segment : clip->segments) labels.insert(segment.label);
  if (options->trim.rule == TrimRule::kAnnotated) outcome.summary["labels"] = labels;
  const auto examples =
      options->trim.rule == TrimRule::kByExample ? ReadExamples(*options, request.inputs) : Expected<Examples>();
  if (!examples) return Forward(examples);
  auto kept = Canonicalise(*options, *examples, std::move(*clip), outcome.findings);
  if (!kept) return Forward(kept);
  if (kept->empty()) {
    // Every dropped span has a finding that names its rule, and an invalid one its error.
    outcome.kind = OutcomeKind::kExcluded;
    const auto wrong = std::find_if(outcome.findings.begin(), outcome.findings.end(),
                                    [](const Finding& finding) { return finding.severity == Severity::kError; });
    if (wrong != outcome.findings.end()) std::rotate(wrong, wrong + 1, outcome.findings.end());
    const std::string reason =
        outcome.findings.empty() ? "no span is left: " + WhatIsMissing(options->trim) : outcome.findings.back().message;
    outcome.error = Error{ErrorCode::kInconsistent, reason, request.item, "see canon.trim"};
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
