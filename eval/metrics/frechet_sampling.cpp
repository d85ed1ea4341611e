#include "eval/metrics/frechet_sampling.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>

namespace mocurate {
namespace {

constexpr double kLeastPart = 0.5;  // of the motions that a part of an extrapolation leaves
constexpr double kEqual = 1e-9;     // relative: FIDs that are equal may differ by the order of their sums

/// Sums of features and of their products; of some motions.
struct Moments {
  double count = 0.0;
  Eigen::VectorXd sum;
  Eigen::MatrixXd squares;

  explicit Moments(Eigen::Index size) : sum(Eigen::VectorXd::Zero(size)), squares(Eigen::MatrixXd::Zero(size, size)) {}

  Moments& operator-=(const Moments& other) {
    count -= other.count;
    sum -= other.sum;
    squares -= other.squares;
    return *this;
  }
};

Moments MomentsOf(const Features& features) {
  Moments moments(features.cols());
  moments.count = static_cast<double>(features.rows());
  moments.sum = features.colwise().sum();
  moments.squares.selfadjointView<Eigen::Lower>().rankUpdate(features.transpose());
  moments.squares = moments.squares.selfadjointView<Eigen::Lower>();
  return moments;
}

Moments MomentsOf(const Features& features, const std::vector<int>& rows) {
  return MomentsOf(Features(features(rows, Eigen::all)));
}

FeatureStatistics FromMoments(const Moments& moments) {
  FeatureStatistics statistics;
  statistics.mean = moments.sum / moments.count;
  statistics.covariance =
      (moments.squares - moments.sum * statistics.mean.transpose()) / std::max(1.0, moments.count - 1.0);
  return statistics;
}

/// FIDs to one set: the root of its covariance is taken once.
class FidTo {
 public:
  explicit FidTo(const FeatureStatistics& reference) : reference_(reference) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(reference.covariance);
    const Eigen::VectorXd roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    root_ = solver.eigenvectors() * roots.asDiagonal() * solver.eigenvectors().transpose();
  }

  double Of(const FeatureStatistics& row) const {
    const Eigen::MatrixXd product = root_ * row.covariance * root_;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (product + product.transpose()),
                                                                Eigen::EigenvaluesOnly);
    return (row.mean - reference_.mean).squaredNorm() + row.covariance.trace() + reference_.covariance.trace() -
           2.0 * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().sum();
  }

 private:
  FeatureStatistics reference_;
  Eigen::MatrixXd root_;
};

double FidOf(const Moments& a, const Moments& b) { return FidTo(FromMoments(b)).Of(FromMoments(a)); }

Status Check(const Features& a, const Features& b) {
  if (const auto first = StatisticsOf(a); !first) return Forward(first);
  if (const auto second = StatisticsOf(b); !second) return Forward(second);
  if (a.cols() == b.cols()) return {};
  return Fail(ErrorCode::kInconsistent,
              std::to_string(a.cols()) + " and " + std::to_string(b.cols()) + " features per motion", "features",
              "compute both sets with the same recogniser");
}

/// Both samples about the mean of the second: sums of products keep their digits.
std::pair<Features, Features> Centred(const Features& a, const Features& b) {
  const Eigen::RowVectorXd origin = b.colwise().mean();
  return {a.rowwise() - origin, b.rowwise() - origin};
}

void Shuffle(std::vector<int>& items, std::size_t first, Random& random) {
  for (std::size_t i = 0; i < first && i + 1 < items.size(); ++i) {
    std::swap(items[i], items[i + random.Below(items.size() - i)]);
  }
}

std::vector<int> Count(int count) {
  std::vector<int> items(static_cast<std::size_t>(count));
  std::iota(items.begin(), items.end(), 0);
  return items;
}

