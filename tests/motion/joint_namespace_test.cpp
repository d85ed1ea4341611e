#include "core/motion/skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mocurate {
namespace {

using ::testing::ElementsAre;

const std::vector<std::string> kBody = {"Hips", "Spine", "Head", "LeftArm", "RightArm", "LeftLeg", "RightLeg"};

std::vector<std::string> With(const std::string& prefix, std::vector<std::string> names = kBody) {
  for (std::string& name : names) name.insert(0, prefix);
  return names;
}

TEST(JointNamespace, TheCommonPrefixOfAnExporterIsRemoved) {
  for (const char* prefix : {"", "mixamorig:", "mixamorig1:", "mixamorig_", "mixamorig", "Character1_", "Armature|",
                             "Armature|mixamorig:", "Bip01 ", "rig.", "bip_01_"}) {
    EXPECT_EQ(WithoutNamespace(With(prefix)), kBody) << prefix;
  }
}

TEST(JointNamespace, ARootOfAnotherNameKeepsItsOwn) {
  EXPECT_THAT(
      WithoutNamespace({"Bip01", "Bip01 Pelvis", "Bip01 Spine", "Bip01 Head", "Bip01 L Thigh", "Bip01 R Thigh"}),
      ElementsAre("Bip01", "Pelvis", "Spine", "Head", "L Thigh", "R Thigh"));
}

TEST(JointNamespace, NamesThatBeginAlikeOrBecomeTheSameAreLeft) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"base", "child1", "child2", "child3", "child4", "child5", "child6"},
        std::vector<std::string>{"a:Hips", "b:Hips", "a:Head", "b:Head", "a:Arm", "b:Arm"},
        std::vector<std::string>{"hip", "left_knee", "left_foot"}, kBody}) {
    EXPECT_EQ(WithoutNamespace(names), names);
  }
}

}  // namespace
}  // namespace mocurate
