// bench_terms: microseconds that each term of tests/fitting/term_cases.h takes: its rows alone, in the equations of the
// banded solver, and in a Ceres problem.
#include <benchmark/benchmark.h>

#include "fitting/solver/ceres_poses.h"
#include "fitting/solver/pose_equations.h"
#include "tests/fitting/term_cases.h"

namespace mocurate {
namespace {

struct Nothing {
  template <class Rows>
  void operator()(const Rows& rows) {
    benchmark::DoNotOptimize(rows.r[0]);
  }
};

void RegisterAll(TermProblem& problem) {
  static const std::vector<TermCase> cases = problem.Cases();
  PoseState& state = problem.state();
  for (const TermCase& one : cases) {
    benchmark::RegisterBenchmark((one.name + "/rows").c_str(), [&](benchmark::State& run) {
      const PoseTerms terms = problem.TermsOf(one);
      Nothing nothing;
      for (auto _ : run) {
        VisitFrame<true>(terms, state, 0, nothing);
        VisitNext<true>(terms, state, 0, nothing);
      }
    })->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark((one.name + "/banded").c_str(), [&](benchmark::State& run) {
      const PoseTerms terms = problem.TermsOf(one);
      PoseEquations pose(state);
      BlockTridiagonal equations(one.frames, pose.columns().size());
      for (auto _ : run) pose.Linearise(terms, state, equations);
    })->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark((one.name + "/ceres").c_str(), [&](benchmark::State& run) {
      const PoseTerms terms = problem.TermsOf(one);
      CeresPoses poses(terms, state);
      for (auto _ : run) poses.PrepareForEvaluation(true, true);
    })->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mocurate::TermProblem problem(mocurate::Regime::kRandom);
  mocurate::RegisterAll(problem);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
