#include "ingest/checks/rate_checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kLeastLikely = 5.0, kMostLikely = 500.0;  // Hz
constexpr double kSame = 0.005;                            // of a rate that was rounded

constexpr std::array<double, 22> kUsual = {10, 12, 12.5, 15,  20,  24,  25,  30,  48,  50,  60,
                                           75, 90, 100,  120, 144, 150, 200, 240, 250, 300, 500};

struct NamedRate {
  double hz;
  const char* word;
};

std::string RateText(double value) { return RoundedText(value, 6); }

}  // namespace

std::optional<double> NearestUsualRate(double hz) {
  const auto* usual =
      std::find_if(kUsual.begin(), kUsual.end(), [&](double rate) { return std::abs(hz / rate - 1.0) < kSame; });
  return usual == kUsual.end() ? std::nullopt : std::optional<double>(*usual);
}

std::optional<Finding> CheckStatedRate(double hz, RateUnit word, const std::string& place) {
  if (!(hz > 0.0) || (hz > kSlowestRecorded_hz && hz <= kFastestRecorded_hz)) return std::nullopt;
  const bool seconds = word == RateUnit::kSecondsPerFrame;
  const double written = seconds ? 1.0 / hz : hz;
  const std::array<NamedRate, 4> readings = {
      {{seconds ? written : 1.0 / written, seconds ? "frames per second" : "seconds per frame"},
       {1e3 / written, "milliseconds per frame"},
       {1e6 / written, "microseconds per frame"},
       {seconds ? 1e-3 / written : 1e3 * written, seconds ? "seconds per 1000 frames" : "frames per millisecond"}}};
  const auto likely = [](const NamedRate& reading) { return reading.hz >= kLeastLikely && reading.hz <= kMostLikely; };
  const auto* best = std::find_if(readings.begin(), readings.end(), [&](const NamedRate& reading) {
    return likely(reading) && NearestUsualRate(reading.hz);
  });
  if (best == readings.end()) best = std::find_if(readings.begin(), readings.end(), likely);
  Finding finding = MakeFinding("rate_implausible", Severity::kError, hz, "");
  finding.message = place + ": " + (seconds ? "Frame Time: " : "") + RateText(written) +
                    (seconds ? " is " + RateText(hz) + " frames per second: " : " frames per second: ") +
                    "motion is not recorded at " + (hz > kFastestRecorded_hz ? "more than 2000" : "1 or less") + "; ";
  if (best == readings.end()) {
    finding.message += "correct it, or declare ingest.source.rate";
  } else {
    finding.message += RateText(written) + " looks like " + best->word + ": write " +
                       (seconds ? "Frame Time: " + RateText(1.0 / best->hz) : RateText(best->hz)) +
                       ", or declare ingest.source.rate: " + RateText(best->hz);
  }
  return finding;
}

}  // namespace mocurate
