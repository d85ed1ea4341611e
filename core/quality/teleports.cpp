#include "core/quality/teleports.h"

#include <algorithm>
#include <map>

#include "core/quality/median.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostStays = 1000;  // looked back over, in numbers that are no motion
constexpr int kPaceFrames = 8;            // on either side of a frame
constexpr double kApart = 1.2;            // metres between the middles of two parts of a body

/// Frames [begin, end] on end (but for frames without anybody) whose steps are possible.
struct Stay {
  int begin = 0;
  int end = 0;     ///< last frame
  int frames = 0;  ///< in which the person is seen
  int best = 0;    ///< frames of the longest chain that ends here
  int before = -1;
};

class JumpPath {
 public:
  JumpPath(const TrackedPoints& points, const TeleportLimits& limits)
      : points_(points), limits_(limits), centres_(BodyCentres(points)) {
    FindSeenSets();
    FindPace();
    Split();
    Chain();
  }

  std::vector<Finding> Teleports() const {
    std::vector<Finding> findings;
    for (std::size_t i = 0; i < stays_.size(); ++i) {
      if (home_[i]) continue;
      const Stay& stay = stays_[i];
      double farthest = 0.0;
      for (int f = stay.begin; f <= stay.end; ++f) {
        if (Seen(f)) farthest = std::max(farthest, FromHome(f));
      }
      const int frames = stay.end - stay.begin + 1;
      findings.push_back(FrameFinding("teleport", stay.begin, stay.end + 1, "", farthest,
                                      "for " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                                          " the person is " + Digits(farthest) +
                                          " m from where the rest of the clip has it; nobody moves faster than " +
                                          Digits(limits_.speed) + " m/s"));
    }
    return findings;
  }

  bool Seen(int f) const { return centres_[static_cast<std::size_t>(f)].seen; }
  const Vector3d& Place(int f) const { return centres_[static_cast<std::size_t>(f)].place; }

 private:
  bool Possible(int from, int to) const {
    const double time = points_.time_s[static_cast<std::size_t>(to)] - points_.time_s[static_cast<std::size_t>(from)];
    double reach = limits_.slack + limits_.speed * time;
    if (!pace_.empty())
      reach +=
          limits_.lost_frames * std::max(pace_[static_cast<std::size_t>(from)], pace_[static_cast<std::size_t>(to)]);
    return Way(from, to).stableNorm() <= reach;
  }

  /// Between frames that see the same points the centres tell it, else the points that both see. The middles of legs
  /// and of a head are a body apart wherever it is.
  Vector3d Way(int from, int to) const {
    const Vector3d way = Place(to) - Place(from);
    if (seen_set_[static_cast<std::size_t>(from)] == seen_set_[static_cast<std::size_t>(to)]) return way;
    if (const auto step = BodyStep(points_, from, to)) return *step;
    return std::max(0.0, 1.0 - kApart / way.stableNorm()) * way;
  }

  void FindSeenSets() {
    std::map<std::vector<bool>, int> sets;
    for (int f = 0; f < points_.frames(); ++f) {
      std::vector<bool> seen(static_cast<std::size_t>(points_.count()));
      for (int k = 0; k < points_.count(); ++k) seen[static_cast<std::size_t>(k)] = points_.sees(f, k);
      seen_set_.push_back(sets.emplace(std::move(seen), static_cast<int>(sets.size())).first->second);
    }
  }

  /// Metres per frame around each frame: the middle step, or half of that over two frames where this is less, as of two
  /// people in turn.
  void FindPace() {
    if (limits_.lost_frames <= 0) return;
    for (int f = 0; f < points_.frames(); ++f) {
      std::vector<double> ones, twos;
      for (int i = std::max(0, f - kPaceFrames); i < std::min(points_.frames() - 1, f + kPaceFrames); ++i) {
        if (Seen(i) && Seen(i + 1)) ones.push_back(Way(i, i + 1).stableNorm());
        if (i + 2 < points_.frames() && Seen(i) && Seen(i + 2)) twos.push_back(0.5 * Way(i, i + 2).stableNorm());
      }
      pace_.push_back(std::min(Median(std::move(ones)), Median(std::move(twos))));
    }
  }

  void Split() {
    for (int f = 0; f < points_.frames(); ++f) {
      if (!Seen(f)) continue;
      if (stays_.empty() || !Possible(stays_.back().end, f)) stays_.push_back({f, f, 0, 0, -1});
      stays_.back().end = f;
      ++stays_.back().frames;
    }
  }

  /// The longest chain of stays, each reachable from the one before; the earlier of two equals.
  void Chain() {
    int last = -1;
    for (std::size_t i = 0; i < stays_.size(); ++i) {
      stays_[i].best = stays_[i].frames;
      for (std::size_t k = i > kMostStays ? i - kMostStays : 0; k < i; ++k) {
        const int length = stays_[k].best + stays_[i].frames;
        if (length <= stays_[i].best || !Possible(stays_[k].end, stays_[i].begin)) continue;
        stays_[i].best = length;
        stays_[i].before = static_cast<int>(k);
      }
      if (last < 0 || stays_[i].best > stays_[static_cast<std::size_t>(last)].best) last = static_cast<int>(i);
    }
    home_.assign(stays_.size(), false);
    for (; last >= 0; last = stays_[static_cast<std::size_t>(last)].before)
      home_[static_cast<std::size_t>(last)] = true;
  }

  /// From the straight line between the last frame at home before and the first after.
  double FromHome(int f) const {
    int before = -1, after = -1;
    for (std::size_t i = 0; i < stays_.size(); ++i) {
      if (!home_[i]) continue;
      if (stays_[i].end < f) before = stays_[i].end;
      if (stays_[i].begin > f && after < 0) after = stays_[i].begin;
    }
    if (before < 0 || after < 0) return Way(before < 0 ? after : before, f).stableNorm();
    const auto at = [&](int frame) { return points_.time_s[static_cast<std::size_t>(frame)]; };
    const double share = (at(f) - at(before)) / (at(after) - at(before));
    return ((1.0 - share) * Way(before, f) + share * Way(after, f)).stableNorm();
  }

  const TrackedPoints& points_;
  const TeleportLimits& limits_;
  std::vector<BodyCentre> centres_;
  std::vector<int> seen_set_;  ///< (frames) the same where the same points are seen
  std::vector<double> pace_;   ///< (frames), or empty: no frames are lost
  std::vector<Stay> stays_;
  std::vector<char> home_;
};

}  // namespace

std::vector<Finding> FindTeleports(const TrackedPoints& points, const TeleportLimits& limits) {
  const JumpPath path(points, limits);
  std::vector<Finding> findings = path.Teleports();
  for (int k = 0; k < points.count(); ++k) {
    for (int f = 0; f < points.frames(); ++f) {
      const int begin = f;
      double farthest = 0.0;
      for (; f < points.frames() && path.Seen(f) && points.sees(f, k); ++f) {
        const double distance = (points.at(f, k) - path.Place(f)).stableNorm();
        if (distance <= limits.reach) break;
        farthest = std::max(farthest, distance);
      }
      if (f == begin) continue;
      findings.push_back(FrameFinding("joint_far", begin, f, points.name(k), farthest,
                                      "'" + points.name(k) + "' is " + Digits(farthest) +
                                          " m from the middle of the body in " + std::to_string(f - begin) +
                                          (f - begin == 1 ? " frame" : " frames")));
    }
  }
  return findings;
}

}  // namespace mocurate
