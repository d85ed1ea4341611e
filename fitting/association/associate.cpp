#include "fitting/association/associate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "core/base/median.h"
#include "fitting/association/propose.h"

namespace mocurate {
namespace {

constexpr double kGate = 0.2;                  ///< of the extent: largest distance of an entry from its person
constexpr double kWidestGate = 0.5;            ///< of the extent: largest gate after frames without the person
constexpr double kUnobservedSpeed = 1.0;       ///< extents per second that an unobserved person may move
constexpr double kSamePlace = 0.25;            ///< of the extent: a body nearer than this to another is the same person
constexpr double kSearch_s = 0.1;              ///< seconds between searches for new people (numerical)
constexpr double kForgotten_s = 0.5;           ///< a person unobserved for longer is found by the search for new people
constexpr double kSameShape = 0.2;             ///< log ratio of lengths: at most, of one person after a gap
constexpr std::size_t kSamplesOfLength = 500;  ///< latest samples that enter the median of a length (numerical)
constexpr double kLeastShareOfFrames = 0.1;    ///< of the frames of the longest track: shorter tracks are false tracks

/// A person over time.
struct Track {
  BodyPoints body;
  BodyPoints first;
  std::vector<std::vector<int>> entry;       ///< [view][frame of the view]
  std::vector<std::deque<double>> measured;  ///< the latest samples of each known length
  std::vector<int> seen_in;                  ///< frames of the take
  double last_s = 0.0;
};

std::vector<double> MedianLengthsOfTrack(const Track& track) {
  std::vector<double> lengths;
  for (const std::deque<double>& samples : track.measured) {
    std::vector<double> sorted(samples.begin(), samples.end());
    lengths.push_back(MeanMedian(sorted));
  }
  return lengths;
}

Vector3d MiddleOfBody(const BodyPoints& body) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 0; k < body.known.size(); ++k) {
    if (body.known[k] != 0) sum += body.position[k];
  }
  return sum / std::max(body.KnownCount(), 1);
}

/// Median of |log ratio| of what both have measured; 0 when they share nothing.
double ShapeDistance(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] > 0.0 && b[i] > 0.0) logs.push_back(std::abs(std::log(a[i] / b[i])));
  }
  return MeanMedian(logs);
}

class PeopleFollower {
 public:
  PeopleFollower(const std::vector<RigView>& rig, const std::vector<KnownLength>& lengths,
                 const std::vector<double>& time_s)
      : rig_(rig), lengths_(lengths) {
    take_.time_s = time_s;
    for (const RigView& view : rig) {
      if (time_s.empty() && view.time_s.size() > take_.time_s.size()) take_.time_s = view.time_s;
      owned_.emplace_back(view.seen.size(), 0);
    }
    MapFrames();
  }

  Association Follow() {
    const auto frames = static_cast<int>(take_.time_s.size());
    double searched_s = -kNoMatch;
    for (int f = 0; f < frames; ++f) {
      std::vector<std::size_t> all(tracks_.size());
      for (std::size_t t = 0; t < all.size(); ++t) all[t] = t;
      const bool any_observed = Assign(f, all);
      if (any_observed && Time(f) - searched_s < kSearch_s) continue;
      searched_s = Time(f);
      FindNew(f);
    }
    for (Track& track : tracks_) FollowBack(track);
    return Rank();
  }

 private:
  struct Match {
    double distance = 0.0;
    std::size_t track = 0;
    Sight sight;
  };

  double Time(int frame) const { return take_.time_s[static_cast<std::size_t>(frame)]; }

  /// Nearest frame of each view for each frame of the take; -1: none within half a frame.
  void MapFrames() {
    const std::vector<double>& time = take_.time_s;
    const double reach = time.size() < 2 ? kNoMatch : 0.5 * UsualStep(time) + 1e-9;
    for (const RigView& view : rig_) {
      std::vector<int> nearest(time.size(), -1);
      std::size_t at = 0;
      for (std::size_t f = 0; f < time.size() && !view.time_s.empty(); ++f) {
        const auto off = [&](std::size_t i) { return std::abs(view.time_s[i] - time[f]); };
        while (at + 1 < view.time_s.size() && off(at + 1) <= off(at) + 1e-6) ++at;
        if (off(at) <= reach) nearest[f] = static_cast<int>(at);
      }
      frame_of_.push_back(std::move(nearest));
    }
  }

