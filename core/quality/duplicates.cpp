#include "core/quality/duplicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/base/median.h"
#include "core/quality/checks.h"

namespace mocurate {
namespace {

constexpr double kPoseStep = 2e-4;  // metres

/// Points with gaps filled linearly in time; false where a point is never observed.
bool Fill(const TrackedPoints& points, JointPositions& filled, std::vector<double>& time) {
  std::vector<int> frames;
  const std::vector<BodyCentre> centres = BodyCentres(points);
  for (int f = 0; f < points.frames(); ++f) {
    if (centres[static_cast<std::size_t>(f)].seen) frames.push_back(f);
  }
  if (frames.size() < 2) return false;
  const int begin = frames.front(), end = frames.back() + 1;
  filled = JointPositions(end - begin, points.count());
  for (int f = begin; f < end; ++f) time.push_back(points.time_s[f] - points.time_s[begin]);
  for (int k = 0; k < points.count(); ++k) {
    int last = -1;
    for (int f = begin; f < end; ++f) {
      if (!points.sees(f, k)) continue;
      const Vector3d place = points.at(f, k);
      for (int gap = last < 0 ? begin : last + 1; gap < f; ++gap) {
        const double share = last < 0 ? 1.0 : static_cast<double>(gap - last) / (f - last);
        const Vector3d before = last < 0 ? place : points.at(last, k);
        filled.at(gap - begin, k) = before + share * (place - before);
      }
      filled.at(f - begin, k) = place;
      last = f;
    }
    if (last < 0) return false;
    for (int gap = last + 1; gap < end; ++gap) filled.at(gap - begin, k) = points.at(last, k);
  }
  return true;
}

/// kSignatureFrames frames of K + 1 points; `pairs` (left, right) give the heading, -1 where unknown.
std::vector<float> PoseSignature(const JointPositions& filled, const std::vector<double>& time,
                                 std::array<int, 2> hips) {
  const int count = filled.joints;
  const auto middle = [&](int f) -> Vector3d {
    if (hips[0] >= 0) return 0.5 * (filled.at(f, hips[0]) + filled.at(f, hips[1]));
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < count; ++k) sum += filled.at(f, k) / count;
    return sum;
  };
  Vector3d mean = Vector3d::Zero(), across = Vector3d::Zero();
  for (int f = 0; f < filled.frames; ++f) {
    mean += middle(f) / filled.frames;
    if (hips[0] >= 0) across += filled.at(f, hips[0]) - filled.at(f, hips[1]);
  }
  const double norm = std::hypot(across.x(), across.z());
  const double c = norm > 0.0 ? across.x() / norm : 1.0;
  const double s = norm > 0.0 ? across.z() / norm : 0.0;
  const auto turned = [&](const Vector3d& p) { return Vector3d(c * p.x() + s * p.z(), p.y(), -s * p.x() + c * p.z()); };
  std::vector<float> shape;
  for (int i = 0; i < kSignatureFrames; ++i) {
    const double at = time.back() * i / (kSignatureFrames - 1);
    const auto next = std::upper_bound(time.begin(), time.end(), at);
    const int to = std::min<int>(static_cast<int>(next - time.begin()), filled.frames - 1);
    const int from = std::max(0, to - 1);
    const double step = time[static_cast<std::size_t>(to)] - time[static_cast<std::size_t>(from)];
    const double share = step > 0.0 ? std::clamp((at - time[static_cast<std::size_t>(from)]) / step, 0.0, 1.0) : 0.0;
    const auto between = [&](const Vector3d& a, const Vector3d& b) -> Vector3d { return a + share * (b - a); };
    for (int k = 0; k <= count; ++k) {
      const Vector3d a = k < count ? Vector3d(filled.at(from, k) - middle(from)) : Vector3d(middle(from) - mean);
      const Vector3d b = k < count ? Vector3d(filled.at(to, k) - middle(to)) : Vector3d(middle(to) - mean);
      const Vector3d place = turned(between(a, b));
      for (int axis = 0; axis < 3; ++axis) shape.push_back(static_cast<float>(place[axis]));
    }
  }
  return shape;
}

/// The power of ten that brings a body of another unit near a person's size: 1 for sides of 0.6 to 6 m. Similarity
/// does not depend on the unit of the recordings.
double ToNaturalSize(const TrackedPoints& points) {
  constexpr double kPerson = 1.9;  // metres
  std::vector<double> sizes;
  for (int f = 0; f < points.frames(); ++f) {
    if (const auto size = points.Extent(f, 2)) sizes.push_back(*size);
  }
  const double size = Median(std::move(sizes));
  return size > 0.0 ? std::pow(10.0, std::round(std::log10(kPerson / size))) : 1.0;
}

std::uint64_t Mixed(std::uint64_t hash, std::uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15u + (hash << 6) + (hash >> 2);
  hash ^= hash >> 31;
  return hash * 0xff51afd7ed558ccdu;
}

/// Of the distances of all points from the first two that lie apart: the same after any rigid movement.
std::uint64_t PoseHash(const TrackedPoints& points, int f, double scale) {
  for (int k = 0; k < points.count(); ++k) {
    if (!points.sees(f, k)) return 0;
  }
  std::uint64_t hash = 0x6d6f637572617465u;
  for (int k = 1; k < points.count(); ++k) {
    for (const int from : {0, points.count() / 2}) {
      const double distance = scale * (points.at(f, k) - points.at(f, from)).norm();
      hash = Mixed(hash, static_cast<std::uint64_t>(std::llround(distance / kPoseStep)));
    }
  }
  return hash == 0 ? 1 : hash;
}

double Distance(const std::vector<float>& a, const std::vector<float>& b, double limit, std::size_t points) {
  const double most = limit * limit * static_cast<double>(points);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - b[i];
    sum += d * d;
    if ((i & 63u) == 63u && sum > most) break;
  }
  return std::sqrt(sum / static_cast<double>(points));
}

