#include "core/quality/duplicates.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nanoflann.hpp>
#include <numeric>
#include <set>

#include "core/motion/gaps.h"

namespace mocurate {
namespace {

constexpr int kMostJoints = 24;     ///< those with the longest bones: fingers contribute little
constexpr int kComponents = 24;     ///< of the distances of a frame
constexpr int kKeyComponents = 10;  ///< of a window, in the tree
constexpr double kStep_s = 0.05;    ///< of a track
constexpr double kSmooth_s = 0.08;  ///< standard deviation of the smoothing
constexpr int kEndSteps = 2;        ///< steps at the ends of a motion that are not compared
constexpr int kSamples = 5;         ///< of a window
constexpr int kIndexed = 2;         ///< steps between indexed windows
constexpr int kLeastAsked = 4;      ///< least windows of a motion that are looked up, if it has them
constexpr int kMostApart = 12;      ///< steps between them, at most
constexpr double kShifts[] = {0.0, 1.0 / 3.0, 2.0 / 3.0};  ///< of indexed windows, at which it is looked up
constexpr int kLearnt = 4096;                              ///< frames and windows for the principal components
constexpr double kSearchReach = 1.5;    ///< of the tree's search, in limits: windows of tree and track do not coincide
constexpr double kOverlap = 0.8;        ///< share of the overlap in time that must match: takes agree in parts
constexpr double kIndexedSpread = 0.3;  ///< of all joints together, where one joint alone moves
constexpr double kMisplaced = 5.0;      ///< limits that two windows may be apart before their shift is found
constexpr double kFar = 3.0;            ///< limits beyond which a single moment ends a stretch
constexpr double kFull_s = 1.0;         ///< shorter stretches may differ by less, as the square root of their length
constexpr double kSpread = 0.007;       ///< metres about the mean, of the joint that moves most: still motions match
constexpr double kWhole = 0.9;          ///< share of both clips from which on they count as equal as a whole

using MatrixRow = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The distances used, and their permutation when the sides are exchanged.
struct JointPairs {
  std::vector<std::array<int, 2>> pairs;
  std::vector<int> mirrored;

