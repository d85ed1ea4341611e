#include "ingest/people/person_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestTrackedBones = 4;
constexpr double kFastest = 3.0;             // m/s, of a person in a gap, at most
constexpr double kSlack = 0.4;               // metres on top of it
constexpr double kFarthestSignature = 0.12;  // of SignatureDistance: bones of one person

/// Middle of the joints that are seen in a row of the track.
Vector3d CentreOf(const PersonTrack& track, std::size_t row) {
  Vector3d centre = Vector3d::Zero();
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (int k = 0; k < track.positions.joints; ++k) {
      if (track.sees(row, k)) values.push_back(track.positions.at(static_cast<int>(row), k)[axis]);
    }
    if (!values.empty()) centre[axis] = Median(values);
  }
  return centre;
}

void CopyRow(const PersonTrack& from, std::size_t row, PersonTrack& to) {
  const auto joints = static_cast<std::size_t>(from.positions.joints);
  to.frames.push_back(from.frames[row]);
  const auto xyz = from.positions.xyz.begin() + static_cast<std::ptrdiff_t>(row * joints * 3);
  to.positions.xyz.insert(to.positions.xyz.end(), xyz, xyz + static_cast<std::ptrdiff_t>(joints * 3));
  const auto seen = from.confidence.begin() + static_cast<std::ptrdiff_t>(row * joints);
  to.confidence.insert(to.confidence.end(), seen, seen + static_cast<std::ptrdiff_t>(joints));
  ++to.positions.frames;
}

/// Rows of both in order of their frames; they share none.
PersonTrack JoinedTrack(const PersonTrack& a, const PersonTrack& b) {
  PersonTrack track;
  track.ids = a.ids;
  track.ids.insert(track.ids.end(), b.ids.begin(), b.ids.end());
  track.positions.joints = a.positions.joints;
  std::size_t i = 0, j = 0;
  while (i < a.frames.size() || j < b.frames.size()) {
    const bool first = j == b.frames.size() || (i < a.frames.size() && a.frames[i] < b.frames[j]);
    CopyRow(first ? a : b, first ? i++ : j++, track);
  }
  return track;
}

/// Whether ids are on in each other's gaps, never together, and always where the other just was.
bool Interleaved(const PersonTrack& a, const PersonTrack& b, const std::vector<double>& time_s) {
  if (a.frames.back() < b.frames.front() || b.frames.back() < a.frames.front()) return false;
  std::size_t i = 0, j = 0;
  int switches = 0;
  int last = -1;  // 0: a, 1: b
  Vector3d place = Vector3d::Zero();
  double time = 0.0;
  while (i < a.frames.size() || j < b.frames.size()) {
    if (i < a.frames.size() && j < b.frames.size() && a.frames[i] == b.frames[j]) return false;
    const int now = j == b.frames.size() || (i < a.frames.size() && a.frames[i] < b.frames[j]) ? 0 : 1;
    const PersonTrack& track = now == 0 ? a : b;
    const std::size_t row = now == 0 ? i++ : j++;
    const Vector3d here = CentreOf(track, row);
    const double at = time_s[static_cast<std::size_t>(track.frames[row])];
    if (last >= 0 && now != last) {
      if ((here - place).norm() > kSlack + kFastest * (at - time)) return false;
      ++switches;
    }
    last = now;
    place = here;
    time = at;
  }
  return switches >= 2;
}

void NoteStitch(const PersonTrack& a, const PersonTrack& b, const char* how, std::vector<Finding>& findings) {
  const int between = std::max(0, b.frames.front() - a.frames.back() - 1);
  Finding finding = FrameFinding("ids_stitched", a.frames.back(), b.frames.front() + 1, "", between,
                                 "body ids " + a.Name() + " and " + b.Name() + " are one person, " +
                                     Counted(between, "frame") + " between them: " + how);
  if (finding.frame_end <= finding.frame_begin) finding.frame_begin = finding.frame_end = 0;
  finding.severity = Severity::kInfo;
  finding.action = FindingAction::kRepaired;
  findings.push_back(std::move(finding));
}

