#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/formats/joint_table.h"

namespace mocurate {

/// What one number (kRotation: nine, row by row) of a joint or of a frame is.
enum class JointColumn {
  kX,
  kY,
  kZ,
  kConfidence,
  kRotation,
  kRotationConfidence,
  kFrame,
  kTimeS,
  kTimeMs,
  kTimeUs,
  kTime100ns,
  kTimeNs,
  kSkip
};

/// `count` joints in a row with the same columns; a group without x, y and z is not a joint (a frame number, a time).
struct JointGroup {
  int count = 1;
  std::vector<JointColumn> columns;

  bool IsJoint() const;
};

/// The numbers of one frame in the order of the file. CAD-60, one row per frame, 171 numbers:
/// "frame 11*(rotation rotation_confidence x y z confidence) 4*(x y z confidence)".
struct JointLayout {
  std::vector<JointGroup> groups;

  int Joints() const;
  int NumbersPerFrame() const;
  /// The column that counts the frames or has their times; kSkip: none.
  JointColumn Counter() const;
  bool has_time() const;
};

/// Words x y z confidence rotation rotation_confidence frame time_s time_ms time_us time_100ns time_ns skip, between
/// blanks or commas; N*(...) repeats. Of frame and times there is one, beside the joints or, where each joint repeats
/// it, in their group. Error kConfig: an unknown word, a bracket that is not closed, a group with only some of x y z,
/// no joint.
Expected<JointLayout> ParseJointLayout(std::string_view text, const std::string& where);

/// Joints by declaration, in the file's own units and axes.
struct JointRows {
  int frames = 0;
  int joints = 0;
  int rows_left_over = 0;                   ///< after the last complete frame, where no discontinuity explains them
  std::vector<double> position;             ///< (frames, joints, 3)
  std::vector<double> confidence;           ///< (frames, joints) as written; empty: none declared
  std::vector<double> rotation;             ///< (frames, joints, 9) row by row; 0 where a joint has none; empty: none
  std::vector<double> rotation_confidence;  ///< (frames, joints); 0 where a joint has no rotation; empty: none
  std::vector<double> counter;              ///< (frames) numbers or times as written; empty: none declared
  std::vector<std::vector<std::string>> header;  ///< of the table
  double hz = 0.0;                               ///< by the times; 0: none declared, or fewer than two
  std::vector<Finding> findings;  ///< those of the table; "frame_number": does not follow the one before;
                                  ///< "time_gap": frames without a row, which are NaN in their place
};

/// The numbers of a table, frame after frame, as far as there are whole frames; they are laid out by no counter yet.
/// Error kInconsistent where the rows of a frame have different numbers or times.
Expected<JointRows> RowsOf(const JointTable& table, const JointLayout& layout, const std::string& name);

/// `table` declares how the text is split into rows (separator, missing, END, damaged rows); its rows_per_frame must
/// divide the numbers of a frame; its columns and names follow from the layout. `rate_hz` is the declared one, 0: none.
/// Errors are those of ParseJointTable, PlacesByNumber and PlacesByClock; kUsage for a layout that does not fit
/// rows_per_frame; kInconsistent where `frame` is declared for a clock, a time in another unit than the header names,
/// or where the rows of a frame have different numbers.
Expected<JointRows> ParseJointRows(std::string_view bytes, const JointLayout& layout, JointTableLayout table,
                                   const std::string& name, double rate_hz = 0.0);

}  // namespace mocurate