  int count() const { return static_cast<int>(pairs.size()); }
};

JointPairs DistancePairsOf(const Skeleton& skeleton) {
  std::vector<int> joints(skeleton.joints.size());
  std::iota(joints.begin(), joints.end(), 0);
  const auto partner = [&](int j) { return skeleton.joints[j].mirror >= 0 ? skeleton.joints[j].mirror : j; };
  const auto length = [&](int j) { return skeleton.joints[j].rest_offset.norm(); };
  if (static_cast<int>(joints.size()) > kMostJoints) {
    // Partners stay together: the longer bone of both counts.
    std::stable_sort(joints.begin(), joints.end(), [&](int a, int b) {
      return std::max(length(a), length(partner(a))) > std::max(length(b), length(partner(b)));
    });
    const std::set<int> chosen(joints.begin(), joints.begin() + kMostJoints);
    joints.clear();
    for (const int j : chosen) {
      if (chosen.count(partner(j)) > 0) joints.push_back(j);
    }
  }
  JointPairs pairs;
  std::map<std::array<int, 2>, int> place;
  for (std::size_t a = 0; a < joints.size(); ++a) {
    for (std::size_t b = a + 1; b < joints.size(); ++b) {
      place[{joints[a], joints[b]}] = pairs.count();
      pairs.pairs.push_back({joints[a], joints[b]});
    }
  }
  for (const auto& [a, b] : pairs.pairs) {
    const int one = partner(a), other = partner(b);
    pairs.mirrored.push_back(place.at({std::min(one, other), std::max(one, other)}));
  }
  return pairs;
}

Eigen::RowVectorXf DistancesOf(const Motion& motion, int frame, const JointPairs& pairs) {
  Eigen::RowVectorXf row(pairs.count());
  for (int p = 0; p < pairs.count(); ++p) {
    const auto& [a, b] = pairs.pairs[static_cast<std::size_t>(p)];
    row[p] = static_cast<float>((motion.joints.at(frame, a) - motion.joints.at(frame, b)).norm());
  }
  return row;
}

struct Components {
  Eigen::RowVectorXf mean;  ///< (P)
  Eigen::MatrixXf basis;    ///< (P,D) orthonormal columns
};

Components Learn(const MatrixRow& rows, int count) {
  Components components;
  components.mean = rows.colwise().mean();
  const Eigen::MatrixXd centred = (rows.rowwise() - components.mean).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred);
  components.basis =
      solver.eigenvectors().rightCols(std::min<Eigen::Index>(count, rows.cols())).rowwise().reverse().cast<float>();
  return components;
}

/// A motion every kStep_s: components of its distances, smoothed. Metres times the root of the number of distances.
using Track = MatrixRow;

/// Steps skipped at both ends, where smoothing has one side only; 0 for a motion that is too short.
int MarginOf(int steps, int window) { return steps - 2 * kEndSteps > window ? kEndSteps : 0; }

/// What one set of motions is compared by.
class StretchSearch {
 public:
  StretchSearch(std::size_t count, const MotionAt& motion_at, double distance)
      : count_(count), motion_at_(motion_at), distance_(distance) {
    for (std::size_t i = 0; i < count && !skeleton_; ++i) {
      const Motion* motion = motion_at(i);
      if (motion != nullptr && motion->frame_count() > 1) skeleton_ = motion->skeleton;
    }
    if (skeleton_ && DistancePairsOf(*skeleton_).count() < kKeyComponents) skeleton_ = nullptr;  // too few joints
    if (!skeleton_) return;
    pairs_ = DistancePairsOf(*skeleton_);
    of_joint_ = Eigen::MatrixXf::Zero(pairs_.count(), skeleton_->joint_count());
    for (int p = 0; p < pairs_.count(); ++p) {
      for (const int joint : pairs_.pairs[static_cast<std::size_t>(p)]) of_joint_(p, joint) = 1.0F;
    }
    const float most = of_joint_.colwise().sum().maxCoeff();  // as many for each that has any
    of_joint_ /= std::max(1.0F, most);
    window_ = std::max(kSamples - 1, static_cast<int>(std::lround(kLeastStretch_s / kStep_s)));
    LearnFrames();
    for (std::size_t i = 0; i < count; ++i) {
      const Motion* motion = motion_at(i);
      const int steps = Comparable(motion) ? StepsOf(*motion) : 0;
      margins_.push_back(MarginOf(steps, window_));
      tracks_.push_back(TrackOf(motion, steps, margins_.back()));
      hz_.push_back(steps > 0 ? motion->rate.hz() : 0.0);
      frames_.push_back(steps > 0 ? motion->frame_count() : 0);
    }
  }

  std::vector<Duplicate> Search() {
    if (!skeleton_ || !LearnWindows()) return {};
    FillTree();
    Stretches found;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      for (const bool mirrored : {false, true}) LookUp(i, mirrored, found);
    }
    std::vector<Duplicate> pairs;
    for (const auto& [indices, stretch] : found) pairs.push_back(InFrames(indices.first, indices.second, stretch));
    return pairs;
  }

 private:
  struct Stretch {
    bool mirrored = false;
    double distance = 0.0;              ///< metres
    double begin_s = 0.0, end_s = 0.0;  ///< of the first motion
    double second_begin_s = 0.0, second_end_s = 0.0;
  };
  using Stretches = std::map<std::pair<std::size_t, std::size_t>, Stretch>;

  Duplicate InFrames(std::size_t first, std::size_t second, const Stretch& stretch) const {
    const auto frame = [&](std::size_t i, double time_s, int more) {
      return std::clamp(static_cast<int>(std::lround(time_s * hz_[i])) + more, 0, frames_[i]);
    };
    Duplicate pair;
    pair.first = first;
    pair.second = second;
    pair.mirrored = stretch.mirrored;
    pair.distance = stretch.distance;
    pair.frame_begin = frame(first, stretch.begin_s, 0);
    pair.frame_end = frame(first, stretch.end_s, 1);
    pair.second_begin = frame(second, stretch.second_begin_s, 0);
    pair.second_end = frame(second, stretch.second_end_s, 1);
    pair.whole = pair.frame_end - pair.frame_begin >= kWhole * frames_[first] &&
                 pair.second_end - pair.second_begin >= kWhole * frames_[second];
    return pair;
  }

