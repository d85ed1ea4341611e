#include "core/formats/smpl_model.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/formats/array_fields.h"
#include "core/formats/npz.h"
#include "core/formats/pickle_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/support/smpl_model_writer.h"

namespace mocurate {
namespace {

SmplModel SmallModel() {
  SmplModel model;
  model.vertices = 4;
  model.joints = 3;
  model.shapes = 2;
  model.pose_columns = 18;
  model.v_template = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  model.shapedirs.assign(24, 0.1);
  model.posedirs.assign(4 * 3 * 18, 0.01);
  model.joint_regressor = {1, 0, 0, 0, 0, 0.5, 0.5, 0, 0, 0, 0, 1};
  model.weights = {1, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0, 1};
  model.parents = {-1, 0, 1};
  model.faces = {0, 1, 2, 0, 2, 3};
  return model;
}

Npz ModelMembers() { return ParseNpz(EncodeSmplModelNpz(SmallModel(), "s.npz").value(), "s.npz").value(); }

void ExpectSmall(const Expected<SmplModel>& model) {
  ASSERT_TRUE(model) << model.error().Message();
  const SmplModel small = SmallModel();
  EXPECT_EQ(model->vertices, small.vertices);
  EXPECT_EQ(model->joints, small.joints);
  EXPECT_EQ(model->shapes, small.shapes);
  EXPECT_EQ(model->pose_columns, small.pose_columns);
  EXPECT_EQ(model->v_template, small.v_template);
  EXPECT_EQ(model->shapedirs, small.shapedirs);
  EXPECT_EQ(model->posedirs, small.posedirs);
  EXPECT_EQ(model->joint_regressor, small.joint_regressor);
  EXPECT_EQ(model->weights, small.weights);
  EXPECT_EQ(model->parents, small.parents);
  EXPECT_EQ(model->faces, small.faces);
}

TEST(SmplModel, RoundTripsAnNpz) {
  ExpectSmall(ParseSmplModel(EncodeSmplModelNpz(SmallModel(), "s.npz").value(), "s.npz"));
}

TEST(SmplModel, ReadsTheSameModelFromAPickle) {
  PickleWriter writer;
  writer.BeginDict();
  for (const NpzMember& member : ModelMembers().members) {
    writer.Text(member.name);
    NpyArray array = member.array;
    if (member.name == "kintree_table") {  // as in SMPL: unsigned; the parent of the root is the maximum
      array.dtype = "<u4";
      array.values[0] = 4294967295.0;
    }
    writer.Array(array);
  }
  writer.Text("bs_style");
  writer.Text("lbs");
  writer.End();
  ExpectSmall(ParseSmplModel(writer.Finish("s.pkl").value(), "s.pkl"));
}

TEST(SmplModel, ReadsASparseRegressorAsTheSameMatrix) {
  PickleWriter writer;
  writer.BeginDict();
  for (const NpzMember& member : ModelMembers().members) {
    if (member.name == "J_regressor") continue;
    writer.Text(member.name);
    writer.Array(member.array);
  }
  writer.End();
  std::string bytes = writer.Finish("s.pkl").value();
  // Appended by hand: 'J_regressor': a scipy csc_matrix object with its state.
  PickleWriter state;
  state.BeginDict();
  state.Text("_shape");
  state.BeginTuple();
  state.Integer(3);
  state.Integer(4);
  state.End();
  state.Text("data");
  state.Array(MakeArray({4}, {1, 0.5, 0.5, 1}));
  state.Text("indices");
  state.Array(MakeArray({4}, {0, 1, 1, 2}, "<i4"));
  state.Text("indptr");
  state.Array(MakeArray({5}, {0, 1, 2, 3, 4}, "<i4"));
  state.End();
  std::string inner = state.Finish("state").value();
  inner = inner.substr(2, inner.size() - 3);
  bytes.resize(bytes.size() - 1);
  bytes += std::string("X\x0b\0\0\0J_regressor", 16) + "cscipy.sparse.csc\ncsc_matrix\n)\x81" + inner + "bs.";
  ExpectSmall(ParseSmplModel(bytes, "s.pkl"));
}

TEST(SmplModel, NamesEveryCorruptedField) {
  struct Case {
    const char* key;
    std::function<void(NpyArray&)> corrupt;
  };
  const auto reshape = [](NpyArray& a) { a.shape = {a.values.size()}; };
  const auto infinite = [](NpyArray& a) { a.values[1] = 1e300 * 1e300; };
  std::vector<Case> cases;
  for (const char* key : {"v_template", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table", "f"}) {
    cases.push_back({key, reshape});
    if (std::string(key) != "f" && std::string(key) != "kintree_table") cases.push_back({key, infinite});
  }
  cases.push_back({"J_regressor", [](NpyArray& a) { a.values[0] = 0.5; }});
  cases.push_back({"weights", [](NpyArray& a) { a.values[0] = 0.5; }});
  cases.push_back({"weights", [](NpyArray& a) { a.values[0] = 2, a.values[1] = -1; }});
  cases.push_back({"kintree_table", [](NpyArray& a) { a.values[1] = 2; }});
  cases.push_back({"kintree_table", [](NpyArray& a) { a.values[0] = 0; }});
  cases.push_back({"kintree_table", [](NpyArray& a) { a.values[4] = 0; }});
  cases.push_back({"f", [](NpyArray& a) { a.values[5] = 4; }});
  for (const Case& c : cases) {
    Npz npz = ModelMembers();
    for (NpzMember& member : npz.members) {
      if (member.name == c.key) c.corrupt(member.array);
    }
    ExpectMalformed(ParseSmplModel(EncodeNpz(npz, "s.npz").value(), "s.npz"), std::string("s.npz:") + c.key);
  }
  for (const char* key : {"v_template", "shapedirs", "J_regressor", "weights", "kintree_table", "f"}) {
    Npz npz = ModelMembers();
    for (NpzMember& member : npz.members) member.name = member.name == key ? "other" : member.name;
    ExpectMalformed(ParseSmplModel(EncodeNpz(npz, "s.npz").value(), "s.npz"), std::string("s.npz:") + key);
  }
}

}  // namespace
}  // namespace mocurate