void SortByBegin(std::vector<PersonTrack>& tracks) {
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const PersonTrack& a, const PersonTrack& b) { return a.frames.front() < b.frames.front(); });
}

void JoinInterleaved(std::vector<PersonTrack>& tracks, const std::vector<double>& time_s,
                     std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (std::size_t k = i + 1; k < tracks.size();) {
      if (!Interleaved(tracks[i], tracks[k], time_s)) {
        ++k;
        continue;
      }
      NoteStitch(tracks[i], tracks[k], "never present together, at the same place", findings);
      tracks[i] = JoinedTrack(tracks[i], tracks[k]);
      tracks.erase(tracks.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;
    }
  }
}

/// Mean distance of log lengths over the bones that both have; 1 when these are fewer than four.
double SignatureDistance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  std::size_t bones = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    if (a[k] < 0.05 || b[k] < 0.05) continue;  // of shorter bones a tracker is never sure
    sum += std::abs(std::log(a[k] / b[k]));
    ++bones;
  }
  return bones < kFewestTrackedBones ? 1.0 : sum / static_cast<double>(bones);
}

}  // namespace

std::string PersonTrack::Name() const {
  std::string name;
  for (const std::uint64_t id : ids) name += (name.empty() ? "" : "+") + std::to_string(id);
  return name;
}

std::vector<double> JointVariances(const PersonTrack& track) {
  std::vector<double> variances;
  for (int k = 0; k < track.positions.joints; ++k) {
    Vector3d sum = Vector3d::Zero();
    double squares = 0.0, count = 0.0;
    for (std::size_t row = 0; row < track.frames.size(); ++row) {
      if (!track.sees(row, k)) continue;
      const Vector3d place = track.positions.at(static_cast<int>(row), k);
      sum += place;
      squares += place.squaredNorm();
      count += 1.0;
    }
    if (count > 0.0) variances.push_back(std::max(0.0, squares / count - (sum / count).squaredNorm()));
  }
  return variances;
}

double MotionEnergy(const PersonTrack& track) {
  const std::vector<double> variances = JointVariances(track);
  return std::accumulate(variances.begin(), variances.end(), 0.0);
}

std::vector<double> BoneLengths(const PersonTrack& track, const std::vector<int>& parents, std::size_t joint) {
  std::vector<double> lengths;
  if (parents[joint] < 0) return lengths;
  for (std::size_t row = 0; row < track.frames.size(); ++row) {
    if (!track.sees(row, static_cast<int>(joint)) || !track.sees(row, parents[joint])) continue;
    const int r = static_cast<int>(row);
    lengths.push_back((track.positions.at(r, static_cast<int>(joint)) - track.positions.at(r, parents[joint])).norm());
  }
  return lengths;
}

std::vector<double> BoneSignature(const PersonTrack& track, const std::vector<int>& parents) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < parents.size(); ++k) lengths.push_back(Median(BoneLengths(track, parents, k)));
  return lengths;
}