  struct Place {
    std::uint32_t motion;
    std::uint32_t step;
  };

  /// The windows as nanoflann reads them.
  struct Keys {
    std::vector<float> values;  ///< (N,kKeyComponents)
    std::size_t kdtree_get_point_count() const { return values.size() / kKeyComponents; }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const { return values[index * kKeyComponents + axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Keys>, Keys, kKeyComponents>;

  double PerLimit() const { return std::sqrt(static_cast<double>(pairs_.count())); }

  bool Comparable(const Motion* motion) const {
    return motion != nullptr && motion->frame_count() > 1 && motion->joint_count() == skeleton_->joint_count() &&
           motion->rate.FrameTime(1) <= kMaxGap_s;
  }

  void LearnFrames() {
    const std::size_t every = std::max<std::size_t>(1, count_ / kLearnt);
    const auto asked = static_cast<int>((count_ + every - 1) / every);
    const int of_each = std::max(1, kLearnt / asked);
    std::vector<Eigen::RowVectorXf> rows;
    for (std::size_t i = 0; i < count_; i += every) {
      const Motion* motion = motion_at_(i);
      if (!Comparable(motion)) continue;
      const int step = std::max(1, motion->frame_count() / of_each);
      for (int f = 0; f < motion->frame_count(); f += step) {
        rows.push_back(DistancesOf(*motion, f, pairs_));
        Eigen::RowVectorXf other(pairs_.count());
        for (int p = 0; p < pairs_.count(); ++p) other[pairs_.mirrored[static_cast<std::size_t>(p)]] = rows.back()[p];
        rows.push_back(other);
      }
    }
    if (rows.empty()) rows.emplace_back(Eigen::RowVectorXf::Zero(pairs_.count()));
    MatrixRow matrix(static_cast<Eigen::Index>(rows.size()), pairs_.count());
    for (std::size_t i = 0; i < rows.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = rows[i];
    frame_ = Learn(matrix, kComponents);
    // The mirror image of a track, in its components: exchange of sides is a permutation of the distances.
    Eigen::MatrixXf exchanged(frame_.basis.rows(), frame_.basis.cols());
    Eigen::RowVectorXf mean(pairs_.count());
    for (int p = 0; p < pairs_.count(); ++p) {
      const int to = pairs_.mirrored[static_cast<std::size_t>(p)];
      exchanged.row(to) = frame_.basis.row(p);
      mean[to] = frame_.mean[p];
    }
    mirror_ = exchanged.transpose() * frame_.basis;  // (D,D): z -> z * mirror
    mirror_offset_ = (mean - frame_.mean) * frame_.basis;
  }

  static int StepsOf(const Motion& motion) {
    return static_cast<int>(std::floor(motion.rate.FrameTime(motion.frame_count() - 1) / kStep_s + 1e-6)) + 1;
  }

  Track TrackOf(const Motion* motion, int steps, int margin) const {
    if (steps == 0) return Track(0, frame_.basis.cols());
    const int F = motion->frame_count();
    MatrixRow projected(F, frame_.basis.cols());
    for (int f = 0; f < F; ++f) projected.row(f) = (DistancesOf(*motion, f, pairs_) - frame_.mean) * frame_.basis;
    Track track(steps - 2 * margin, frame_.basis.cols());
    const double hz = motion->rate.hz();
    for (int s = 0; s < track.rows(); ++s) {
      // Locally weighted linear regression: no bias at the ends of the clip.
      const double t = (s + margin) * kStep_s;
      const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * kSmooth_s * hz)));
      const int middle = static_cast<int>(std::lround(t * hz));
      const int from = std::max(0, middle - reach), to = std::min(F - 1, middle + reach);
      double s0 = 0.0, s1 = 0.0, s2 = 0.0;
      std::vector<double> weight;
      for (int f = from; f <= to; ++f) {
        const double x = motion->rate.FrameTime(f) - t;
        weight.push_back(std::exp(-0.5 * x * x / (kSmooth_s * kSmooth_s)));
        s0 += weight.back();
        s1 += weight.back() * x;
        s2 += weight.back() * x * x;
      }
      const double determinant = s0 * s2 - s1 * s1;
      track.row(s).setZero();
      for (int f = from; f <= to; ++f) {
        const double x = motion->rate.FrameTime(f) - t;
        const double w = weight[static_cast<std::size_t>(f - from)];
        const double share = determinant > 1e-12 * s0 * s2 ? w * (s2 - s1 * x) / determinant : w / s0;
        track.row(s) += static_cast<float>(share) * projected.row(f);
      }
    }
    return track;
  }

