#include "ingest/inspect/inspect_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/file_names.h"
#include "ingest/options.h"

namespace mocurate {
namespace {

constexpr double kNearTen = 0.05;             // of the logarithm of a factor
constexpr std::size_t kFewestSeenPoints = 5;  // that tell where a body is
constexpr double kLeastSpread = 0.1;          // of the size of a body, of places that count as different
constexpr double kElsewhere = 6.0;            // of the spread, from the middle of all: no other clip is there
constexpr double kThere = 3.0;                // of the spread, where the others are
constexpr double kSureHandedness = 0.6;       // of a handedness that is kept against that of all others

/// Clips by folder, format and joints.
std::map<std::string, std::vector<InspectedClip*>> Members(std::vector<InspectedClip>& clips) {
  std::map<std::string, std::vector<InspectedClip*>> members;
  for (InspectedClip& clip : clips) {
    members[FolderOf(clip.file) + "\n" + clip.format + "\n" + JointsText(clip)].push_back(&clip);
  }
  return members;
}

/// Whether all follow one known order or tree, so that their left and right are the same words.
bool OneSkeleton(const std::vector<InspectedClip*>& group) {
  const std::optional<std::string>& first = group[0]->skeleton.value;
  if (!first || first->rfind("own tree", 0) == 0) return false;
  return std::all_of(group.begin(), group.end(),
                     [&](const InspectedClip* clip) { return clip->skeleton.value == first; });
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

/// The unit that a clip's own lengths show, of clips without a declared unit.
std::optional<double> MeasuredMetres(const InspectedClip& clip) {
  if (clip.units.from != Provenance::kMeasured) return std::nullopt;
  const Expected<double> metres = MetresPerUnit(*clip.units.value);
  return metres ? std::optional<double>(*metres) : std::nullopt;
}

/// Clips whose numbers are a power of ten of those of most clips of their folder.
void ReportUnits(const std::vector<InspectedClip*>& group, std::vector<Finding>& findings) {
  std::map<std::string, std::size_t> votes;
  std::string usual;
  std::size_t decided = 0;
  for (const InspectedClip* clip : group) {
    if (!MeasuredMetres(*clip)) continue;
    ++decided;
    const std::size_t count = ++votes[*clip->units.value];
    if (count > votes[usual]) usual = *clip->units.value;
  }
  for (const InspectedClip* clip : group) {
    const std::optional<double> metres = MeasuredMetres(*clip);
    if (!metres) continue;
    const double tens = std::log10(MetresPerUnit(usual).value_or(*metres) / *metres);
    if (std::round(tens) == 0.0 || std::abs(tens - std::round(tens)) > kNearTen) continue;
    const double factor = std::pow(10.0, std::round(tens));
    findings.push_back(FindingAt(
        clip->id, "units_outlier", Severity::kError, factor,
        "the numbers of this clip are " + FormatDouble(factor) + " times those of the others: its unit is " +
            *clip->units.value + " where that of " + std::to_string(votes[usual]) + " of the " +
            std::to_string(decided) + " clips of the folder that tell is " + usual + " (" + clip->units.evidence +
            "); divide them, or give the clip a source with its own ingest.source.units"));
  }
}

/// Where a body is in its first frame, and how large: medians of the coordinates, longest side of its box.
struct FirstPlace {
  std::array<double, 3> place{};
  double size = 0.0;
};

std::optional<FirstPlace> FirstPlaceOf(const InspectedClip& clip) {
  if (!clip.first_frame.value) return std::nullopt;
  FirstPlace first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const std::optional<Vector3d>& point : *clip.first_frame.value) {
      if (point) values.push_back((*point)[static_cast<int>(axis)]);
    }
    if (values.size() < kFewestSeenPoints) return std::nullopt;
    std::sort(values.begin(), values.end());
    first.place[axis] = values[values.size() / 2];
    first.size = std::max(first.size, values.back() - values.front());
  }
  return first;
}

/// Clips in which two axes are exchanged: the person is elsewhere than in the rest of the folder for that reason alone.
void ReportPlaces(const std::vector<InspectedClip*>& group, std::vector<Finding>& findings) {
  std::vector<const InspectedClip*> clips;
  std::vector<FirstPlace> places;
  std::vector<double> sizes;
  for (const InspectedClip* clip : group) {
    const std::optional<FirstPlace> place = FirstPlaceOf(*clip);
    if (!place) continue;
    clips.push_back(clip);
    places.push_back(*place);
    sizes.push_back(place->size);
  }
  if (places.size() <= kFewestVotes) return;
  const double least = kLeastSpread * Median(sizes);
  std::array<double, 3> middle{}, spread{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values, off;
    for (const FirstPlace& place : places) values.push_back(place.place[axis]);
    middle[axis] = Median(values);
    for (const double value : values) off.push_back(std::abs(value - middle[axis]));
    spread[axis] = std::max(least, kMadToSigma * Median(off));
  }
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const auto off = [&](std::size_t axis, std::size_t read) {
      return std::abs(places[c].place[read] - middle[axis]) / spread[axis];
    };
    for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
      if (off(a, a) < kElsewhere || off(b, b) < kElsewhere || off(a, b) > kThere || off(b, a) > kThere) continue;
      findings.push_back(
          FindingAt(clips[c]->id, "axes_outlier", Severity::kWarning, FourDecimals(std::min(off(a, a), off(b, b))),
                    std::string("the person is where no other of the folder is, but would be among them with ") +
                        "xyz"[a] + " and " + "xyz"[b] + " exchanged (" + Digits(std::min(off(a, a), off(b, b))) +
                        " times as far from their middle as they usually are): compare the columns of the file"));
    }
  }
}

