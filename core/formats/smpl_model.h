#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A body model of SMPL's family as its file holds it: metres, y up, facing +z.
struct SmplModel {
  std::size_t vertices = 0;
  std::size_t joints = 0;               ///< 24 SMPL, 52 SMPL-H, 55 SMPL-X
  std::size_t shapes = 0;               ///< shape (and expression) directions
  std::size_t pose_columns = 0;         ///< 9 x (joints - 1), or 0
  std::vector<double> v_template;       ///< vertices x 3
  std::vector<double> shapedirs;        ///< vertices x 3 x shapes
  std::vector<double> posedirs;         ///< vertices x 3 x pose_columns; empty when absent
  std::vector<double> joint_regressor;  ///< joints x vertices, rows sum to 1
  std::vector<double> weights;          ///< vertices x joints, rows sum to 1
  std::vector<int> parents;             ///< of each joint; -1 of the root; every parent before its child
  std::vector<std::uint32_t> faces;     ///< three vertices each
};

/// The official .pkl (Python 2, chumpy and sparse matrices included) or .npz, distinguished by their bytes. Every field
/// is checked against the others. Errors kMalformed name the field.
Expected<SmplModel> ParseSmplModel(std::string_view bytes, const std::string& name);

}  // namespace mocurate
