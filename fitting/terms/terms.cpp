#include "fitting/terms/terms.h"

namespace mocurate {
namespace {

struct SumOfSquares {
  double twice = 0.0;

  template <int K>
  void operator()(const BodyRows<K>& rows) {
    twice += rows.Loss();
  }
  template <class Rows>
  void operator()(const Rows& rows) {
    twice += rows.r.squaredNorm();
  }
};

}  // namespace

double Cost(const PoseTerms& terms, const PoseState& state) {
  SumOfSquares sum;
  for (int i = 0; i < static_cast<int>(terms.frames.size()); ++i) {
    VisitFrame<false>(terms, state, i, sum);
    VisitNext<false>(terms, state, i, sum);
  }
  return 0.5 * sum.twice;
}

}  // namespace mocurate
