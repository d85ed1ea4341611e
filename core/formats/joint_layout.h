#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/formats/joint_table.h"

namespace mocurate {

/// What one number (kRotation: nine, row by row) of a joint or of a frame is.
enum class JointColumn { kX, kY, kZ, kConfidence, kRotation, kRotationConfidence, kFrame, kSkip };

/// `count` joints in a row with the same columns; a group without x, y and z is not a joint (a frame number).
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
};

/// Words x y z confidence rotation rotation_confidence frame skip, between blanks or commas; N*(...) repeats. Error
/// kConfig: an unknown word, a bracket that is not closed, a group with only some of x y z, no joint.
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
  std::vector<double> frame_number;         ///< (frames); empty: none declared
  std::vector<Finding> findings;            ///< those of the table; "frame_number": does not follow the one before;
                                            ///< "time_gap": frames without a row, which are NaN in their place
};

/// `table` declares how the text is split into rows (separator, missing, END, damaged rows); its rows_per_frame must
/// divide the numbers of a frame; its columns and names follow from the layout. Errors are those of ParseJointTable,
/// and kUsage for a layout that does not fit rows_per_frame.
Expected<JointRows> ParseJointRows(std::string_view bytes, const JointLayout& layout, JointTableLayout table,
                                   const std::string& name);

}  // namespace mocurate