  Track Mirrored(const Track& track) const { return (track * mirror_).rowwise() + mirror_offset_; }

  /// Track at a moment between steps.
  static Eigen::RowVectorXf At(const Track& track, double step) {
    const auto from = std::min(static_cast<Eigen::Index>(step), track.rows() - 1);
    const auto to = std::min(from + 1, track.rows() - 1);
    const auto share = static_cast<float>(step - static_cast<double>(from));
    return track.row(from) + share * (track.row(to) - track.row(from));
  }

  /// (kSamples*D) of a window that begins at a moment; its spread about its mean in metres.
  Eigen::RowVectorXf Window(const Track& track, double begin, double* spread = nullptr) const {
    const Eigen::Index D = track.cols();
    Eigen::RowVectorXf window(kSamples * D);
    for (int k = 0; k < kSamples; ++k) {
      window.segment(k * D, D) = At(track, begin + static_cast<double>(window_) * k / (kSamples - 1));
    }
    if (spread != nullptr) {
      Eigen::RowVectorXf mean = Eigen::RowVectorXf::Zero(D);
      for (int k = 0; k < kSamples; ++k) mean += window.segment(k * D, D) / kSamples;
      double sum = 0.0;
      for (int k = 0; k < kSamples; ++k) sum += (window.segment(k * D, D) - mean).squaredNorm() / kSamples;
      *spread = std::sqrt(sum) / PerLimit();
    }
    return window;
  }

  /// Mean square over the distances of each joint, of a difference of two tracks at one moment. (J') square metres
  Eigen::RowVectorXf JointSquares(const Eigen::RowVectorXf& difference) const {
    return (difference * frame_.basis.transpose()).cwiseAbs2() * of_joint_;
  }

  /// Whether a joint moves about its mean by kSpread.
  bool Moves(const Track& track, int first, int last) const {
    const Eigen::RowVectorXf mean = track.middleRows(first, last - first + 1).colwise().mean();
    Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(of_joint_.cols());
    for (int s = first; s <= last; ++s) sum += JointSquares(track.row(s) - mean);
    return sum.maxCoeff() >= kSpread * kSpread * (last - first + 1);
  }

  int WindowsOf(const Track& track) const { return std::max(0, static_cast<int>(track.rows()) - window_); }