  /// Entries of a frame that are free and have enough keypoints.
  std::vector<Sight> FreeEntries(int frame) const {
    std::vector<Sight> entries;
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      const int at = frame_of_[v][static_cast<std::size_t>(frame)];
      for (int p = 0; at >= 0 && p < rig_[v].people; ++p) {
        const std::size_t entry = rig_[v].Entry(at, p);
        if (rig_[v].seen[entry] < kLeastKeypoints || owned_[v][entry] != 0) continue;
        entries.push_back({static_cast<int>(v), at, p});
      }
    }
    return entries;
  }

  /// Largest distance of an entry, metres; 0 for a person unobserved for too long.
  static double Gate(const Track& track, double now) {
    const double away = std::abs(now - track.last_s);
    return away > kForgotten_s ? 0.0 : track.body.extent * std::min(kGate + kUnobservedSpeed * away, kWidestGate);
  }

  bool Own(Track& track, const Sight& sight) {
    const auto v = static_cast<std::size_t>(sight.view);
    char& owned = owned_[v][rig_[v].Entry(sight.frame, sight.person)];
    int& place = track.entry[v][static_cast<std::size_t>(sight.frame)];
    if (owned != 0 || place >= 0) return false;
    owned = 1;
    place = sight.person;
    return true;
  }

  /// Assigns free entries of a frame to `tracks`, nearest first, one per view and track. Returns whether two views
  /// observe any of them.
  bool Assign(int frame, const std::vector<std::size_t>& tracks) {
    const std::vector<Sight> entries = FreeEntries(frame);
    std::vector<Match> matches;
    for (const std::size_t t : tracks) {
      const Track& track = tracks_[t];
      const double gate = Gate(track, Time(frame));
      if (gate <= 0.0) continue;
      for (const Sight& sight : entries) {
        const RigView& view = rig_[static_cast<std::size_t>(sight.view)];
        const double distance = EntryDistance(view, sight.frame, sight.person, track.body, kLeastKeypoints);
        if (distance <= gate) matches.push_back({distance / track.body.extent, t, sight});
      }
    }
    std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.distance < b.distance; });
    std::vector<std::vector<Sight>> sights(tracks_.size());
    for (const Match& match : matches) {
      if (Own(tracks_[match.track], match.sight)) sights[match.track].push_back(match.sight);
    }
    bool any_renewed = false;
    for (const std::size_t t : tracks) {
      if (sights[t].size() >= 2 && Renew(tracks_[t], frame, sights[t])) any_renewed = true;
    }
    return any_renewed;
  }

  /// Updates the body from the entries. Unobserved keypoints move with the others.
  bool Renew(Track& track, int frame, const std::vector<Sight>& sights) const {
    BodyPoints now = NearestBody(rig_, sights);
    if (now.KnownCount() < kLeastKeypoints) return false;
    const std::vector<double> measured = MeasureLengths(now, lengths_);
    for (std::size_t i = 0; i < measured.size(); ++i) {
      if (measured[i] > 0.0) track.measured[i].push_back(measured[i]);
      if (track.measured[i].size() > kSamplesOfLength) track.measured[i].pop_front();
    }
    if (track.body.extent > 0.0) {
      now.extent = 0.9 * track.body.extent + 0.1 * now.extent;
      Vector3d moved = Vector3d::Zero();
      int shared = 0;
      for (std::size_t k = 0; k < now.known.size(); ++k) {
        if (now.known[k] == 0 || track.body.known[k] == 0) continue;
        moved += now.position[k] - track.body.position[k];
        ++shared;
      }
      if (shared > 0) moved /= shared;
      for (std::size_t k = 0; k < now.known.size(); ++k) {
        if (now.known[k] != 0 || track.body.known[k] == 0) continue;
        now.position[k] = track.body.position[k] + moved;
        now.known[k] = 1;
      }
    }
    track.body = std::move(now);
    track.last_s = Time(frame);
    track.seen_in.push_back(frame);
    return true;
  }

  void FindNew(int frame) {
    std::vector<double> scales;
    for (const Track& track : tracks_) {
      const ShapeMatch shape = CompareShape(MedianLengthsOfTrack(track), lengths_);
      if (shape.scale > 0.0) scales.push_back(shape.scale);
    }
    const double usual_scale = MeanMedian(scales);
    for (const std::vector<Sight>& sights : ProposePeople(rig_, FreeEntries(frame), lengths_, usual_scale)) {
      Track started;
      for (const RigView& view : rig_) started.entry.emplace_back(view.time_s.size(), -1);
      started.measured.resize(lengths_.size());
      if (!Renew(started, frame, sights) || OnPerson(started, frame)) continue;
      started.first = started.body;
      const std::size_t known = SamePerson(started);
      if (known == tracks_.size()) {
        tracks_.push_back(std::move(started));
      } else {
        Track& track = tracks_[known];
        track.body = std::move(started.body);
        track.last_s = started.last_s;
        track.seen_in.push_back(frame);
      }
      for (const Sight& sight : sights) Own(tracks_[known], sight);
    }
  }

  /// Whether a body coincides with a person of the same frame: two poorly calibrated views of one person.
  bool OnPerson(const Track& started, int frame) const {
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
      return !track.seen_in.empty() && track.seen_in.back() == frame &&
             (MiddleOfBody(track.body) - MiddleOfBody(started.body)).norm() < kSamePlace * track.body.extent;
    });
  }

  /// The track of a person unobserved for a while, with the same position and bone lengths; tracks_.size() without one.
  std::size_t SamePerson(const Track& started) const {
    std::size_t best = tracks_.size();
    double nearest = kNoMatch;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      const double away = started.last_s - track.last_s;
      const double distance = (MiddleOfBody(track.body) - MiddleOfBody(started.body)).norm();
      if (!(away > 0.0) || distance > track.body.extent * (kGate + kUnobservedSpeed * away) || distance >= nearest)
        continue;
      if (ShapeDistance(MedianLengthsOfTrack(track), MedianLengthsOfTrack(started)) > kSameShape) continue;
      nearest = distance;
      best = t;
    }
    return best;
  }

  /// Extends a track backwards from its first frame, as long as entries match.
  void FollowBack(Track& track) {
    const auto t = static_cast<std::size_t>(&track - tracks_.data());
    const int first = track.seen_in.front();
    track.body = track.first;
    track.last_s = Time(first);
    for (int f = first - 1; f >= 0 && Gate(track, Time(f)) > 0.0; --f) Assign(f, {t});
  }

  Association Rank() {
    std::size_t most = 0;
    for (const Track& track : tracks_) most = std::max(most, track.seen_in.size());
    for (const Track& track : tracks_) {
      if (static_cast<double>(track.seen_in.size()) < kLeastShareOfFrames * static_cast<double>(most)) continue;
      AssociatedPerson person;
      person.entry = track.entry;
      person.frames_seen = static_cast<int>(track.seen_in.size());
      for (std::size_t v = 0; v < rig_.size(); ++v) {
        for (std::size_t f = 0; f < person.entry[v].size(); ++f) {
          if (person.entry[v][f] < 0) continue;
          const std::size_t first = rig_[v].Point(static_cast<int>(f), person.entry[v][f], 0);
          for (int k = 0; k < rig_[v].keypoints; ++k)
            person.presence += rig_[v].confidence[first + static_cast<std::size_t>(k)];
        }
      }
      take_.people.push_back(std::move(person));
    }
    std::stable_sort(take_.people.begin(), take_.people.end(),
                     [](const auto& a, const auto& b) { return a.presence > b.presence; });
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      const auto enough =
          std::count_if(rig_[v].seen.begin(), rig_[v].seen.end(), [](int seen) { return seen >= kLeastKeypoints; });
      int owned = 0;
      for (const AssociatedPerson& person : take_.people) {
        owned += static_cast<int>(
            std::count_if(person.entry[v].begin(), person.entry[v].end(), [](int entry) { return entry >= 0; }));
      }
      take_.entries.push_back(static_cast<int>(enough));
      take_.excluded.push_back(static_cast<int>(enough) - owned);
    }
    return std::move(take_);
  }

  const std::vector<RigView>& rig_;
  const std::vector<KnownLength>& lengths_;
  Association take_;
  std::vector<std::vector<int>> frame_of_;  ///< [view][frame of the take]: frame of the view; -1: none
  std::vector<std::vector<char>> owned_;    ///< [view][entry]
  std::vector<Track> tracks_;
};

}  // namespace