/// Exchanges of motions between two samples within labels: every draw keeps how many of a label each sample has.
class Exchanges {
 public:
  Exchanges(const FeatureSample& a, const FeatureSample& b) {
    auto [first, second] = Centred(a.features, b.features);
    pooled_.resize(first.rows() + second.rows(), first.cols());
    pooled_ << first, second;
    all_ = std::make_unique<Moments>(MomentsOf(pooled_));
    for (int i = 0; i < a.count(); ++i) ++sizes_[a.label[static_cast<std::size_t>(i)]];
    for (int i = 0; i < a.count() + b.count(); ++i) {
      const bool of_a = i < a.count();
      members_[of_a ? a.label[static_cast<std::size_t>(i)] : b.label[static_cast<std::size_t>(i - a.count())]]
          .push_back(i);
    }
    observed_ = Count(a.count());
  }

  const Features& pooled() const { return pooled_; }
  const std::vector<int>& observed() const { return observed_; }
  const Moments& all() const { return *all_; }

  /// Rows of the first sample after an exchange.
  std::vector<int> Draw(Random& random) {
    std::vector<int> rows;
    for (auto& [label, members] : members_) {
      const auto size = static_cast<std::size_t>(sizes_[label]);
      Shuffle(members, size, random);
      rows.insert(rows.end(), members.begin(), members.begin() + static_cast<std::ptrdiff_t>(size));
    }
    std::sort(rows.begin(), rows.end());
    return rows;
  }

  /// Moments of the rows, and of all others.
  std::pair<Moments, Moments> Split(const std::vector<int>& rows) const {
    Moments first = MomentsOf(pooled_, rows), second = *all_;
    second -= first;
    return {std::move(first), std::move(second)};
  }

 private:
  Features pooled_;
  std::unique_ptr<Moments> all_;
  std::map<int, int> sizes_;
  std::map<int, std::vector<int>> members_;
  std::vector<int> observed_;
};

/// One side of FIDs under signs: deviations of units from their label's moments.
class SignedSide {
 public:
  /// `features` and `sample`: of the side. `base`: moments that the side has without deviations, of one motion.
  SignedSide(Features features, const FeatureSample& sample) : features_(std::move(features)), sample_(sample) {
    for (int i = 0; i < sample.count(); ++i) members_[sample.label[static_cast<std::size_t>(i)]].push_back(i);
    for (const auto& [label, members] : members_) own_.emplace(label, MomentsOf(features_, members));
  }

  const std::map<int, Moments>& by_label() const { return own_; }

  void SetBase(const std::map<int, Moments>& pooled) {
    base_ = std::make_unique<Moments>(features_.cols());
    for (const auto& [label, members] : members_) {
      const Moments& all = pooled.at(label);
      const double weight = static_cast<double>(members.size()) / all.count;
      base_->sum += weight * all.sum;
      base_->squares += weight * all.squares;
    }
    base_->count = static_cast<double>(sample_.count());
  }

  Moments Draw(Random& random) const {
    Eigen::VectorXd signs(sample_.units);
    for (double& sign : signs) sign = random.Below(2) == 1 ? 1.0 : -1.0;
    signs *= std::sqrt(sample_.units / (sample_.units - 1.0));
    Eigen::VectorXd of_motion(sample_.count());
    for (int i = 0; i < sample_.count(); ++i) of_motion(i) = signs(sample_.unit[static_cast<std::size_t>(i)]);
    Moments drawn = *base_;
    drawn.sum += features_.transpose() * of_motion;
    drawn.squares += features_.transpose() * of_motion.asDiagonal() * features_;
    for (const auto& [label, members] : members_) {
      const Moments& own = own_.at(label);
      const double sum = of_motion(members).sum() / own.count;
      drawn.sum -= sum * own.sum;
      drawn.squares -= sum * own.squares;
    }
    return drawn;
  }

 private:
  Features features_;
  const FeatureSample& sample_;
  std::map<int, std::vector<int>> members_;
  std::map<int, Moments> own_;
  std::unique_ptr<Moments> base_;
};

