#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/formats/array_fields.h"
#include "core/formats/npz.h"
#include "core/formats/smpl_model.h"

namespace mocurate {

/// As .npz. Error kInconsistent: sizes that do not fit.
inline Expected<std::string> EncodeSmplModelNpz(const SmplModel& model, const std::string& name) {
  const std::size_t v = model.vertices, j = model.joints;
  Npz npz;
  const auto add = [&](const char* key, NpyArray array) { npz.members.push_back({key, std::move(array), ""}); };
  add("v_template", MakeArray({v, 3}, model.v_template));
  add("shapedirs", MakeArray({v, 3, model.shapes}, model.shapedirs));
  if (model.pose_columns > 0) add("posedirs", MakeArray({v, 3, model.pose_columns}, model.posedirs));
  add("J_regressor", MakeArray({j, v}, model.joint_regressor));
  add("weights", MakeArray({v, j}, model.weights));
  std::vector<double> tree(model.parents.begin(), model.parents.end());
  for (std::size_t k = 0; k < j; ++k) tree.push_back(static_cast<double>(k));
  add("kintree_table", MakeArray({2, j}, std::move(tree), "<i8"));
  add("f", MakeArray({model.faces.size() / 3, 3}, {model.faces.begin(), model.faces.end()}, "<u4"));
  return EncodeNpz(npz, name);
}

}  // namespace mocurate
