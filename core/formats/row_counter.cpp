#include "core/formats/row_counter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kSlowest_hz = 10.0, kFastest_hz = 250.0;            // of a clock that only its values tell
constexpr double kSlowestNamed_hz = 1.0, kFastestNamed_hz = 2000.0;  // of one that a header names
constexpr double kRateSlack = 0.01;                                  // relative, at the ends of these
constexpr double kDeclaredSlack = 0.05;  // relative, of the declared rate against steps in whole units
constexpr double kJitter = 0.3;          // of the usual step, from a multiple of it
constexpr double kRegular = 0.9;         // share of steps that do not vary by more
constexpr double kMostStill = 0.1;       // share of steps that may be 0 or go back
constexpr std::size_t kFewestSteps = 5;  // of a clock that only its values tell
constexpr int kMostSkipped = 10000;      // frames; a recording of minutes has some thousands

/// What ends a name of letters and digits in lower case, for each unit of ClockUnits.
constexpr std::array<std::string_view, 5> kUnitNames = {
    "seconds second secs sec s", "milliseconds millisecond millis msecs msec ms",
    "microseconds microsecond micros usecs usec us \xc2\xb5s \xce\xbcs", "100nanoseconds 100ns ticks tick",
    "nanoseconds nanosecond nanos nsecs nsec ns"};
constexpr std::array<std::string_view, 13> kTimeNames = {
    "time",        "timestamp",    "timestamps", "t",          "ts",         "clock",   "elapsed",
    "elapsedtime", "relativetime", "reltime",    "devicetime", "systemtime", "unixtime"};
constexpr std::array<std::string_view, 9> kFrameNames = {"frame",   "frames",   "frameno",    "framenum", "framenumber",
                                                         "frameid", "frameidx", "frameindex", "fno"};

template <std::size_t N>
bool IsOneOf(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Letters and digits in lower case, and what is not ASCII.
std::string PlainName(std::string_view text) {
  std::string plain;
  for (const char c : text) {
    const bool upper = c >= 'A' && c <= 'Z';
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
    if (upper || kept) plain += upper ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain;
}

double RateOf(double step, const ClockUnit& unit) { return 1.0 / (step * unit.seconds); }

std::vector<ClockUnit> UnitsBetween(double step, double slowest_hz, double fastest_hz) {
  std::vector<ClockUnit> units;
  for (const ClockUnit& unit : ClockUnits()) {
    const double hz = RateOf(step, unit);
    if (hz >= slowest_hz * (1.0 - kRateSlack) && hz <= fastest_hz * (1.0 + kRateSlack)) units.push_back(unit);
  }
  return units;
}

/// The middle one, the lower of two: rows that are missing make steps longer.
double MiddleStep(std::vector<double> steps) {
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// The usual step of rising values: the mean of those that are about the middle one, then of all with their multiples.
double UsualStep(const std::vector<double>& steps) {
  const double median = MiddleStep(steps);
  double sum = 0.0, count = 0.0;
  for (const double step : steps) {
    if (std::abs(step / median - 1.0) < 0.5) sum += step, count += 1.0;
  }
  const double about = count > 0.0 ? sum / count : median;
  sum = count = 0.0;
  for (const double step : steps) {
    sum += step;
    count += std::max(1.0, std::round(step / about));
  }
  return sum / count;
}

/// The nearest rising line through values, by least squares: neighbours that fall share their mean.
std::vector<double> Rising(const std::vector<double>& values) {
  struct Level {
    double sum = 0.0;
    std::size_t count = 0;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Level> levels;
  for (const double value : values) {
    levels.push_back({value, 1});
    while (levels.size() > 1 && levels[levels.size() - 2].mean() >= levels.back().mean()) {
      const Level last = levels.back();
      levels.pop_back();
      levels.back().sum += last.sum;
      levels.back().count += last.count;
    }
  }
  std::vector<double> rising;
  for (const Level& level : levels) rising.insert(rising.end(), level.count, level.mean());
  return rising;
}

/// Times of damaged rows lie evenly between those of their neighbours, or a step behind. False where no row has one.
bool FillTimes(std::vector<double>& times) {
  std::vector<std::size_t> known;
  std::vector<double> steps;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (std::isnan(times[i])) continue;
    if (!known.empty() && times[i] > times[known.back()] && known.back() + 1 == i)
      steps.push_back(times[i] - times[known.back()]);
    known.push_back(i);
  }
  if (known.empty()) return false;
  const double step = steps.empty() ? 1.0 : MiddleStep(steps);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isnan(times[i])) continue;
    const auto after = std::upper_bound(known.begin(), known.end(), i);
    if (after == known.begin()) {
      times[i] = times[*after] - step * static_cast<double>(*after - i);
    } else if (after == known.end()) {
      times[i] = times[known.back()] + step * static_cast<double>(i - known.back());
    } else {
      const std::size_t before = *(after - 1);
      const double share = static_cast<double>(i - before) / static_cast<double>(*after - before);
      times[i] = (1.0 - share) * times[before] + share * times[*after];
    }
  }
  return true;
}

tl::unexpected<Error> TooManySkipped(double skipped, const std::string& name) {
  return Fail(ErrorCode::kInconsistent,
              FormatDouble(skipped) + " frames have no row by the numbers or times of the rows, at most " +
                  std::to_string(kMostSkipped) + " are allowed",
              name, "check for rows of another recording, and whether the column counts frames");
}

std::string CounterWords(const CounterEstimate& estimate, double least, double most) {
  std::string words = "steps of " + RoundedText(least, 8);
  if (!estimate.equal) words += " to " + RoundedText(most, 8);
  std::string rates;
  for (const ClockUnit& unit : estimate.units)
    rates += (rates.empty() ? ": " : ", ") + RoundedText(RateOf(estimate.step, unit), 5) + " Hz in " + unit.name;
  return words + rates;
}

}  // namespace