std::vector<double> FidsUnderSigns(const FeatureSample& a, const FeatureSample& b, int draws, Random& random) {
  auto [first, second] = Centred(a.features, b.features);
  SignedSide of_a(std::move(first), a), of_b(std::move(second), b);
  std::map<int, Moments> pooled = of_a.by_label();
  for (const auto& [label, moments] : of_b.by_label()) {
    Moments& all = pooled.try_emplace(label, Moments(a.features.cols())).first->second;
    all.count += moments.count;
    all.sum += moments.sum;
    all.squares += moments.squares;
  }
  of_a.SetBase(pooled);
  of_b.SetBase(pooled);
  std::vector<double> fids;
  for (int d = 0; d < draws; ++d) {
    const Moments x = of_a.Draw(random), y = of_b.Draw(random);
    fids.push_back(FidOf(x, y));
  }
  return fids;
}

NoDifference NoDifferenceOf(double observed, const std::vector<double>& fids) {
  NoDifference summary;
  const double n = static_cast<double>(fids.size());
  double mean = 0.0, squares = 0.0;
  int as_far = 1;
  for (const double fid : fids) {
    mean += fid / n;
    as_far += fid >= observed * (1.0 - kEqual) ? 1 : 0;
  }
  for (const double fid : fids) squares += (fid - mean) * (fid - mean);
  summary.p = as_far / (n + 1.0);
  summary.variance = squares / std::max(1.0, n - 1.0);
  return summary;
}

/// Influence of each motion of `a` on its FID to a set of the statistics `of_b`.
Eigen::VectorXd Influence(const Features& features, const FeatureStatistics& of_a, const FeatureStatistics& of_b) {
  constexpr double kSmallest = 1e-10;  // of the largest eigenvalue; below, a direction has no variance
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(of_a.covariance);
  const double least = kSmallest * std::max(solver.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse =
      solver.eigenvalues().unaryExpr([least](double value) { return value > least ? 1.0 / std::sqrt(value) : 0.0; });
  const Eigen::MatrixXd& basis = solver.eigenvectors();
  const Eigen::MatrixXd root = basis * roots.asDiagonal() * basis.transpose();
  const Eigen::MatrixXd back = basis * inverse.asDiagonal() * basis.transpose();
  const Eigen::MatrixXd product = root * of_b.covariance * root;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> middle(0.5 * (product + product.transpose()));
  const Eigen::MatrixXd transport = back * middle.eigenvectors() *
                                    middle.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                                    middle.eigenvectors().transpose() * back;
  const Features centred = features.rowwise() - of_a.mean.transpose();
  const Features moved = centred - centred * transport;
  return (centred.cwiseProduct(moved)).rowwise().sum() + 2.0 * centred * (of_a.mean - of_b.mean);
}

constexpr int kParts = 20;

/// The part of each unit, 0 to `parts` - 1, in equal numbers.
std::vector<int> PartsOfUnits(int units, int parts, Random& random) {
  std::vector<int> order = Count(units), part(order.size());
  Shuffle(order, order.size(), random);
  for (std::size_t i = 0; i < order.size(); ++i) {
    part[static_cast<std::size_t>(order[i])] = static_cast<int>(i) % parts;
  }
  return part;
}

std::vector<Moments> MomentsOfParts(const Features& features, const FeatureSample& sample, int parts, Random& random) {
  const std::vector<int> part = PartsOfUnits(sample.units, parts, random);
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(parts));
  for (int i = 0; i < sample.count(); ++i) {
    const int unit = sample.unit[static_cast<std::size_t>(i)];
    rows[static_cast<std::size_t>(part[static_cast<std::size_t>(unit)])].push_back(i);
  }
  std::vector<Moments> moments;
  for (const std::vector<int>& of_part : rows) moments.push_back(MomentsOf(features, of_part));
  return moments;
}

