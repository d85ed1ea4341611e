// BVH files of our writer, read by assimp.

#include <gtest/gtest.h>

#include <map>

#include "core/formats/bvh.h"
#include "corruption.h"

#ifdef MOCURATE_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace mocurate {
namespace {

#ifdef MOCURATE_ASSIMP

Vector3d Eigens(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// World positions of all nodes at a frame, by name. A channel with one key holds for all frames.
void PlaceNodes(const aiNode& node, const std::map<std::string, const aiNodeAnim*>& channels, unsigned frame,
                const aiMatrix4x4& parent, std::map<std::string, Vector3d>& places) {
  aiMatrix4x4 local = node.mTransformation;
  if (const auto found = channels.find(node.mName.C_Str()); found != channels.end()) {
    const aiNodeAnim& channel = *found->second;
    const aiVectorKey& position = channel.mPositionKeys[channel.mNumPositionKeys > 1 ? frame : 0];
    const aiQuatKey& rotation = channel.mRotationKeys[channel.mNumRotationKeys > 1 ? frame : 0];
    local = aiMatrix4x4(aiVector3D(1, 1, 1), rotation.mValue, position.mValue);
  }
  const aiMatrix4x4 global = parent * local;
  places[node.mName.C_Str()] = Eigens(aiVector3D(global.a4, global.b4, global.c4));
  for (unsigned i = 0; i < node.mNumChildren; ++i) PlaceNodes(*node.mChildren[i], channels, frame, global, places);
}

int CountNodes(const aiNode& node) {
  int count = 1;
  for (unsigned i = 0; i < node.mNumChildren; ++i) count += CountNodes(*node.mChildren[i]);
  return count;
}

void ExpectAssimpReads(const Bvh& bvh, double tolerance) {
  const std::string text = WriteBvh(bvh);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), 0, "bvh");
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  int end_sites = 0;
  for (const BvhJoint& joint : bvh.joints) end_sites += joint.has_end_site ? 1 : 0;
  EXPECT_EQ(CountNodes(*scene->mRootNode), static_cast<int>(bvh.joints.size()) + end_sites);
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const aiAnimation& motion = *scene->mAnimations[0];
  EXPECT_NEAR(motion.mTicksPerSecond, bvh.hz(), 1e-4 * bvh.hz());
  std::map<std::string, const aiNodeAnim*> channels;
  unsigned keys = 0;
  for (unsigned c = 0; c < motion.mNumChannels; ++c) {
    channels[motion.mChannels[c]->mNodeName.C_Str()] = motion.mChannels[c];
    keys = std::max(keys, motion.mChannels[c]->mNumRotationKeys);
  }
  ASSERT_EQ(keys, static_cast<unsigned>(bvh.frames));
  for (const int frame : {0, bvh.frames / 2, bvh.frames - 1}) {
    std::map<std::string, Vector3d> places;
    PlaceNodes(*scene->mRootNode, channels, static_cast<unsigned>(frame), aiMatrix4x4(), places);
    std::vector<Vector3d> positions;
    BvhForward(bvh, frame, positions);
    for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
      const auto place = places.find(bvh.joints[j].name);
      ASSERT_NE(place, places.end()) << bvh.joints[j].name;
      EXPECT_LT((place->second - positions[j]).norm(), tolerance) << bvh.joints[j].name << " in frame " << frame;
    }
  }
}

Bvh Walker() {
  using C = BvhChannel;
  Bvh bvh;
  bvh.joints = {{"Hips",
                 -1,
                 {0, 90, 0},
                 {C::kXPosition, C::kYPosition, C::kZPosition, C::kXRotation, C::kYRotation, C::kZRotation},
                 0,
                 false,
                 {}},
                {"LeftLeg", 0, {9, -5, 0}, {C::kZRotation, C::kXRotation, C::kYRotation}, 6, false, {}},
                {"LeftFoot", 1, {0, -40, 0}, {C::kYRotation, C::kXRotation, C::kZRotation}, 9, true, {0, -8, 12}},
                {"RightLeg", 0, {-9, -5, 0}, {C::kZRotation, C::kYRotation, C::kXRotation}, 12, true, {0, -40, 0}}};
  bvh.channel_count = 15;
  bvh.frames = 4;
  bvh.frame_time_s = 1.0 / 120;
  for (int i = 0; i < bvh.frames * bvh.channel_count; ++i) bvh.values.push_back((i * 37) % 160 - 75.5);
  return bvh;
}

TEST(BvhByAssimp, ReadsJointsFramesRateAndPositionsAsWritten) { ExpectAssimpReads(Walker(), 1e-3); }

TEST(BvhByAssimp, ReadsARewrittenRecordedClip) {
  const std::filesystem::path folder = RecordedData("bvh/bandai1");
  if (folder.empty()) GTEST_SKIP() << "MOCURATE_DATA has no bvh/bandai1";
  const auto files = FilesEndingIn(folder, ".bvh");
  ASSERT_FALSE(files.empty());
  ExpectAssimpReads(ParseBvh(Bytes(files[0]), "clip").value(), 1e-2);
}

#else

TEST(BvhByAssimp, ReadsJointsFramesRateAndPositionsAsWritten) { GTEST_SKIP() << "built without libassimp-dev"; }

#endif

}  // namespace
}  // namespace mocurate
