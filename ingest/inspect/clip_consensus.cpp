#include "ingest/inspect/clip_consensus.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/text.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {
namespace {

constexpr double kMostOfThem = 0.9;  // share of names of one form, above which the others are another source's

std::string VoteText(const std::string& value) { return value; }
std::string VoteText(double value) { return FormatDouble(value); }
std::string VoteText(int value) { return std::to_string(value); }

/// The number of joints, "null" where it is unknown.
std::string JointsText(const InspectedClip& clip) {
  return clip.joints.value ? std::to_string(*clip.joints.value) : "null";
}

/// The most frequent value of a field, weighted by confidence.
template <class T>
struct Consensus {
  const Reported<T>* clearest = nullptr;  ///< of the highest confidence; none: no clip has a value
  const Reported<T>* last = nullptr;
  double share = 0.0;     ///< of the votes
  std::size_t clips = 0;  ///< that report this value
};

template <class T>
Consensus<T> ConsensusOf(const std::vector<const InspectedClip*>& clips, Reported<T> InspectedClip::*field) {
  struct Weighed {
    double weight = 0.0;
    Consensus<T> votes;
  };
  std::map<std::string, Weighed> values;
  double all = 0.0;
  for (const InspectedClip* clip : clips) {
    const Reported<T>& reported = clip->*field;
    if (!reported.value) continue;
    const double weight = std::max(1e-6, reported.confidence);
    auto& [sum, votes] = values[VoteText(*reported.value)];
    sum += weight;
    all += weight;
    ++votes.clips;
    votes.last = &reported;
    if (votes.clearest == nullptr || reported.confidence > votes.clearest->confidence) votes.clearest = &reported;
  }
  const auto most = std::max_element(values.begin(), values.end(),
                                     [](const auto& a, const auto& b) { return a.second.weight < b.second.weight; });
  if (most == values.end()) return {};
  most->second.votes.share = most->second.weight / all;
  return most->second.votes;
}

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

std::string TwoDecimals(double value) { return FormatDouble(std::round(value * 100.0) / 100.0); }

ClipConsensus::ClipConsensus(const Inspection& inspection, std::string format) : format_(std::move(format)) {
  std::set<std::string> no_bodies;
  for (const Finding& finding : inspection.findings) {
    if (finding.code == "not_joint_positions") no_bodies.insert(finding.clip);
  }
  // Features beside joints ("_vecs.npy") may be more, but they are no clips.
  const auto is_body = [&](const InspectedClip& clip) { return no_bodies.count(clip.id) == 0; };
  const bool some = std::any_of(inspection.clips.begin(), inspection.clips.end(),
                                [&](const InspectedClip& clip) { return clip.format == format_ && is_body(clip); });
  std::map<std::string, std::vector<const InspectedClip*>> by_joints;
  for (const InspectedClip& clip : inspection.clips) {
    if (clip.format != format_)
      others_[clip.format] += 1;
    else if (some && !is_body(clip))
      others_[format_ + " without joint positions"] += 1;
    else
      by_joints[JointsText(clip)].push_back(&clip);
  }
  std::size_t most = 0;
  for (const auto& [joints, clips] : by_joints) {
    const bool known = joints != "null";
    if (clips_.empty() || (known && clips.size() > most)) clips_ = clips;
    if (known) most = std::max(most, clips.size());
  }
  // An .amc without its skeleton has no count of joints; its name is of the source all the same.
  if (by_joints.count("null") != 0 && most > 0) {
    clips_.insert(clips_.end(), by_joints["null"].begin(), by_joints["null"].end());
    by_joints.erase("null");
  }
  KeepOneForm();
  for (const auto& [joints, clips] : by_joints) {
    if (!clips_.empty() && JointsText(*clips_[0]) != joints) {
      others_[format_ + " of " + joints + " joints"] += clips.size();
    }
  }
  for (const InspectedClip& clip : inspection.clips) {
    if (std::find(clips_.begin(), clips_.end(), &clip) == clips_.end()) other_files_.push_back(clip.file);
  }
}

/// Companions of other names (KARD's pixels beside its places) are not of the source.
void ClipConsensus::KeepOneForm() {
  std::map<std::string, std::size_t> forms;
  for (const InspectedClip* clip : clips_) forms[FormOf(clip->file)] += 1;
  const auto most =
      std::max_element(forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (forms.size() < 2 || static_cast<double>(most->second) < kMostOfThem * static_cast<double>(clips_.size())) return;
  const auto other = [&](const InspectedClip* clip) { return FormOf(clip->file) != most->first; };
  others_[format_ + " of other names"] += clips_.size() - most->second;
  clips_.erase(std::remove_if(clips_.begin(), clips_.end(), other), clips_.end());
}

template <class T>
Vote<T> ClipConsensus::Ask(Reported<T> InspectedClip::*field) const {
  Vote<T> vote;
  const Consensus<T> most = ConsensusOf(clips_, field);
  if (most.clearest == nullptr) {
    vote.comment = clips_.empty() ? "" : (clips_[0]->*field).evidence;
    return vote;
  }
  vote.value = most.clearest->value;
  vote.from = most.clearest->from;
  vote.share = most.share;
  vote.voters = static_cast<double>(most.clips) / static_cast<double>(clips_.size());
  const std::string& evidence = most.clearest->evidence;
  vote.comment = vote.from == Provenance::kDeclared
                     ? "declared by the file: " + evidence
                     : "measured: " + std::to_string(most.clips) + " of " + std::to_string(clips_.size()) +
                           " clips agree, the most confident with " + TwoDecimals(most.clearest->confidence) + " (" +
                           evidence + ")";
  return vote;
}

template Vote<std::string> ClipConsensus::Ask(Reported<std::string> InspectedClip::*) const;
template Vote<double> ClipConsensus::Ask(Reported<double> InspectedClip::*) const;
template Vote<int> ClipConsensus::Ask(Reported<int> InspectedClip::*) const;

const InspectedClip& ClipConsensus::ClearestSkeleton() const {
  return **std::max_element(clips_.begin(), clips_.end(), [](const InspectedClip* a, const InspectedClip* b) {
    return a->skeleton.confidence < b->skeleton.confidence;
  });
}

std::vector<std::string> ClipConsensus::files() const {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const InspectedClip* clip : clips_) {
    if (known.insert(clip->file).second) names.push_back(clip->file);
  }
  return names;
}

std::vector<std::string> ClipConsensus::Facts(const char* key) const {
  std::vector<std::string> facts;
  for (const InspectedClip* clip : clips_) facts.push_back(clip->Fact(key));
  return facts;
}

void CompareGroups(Inspection& inspection) {
  for (const auto& [key, group] : Members(inspection.clips)) {
    ReportRates(group, inspection.findings);
    inspection.groups.push_back(GroupOf({group.begin(), group.end()}));
  }
}

}  // namespace mocurate