/// Sums of (x.y / D + 1)^3 over the pairs of two sets.
struct KernelSums {
  Eigen::VectorXd of_a, of_b;  ///< over the other set, of each motion
  Eigen::VectorXd diagonal;    ///< of a set with itself
  double squares = 0.0;

  double all() const { return of_b.sum(); }
};

KernelSums KernelOf(const Features& a, const Features& b) {
  KernelSums sums{Eigen::VectorXd::Zero(a.rows()), Eigen::VectorXd(b.rows()), Eigen::VectorXd(), 0.0};
  const bool own = &a == &b;
  if (own) sums.diagonal.resize(a.rows());
  const double size = static_cast<double>(a.cols());
  Eigen::MatrixXd kernel;  // in blocks that stay in the cache
  for (Eigen::Index begin = 0; begin < b.rows(); begin += kRowsAtOnce) {
    const Eigen::Index n = std::min(kRowsAtOnce, b.rows() - begin);
    kernel.resize(a.rows(), n);
    kernel.noalias() = a * b.middleRows(begin, n).transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
      kernel.col(i) = (kernel.col(i).array() / size + 1.0).cube();
      sums.of_b(begin + i) = kernel.col(i).sum();
      sums.squares += kernel.col(i).squaredNorm();
      if (own) sums.diagonal(begin + i) = kernel(begin + i, i);
      if (!own) sums.of_a += kernel.col(i);
    }
  }
  if (own) sums.of_a = sums.of_b;
  return sums;
}

/// Mean square over pairs of the kernel without its rows' and columns' means, without pairs of a motion with itself.
double PairVariance(const KernelSums& sums) {
  const double n = static_cast<double>(sums.of_a.size()), m = static_cast<double>(sums.of_b.size());
  const Eigen::ArrayXd rows = sums.of_a.array() / m, columns = sums.of_b.array() / n;
  const double mean = rows.mean();
  double left = sums.squares - m * rows.square().sum() - n * columns.square().sum() + n * m * mean * mean;
  const bool own = sums.diagonal.size() > 0;
  if (own) left -= (sums.diagonal.array() - 2.0 * rows + mean).square().sum();
  return std::max(0.0, left) / (n * (m - (own ? 1.0 : 0.0)));
}

bool SameLabels(const FeatureSample& a, const FeatureSample& b) {
  return std::set<int>(a.label.begin(), a.label.end()) == std::set<int>(b.label.begin(), b.label.end());
}

}  // namespace

Expected<EqualSizeFid> FidAtEqualSizes(const Features* row, const Features& real, int draws, std::uint64_t seed) {
  const Features& other = row == nullptr ? real : *row;
  if (Status sound = Check(other, real); !sound) return Forward(sound);
  EqualSizeFid fid;
  fid.draws = draws;
  fid.motions = static_cast<int>(std::min(real.rows() / 2, other.rows()));
  if (fid.motions < 2) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(real.rows()) + " real and " + std::to_string(other.rows()) + " generated motions",
                "FID_equal", "use four real motions and two generated ones, or more");
  }
  const auto n = static_cast<std::size_t>(fid.motions);
  const auto [centred, centred_real] = Centred(other, real);
  std::vector<double> of_real;
  for (int d = 0; d < draws; ++d) {
    Random halves(seed, "equal sizes, real", std::to_string(d));
    std::vector<int> order = Count(static_cast<int>(real.rows()));
    Shuffle(order, 2 * n, halves);
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(n);
    const FidTo to_b(FromMoments(MomentsOf(centred_real, {middle, middle + static_cast<std::ptrdiff_t>(n)})));
    of_real.push_back(to_b.Of(FromMoments(MomentsOf(centred_real, {order.begin(), middle}))));
    if (row == nullptr) continue;
    Random chosen(seed, "equal sizes, row", std::to_string(d));
    std::vector<int> drawn = Count(static_cast<int>(row->rows()));
    Shuffle(drawn, n, chosen);
    drawn.resize(n);
    fid.row += to_b.Of(FromMoments(MomentsOf(centred, drawn))) / draws;
  }
  fid.real = std::accumulate(of_real.begin(), of_real.end(), 0.0) / draws;
  for (const double one : of_real) fid.real_sd += (one - fid.real) * (one - fid.real) / std::max(1, draws - 1);
  fid.real_sd = std::sqrt(fid.real_sd);
  if (row == nullptr) fid.row = fid.real;
  return fid;
}

