// Precision and recall of the audit for label errors: symmetric ones planted in a dataset assumed correct, pooled over
// draws.
//
//   bench_label_noise DATASET.h5 [SHARE [DRAWS]]
//
// Prints the precision of the ranking at a recall of 0.8, and precision and recall at the audit's own threshold. Real
// errors of the set count against the audit.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "canon/audit/audit.h"
#include "core/base/random.h"

namespace {

using namespace mocurate;

struct Judged {
  double margin;
  bool planted, suspect;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_label_noise DATASET.h5 [SHARE [DRAWS]]\n");
    return 2;
  }
  const double share = argc > 2 ? std::atof(argv[2]) : 0.03;
  const int draws = argc > 3 ? std::atoi(argv[3]) : 20;
  auto dataset = ReadDataset(argv[1]);
  if (!dataset) {
    std::fprintf(stderr, "%s\n", dataset.error().Message().c_str());
    return 3;
  }
  std::vector<Judged> pooled;
  const auto begin = std::chrono::steady_clock::now();
  for (int draw = 0; draw < draws; ++draw) {
    Dataset changed = *dataset;
    std::vector<bool> planted(changed.clips.size(), false);
    Random random(static_cast<std::uint64_t>(draw), "planted label errors");
    const auto count =
        std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(changed.clips.size()) + 0.5));
    for (std::size_t done = 0; done < count;) {
      const auto row = static_cast<std::size_t>(random.Below(changed.clips.size()));
      if (planted[row]) continue;
      planted[row] = true;
      ++done;
      const auto own = static_cast<std::uint64_t>(changed.LabelIndex(changed.clips[row].label));
      const std::uint64_t other = (own + 1 + random.Below(changed.labels.size() - 1)) % changed.labels.size();
      changed.clips[row].label = changed.labels[static_cast<std::size_t>(other)];
    }
    const LabelAudit audit = AuditLabels(changed, LabelNoiseOptions());
    for (std::size_t i = 0; i < audit.rows.size(); ++i) {
      pooled.push_back(
          {audit.judged[i].margin, planted[static_cast<std::size_t>(audit.rows[i])], audit.judged[i].suspect});
    }
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::sort(pooled.begin(), pooled.end(), [](const Judged& a, const Judged& b) { return a.margin < b.margin; });
  double all = 0.0, suspects = 0.0, right = 0.0, found = 0.0, at = 0.0, precision = 0.0;
  for (const Judged& one : pooled) {
    all += one.planted ? 1.0 : 0.0;
    suspects += one.suspect ? 1.0 : 0.0;
    right += one.suspect && one.planted ? 1.0 : 0.0;
  }
  for (const Judged& one : pooled) {
    at += 1.0;
    found += one.planted ? 1.0 : 0.0;
    if (found >= 0.8 * all) {
      precision = found / at;
      break;
    }
  }
  std::printf("%s: %zu clips, %.0f planted errors in %d draws\n", argv[1], dataset->clips.size(), all, draws);
  std::printf("ranking: precision %.3f at recall 0.8\n", precision);
  std::printf("threshold: precision %.3f, recall %.3f, %.1f suspects per draw\n", right / std::max(1.0, suspects),
              right / std::max(1.0, all), suspects / draws);
  std::printf("%.2f s per draw\n", seconds / draws);
  return 0;
}