Association AssociatePeople(const std::vector<RigView>& rig, const std::vector<KnownLength>& lengths,
                            const std::vector<double>& time_s) {
  return PeopleFollower(rig, lengths, time_s).Follow();
}

std::vector<double> UnobservedShares(const AssociatedPerson& person) {
  std::vector<double> shares;
  for (const std::vector<int>& entries : person.entry) {
    const auto without = std::count_if(entries.begin(), entries.end(), [](int entry) { return entry < 0; });
    shares.push_back(static_cast<double>(without) / static_cast<double>(std::max<std::size_t>(entries.size(), 1)));
  }
  return shares;
}

namespace {

constexpr double kSameTime = 1e-3;  ///< share of a view's step within which two stamps are equal (numerical)
/// Factor on a view's usual step: longest step between two frames that are interpolated.
constexpr double kLongestUsualSteps = 2.5;

/// Two frames of a view around a moment; the same frame twice where the view has one at that time.
struct Bracket {
  int before = -1;
  int after = -1;
  double share = 0.0;  ///< of the way from one to the other
};

Bracket FramesAround(const std::vector<double>& time, double step, double moment) {
  Bracket bracket;
  const auto next = std::lower_bound(time.begin(), time.end(), moment);
  const auto after = static_cast<int>(next - time.begin());
  for (const int f : {after, after - 1}) {
    if (f < 0 || f >= static_cast<int>(time.size())) continue;
    if (std::abs(time[static_cast<std::size_t>(f)] - moment) > std::max(kSameTime * step, 1e-9)) continue;
    bracket.before = bracket.after = f;
    return bracket;
  }
  if (after == 0 || next == time.end()) return bracket;
  const double gap = *next - *(next - 1);
  if (gap > kLongestUsualSteps * step) return bracket;
  bracket.before = after - 1;
  bracket.after = after;
  bracket.share = (moment - *(next - 1)) / gap;
  return bracket;
}

}  // namespace