Expected<NoDifference> FidsOfNoDifference(const FeatureSample& a, const FeatureSample& b, int draws, Random& random) {
  if (!SameLabels(a, b)) {  // then a motion of one of them could never be exchanged
    FeatureSample first = a, second = b;
    std::fill(first.label.begin(), first.label.end(), 0);
    std::fill(second.label.begin(), second.label.end(), 0);
    return FidsOfNoDifference(first, second, draws, random);
  }
  if (Status sound = Check(a.features, b.features); !sound) return Forward(sound);
  if (std::min(a.units, b.units) < 2) {
    return Fail(ErrorCode::kInconsistent, "a set of motions of one person", "FID", "use motions of two persons");
  }
  if (a.units < a.count() || b.units < b.count()) {
    const auto [first, second] = Centred(a.features, b.features);
    return NoDifferenceOf(FidOf(MomentsOf(first), MomentsOf(second)), FidsUnderSigns(a, b, draws, random));
  }
  Exchanges exchanges(a, b);
  const auto fid = [&](const std::vector<int>& rows) {
    const auto [first, second] = exchanges.Split(rows);
    return FidOf(first, second);
  };
  std::vector<double> fids;
  for (int d = 0; d < draws; ++d) fids.push_back(fid(exchanges.Draw(random)));
  return NoDifferenceOf(fid(exchanges.observed()), fids);
}

Expected<FidDifference> DifferenceOfFids(const FeatureSample& a, const FeatureSample& b, const Features& reference,
                                         int draws, Random& random) {
  FidDifference compared;
  compared.motions = std::min(a.count(), b.count());
  const auto first_rows = [&](const FeatureSample& sample) {
    std::vector<int> rows = Count(sample.count());
    Shuffle(rows, static_cast<std::size_t>(compared.motions), random);
    rows.resize(static_cast<std::size_t>(compared.motions));
    std::sort(rows.begin(), rows.end());
    FeatureSample taken;
    taken.features = sample.features(rows, Eigen::all);
    for (const int row : rows) taken.label.push_back(sample.label[static_cast<std::size_t>(row)]);
    return taken;
  };
  FeatureSample one = a.count() == compared.motions ? a : first_rows(a);
  FeatureSample other = b.count() == compared.motions ? b : first_rows(b);
  if (Status sound = Check(one.features, reference); !sound) return Forward(sound);
  if (Status sound = Check(other.features, reference); !sound) return Forward(sound);
  if (!SameLabels(one, other)) {
    std::fill(one.label.begin(), one.label.end(), 0);
    std::fill(other.label.begin(), other.label.end(), 0);
  }
  Exchanges exchanges(one, other);
  const Eigen::RowVectorXd origin = other.features.colwise().mean();  // as of the exchanges
  const FidTo to_reference(FromMoments(MomentsOf(Features(reference.rowwise() - origin))));
  const auto difference = [&](const std::vector<int>& rows) {
    const auto [first, second] = exchanges.Split(rows);
    return to_reference.Of(FromMoments(first)) - to_reference.Of(FromMoments(second));
  };
  compared.difference = difference(exchanges.observed());
  int as_far = 1;
  for (int d = 0; d < draws; ++d) {
    as_far += std::abs(difference(exchanges.Draw(random))) >= std::abs(compared.difference) * (1.0 - kEqual) ? 1 : 0;
  }
  compared.p = as_far / (draws + 1.0);
  return compared;
}

