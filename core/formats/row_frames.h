#pragma once

#include <vector>

namespace mocurate {

/// Rows of one joint each: (rows, columns), x, y and z in three of the columns. A row that holds no finite numbers, or
/// zeros alone, is in its place and says nothing.
struct JointPerRow {
  const double* values = nullptr;
  long long rows = 0;
  int columns = 0;
  int xyz[3] = {0, 1, 2};
};

/// Where rows lack (missing > 0: so many before `row`), or are too many (missing < 0: so many from `row` on).
struct RowBreak {
  long long row = 0;
  int missing = 0;
};

/// Rows [first, first + rows) of the table.
struct FrameOfRows {
  long long first = 0;
  int rows = 0;
};

/// Whether most rows are near to where the row as many joints before them is, as they are in frames of that many joints
/// however many of the frames lack a row.
bool MostRowsGoOn(const JointPerRow& table, int joints_per_frame);

/// Breaks in the order of joints, by continuity: a joint stays near where it was in the frame before, and is far from
/// where the others were. Nothing where every row continues its joint, where all points move as far as joints are
/// apart, and within the first frame, which nothing goes before.
std::vector<RowBreak> FindRowBreaks(const JointPerRow& table, int joints_per_frame);

/// The frames that the breaks leave; those with another count of rows than joints_per_frame are not whole. The last
/// one has what the table ends with.
std::vector<FrameOfRows> FramesOfRows(long long rows, int joints_per_frame, const std::vector<RowBreak>& breaks);

}  // namespace mocurate
