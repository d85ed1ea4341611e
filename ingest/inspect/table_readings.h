#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/joint_table.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {

inline constexpr double kSmooth = 0.35;  ///< a frame's step against the size of the body: a body moves less

/// Where the numbers of a table stand, if a frame is read in one way.
struct RowLayout {
  int joints = 0;
  int rows_per_frame = 0;
  int first_column = 0;  ///< of the first joint in a row
  int columns_per_joint = 3;
  std::vector<int> x_columns;  ///< (joints) where it is irregular: column of x
  std::string words;
};

RawClip ReadRows(const JointTable& rows, const RowLayout& layout);

/// "1290 rows of 3 numbers = 86 frames of 15 joints, one a row".
std::string RowWords(int rows, int joints, int columns);

/// Every way to read the table that its counts allow, and the header where it names a column of frames or times.
std::vector<RowLayout> PossibleLayouts(const JointTable& rows);

/// Rows of one joint each behind numbers that count the frames, or frames and joints; nothing of other tables.
std::optional<RowLayout> CountedLayout(const JointTable& rows);

/// Median step of a joint between frames against the size of the body: small when frames are cut at the right rows.
double Roughness(const RawClip& clip);

/// The surest reading in a known order; a remark names the other counts that fit.
std::optional<RawClip> KnownLayout(const JointTable& rows, const std::vector<RowLayout>& layouts);

}  // namespace mocurate