double UsualStep(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t f = 1; f < time.size(); ++f) steps.push_back(time[f] - time[f - 1]);
  return MeanMedian(steps);
}

void ReadBetweenFrames(const RigView& view, const std::vector<int>& entry, double step, double moment,
                       Vector2d* normalised, double* confidence) {
  const Bracket bracket = FramesAround(view.time_s, step, moment);
  if (bracket.before < 0) return;
  const int one = entry[static_cast<std::size_t>(bracket.before)];
  const int other = entry[static_cast<std::size_t>(bracket.after)];
  if (one < 0 || other < 0) return;
  const std::size_t here = view.Point(bracket.before, one, 0);
  const std::size_t there = view.Point(bracket.after, other, 0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(view.keypoints); ++k) {
    const double sure = std::min(view.confidence[here + k], view.confidence[there + k]);
    if (sure <= 0.0) continue;
    normalised[k] = (1.0 - bracket.share) * view.normalised[here + k] + bracket.share * view.normalised[there + k];
    confidence[k] = sure;
  }
}

std::vector<ViewKeypoints> ViewsOfPerson(const std::vector<RigView>& rig, const Association& take,
                                         const AssociatedPerson& person) {
  std::vector<ViewKeypoints> views;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const RigView& from = rig[v];
    const auto keypoints = static_cast<std::size_t>(from.keypoints);
    ViewKeypoints view;
    view.camera = from.camera.camera;
    view.normalised.assign(take.time_s.size() * keypoints, Vector2d::Zero());
    view.confidence.assign(take.time_s.size() * keypoints, 0.0);
    const double step = UsualStep(from.time_s);
    for (std::size_t f = 0; f < take.time_s.size(); ++f) {
      ReadBetweenFrames(from, person.entry[v], step, take.time_s[f], view.normalised.data() + f * keypoints,
                        view.confidence.data() + f * keypoints);
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace mocurate
