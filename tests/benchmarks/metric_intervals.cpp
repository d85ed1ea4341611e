// How often intervals and tests of features hold what they say, on distributions whose true distances are known; prints
// one JSON line. 30 features with the spectrum 1/k and trace 25, normal or bent by tanh (docs/evaluation.md).
//   metric_intervals copies N [trials] [bent]          row and real set from one distribution: difference of FID_equal
//   to
//                                                      Real with its standard error, share of p of at most 0.05
//   metric_intervals intervals N FID [trials]          95 % intervals of FID_inf and KID: share that hold the truth,
//   mean
//                                                      width; FID of both samples, its bias
//   metric_intervals accuracy N SHARE [trials]         the same of accuracy
//   metric_intervals persons N FID [trials]            as `intervals`, the real set of 40 persons

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "eval/metrics/frechet_sampling.h"
#include "tests/support/known_features.h"

namespace mocurate {
namespace {

constexpr int kFeatures = 30;
constexpr int kThreads = 2;

struct Trial {
  double value = 0.0, width = 0.0, other = 0.0, other_width = 0.0, biased = 0.0;
  bool held = false, other_held = false, fired = false;
};

template <class Work>
std::vector<Trial> Trials(int count, Work&& work) {
  std::vector<Trial> trials(static_cast<std::size_t>(count));
  ParallelFor(count, 1, kThreads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) trials[static_cast<std::size_t>(i)] = work(i);
  });
  return trials;
}

template <class Value>
double Mean(const std::vector<Trial>& trials, Value&& value) {
  double sum = 0.0;
  for (const Trial& trial : trials) sum += value(trial);
  return sum / static_cast<double>(trials.size());
}

bool Holds(const SampledInterval& interval, double truth) {
  return interval.ends[0] <= truth && truth <= interval.ends[1];
}

void Copies(int n, int trials, bool bent) {
  const int draws = n > 1000 ? 20 : 100;
  const std::vector<Trial> all = Trials(trials, [&](int i) {
    const KnownFeatures known(kFeatures, bent, i);
    const FeatureSample row = known.Motions(n, "row"), real = known.Motions(n, "real");
    Trial trial;
    const auto fid = FidAtEqualSizes(&row.features, real.features, draws, 1);
    Random random(1, "exchanges", std::to_string(i));
    const auto none = FidsOfNoDifference(row, real, 199, random);
    if (!fid || !none) std::abort();
    trial.value = fid->row - fid->real;
    trial.fired = none->p <= 0.05;
    return trial;
  });
  const double mean = Mean(all, [](const Trial& t) { return t.value; });
  const double square = Mean(all, [&](const Trial& t) { return (t.value - mean) * (t.value - mean); });
  std::printf(
      "{\"copies\": %d, \"bent\": %s, \"trials\": %d, \"difference\": %.5f, \"standard_error\": %.5f, \"fired\": "
      "%.4f}\n",
      n, bent ? "true" : "false", trials, mean, std::sqrt(square / trials),
      Mean(all, [](const Trial& t) { return t.fired ? 1.0 : 0.0; }));
}

