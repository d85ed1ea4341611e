#include "ingest/inspect/inspect_groups.h"

#include <algorithm>
#include <map>
#include <vector>

#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {
namespace {

/// Clips by folder, format and joints.
std::map<std::string, std::vector<InspectedClip*>> Members(std::vector<InspectedClip>& clips) {
  std::map<std::string, std::vector<InspectedClip*>> members;
  for (InspectedClip& clip : clips) {
    members[FolderOf(clip.file) + "\n" + clip.format + "\n" + JointsText(clip)].push_back(&clip);
  }
  return members;
}

/// Rates that motions deny, of the clips of a folder together.
void ReportRates(const std::vector<InspectedClip*>& group, std::vector<Finding>& findings) {
  std::map<std::string, const InspectedClip*> by_id;
  for (const InspectedClip* clip : group) by_id[clip->id] = clip;
  RateDenials denials;
  denials.clips = group.size();
  for (const Finding& finding : findings) {
    if (finding.code != "rate_suspect") continue;
    const auto clip = by_id.find(finding.clip);
    if (clip != by_id.end()) denials.Add(clip->second->rate_hz.value.value_or(0.0), finding.value);
  }
  if (!denials.OfTheSet()) return;
  const std::string folder = FolderOf(group[0]->file);
  findings.push_back(FindingAt(folder.empty() ? "." : folder, "rate_suspect", Severity::kError,
                               FourDecimals(denials.Share()),
                               "the motions of the whole folder contradict its rate: " + denials.Words()));
}

template <class T>
Pooled<T> PooledOf(const std::vector<const InspectedClip*>& clips, Reported<T> InspectedClip::*field) {
  const Consensus<T> most = ConsensusOf(clips, field);
  if (most.last == nullptr) return {};
  return {most.last->value, most.last->from, FourDecimals(most.share)};
}

InspectedGroup GroupOf(const std::vector<const InspectedClip*>& clips) {
  InspectedGroup group;
  group.folder = FolderOf(clips[0]->file);
  group.format = clips[0]->format;
  group.joints = clips[0]->joints.value;
  group.clips = clips.size();
  group.fewest_frames = *clips[0]->frames.value;
  for (const InspectedClip* clip : clips) {
    const int frames = *clip->frames.value;
    group.frames += frames;
    group.fewest_frames = std::min(group.fewest_frames, frames);
    group.most_frames = std::max(group.most_frames, frames);
  }
  group.rate_hz = PooledOf(clips, &InspectedClip::rate_hz);
  ForEachSharedText([&](const char*, auto of_clip, auto of_group) { group.*of_group = PooledOf(clips, of_clip); });
  return group;
}

}  // namespace

void CompareGroups(Inspection& inspection) {
  for (const auto& [key, group] : Members(inspection.clips)) {
    ReportRates(group, inspection.findings);
    inspection.groups.push_back(GroupOf({group.begin(), group.end()}));
  }
}

}  // namespace mocurate
