#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/joint_table.h"
#include "ingest/formats/table_header.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {

inline constexpr double kSmooth = 0.35;  ///< a frame's step against the size of the body: a body moves less

/// Where the numbers of a table stand, if a frame is read in one way.
struct RowLayout {
  int joints = 0;
  int rows_per_frame = 1;             ///< 1, or one a joint
  std::vector<HeaderColumn> columns;  ///< of a row; `word` is empty of one that may count the frames
  bool second_person = false;         ///< who is there, and whose columns are passed over
  std::string fixed;                  ///< the layout of a known set, instead of `columns`
  std::string words;                  ///< how it was recognised

  /// All numbers of a frame, as ParseJointLayout reads them; kFillIn stands for `skip`.
  std::string Text() const;
};

/// `text` of a layout with `word` for each kFillIn.
std::string WithFilledIn(std::string text, const char* word);

/// The points of the table so read, a frame for each `rows_per_frame` rows; of the clip nothing else.
RawClip ReadPoints(const JointTable& rows, const RowLayout& layout);

/// "1290 rows of 3 numbers = 86 frames of 15 joints, one a row".
std::string RowWords(int rows, int joints, int columns);

/// Every way to read the table that its counts allow, and the header where it names a column of frames or times.
std::vector<RowLayout> PossibleLayouts(const JointTable& rows);

/// Rows of one joint each behind numbers that count the frames, or frames and joints; nothing of other tables.
std::optional<RowLayout> CountedLayout(const JointTable& rows);

/// Median step of a joint between frames against the size of the body: small when frames are cut at the right rows.
double Roughness(const RawClip& clip);

/// A reading and its clip.
struct TableReading {
  RowLayout layout;
  RawClip clip;
};

/// The surest reading in a known order; a remark names the other counts that fit.
std::optional<TableReading> KnownLayout(const JointTable& rows, const std::vector<RowLayout>& layouts);

/// Decides what the leading columns count, and says how a source declares the layout (`facts`).
void DeclareLayout(const JointTable& rows, RowLayout& layout, RawClip& clip);

}  // namespace mocurate