const std::vector<ClockUnit>& ClockUnits() {
  static const std::vector<ClockUnit> units = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"100ns", 1e-7}, {"ns", 1e-9}};
  return units;
}

CounterName CounterNameOf(std::string_view name) {
  const std::string plain = PlainName(name);
  if (IsOneOf(kFrameNames, plain)) return {false, true, nullptr};
  if (IsOneOf(kTimeNames, plain)) return {true, false, nullptr};
  for (std::size_t unit = 0; unit < kUnitNames.size(); ++unit) {
    for (const std::string_view ending : SplitBlanks(kUnitNames[unit])) {
      if (plain.size() < ending.size() || plain.compare(plain.size() - ending.size(), ending.size(), ending) != 0)
        continue;
      const std::string_view stem = std::string_view(plain).substr(0, plain.size() - ending.size());
      if (IsOneOf(kTimeNames, stem) || (stem.empty() && ending.size() > 3)) return {true, false, &ClockUnits()[unit]};
    }
  }
  return {};
}

CounterEstimate EstimateCounter(const std::vector<double>& values, const CounterName& name) {
  CounterEstimate estimate;
  std::vector<double> steps;
  std::optional<double> before;
  double largest = 0.0, other = 0.0;
  bool whole = true, back = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    whole = whole && value == std::floor(value);
    largest = std::max(largest, std::abs(value));
    if (before && value > *before) steps.push_back(value - *before);
    if (before && value <= *before) other += 1.0;
    back = back || (before && value < *before);
    before = value;
  }
  const bool named = name.time || name.frame;
  if (steps.empty()) {
    const bool one_row = other == 0.0;
    estimate.counter = named || one_row ? Counter::kAmbiguous : Counter::kOther;
    estimate.words = one_row ? "one row" : "one value";
    return estimate;
  }
  estimate.step = UsualStep(steps);
  const double usual = MiddleStep(steps);
  double regular = 0.0;
  estimate.equal = true;
  const double rounding = whole ? 0.0 : 1e-6 * usual + 1e-15 * largest;  // of decimals
  for (const double step : steps) {
    const auto off = [&](double of) { return std::abs(step - of * std::max(1.0, std::round(step / of))); };
    estimate.equal = estimate.equal && off(usual) <= rounding;
    regular += off(estimate.step) <= kJitter * estimate.step ? 1.0 : 0.0;
  }
  estimate.units = UnitsBetween(estimate.step, kSlowest_hz, kFastest_hz);
  const bool by_one = whole && usual == 1.0;
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  if (back || other > kMostStill * static_cast<double>(steps.size())) {
    const bool mostly = other <= kMostStill * static_cast<double>(steps.size());
    estimate.counter = named || mostly ? Counter::kAmbiguous : Counter::kOther;
    estimate.words = back ? "the numbers do not rise throughout" : "many numbers stand still";
    return estimate;
  }
  if (name.time && estimate.units.size() != 1 && name.unit == nullptr)
    estimate.units = UnitsBetween(estimate.step, kSlowestNamed_hz, kFastestNamed_hz);
  if (name.time && name.unit != nullptr) {
    const double hz = RateOf(estimate.step, *name.unit);
    estimate.units.clear();
    if (hz > kSlowestNamed_hz && hz <= kFastestNamed_hz) estimate.units = {*name.unit};
  }
  estimate.words = CounterWords(estimate, *least, *most);
  const bool varies = regular >= kRegular * static_cast<double>(steps.size()) && !(estimate.equal && whole);
  const bool time = name.time ? !by_one : !name.frame && varies && steps.size() >= kFewestSteps;
  const bool frames = !name.time && (by_one || (name.frame && estimate.equal && whole));
  estimate.counter = frames                               ? Counter::kFrames
                     : time && estimate.units.size() == 1 ? Counter::kTime
                                                          : Counter::kAmbiguous;
  return estimate;
}

