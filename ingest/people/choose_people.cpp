#include "ingest/people/person_tracks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr double kPresent = 0.5;     // share of the frames of whoever is there longest
constexpr double kMostlyFlat = 0.7;  // share of frames
constexpr double kMostlyTogether = 0.6;

// Why a track shows no person.
constexpr int kFewestFrames = 8;  // "short": fewer frames, or less than kLeastShare of the file's
constexpr double kLeastShare = 0.05;
constexpr double kStill = 0.004;      // "frozen": metres that the joints move about their mean (median of the joints)
constexpr double kFlat = 0.5;         // "furniture": height over width of the box around the body in most frames, or
constexpr double kProportion = 0.35;  // bones whose log lengths are so far from a person's, or
constexpr double kSpread = 0.3;       // change their length by so much
constexpr double kTogether = 0.25;    // "double": metres between its middle and another's in most frames they share

/// Middle of the box around the seen joints of a row, and its sides.
struct Box {
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
  bool seen = false;

  Vector3d middle() const { return 0.5 * (low + high); }
};

Box BoxOf(const PersonTrack& track, std::size_t row) {
  Box box;
  for (int k = 0; k < track.positions.joints; ++k) {
    if (!track.sees(row, k)) continue;
    const Vector3d place = track.positions.at(static_cast<int>(row), k);
    box.low = box.seen ? Vector3d(box.low.cwiseMin(place)) : place;
    box.high = box.seen ? Vector3d(box.high.cwiseMax(place)) : place;
    box.seen = true;
  }
  return box;
}

/// Median over the joints of how far they are from their mean place, metres, root mean square.
double WanderOf(const PersonTrack& track) { return std::sqrt(Median(JointVariances(track))); }

/// Mean distance of the bones' log lengths from a person's, after the best scale.
double ProportionOf(const std::vector<double>& signature, const std::vector<double>& rest_lengths) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::min(signature.size(), rest_lengths.size()); ++k) {
    if (signature[k] > 0.0 && rest_lengths[k] > 0.05) ratios.push_back(std::log(signature[k] / rest_lengths[k]));
  }
  if (ratios.size() < 4) return 0.0;
  const double scale = Median(ratios);
  double sum = 0.0;
  for (const double ratio : ratios) sum += std::abs(ratio - scale);
  return sum / static_cast<double>(ratios.size());
}

/// Median relative spread of the bones' lengths.
double SpreadOf(const PersonTrack& track, const std::vector<int>& parents, const std::vector<double>& signature) {
  std::vector<double> spreads;
  for (std::size_t k = 0; k < parents.size(); ++k) {
    if (signature[k] < 0.05) continue;
    std::vector<double> off = BoneLengths(track, parents, k);
    for (double& length : off) length = std::abs(length - signature[k]);
    spreads.push_back(kMadToSigma * Median(off) / signature[k]);
  }
  return Median(spreads);
}

double FlatShare(const PersonTrack& track) {
  int seen = 0, lies = 0;
  for (std::size_t row = 0; row < track.frames.size(); ++row) {
    const Box box = BoxOf(track, row);
    if (!box.seen) continue;
    const Vector3d sides = box.high - box.low;
    ++seen;
    lies += sides.y() < kFlat * std::hypot(sides.x(), sides.z()) ? 1 : 0;
  }
  return seen == 0 ? 1.0 : static_cast<double>(lies) / seen;
}

/// Share of a's frames in which both are there and in one place.
double TogetherShare(const PersonTrack& a, const PersonTrack& b) {
  std::size_t j = 0;
  int together = 0;
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    while (j < b.frames.size() && b.frames[j] < a.frames[i]) ++j;
    if (j == b.frames.size()) break;
    if (b.frames[j] != a.frames[i]) continue;
    const Box box = BoxOf(a, i), other = BoxOf(b, j);
    together += box.seen && other.seen && (box.middle() - other.middle()).norm() < kTogether ? 1 : 0;
  }
  return static_cast<double>(together) / static_cast<double>(a.frames.size());
}

/// Why a track is false, or empty.
std::string FalseTrackReason(const std::vector<PersonTrack>& tracks, std::size_t i, const std::vector<int>& parents,
                             const std::vector<double>& rest_lengths, int frames) {
  const PersonTrack& track = tracks[i];
  const int count = static_cast<int>(track.frames.size());
  const auto metres = [](double value) { return Digits(1e3 * value) + " mm"; };
  if (count < kFewestFrames || count < kLeastShare * frames) {
    return "short: in " + std::to_string(count) + " of " + std::to_string(frames) + " frames";
  }
  if (const double wander = WanderOf(track); wander < kStill) {
    return "frozen: its joints move by " + metres(wander);
  }
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    const bool better =
        tracks[k].frames.size() > track.frames.size() || (tracks[k].frames.size() == track.frames.size() && k < i);
    if (k == i || !better || TogetherShare(track, tracks[k]) < kMostlyTogether) continue;
    return "double: in the place of " + tracks[k].Name();
  }
  const std::vector<double> signature = BoneSignature(track, parents);
  if (const double off = ProportionOf(signature, rest_lengths); off > kProportion) {
    return "furniture: proportions are off by " + Digits(100.0 * (std::exp(off) - 1.0)) + " %";
  }
  if (const double spread = SpreadOf(track, parents, signature); spread > kSpread) {
    return "furniture: bones change their length by " + Digits(100.0 * spread) + " %";
  }
  if (const double flat = FlatShare(track); flat > kMostlyFlat && tracks.size() > 1) {
    return "furniture: wider than high in " + Digits(100.0 * flat) + " % of its frames";
  }
  return {};
}