  bool LearnWindows() {
    std::int64_t windows = 0;
    for (const Track& track : tracks_) windows += WindowsOf(track);
    const std::int64_t every = std::max<std::int64_t>(1, windows / kLearnt);
    std::vector<Eigen::RowVectorXf> rows;
    std::int64_t at = 0;
    for (const Track& track : tracks_) {
      for (int s = 0; s < WindowsOf(track); ++s, ++at) {
        if (at % every != 0) continue;
        double spread = 0.0;
        const Eigen::RowVectorXf window = Window(track, s, &spread);
        if (spread >= kIndexedSpread * kSpread) rows.push_back(window);
      }
    }
    if (rows.empty()) return false;
    MatrixRow matrix(static_cast<Eigen::Index>(rows.size()), rows.front().cols());
    for (std::size_t i = 0; i < rows.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = rows[i];
    window_components_ = Learn(matrix, kKeyComponents);
    return window_components_.basis.cols() == kKeyComponents;
  }

  std::array<float, kKeyComponents> KeyOf(const Eigen::RowVectorXf& window) const {
    std::array<float, kKeyComponents> key{};
    Eigen::Map<Eigen::RowVectorXf>(key.data(), kKeyComponents) =
        (window - window_components_.mean) * window_components_.basis;
    return key;
  }

  void FillTree() {
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      for (int s = 0; s < WindowsOf(tracks_[i]); s += kIndexed) {
        double spread = 0.0;
        const Eigen::RowVectorXf window = Window(tracks_[i], s, &spread);
        if (spread < kIndexedSpread * kSpread) continue;
        const auto key = KeyOf(window);
        keys_.values.insert(keys_.values.end(), key.begin(), key.end());
        places_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(s)});
      }
    }
    tree_ = std::make_unique<Tree>(kKeyComponents, keys_, nanoflann::KDTreeSingleIndexAdaptorParams(20));
    tree_->buildIndex();
  }

  void LookUp(std::size_t i, bool mirrored, Stretches& found) const {
    if (places_.empty() || tracks_[i].rows() == 0) return;
    const Track own = mirrored ? Mirrored(tracks_[i]) : tracks_[i];
    const double reach = kSearchReach * distance_ * PerLimit() * std::sqrt(static_cast<double>(kSamples));
    std::set<std::pair<std::size_t, int>> compared;  // motion, shift in indexed steps
    std::vector<std::pair<std::uint32_t, float>> near;
    const int step = std::clamp(WindowsOf(own) / kLeastAsked, kIndexed, kMostApart);
    for (int s = 0; s < WindowsOf(own); s += step) {
      for (const double shift : kShifts) {
        const double begin = s + shift * kIndexed;
        if (begin + window_ > static_cast<double>(own.rows() - 1)) continue;
        double spread = 0.0;
        const Eigen::RowVectorXf window = Window(own, begin, &spread);
        if (spread < kIndexedSpread * kSpread) continue;
        const auto key = KeyOf(window);
        near.clear();
        tree_->radiusSearch(key.data(), static_cast<float>(reach * reach), near,
                            nanoflann::SearchParams(0, 0.0F, false));
        for (const auto& [index, unused] : near) {
          const Place& place = places_[index];
          if (place.motion == i || !Near(own, tracks_[place.motion], begin, place.step)) continue;
          const double by = static_cast<double>(place.step) - begin;
          if (!compared.emplace(place.motion, static_cast<int>(std::lround(by / kIndexed))).second) continue;
          Compare(i, place.motion, mirrored, own, begin, by, found);
        }
      }
    }
  }

  /// Whether two windows may be one at another shift: a look at their ends and middle, for most that share a key do
  /// not.
  bool Near(const Track& a, const Track& b, double begin, std::uint32_t step) const {
    const double most = kMisplaced * distance_ * PerLimit();
    for (const int k : {window_ / 2, 0, window_}) {
      if ((At(a, begin + k) - b.row(step + k)).squaredNorm() > most * most) return false;
    }
    return true;
  }

  /// Mean squared distance of a window of `a` to that of `b`, `by` steps later.
  double WindowDistance(const Track& a, const Track& b, double begin, double by) const {
    double sum = 0.0;
    for (int k = 0; k <= window_; ++k) {
      const double at = std::clamp(begin + k + by, 0.0, static_cast<double>(b.rows() - 1));
      sum += (At(a, begin + k) - At(b, at)).squaredNorm();
    }
    return sum / (window_ + 1);
  }

  void Compare(std::size_t i, std::size_t other, bool mirrored, const Track& a, double begin, double by,
               Stretches& found) const {
    const Track& b = tracks_[other];
    double best = WindowDistance(a, b, begin, by), shift = by;
    for (double step = 0.5; step > 0.02; step *= 0.5) {  // steps of the track: from 25 ms to 1 ms
      for (const double tried : {shift - step, shift + step}) {
        const double distance = WindowDistance(a, b, begin, tried);
        if (distance < best) {
          best = distance;
          shift = tried;
        }
      }
    }
    const double limit = distance_ * distance_;
    if (best > limit * PerLimit() * PerLimit()) return;  // no joint is nearer than all together
    // The stretch: from the window outwards, as long as single moments are near and all of it is near in the mean.
    const auto from = static_cast<int>(std::ceil(std::max(0.0, -shift)));
    const auto to = static_cast<int>(std::floor(std::min<double>(a.rows() - 1, b.rows() - 1 - shift)));
    const auto apart = [&](int s) { return JointSquares(a.row(s) - At(b, s + shift)); };
    int first = std::max(from, static_cast<int>(std::ceil(begin)));
    int last = std::min(to, static_cast<int>(std::floor(begin + window_)));
    Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(of_joint_.cols());
    for (int s = first; s <= last; ++s) sum += apart(s);
    const auto grow = [&](int& end, int step, int bound) {
      while (end != bound) {
        const Eigen::RowVectorXf one = apart(end + step);
        if (one.maxCoeff() > kFar * kFar * limit) return;
        sum += one;
        end += step;
      }
    };
    grow(first, -1, from);
    grow(last, 1, to);
    while (last - first >= window_ && sum.maxCoeff() > limit * (last - first + 1)) {
      const Eigen::RowVectorXf one = apart(first), other_end = apart(last);
      const bool at_first = one.maxCoeff() > other_end.maxCoeff();
      sum -= at_first ? one : other_end;
      (at_first ? first : last) += at_first ? 1 : -1;
    }
    const int count = last - first + 1;
    if (count < kOverlap * (to - from + 1)) return;
    const double allowed = limit * std::min(1.0, count * kStep_s / kFull_s);
    if (count < window_ || sum.maxCoeff() > allowed * count || !Moves(a, first, last)) return;
    Stretch stretch;
    stretch.mirrored = mirrored;
    stretch.distance = std::sqrt(std::max(0.0F, sum.maxCoeff()) / static_cast<float>(count));
    // Steps skipped at an end of either are assumed to continue the neighbouring ones.
    const int before = first == from ? std::min(margins_[i], margins_[other]) : 0;
    const int after = last == to ? std::min(margins_[i], margins_[other]) : 0;
    stretch.begin_s = (first - before + margins_[i]) * kStep_s;
    stretch.end_s = (last + after + margins_[i]) * kStep_s;
    stretch.second_begin_s = (first + shift - before + margins_[other]) * kStep_s;
    stretch.second_end_s = (last + shift + after + margins_[other]) * kStep_s;
    if (i > other) {
      std::swap(stretch.begin_s, stretch.second_begin_s);
      std::swap(stretch.end_s, stretch.second_end_s);
    }
    const auto [known, added] = found.emplace(std::minmax(i, other), stretch);
    const auto length = [](const Stretch& s) { return s.end_s - s.begin_s; };
    const double longer = length(stretch) - length(known->second);
    const bool better =
        longer > 0.5 * kStep_s || (longer > -0.5 * kStep_s && stretch.distance < known->second.distance);
    if (!added && better) known->second = stretch;
  }

  std::size_t count_;
  const MotionAt& motion_at_;
  double distance_;  ///< metres
  SkeletonPtr skeleton_;
  JointPairs pairs_;
  Eigen::MatrixXf of_joint_;  ///< (P,J) mean over the distances of each joint
  int window_ = 0;            ///< steps
  Components frame_, window_components_;
  Eigen::MatrixXf mirror_;
  Eigen::RowVectorXf mirror_offset_;
  std::vector<int> margins_;  ///< steps, of each track
  std::vector<double> hz_;    ///< of each motion
  std::vector<int> frames_;
  std::vector<Track> tracks_;
  Keys keys_;
  std::vector<Place> places_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace

std::vector<Duplicate> FindSharedStretches(std::size_t count, const MotionAt& motion, double distance) {
  return StretchSearch(count, motion, distance).Search();
}

}  // namespace mocurate
