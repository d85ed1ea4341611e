// Columns of numbers and times beside the joints of a row, and the frames that rows are laid out in.

#include "core/formats/row_counter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

/// `frames` of 30 Hz from `begin`, in units of `seconds`, as a clock of whole units writes them.
std::vector<double> Clock(double begin, double seconds, int frames = 30) {
  std::vector<double> times;
  for (int f = 0; f < frames; ++f) times.push_back(begin + std::round(f / 30.0 / seconds));
  return times;
}

std::string UnitOf(const CounterEstimate& estimate) {
  return estimate.counter == Counter::kTime ? estimate.units.at(0).name : "";
}

TEST(RowCounter, FindsTheUnitOfAClock) {
  EXPECT_EQ(UnitOf(EstimateCounter(Clock(8981000, 1e-3))), "ms");
  EXPECT_EQ(UnitOf(EstimateCounter(Clock(1.6e15, 1e-6))), "us");
  EXPECT_EQ(UnitOf(EstimateCounter(Clock(133000000000000000.0, 1e-7))), "100ns");
  EXPECT_EQ(UnitOf(EstimateCounter(Clock(1.7e18, 1e-9))), "ns");
  std::vector<double> seconds, hundredths;
  for (int f = 0; f < 30; ++f)
    seconds.push_back(1.5 + f / 30.0), hundredths.push_back(std::round(100.0 * f / 30) / 100);
  EXPECT_EQ(UnitOf(EstimateCounter(seconds)), "s") << "equal steps that are no whole numbers count no frames";
  EXPECT_EQ(UnitOf(EstimateCounter(hundredths)), "s");
}

TEST(RowCounter, FindsFramesAndReportsWhatMayBeEither) {
  const auto counter = [](const std::vector<double>& values) { return EstimateCounter(values).counter; };
  EXPECT_EQ(counter({7, 8, 9, 10, 12, 13}), Counter::kFrames);
  EXPECT_EQ(counter({0, 33, 66, 99, 132, 165}), Counter::kAmbiguous);
  EXPECT_EQ(counter({0, 5, 10, 15, 25, 30}), Counter::kAmbiguous);
  EXPECT_EQ(counter({0, 3, 7, 12, 13, 21, 22}), Counter::kAmbiguous) << "frames that were thinned out";
  EXPECT_EQ(counter({0, 40010, 80000, 120005, 160000, 200010}), Counter::kAmbiguous) << "25 Hz in us, 250 Hz in 100 ns";
  EXPECT_EQ(counter({5, 5, 5, 5}), Counter::kOther);
  EXPECT_EQ(counter({3, 1, 2, 0, 5}), Counter::kOther);
  EXPECT_EQ(counter({5}), Counter::kAmbiguous);
}

TEST(RowCounter, ReadsNamesOfAHeader) {
  for (const char* name : {"time", "Timestamp", "t", "ts", "clock", "\"Time\""}) {
    EXPECT_TRUE(CounterNameOf(name).time) << name;
    EXPECT_EQ(CounterNameOf(name).unit, nullptr) << name;
  }
  const std::pair<const char*, const char*> units[] = {
      {"time_s", "s"},          {"Time (ms)", "ms"},      {"timestamp_us", "us"},
      {"timestamp [ns]", "ns"}, {"ticks", "100ns"},       {"time_100ns", "100ns"},
      {"Milliseconds", "ms"},   {"elapsed_seconds", "s"}, {"time \xc2\xb5s", "us"}};
  for (const auto& [name, unit] : units) {
    ASSERT_NE(CounterNameOf(name).unit, nullptr) << name;
    EXPECT_STREQ(CounterNameOf(name).unit->name, unit);
  }
  EXPECT_TRUE(CounterNameOf("Frame#").frame);
  for (const char* name : {"x", "head_x", "hips", "s", "left_toes", "items", ""}) {
    EXPECT_FALSE(CounterNameOf(name).time || CounterNameOf(name).frame) << name;
  }
}

TEST(RowCounter, FollowsTheNameOfAColumn) {
  const std::vector<double> equal = {0, 33, 66, 99, 132, 165};
  EXPECT_EQ(UnitOf(EstimateCounter(equal, CounterNameOf("timestamp"))), "ms");
  EXPECT_EQ(UnitOf(EstimateCounter(equal, CounterNameOf("time_ms"))), "ms");
  EXPECT_EQ(EstimateCounter(equal, CounterNameOf("frame")).counter, Counter::kFrames);
  EXPECT_EQ(UnitOf(EstimateCounter({0, 0.2, 0.4}, CounterNameOf("time"))), "s") << "5 Hz";
  EXPECT_EQ(EstimateCounter({1, 2, 3}, CounterNameOf("time")).counter, Counter::kAmbiguous);
  EXPECT_EQ(EstimateCounter({0, 33, 20}, CounterNameOf("time")).counter, Counter::kAmbiguous);
}

