#include "core/quality/repeated_stretches.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kFewestPoses = 8;  // different ones
constexpr int kFewestSeen = 3;   // least observed points of a frame
constexpr double kSmoothTurn =
    0.7;                            // change of the step over the step: 0.2 of a walk at 30 Hz, 1.7 of a sensor's noise
constexpr double kUsualStep = 1.1;  // times the mean step: largest step that is not a jump
constexpr int kNoFrame = -1;

/// Frames [begin, end) with equal content.
struct Pose {
  int content = kNoFrame;  ///< the first frame of the clip that shows it
  int begin = 0;
  int end = 0;

  bool operator==(const Pose& other) const {
    return content == other.content && end - begin == other.end - other.begin;
  }
};

/// All observed values of a frame, bit for bit; empty where too few points are observed.
std::string ContentOf(const TrackedPoints& points, int f) {
  std::string bits;
  int seen = 0;
  for (int k = 0; k < points.count(); ++k) {
    bits.push_back(points.sees(f, k) ? '1' : '0');
    if (!points.sees(f, k)) continue;
    ++seen;
    const Vector3d place = points.at(f, k);
    char xyz[3 * sizeof(double)];
    std::memcpy(xyz, place.data(), sizeof(xyz));
    bits.append(xyz, sizeof(xyz));
  }
  return seen < std::min(kFewestSeen, points.count()) ? std::string() : bits;
}

std::vector<Pose> PosesOf(const TrackedPoints& points) {
  std::unordered_multimap<std::size_t, int> firsts;  // frames by the hash of their content
  std::vector<Pose> poses;
  for (int f = 0; f < points.frames(); ++f) {
    const std::string bits = ContentOf(points, f);
    const std::size_t hash = std::hash<std::string>()(bits);
    int content = bits.empty() ? kNoFrame : f;
    const auto same = firsts.equal_range(hash);
    for (auto first = same.first; content == f && first != same.second; ++first) {
      if (ContentOf(points, first->second) == bits) content = first->second;
    }
    if (content == f) firsts.emplace(hash, f);
    if (poses.empty() || poses.back().content != content) poses.push_back({content, f, f});
    poses.back().end = f + 1;
  }
  return poses;
}

/// Frames [begin, end) that repeat those `back` frames earlier.
struct Stretch {
  int begin = 0;
  int end = 0;
  int back = 0;
};

/// The longest that the poses go on as they did when they last began so.
std::vector<Stretch> StretchesOf(const std::vector<Pose>& poses) {
  std::vector<Stretch> stretches;
  std::unordered_map<int, std::size_t> last;  // pose of each content
  for (std::size_t i = 0; i < poses.size();) {
    const auto before = last.find(poses[i].content);
    std::size_t end = i;
    int different = 0;
    if (poses[i].content != kNoFrame && before != last.end()) {
      const std::size_t back = i - before->second;
      std::vector<int> contents;
      for (; end < poses.size() && poses[end] == poses[end - back]; ++end) contents.push_back(poses[end].content);
      std::sort(contents.begin(), contents.end());
      contents.erase(std::unique(contents.begin(), contents.end()), contents.end());
      different = static_cast<int>(contents.size()) - (!contents.empty() && contents.front() == kNoFrame ? 1 : 0);
    }
    if (different >= kFewestPoses)
      stretches.push_back({poses[i].begin, poses[end - 1].end, poses[i].begin - poses[before->second].begin});
    for (end = std::max(end, i + 1); i < end; ++i) last[poses[i].content] = i;
  }
  return stretches;
}

/// Mean length over the points of the step from f - 1 to f, or of how the next step differs from it.
struct Steps {
  const TrackedPoints& points;

  double Step(int f) const { return Mean(f, false); }
  double Turn(int f) const { return Mean(f, true); }

 private:
  double Mean(int f, bool turn) const {
    if (f < 1 || f + (turn ? 1 : 0) >= points.frames()) return 0.0;
    double sum = 0.0;
    int seen = 0;
    for (int k = 0; k < points.count(); ++k) {
      if (!points.sees(f, k) || !points.sees(f - 1, k) || (turn && !points.sees(f + 1, k))) continue;
      const Vector3d step = points.at(f, k) - points.at(f - 1, k);
      sum += turn ? (points.at(f + 1, k) - points.at(f, k) - step).stableNorm() : step.stableNorm();
      ++seen;
    }
    return seen == 0 ? 0.0 : sum / seen;
  }
};

/// Whether a smooth motion continues through the ends of both stretches as within them, or reverses there.
bool IsLoop(const Steps& steps, const Stretch& stretch) {
  double moved = 0.0, turned = 0.0, most = 0.0;
  for (int f = stretch.begin + 1; f + 1 < stretch.end; ++f) {
    const double turn = steps.Turn(f);
    moved += steps.Step(f);
    turned += turn;
    most = std::max(most, turn);
  }
  if (turned > kSmoothTurn * moved) return false;
  const double usual = kUsualStep * moved / (stretch.end - stretch.begin - 2);
  for (const int seam : {stretch.begin, stretch.end, stretch.begin - stretch.back, stretch.end - stretch.back}) {
    if (std::max(steps.Turn(seam - 1), steps.Turn(seam)) > most && steps.Step(seam) > usual) return false;
  }
  return true;
}

}  // namespace

std::vector<Finding> FindRepeatedStretches(const TrackedPoints& points) {
  std::vector<Finding> findings;
  for (const Stretch& stretch : StretchesOf(PosesOf(points))) {
    if (IsLoop({points}, stretch)) continue;
    const int count = stretch.end - stretch.begin, first = stretch.begin - stretch.back;
    findings.push_back(FrameFinding(
        "repeated_stretch", stretch.begin, stretch.end, "", count,
        Counted(count, "frame") + " repeat frames " + std::to_string(first) + " to " +
            std::to_string(first + count - 1) +
            " to the last digit, which no person does: a section that was written twice; remove one of the "
            "two, or export the file again"));
  }
  return findings;
}

}  // namespace mocurate