/// Best first.
void Rank(std::vector<PersonTrack>& tracks, TrackRule rule) {
  std::size_t longest = 0;
  for (const PersonTrack& track : tracks) longest = std::max(longest, track.frames.size());
  const auto key = [&](const PersonTrack& track) -> std::pair<double, double> {
    const double length = static_cast<double>(track.frames.size());
    if (rule == TrackRule::kOfficial) return {MotionEnergy(track), length};
    if (rule == TrackRule::kPresence) return {length, MotionEnergy(track)};
    if (rule == TrackRule::kNearest) {
      std::vector<double> distances;
      for (std::size_t row = 0; row < track.frames.size(); ++row)
        distances.push_back(BoxOf(track, row).middle().norm());
      return {-Median(distances), length};
    }
    const bool present = length >= kPresent * static_cast<double>(longest);
    return present ? std::pair(1.0, MotionEnergy(track)) : std::pair(0.0, length);
  };
  std::vector<std::pair<std::pair<double, double>, std::size_t>> order;
  for (std::size_t i = 0; i < tracks.size(); ++i) order.emplace_back(key(tracks[i]), i);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<PersonTrack> ranked;
  for (const auto& entry : order) ranked.push_back(std::move(tracks[entry.second]));
  tracks = std::move(ranked);
}

void NoteOthers(const People& people, std::size_t wanted, std::vector<Finding>& findings) {
  const std::size_t left = people.others.size();
  if (left == 0) return;
  std::string which;
  for (const PersonTrack& track : people.others) {
    which += (which.empty() ? "" : ", ") + track.Name() + " in " + std::to_string(track.frames.size()) + " frames";
  }
  findings.push_back(MakeFinding("bodies_skipped", Severity::kWarning, static_cast<double>(left),
                                 "the file holds " + std::to_string(left + people.chosen.size()) +
                                     " people, ingest.source.bodies asks for " + std::to_string(wanted) + "; " +
                                     std::to_string(left) + " not taken: " + which,
                                 FindingAction::kExcluded));
}

void NoteSecondPerson(const People& people, std::size_t wanted, int frames, std::vector<Finding>& findings) {
  if (people.chosen.empty() || people.others.empty()) return;
  double least = MotionEnergy(people.chosen.front());
  for (const PersonTrack& track : people.chosen) least = std::min(least, MotionEnergy(track));
  for (const PersonTrack& other : people.others) {
    const double energy = MotionEnergy(other);
    if (2 * static_cast<int>(other.frames.size()) < frames || energy < 0.5 * least) continue;
    findings.push_back(FrameFinding("second_person", 0, 0, "", energy,
                                    "another person, " + other.Name() + ", is there in " +
                                        std::to_string(other.frames.size()) + " of " + std::to_string(frames) +
                                        " frames and moves as much (" + Digits(energy) + " m2 to " + Digits(least) +
                                        "); the name declares " + std::to_string(wanted)));
  }
}

}  // namespace

std::vector<PersonTrack> JoinIds(std::vector<PersonTrack> tracks, const PeopleOptions& options,
                                 const std::vector<int>& parents, const std::vector<double>& time_s,
                                 std::vector<Finding>& findings) {
  if (!options.stitch || options.rule == TrackRule::kOfficial) return tracks;
  return StitchTracks(std::move(tracks), parents, time_s, options.max_lost_s, findings);
}

People ChoosePeople(std::vector<PersonTrack> tracks, std::size_t wanted, TrackRule rule, bool look_for_false_tracks,
                    const std::vector<int>& parents, const std::vector<double>& rest_lengths, int frames) {
  People people;
  std::vector<PersonTrack> sound;
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    reasons.push_back(rule == TrackRule::kOfficial || !look_for_false_tracks
                          ? std::string()
                          : FalseTrackReason(tracks, i, parents, rest_lengths, frames));
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    (reasons[i].empty() ? sound : people.false_tracks).push_back(tracks[i]);
  }
  reasons.erase(std::remove(reasons.begin(), reasons.end(), std::string()), reasons.end());
  Rank(sound, rule);
  for (std::size_t i = 0; i < sound.size(); ++i) (i < wanted ? people.chosen : people.others).push_back(sound[i]);
  std::vector<std::size_t> order(people.false_tracks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return MotionEnergy(people.false_tracks[a]) > MotionEnergy(people.false_tracks[b]);
  });
  std::vector<PersonTrack> false_tracks;
  for (const std::size_t i : order) {
    const bool taken = people.chosen.size() < wanted && people.false_tracks[i].frames.size() > 1;
    Finding finding =
        FrameFinding("false_track", people.false_tracks[i].frames.front(), people.false_tracks[i].frames.back() + 1, "",
                     static_cast<double>(people.false_tracks[i].frames.size()),
                     "body " + people.false_tracks[i].Name() + " is a false track (" + reasons[i] + "), in " +
                         Counted(static_cast<long long>(people.false_tracks[i].frames.size()), "frame"));
    finding.action = taken ? FindingAction::kKept : FindingAction::kExcluded;
    people.findings.push_back(std::move(finding));
    (taken ? people.chosen : false_tracks).push_back(std::move(people.false_tracks[i]));
  }
  people.false_tracks = std::move(false_tracks);
  NoteOthers(people, wanted, people.findings);
  NoteSecondPerson(people, wanted, frames, people.findings);
  std::stable_sort(people.chosen.begin(), people.chosen.end(),
                   [](const PersonTrack& a, const PersonTrack& b) { return a.frames.front() < b.frames.front(); });
  return people;
}

}  // namespace mocurate