std::vector<PersonTrack> StitchTracks(std::vector<PersonTrack> tracks, const std::vector<int>& parents,
                                      const std::vector<double>& time_s, double max_lost_s,
                                      std::vector<Finding>& findings) {
  constexpr double kNever = 1e9;
  SortByBegin(tracks);
  JoinInterleaved(tracks, time_s, findings);
  const int count = static_cast<int>(tracks.size());
  std::vector<std::vector<double>> signatures;
  for (const PersonTrack& track : tracks) signatures.push_back(BoneSignature(track, parents));
  std::vector<double> costs(static_cast<std::size_t>(count) * static_cast<std::size_t>(count), kNever);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      const PersonTrack& from = tracks[static_cast<std::size_t>(i)];
      const PersonTrack& to = tracks[static_cast<std::size_t>(k)];
      if (i == k || from.frames.back() >= to.frames.front()) continue;
      const double gap =
          time_s[static_cast<std::size_t>(to.frames.front())] - time_s[static_cast<std::size_t>(from.frames.back())];
      const double reach = kSlack + kFastest * gap;
      const double distance = (CentreOf(to, 0) - CentreOf(from, from.frames.size() - 1)).norm();
      const double signature =
          SignatureDistance(signatures[static_cast<std::size_t>(i)], signatures[static_cast<std::size_t>(k)]);
      if (gap > max_lost_s || distance > reach || signature > kFarthestSignature) continue;
      costs[static_cast<std::size_t>(i) * static_cast<std::size_t>(count) + static_cast<std::size_t>(k)] =
          distance / reach + signature / kFarthestSignature;
    }
  }
  const std::vector<int> next = LeastCostAssignment(costs, count, count, 3.0);
  std::vector<char> continues(tracks.size(), 0);
  for (const int to : next) {
    if (to >= 0) continues[static_cast<std::size_t>(to)] = 1;
  }
  std::vector<PersonTrack> people;
  for (int i = 0; i < count; ++i) {
    if (continues[static_cast<std::size_t>(i)] != 0) continue;
    PersonTrack person = tracks[static_cast<std::size_t>(i)];
    for (int to = next[static_cast<std::size_t>(i)]; to >= 0; to = next[static_cast<std::size_t>(to)]) {
      const PersonTrack& more = tracks[static_cast<std::size_t>(to)];
      NoteStitch(person, more, "lost and found again, with the same bones", findings);
      person = JoinedTrack(person, more);
    }
    people.push_back(std::move(person));
  }
  SortByBegin(people);
  return people;
}

/// Hungarian method with potentials (Kuhn 1955; O(rows^2 columns)), on costs to which a column "none" per row is added.
std::vector<int> LeastCostAssignment(const std::vector<double>& costs, int rows, int columns, double none) {
  const int wide = columns + rows;
  const auto cost = [&](int r, int c) {
    if (c >= columns) return none;
    return std::min(
        costs[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c)],
        2.0 * none);
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> u(static_cast<std::size_t>(rows) + 1, 0.0), v(static_cast<std::size_t>(wide) + 1, 0.0);
  std::vector<int> row_of(static_cast<std::size_t>(wide) + 1, 0), way(static_cast<std::size_t>(wide) + 1, 0);
  for (int r = 1; r <= rows; ++r) {
    row_of[0] = r;
    std::vector<double> least(static_cast<std::size_t>(wide) + 1, kInfinity);
    std::vector<char> used(static_cast<std::size_t>(wide) + 1, 0);
    int column = 0;
    do {
      used[static_cast<std::size_t>(column)] = 1;
      const int row = row_of[static_cast<std::size_t>(column)];
      double delta = kInfinity;
      int best = 0;
      for (int c = 1; c <= wide; ++c) {
        const auto at = static_cast<std::size_t>(c);
        if (used[at] != 0) continue;
        const double reduced = cost(row - 1, c - 1) - u[static_cast<std::size_t>(row)] - v[at];
        if (reduced < least[at]) {
          least[at] = reduced;
          way[at] = column;
        }
        if (least[at] < delta) {
          delta = least[at];
          best = c;
        }
      }
      for (int c = 0; c <= wide; ++c) {
        const auto at = static_cast<std::size_t>(c);
        if (used[at] != 0) {
          u[static_cast<std::size_t>(row_of[at])] += delta;
          v[at] -= delta;
        } else {
          least[at] -= delta;
        }
      }
      column = best;
    } while (row_of[static_cast<std::size_t>(column)] != 0);
    do {
      const int before = way[static_cast<std::size_t>(column)];
      row_of[static_cast<std::size_t>(column)] = row_of[static_cast<std::size_t>(before)];
      column = before;
    } while (column != 0);
  }
  std::vector<int> partner(static_cast<std::size_t>(rows), -1);
  for (int c = 1; c <= columns; ++c) {
    const int row = row_of[static_cast<std::size_t>(c)];
    if (row > 0 && cost(row - 1, c - 1) < none) partner[static_cast<std::size_t>(row - 1)] = c - 1;
  }
  return partner;
}

}  // namespace mocurate