/// Gives the clips of a group the handedness that the others agree on.
void ShareHandedness(const std::vector<InspectedClip*>& group, std::vector<Finding>& findings) {
  if (!OneSkeleton(group)) return;
  std::vector<const InspectedClip*> voters;
  for (const InspectedClip* clip : group) {
    if (clip->handedness.from == Provenance::kMeasured) voters.push_back(clip);
  }
  if (voters.size() < kFewestVotes) return;
  const Consensus<std::string> most = ConsensusOf(voters, &InspectedClip::handedness);
  const std::string agreed = *most.clearest->value;
  const double share = FourDecimals(most.share);
  if (share < kAgreement && most.clips + 1 != voters.size()) return;
  const std::string evidence = "as " + std::to_string(most.clips) + " of the " + std::to_string(voters.size()) +
                               " clips of the folder that tell say";
  for (InspectedClip* clip : group) {
    Reported<std::string>& handedness = clip->handedness;
    if (handedness.from == Provenance::kDeclared || handedness.value == agreed) continue;
    const std::string own = handedness.evidence;
    if (handedness.value) {
      findings.push_back(FindingAt(clip->id, "handedness_outlier", Severity::kWarning, handedness.confidence,
                                   "this clip alone would be " + *handedness.value + "-handed (" + own + ", " +
                                       RoundedText(100.0 * handedness.confidence, 3) +
                                       " % confidence), the others of the folder are not"));
      const std::string contradicts = "the clip contradicts the others of its folder";
      for (Reported<std::string>* field : {&clip->facing, &clip->axes}) {
        if (field->from == Provenance::kMeasured) *field = Unknown<std::string>(contradicts);
      }
      if (handedness.confidence >= kSureHandedness) {
        handedness = Unknown<std::string>(contradicts + ": " + own);
        continue;
      }
    }
    handedness = Report<std::string>(agreed, Provenance::kMeasured, share, evidence + "; of itself: " + own);
  }
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
    ReportUnits(group, inspection.findings);
    ReportPlaces(group, inspection.findings);
    ShareHandedness(group, inspection.findings);
    inspection.groups.push_back(GroupOf({group.begin(), group.end()}));
  }
}

}  // namespace mocurate