Expected<double> FirstOrderVariance(const FeatureSample& a, const FeatureSample& b) {
  const auto of_a = StatisticsOf(a.features), of_b = StatisticsOf(b.features);
  if (!of_a) return Forward(of_a);
  if (!of_b) return Forward(of_b);
  return VarianceOfMean(Influence(a.features, *of_a, *of_b), a) +
         VarianceOfMean(Influence(b.features, *of_b, *of_a), b);
}

Expected<std::optional<double>> ExtrapolatedFid(const FeatureSample& a, const FeatureSample& b, std::uint64_t seed) {
  if (Status sound = Check(a.features, b.features); !sound) return Forward(sound);
  const int parts = std::min({kParts, a.units, b.units});
  const Eigen::Index fewest = std::min(a.features.rows(), b.features.rows());
  if (parts < 2 || fewest < kMotionsPerFeature * a.features.cols()) return std::optional<double>();
  const auto [first, second] = Centred(a.features, b.features);
  Random random_a(seed, "parts of the row"), random_b(seed, "parts of the reference");
  const std::vector<Moments> of_a = MomentsOfParts(first, a, parts, random_a);
  const std::vector<Moments> of_b = MomentsOfParts(second, b, parts, random_b);
  const Moments all_a = MomentsOf(first), all_b = MomentsOf(second);
  double without = 0.0;
  for (int part = 0; part < parts; ++part) {
    Moments left_a = all_a, left_b = all_b;
    left_a -= of_a[static_cast<std::size_t>(part)];
    left_b -= of_b[static_cast<std::size_t>(part)];
    const double share = std::min(left_a.count / all_a.count, left_b.count / all_b.count);
    const double left = std::min(left_a.count, left_b.count);
    if (share < kLeastPart || left < kMotionsPerFeature * kLeastPart * static_cast<double>(a.features.cols())) {
      return std::optional<double>();  // one person has most of the motions
    }
    without += FidOf(left_a, left_b) / parts;
  }
  return std::optional<double>(parts * FidOf(all_a, all_b) - (parts - 1) * without);
}

Expected<KernelEstimate> KernelDistanceOfAll(const FeatureSample& a, const FeatureSample& b) {
  if (Status sound = Check(a.features, b.features); !sound) return Forward(sound);
  const double n = a.count(), m = b.count();
  const KernelSums xx = KernelOf(a.features, a.features), yy = KernelOf(b.features, b.features),
                   xy = KernelOf(a.features, b.features);
  const Eigen::VectorXd own_a = (xx.of_a - xx.diagonal) / (n - 1.0), own_b = (yy.of_a - yy.diagonal) / (m - 1.0);
  const Eigen::VectorXd of_a = own_a - xy.of_a / m, of_b = own_b - xy.of_b / n;
  KernelEstimate estimate;
  estimate.value = own_a.mean() + own_b.mean() - 2.0 * xy.all() / (n * m);
  const double pairs = 2.0 * PairVariance(xx) / (n * (n - 1.0)) + 2.0 * PairVariance(yy) / (m * (m - 1.0)) +
                       4.0 * PairVariance(xy) / (n * m);
  // The influences, means over finite sets, hold the pairs' variance twice beside their own: near equality this is too
  // wide by a factor of up to 1.4, and without it too narrow elsewhere (89 % held at 80 motions).
  estimate.variance = std::max(VarianceOfMean(2.0 * of_a, a) + VarianceOfMean(2.0 * of_b, b), pairs);
  return estimate;
}

Features Normalised(const Features& features) {
  Features normalised = features;
  for (Eigen::Index i = 0; i < features.rows(); ++i) {
    const double length = features.row(i).norm();
    if (length > 0.0) normalised.row(i) /= length;
  }
  return normalised;
}

}  // namespace mocurate