double Norm(const std::vector<float>& a) {
  double sum = 0.0;
  for (const float value : a) sum += static_cast<double>(value) * value;
  return std::sqrt(sum);
}

using DuplicatePairs = std::map<std::pair<std::size_t, std::size_t>, Duplicate>;

Duplicate& PairOf(DuplicatePairs& pairs, std::size_t a, std::size_t b) {
  Duplicate& pair = pairs[{std::min(a, b), std::max(a, b)}];
  pair.first = std::min(a, b);
  pair.second = std::max(a, b);
  return pair;
}

std::vector<Duplicate> ListOf(const DuplicatePairs& pairs) {
  std::vector<Duplicate> duplicates;
  for (const auto& [indices, pair] : pairs) duplicates.push_back(pair);
  return duplicates;
}

MotionSignature SignatureOf(const Motion& motion) {
  const std::vector<double> all_seen;
  std::vector<double> time_s;
  std::vector<std::string> names;
  for (int f = 0; f < motion.frame_count(); ++f) time_s.push_back(motion.rate.FrameTime(f));
  for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
  return mocurate::SignatureOf({motion.joints, all_seen, time_s, names});
}

/// The norm of a signature and that of its mirror image are equal, so that one order serves both.
void CompareShapes(const std::vector<MotionSignature>& clips, const DuplicateLimits& limits, DuplicatePairs& pairs) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!clips[i].shape.empty() && clips[i].spread >= 4.0 * limits.distance)
      order.emplace_back(Norm(clips[i].shape), i);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const MotionSignature& a = clips[order[i].second];
    const std::size_t points = a.shape.size() / 3;
    const double window = limits.distance * std::sqrt(static_cast<double>(points)) * (1.0 + 1e-6) + 1e-6;
    for (std::size_t k = i + 1; k < order.size() && order[k].first - order[i].first <= window; ++k) {
      const MotionSignature& b = clips[order[k].second];
      if (a.shape.size() != b.shape.size()) continue;
      const double same = Distance(a.shape, b.shape, limits.distance, points);
      const bool sides = !a.mirrored.empty() && a.mirrored.size() == b.shape.size();
      const double mirrored = sides ? Distance(a.mirrored, b.shape, limits.distance, points) : 2.0 * limits.distance;
      if (std::min(same, mirrored) > limits.distance) continue;
      Duplicate& pair = PairOf(pairs, order[i].second, order[k].second);
      pair.whole = true;
      pair.mirrored = mirrored < same;
      pair.distance = std::min(same, mirrored);
      pair.frame_end = static_cast<int>(clips[pair.first].poses.size());
      pair.second_end = static_cast<int>(clips[pair.second].poses.size());
    }
  }
}