void Intervals(int n, double fid, int trials, bool of_persons) {
  const double shift = std::sqrt(fid);
  const int each = of_persons ? std::max(1, n / 40) : 1;
  const auto real_of = [&](const KnownFeatures& known, int count) {
    return of_persons ? known.Persons(count / each, each, "real") : known.Motions(count, "real");
  };
  const std::vector<Trial> others = Trials(400, [&](int i) {
    const KnownFeatures other(kFeatures, false, 1000000 + i);
    Trial trial;
    trial.value = KernelDistanceOfAll(other.Motions(1000, "row", shift), other.Motions(1000, "real"))->value;
    return trial;
  });
  const double kid = Mean(others, [](const Trial& t) { return t.value; });
  const std::vector<Trial> all = Trials(trials, [&](int i) {
    const KnownFeatures known(kFeatures, false, i);
    const FeatureSample row = known.Motions(n, "row", shift), real = real_of(known, n);
    Random random(1, "exchanges", std::to_string(i));
    const auto none = FidsOfNoDifference(row, real, n > 1000 ? 99 : 199, random);
    const auto first = FirstOrderVariance(row, real);
    const auto limit = ExtrapolatedFid(row, real, 1);
    const auto kernel = KernelDistanceOfAll(row, real);
    if (!none || !first || !limit || !*limit || !kernel) std::abort();
    const int units = std::min(row.units, real.units);
    const auto of_fid = IntervalAbout(**limit, *first + none->variance, units, SampledKind::kMotions);
    const auto of_kid = IntervalAbout(kernel->value, kernel->variance, units, SampledKind::kMotions);
    Trial trial;
    trial.value = **limit;
    trial.held = Holds(*of_fid, fid);
    trial.width = of_fid->ends[1] - of_fid->ends[0];
    trial.other = kernel->value;
    trial.other_held = Holds(*of_kid, kid);
    trial.other_width = of_kid->ends[1] - of_kid->ends[0];
    trial.biased = *FrechetDistance(*StatisticsOf(row.features), *StatisticsOf(real.features));
    return trial;
  });
  std::printf(
      "{\"%s\": %d, \"fid\": %g, \"trials\": %d, \"FID\": %.4f, \"FID_inf\": %.4f, \"held\": %.4f, \"width\": %.3f, "
      "\"kid\": %.4f, \"KID\": %.4f, \"KID_held\": %.4f, \"KID_width\": %.4f}\n",
      of_persons ? "persons" : "intervals", n, fid, trials, Mean(all, [](const Trial& t) { return t.biased; }),
      Mean(all, [](const Trial& t) { return t.value; }), Mean(all, [](const Trial& t) { return t.held ? 1.0 : 0.0; }),
      Mean(all, [](const Trial& t) { return t.width; }), kid, Mean(all, [](const Trial& t) { return t.other; }),
      Mean(all, [](const Trial& t) { return t.other_held ? 1.0 : 0.0; }),
      Mean(all, [](const Trial& t) { return t.other_width; }));
}

void Accuracy(int n, double share, int trials) {
  const std::vector<Trial> all = Trials(trials, [&](int i) {
    FeatureSample sample = KnownFeatures(1, false, i).Motions(n, "row");
    Random random(2, "right", std::to_string(i));
    Eigen::VectorXd right(n);
    for (double& one : right) one = random.Uniform() < share ? 1.0 : 0.0;
    const auto interval = IntervalOfShare(right, sample);
    Trial trial;
    trial.held = Holds(*interval, share);
    trial.width = interval->ends[1] - interval->ends[0];
    return trial;
  });
  std::printf("{\"accuracy\": %d, \"share\": %g, \"trials\": %d, \"held\": %.4f, \"width\": %.4f}\n", n, share, trials,
              Mean(all, [](const Trial& t) { return t.held ? 1.0 : 0.0; }),
              Mean(all, [](const Trial& t) { return t.width; }));
}

int Run(const std::vector<std::string>& arguments) {
  const auto number = [&](std::size_t at, double otherwise) {
    return at < arguments.size() ? std::atof(arguments[at].c_str()) : otherwise;
  };
  const std::string what = arguments.empty() ? "" : arguments[0];
  const int n = static_cast<int>(number(1, 432.0));
  if (what == "copies") {
    Copies(n, static_cast<int>(number(2, 2000.0)), arguments.size() > 3);
  } else if (what == "accuracy") {
    Accuracy(n, number(2, 0.9), static_cast<int>(number(3, 2000.0)));
  } else if (what == "intervals" || what == "persons") {
    Intervals(n, number(2, 0.5), static_cast<int>(number(3, 500.0)), what == "persons");
  } else {
    std::fprintf(stderr, "usage: metric_intervals copies|intervals|persons|accuracy N ...\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) { return mocurate::Run({argv + 1, argv + argc}); }
