#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// A unit of a column of times; 100ns are the ticks of Windows and of the Kinect v2.
struct ClockUnit {
  const char* name;  ///< "s", "ms", "us", "100ns", "ns"
  double seconds;
};
const std::vector<ClockUnit>& ClockUnits();

/// What a header calls a column: "timestamp", "Time (ms)", "frame_no".
struct CounterName {
  bool time = false;
  bool frame = false;
  const ClockUnit* unit = nullptr;  ///< of a time, where the name has one
};
CounterName CounterNameOf(std::string_view name);

/// What the numbers of a column beside the joints count, row by row.
enum class Counter {
  kFrames,     ///< mostly by one
  kTime,       ///< a clock, in the one unit of `units`
  kAmbiguous,  ///< they rise otherwise: every n-th frame, or a clock whose unit is unknown
  kOther,      ///< they do not rise
};

struct CounterEstimate {
  Counter counter = Counter::kOther;
  std::vector<ClockUnit> units;  ///< in which the usual step is one of 10 to 250 Hz
  double step = 0.0;             ///< between frames, in the unit of the column; 0: fewer than two rows
  bool equal = false;            ///< all steps are the usual one, or a multiple
  std::string words;             ///< "steps of 33 to 34: 29.995 Hz in ms"
};

/// By the values, NaN for a damaged row, and the name in the header. A column without a name is a time where its steps
/// vary about one, as those of a clock do, or are no whole numbers, and are of 10 to 250 Hz in one unit only; five of
/// them at least. A named time without unit has the one unit in which its usual step is of 10 to 250 Hz, else of 1 to
/// 2000 Hz.
CounterEstimate EstimateCounter(const std::vector<double>& values, const CounterName& name = {});

/// Whether a column that is declared to count frames is a clock: EstimateCounter finds a time; or its equal steps are
/// those of a clock of `rate_hz`; or the header names a time and it does not count by one.
bool IsClock(const CounterEstimate& estimate, const CounterName& name, double rate_hz);

/// The frame of each row on an even grid, from 0 and rising.
struct RowPlaces {
  std::vector<int> place;  ///< (rows); -1: the row is at the time of the one before
  double step = 0.0;       ///< between frames, in the unit of the times; 0: fewer than two times

  int frames() const;
  bool every_row() const { return frames() == static_cast<int>(place.size()); }
};

/// By numbers that rise by whole multiples of `step`; NaN is of a damaged row, which follows the one before. Empty
/// where they do not. Error kInconsistent at "name" where more than 10000 frames are skipped.
Expected<RowPlaces> PlacesByNumber(const std::vector<double>& numbers, double step, const std::string& name);

/// By times, NaN of a damaged row: on a grid of their usual step, so that a clock may vary by a good part of it and
/// drift. Error kInconsistent at "name" where time runs backwards, or more than 10000 frames are skipped.
Expected<RowPlaces> PlacesByClock(std::vector<double> times, const std::string& name);

/// Brings findings from rows to frames. A row without a frame is where the one before it is.
void MoveFindings(const RowPlaces& places, std::vector<Finding>& findings);

}  // namespace mocurate