void ComparePoses(const std::vector<MotionSignature>& clips, const DuplicateLimits& limits, DuplicatePairs& pairs) {
  constexpr std::size_t kCommon = 50;  // a pose in more clips than this is a rest pose, which distinguishes none
  struct PoseSample {
    std::uint64_t pose;
    std::uint32_t clip, frame;
  };
  std::vector<PoseSample> samples;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    for (std::size_t f = 0; f < clips[i].poses.size(); ++f) {
      if (clips[i].poses[f] == 0) continue;
      samples.push_back({clips[i].poses[f], static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(f)});
    }
  }
  const auto place = [](const PoseSample& sample) { return std::make_tuple(sample.pose, sample.clip, sample.frame); };
  std::sort(samples.begin(), samples.end(),
            [&](const PoseSample& a, const PoseSample& b) { return place(a) < place(b); });
  const auto same = [](const PoseSample& a, const PoseSample& b) { return a.pose == b.pose && a.clip == b.clip; };
  samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());  // each pose once a clip
  DuplicatePairs shared;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    while (end < samples.size() && samples[end].pose == samples[begin].pose) ++end;
    if (end - begin > kCommon) continue;
    for (std::size_t a = begin; a < end; ++a) {
      for (std::size_t b = a + 1; b < end; ++b) {
        Duplicate& pair = PairOf(shared, samples[a].clip, samples[b].clip);
        const int f = static_cast<int>(samples[a].frame), g = static_cast<int>(samples[b].frame);
        pair.frame_begin = pair.shared == 0 ? f : std::min(pair.frame_begin, f);
        pair.frame_end = std::max(pair.frame_end, f + 1);
        pair.second_begin = pair.shared == 0 ? g : std::min(pair.second_begin, g);
        pair.second_end = std::max(pair.second_end, g + 1);
        ++pair.shared;
      }
    }
  }
  for (const auto& [indices, pair] : shared) {
    if (pair.shared >= limits.shared_frames) pairs.emplace(indices, pair).first->second.shared = pair.shared;
  }
}

}  // namespace

MotionSignature SignatureOf(const TrackedPoints& points) {
  MotionSignature signature;
  signature.points = points.count();
  const double scale = ToNaturalSize(points);
  for (int f = 0; f < points.frames(); ++f)
    signature.poses.push_back(points.count() < 3 ? 0 : PoseHash(points, f, scale));
  JointPositions filled;
  std::vector<double> time;
  if (!Fill(points, filled, time)) return signature;
  for (double& value : filled.xyz) value *= scale;
  const LimbPairs limbs = FindLimbPairs(points.names);
  std::array<int, 2> hips{-1, -1};
  for (const auto& pair : limbs.arms) {
    if (points.name(pair[0]).find("houlder") != std::string::npos) hips = pair;
  }
  for (const auto& pair : limbs.legs) {
    const std::string name = points.name(pair[0]);
    if (name.find("hip") != std::string::npos || name.find("pperLeg") != std::string::npos) hips = pair;
  }
  signature.shape = PoseSignature(filled, time, hips);
  const std::size_t stride = signature.shape.size() / kSignatureFrames;
  double spread = 0.0;
  for (std::size_t i = 0; i < stride; ++i) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t f = 0; f < kSignatureFrames; ++f) {
      const double value = signature.shape[f * stride + i];
      sum += value / kSignatureFrames;
      squares += value * value / kSignatureFrames;
    }
    spread += std::max(0.0, squares - sum * sum);
  }
  signature.spread = std::sqrt(spread / (static_cast<double>(stride) / 3.0));
  if (hips[0] < 0) return signature;
  std::vector<int> partner(static_cast<std::size_t>(points.count()) + 1);
  std::iota(partner.begin(), partner.end(), 0);
  for (const auto* pairs : {&limbs.arms, &limbs.legs}) {
    for (const auto& [left, right] : *pairs)
      std::swap(partner[static_cast<std::size_t>(left)], partner[static_cast<std::size_t>(right)]);
  }
  signature.mirrored.resize(signature.shape.size());
  for (std::size_t f = 0; f < kSignatureFrames; ++f) {
    for (std::size_t k = 0; k < partner.size(); ++k) {
      const float* from = &signature.shape[f * stride + 3 * static_cast<std::size_t>(partner[k])];
      float* to = &signature.mirrored[f * stride + 3 * k];
      to[0] = -from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  }
  return signature;
}

std::vector<Duplicate> FindDuplicates(const std::vector<MotionSignature>& clips, const DuplicateLimits& limits) {
  DuplicatePairs pairs;
  CompareShapes(clips, limits, pairs);
  ComparePoses(clips, limits, pairs);
  return ListOf(pairs);
}

std::vector<Duplicate> FindDuplicates(std::size_t count, const MotionAt& motion_at, double distance) {
  constexpr double kShortest_s = 1.5 * kLeastStretch_s;  // shorter clips are compared as a whole
  constexpr int kFewJoints = 6;                          // of a motion that is compared as a whole too
  DuplicatePairs pairs;
  for (const Duplicate& stretch : FindSharedStretches(count, motion_at, distance))
    pairs.emplace(std::make_pair(stretch.first, stretch.second), stretch);
  std::vector<MotionSignature> signatures(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Motion* motion = motion_at(i);
    if (motion == nullptr) continue;
    signatures[i] = SignatureOf(*motion);
    if (motion->duration() <= kShortest_s || motion->joint_count() < kFewJoints) continue;
    signatures[i].shape = {};
    signatures[i].mirrored = {};
  }
  DuplicateLimits limits;
  limits.distance = distance;
  for (const Duplicate& pair : FindDuplicates(signatures, limits))
    pairs.emplace(std::make_pair(pair.first, pair.second), pair);
  return ListOf(pairs);
}

}  // namespace mocurate