TEST(RowCounter, FindsAClockThatIsDeclaredToCountFrames) {
  const auto is_clock = [](const std::vector<double>& values, const char* name, double rate_hz) {
    const CounterName named = CounterNameOf(name);
    return IsClock(EstimateCounter(values, named), named, rate_hz);
  };
  EXPECT_TRUE(is_clock(Clock(8981000, 1e-3), "", 30));
  EXPECT_TRUE(is_clock({0, 33, 66, 99}, "", 30)) << "steps of 33 ms are of 30 Hz";
  EXPECT_TRUE(is_clock({0, 33, 66, 99}, "timestamp", 120));
  EXPECT_FALSE(is_clock({0, 5, 10, 15}, "", 30)) << "every fifth frame";
  EXPECT_FALSE(is_clock({1, 2, 3, 5}, "timestamp", 30));
}

TEST(RowPlaces, LeaveTheGapsOfAClock) {
  const auto places = [](const std::vector<double>& times) { return PlacesByClock(times, "a")->place; };
  EXPECT_THAT(places({100, 133, 167, 267, 300}), ElementsAre(0, 1, 2, 5, 6));
  EXPECT_THAT(places({0, 33, 33, 67}), ElementsAre(0, 1, -1, 2)) << "the same moment again";
  EXPECT_THAT(places({std::nan(""), 33, std::nan(""), 100, 133, std::nan("")}), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(places({5}), ElementsAre(0));
  ExpectError(PlacesByClock({0, 33, 20, 66}, "a"), ErrorCode::kInconsistent, "a");
  ExpectError(PlacesByClock({0, 33, 67, 3600000}, "a"), ErrorCode::kInconsistent, "a");
  ExpectError(PlacesByClock({std::nan("")}, "a"), ErrorCode::kInconsistent, "a");
}

TEST(RowPlaces, NeverHaveMoreFramesThanTheTimesSpan) {
  unsigned state = 1;
  const auto random = [&] { return (state = state * 1103515245u + 12345u) / 4294967296.0; };
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> times;
    const double jitter = 0.45 * random(), lost = 0.3 * random();
    for (int f = 0; f < 90; ++f) {
      if (f > 0 && random() < lost) continue;
      times.push_back(f / 30.0 + jitter / 30.0 * (random() - 0.5));
    }
    std::sort(times.begin(), times.end());
    const RowPlaces places = PlacesByClock(times, "a").value();
    const double hz = 1.0 / places.step;
    EXPECT_NEAR(hz, 30.0, 1.0) << trial;
    EXPECT_LE(places.frames(), (times.back() - times.front()) * hz + 1.5) << trial;
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GT(places.place[i], places.place[i - 1]);
  }
}

TEST(RowPlaces, InsertNoFrameWhereAClockOnlyVaries) {
  std::vector<double> times;
  for (int f = 0; f < 900; ++f) times.push_back(f / 29.7 + 0.4 / 30.0 * std::sin(0.7 * f));
  const RowPlaces places = PlacesByClock(times, "a").value();
  EXPECT_TRUE(places.every_row());
  EXPECT_NEAR(places.step, 1.0 / 29.7, 1e-4);
}

TEST(RowPlaces, FollowNumbersThatRise) {
  const double nan = std::nan("");
  EXPECT_THAT(PlacesByNumber({3, 4, nan, 8}, 1.0, "a")->place, ElementsAre(0, 1, 2, 5));
  EXPECT_THAT(PlacesByNumber({1, 5, 13}, 4.0, "a")->place, ElementsAre(0, 1, 3));
  EXPECT_TRUE(PlacesByNumber({1, 2, 1.5}, 1.0, "a")->place.empty());
  EXPECT_TRUE(PlacesByNumber({1, 2, 90000000, 4}, 1.0, "a")->place.empty());
  ExpectError(PlacesByNumber({1, 2, 20000}, 1.0, "a"), ErrorCode::kInconsistent, "a");
}

}  // namespace
}  // namespace mocurate