bool IsClock(const CounterEstimate& estimate, const CounterName& name, double rate_hz) {
  if (estimate.counter == Counter::kTime) return true;
  if (estimate.counter != Counter::kAmbiguous || estimate.step == 0.0) return false;
  if (name.time) return estimate.step > 1.5;
  return estimate.equal && std::any_of(estimate.units.begin(), estimate.units.end(), [&](const ClockUnit& unit) {
           return std::abs(RateOf(estimate.step, unit) / rate_hz - 1.0) < kDeclaredSlack;
         });
}

int RowPlaces::frames() const {
  const auto last = std::find_if(place.rbegin(), place.rend(), [](int frame) { return frame >= 0; });
  return last == place.rend() ? 0 : *last + 1;
}

Expected<RowPlaces> PlacesByNumber(const std::vector<double>& numbers, double step, const std::string& name) {
  RowPlaces places;
  if (numbers.empty() || std::isnan(numbers[0])) return places;  // damaged: nothing to count from
  double last = numbers[0], frame = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double number = std::isnan(numbers[i]) ? last + step : numbers[i];
    const double steps = i == 0 ? 0.0 : (number - last) / step;
    if (i > 0 && (!(steps >= 1.0) || steps != std::floor(steps))) return RowPlaces();
    frame += steps;
    // Beyond, a number is damaged, which the next one shows.
    places.place.push_back(static_cast<int>(std::min(frame, 1e9)));
    last = number;
  }
  const double skipped = frame + 1.0 - static_cast<double>(numbers.size());
  if (skipped > kMostSkipped) return TooManySkipped(skipped, name);
  return places;
}

Expected<RowPlaces> PlacesByClock(std::vector<double> times, const std::string& name) {
  if (!FillTimes(times)) {
    return Fail(ErrorCode::kInconsistent, "no row has a time", name, "declare the column of times as `skip`");
  }
  RowPlaces places;
  std::vector<double> kept, steps;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!kept.empty() && times[i] < kept.back()) {
      return Fail(ErrorCode::kInconsistent,
                  "time " + FormatDouble(times[i]) + " in row " + std::to_string(i + 1) + " comes before " +
                      FormatDouble(kept.back()),
                  name, "rows must be in the order of time: split the file there, or sort its rows");
    }
    const bool still = !kept.empty() && times[i] == kept.back();
    places.place.push_back(still ? -1 : 0);
    if (still) continue;
    if (!kept.empty()) steps.push_back(times[i] - kept.back());
    kept.push_back(times[i]);
  }
  if (steps.empty()) return places;
  places.step = UsualStep(steps);
  const double span = (kept.back() - kept.front()) / places.step;
  const double skipped = std::round(span) + 1.0 - static_cast<double>(kept.size());
  if (!(skipped <= kMostSkipped)) return TooManySkipped(skipped, name);
  // How far each row is behind a row a step: it rises where frames are missing, and varies with the clock.
  std::vector<double> behind;
  for (std::size_t k = 0; k < kept.size(); ++k)
    behind.push_back((kept[k] - kept[0]) / places.step - static_cast<double>(k));
  const std::vector<double> rising = Rising(behind);
  const double most = std::max(0.0, behind.back());
  const auto missing_before = [&](std::size_t k) {
    return static_cast<int>(std::floor(std::clamp(rising[k], 0.0, most) + 0.5));
  };
  std::size_t k = 0;
  for (int& place : places.place) {
    if (place < 0) continue;
    place = static_cast<int>(k) + missing_before(k) - missing_before(0);
    ++k;
  }
  return places;
}

void MoveFindings(const RowPlaces& places, std::vector<Finding>& findings) {
  std::vector<int> frame_of;
  for (const int place : places.place) frame_of.push_back(place >= 0 ? place : frame_of.back());
  const auto placed = [&](int row) {
    return row < static_cast<int>(frame_of.size()) ? frame_of[static_cast<std::size_t>(row)] : places.frames();
  };
  for (Finding& finding : findings) {
    const bool any = finding.frame_end > finding.frame_begin;
    finding.frame_begin = placed(finding.frame_begin);
    finding.frame_end = any ? placed(finding.frame_end - 1) + 1 : finding.frame_begin;
  }
}

}  // namespace mocurate
