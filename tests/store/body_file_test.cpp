// A body template from its file: every field is required, with its shape, finite and consistent with the others.
#include "core/store/body_file.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/store/hdf5_file.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using store::Array;
using store::MakeArray;
using ::testing::HasSubstr;
using Fields = std::map<std::string, Array>;

std::vector<float> Floats(std::size_t count, float value = 0.25F) { return std::vector<float>(count, value); }

/// Two joints, four vertices, one shape, one variant.
Fields SmallBody() {
  Fields fields;
  fields["/parents"] = MakeArray<std::int32_t>({2}, {-1, 0});
  fields["/joint_names"] = MakeArray<std::string>({2}, {"pelvis", "head"});
  fields["/v_template"] = MakeArray({4, 3}, Floats(12));
  fields["/J_template"] = MakeArray<float>({2, 3}, {0, 0, 0, 0, 1, 0});
  fields["/faces"] = MakeArray<std::int32_t>({1, 3}, {0, 1, 2});
  fields["/weights_idx4"] = MakeArray({4, 4}, std::vector<std::int32_t>(16, 1));
  fields["/weights_val4"] = MakeArray({4, 4}, Floats(16));
  fields["/shape_names"] = MakeArray<std::string>({1}, {"tall"});
  fields["/shapedirs"] = MakeArray({1, 4, 3}, Floats(12));
  fields["/J_shapedirs"] = MakeArray({1, 2, 3}, Floats(6));
  fields["/variants/male/vertices_tpose"] = MakeArray({4, 3}, Floats(12));
  fields["/variants/male/joints_tpose"] = MakeArray({2, 3}, Floats(6));
  return fields;
}

Expected<BodyTemplate> WrittenAndRead(const Fields& fields) {
  const ScratchFolder folder;
  const auto file = folder / "body.h5";
  auto writer = store::Hdf5Writer::Create(file);
  EXPECT_TRUE(writer);
  for (const auto& [path, array] : fields) EXPECT_TRUE(writer->Write(path, array)) << path;
  EXPECT_TRUE(writer->Finish());
  return ReadBodyTemplate(file);
}

TEST(BodyFile, IsReadAsWrittenAndCanBePosed) {
  const auto body = WrittenAndRead(SmallBody());
  ASSERT_TRUE(body) << body.error().Message();
  EXPECT_EQ(body->joint_names[1], "head");
  EXPECT_EQ(body->variants.count("male"), 1u);
  EXPECT_EQ(Shaped(*body, {2.0}).joints[1], Vector3d(0.5, 1.5, 0.5));
  // The head rotates by pi about y, and the skin with it; then everything is translated.
  const RestBody posed =
      Posed(*body, body->rest, {Quaterniond::Identity(), Quaterniond(0, 0, 1, 0)}, Vector3d(0, 0, 5));
  EXPECT_LT((posed.joints[1] - Vector3d(0, 1, 5)).norm(), 1e-12);
  EXPECT_LT((posed.vertices[0] - Vector3d(-0.25, 0.25, 4.75)).norm(), 1e-7);
}

TEST(BodyFile, AMissingFieldOrOneOfAnotherShapeIsNamed) {
  for (const auto& [path, array] : SmallBody()) {
    Fields fields = SmallBody();
    fields.erase(path);
    const auto missing = WrittenAndRead(fields);
    ASSERT_FALSE(missing) << path;
    EXPECT_THAT(missing.error().Message(), HasSubstr(path));
    fields[path] = MakeArray({1, 1, 1, 1}, Floats(1));
    const auto other = WrittenAndRead(fields);
    ASSERT_FALSE(other) << path;
    EXPECT_THAT(other.error().Message(), HasSubstr(path));
  }
}

TEST(BodyFile, BrokenRulesAreNamed) {
  const auto message = [](const std::string& path, const Array& array) {
    Fields fields = SmallBody();
    fields[path] = array;
    const auto body = WrittenAndRead(fields);
    return body ? std::string("read") : body.error().Message();
  };
  EXPECT_THAT(message("/parents", MakeArray<std::int32_t>({2}, {-1, 1})), HasSubstr("/parents/1: joint 0 is the root"));
  EXPECT_THAT(message("/faces", MakeArray<std::int32_t>({1, 3}, {0, 1, 4})),
              HasSubstr("/faces/0: there is no vertex 4"));
  EXPECT_THAT(message("/weights_val4", MakeArray({4, 4}, Floats(16, 0.3F))), HasSubstr("do not sum to 1"));
  EXPECT_THAT(message("/weights_idx4", MakeArray({4, 4}, std::vector<std::int32_t>(16, 2))), HasSubstr("/weights/0"));
  EXPECT_THAT(message("/J_template", MakeArray({2, 3}, Floats(6, NAN))),
              HasSubstr("/J_template: a value is not finite"));
}

}  // namespace
}  // namespace mocurate
