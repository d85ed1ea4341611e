// Reading a dataset clip by clip gives the same as reading all of it.

#include "core/store/dataset_clips.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/file.h"
#include "core/store/store.h"
#include "tests/store/builders.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

class ClipByClip : public ::testing::Test {
 protected:
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "clips.h5";
};

TEST_F(ClipByClip, EachEqualsThatOfTheWholeDataset) {
  for (const Dataset& dataset : {test::MakeDataset(), test::MakeJointsOnlyDataset()}) {
    ASSERT_TRUE(WriteDataset(dataset, path));
    const auto whole = ReadDataset(path);
    ASSERT_TRUE(whole) << whole.error().Message();
    for (const auto check : {DatasetClips::Check::kHashes, DatasetClips::Check::kNone}) {
      const auto clips = DatasetClips::Open(path, check);
      ASSERT_TRUE(clips) << clips.error().Message();
      ASSERT_EQ(clips->size(), whole->clips.size());
      EXPECT_EQ(clips->axes(), whole->axes);
      for (std::size_t row = clips->size(); row-- > 0;) {
        const Clip& expected = whole->clips[row];
        EXPECT_EQ(clips->Id(row), expected.id());
        EXPECT_EQ(clips->Label(row), expected.label);
        const auto clip = clips->Read(row);
        ASSERT_TRUE(clip) << clip.error().Message();
        EXPECT_EQ(clip->id(), expected.id());
        EXPECT_EQ(clip->label, expected.label);
        EXPECT_EQ(clip->role, expected.role);
        EXPECT_EQ(clip->provenance, expected.provenance);
        EXPECT_TRUE(clip->rate == expected.rate);
        ASSERT_EQ(clip->segments.size(), expected.segments.size());
        for (std::size_t s = 0; s < clip->segments.size(); ++s) {
          EXPECT_EQ(clip->segments[s].label, expected.segments[s].label);
          EXPECT_EQ(clip->segments[s].begin_s, expected.segments[s].begin_s);
        }
        EXPECT_EQ(clip->motion->joints.xyz, expected.motion->joints.xyz);
        EXPECT_EQ(clip->motion->bone_length, expected.motion->bone_length);
        EXPECT_EQ(clip->motion->position_cov, expected.motion->position_cov);
        EXPECT_EQ(clip->motion->state, expected.motion->state);
        EXPECT_EQ(clip->motion->contact, expected.motion->contact);
        ASSERT_EQ(clip->motion->rotation.size(), expected.motion->rotation.size());
        for (std::size_t i = 0; i < clip->motion->rotation.size(); ++i) {
          EXPECT_EQ(clip->motion->rotation[i].coeffs(), expected.motion->rotation[i].coeffs());
        }
      }
    }
  }
}

TEST_F(ClipByClip, AChangedFrameIsFoundWhenTheFileIsOpened) {
  const Dataset dataset = test::MakeDataset();
  ASSERT_TRUE(WriteDataset(dataset, path));
  std::string bytes = *ReadFile(path);
  const auto value = static_cast<float>(dataset.clips.back().motion->joints.xyz.back());
  const std::size_t at = bytes.rfind(std::string(reinterpret_cast<const char*>(&value), sizeof value));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  ASSERT_TRUE(WriteFile(path, bytes));
  ASSERT_FALSE(ReadDataset(path)) << "the file is damaged";
  const auto clips = DatasetClips::Open(path, DatasetClips::Check::kHashes);
  ASSERT_FALSE(clips);
  EXPECT_EQ(clips.error().code, ErrorCode::kMalformed);
  EXPECT_THAT(clips.error().Message(), HasSubstr("/frames/joints"));
}

TEST_F(ClipByClip, ANonFiniteNumberFailsOnlyItsClip) {
  const Dataset dataset = test::MakeDataset();
  ASSERT_GT(dataset.clips.size(), 1u);
  ASSERT_TRUE(WriteDataset(dataset, path));
  std::string bytes = *ReadFile(path);
  std::string first;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto value = static_cast<float>(dataset.clips[0].motion->joints.xyz[i]);
    first.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  const std::size_t at = bytes.find(first);
  ASSERT_NE(at, std::string::npos);
  const float not_finite = std::numeric_limits<float>::quiet_NaN();
  bytes.replace(at, sizeof not_finite, reinterpret_cast<const char*>(&not_finite), sizeof not_finite);
  ASSERT_TRUE(WriteFile(path, bytes));
  const auto clips = DatasetClips::Open(path, DatasetClips::Check::kNone);
  ASSERT_TRUE(clips) << clips.error().Message();
  const auto lost = clips->Read(0);
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().Message(), HasSubstr("/frames/joints: [0, 0, 0] is nan"));
  EXPECT_THAT(lost.error().hint, HasSubstr("exclude it"));
  EXPECT_TRUE(clips->Read(1));
}

TEST_F(ClipByClip, AFileThatIsNotADatasetIsRefused) {
  EXPECT_EQ(DatasetClips::Open(path, DatasetClips::Check::kNone).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(WriteEvidence(test::MakeEvidenceClip(true), path));
  for (const auto check : {DatasetClips::Check::kHashes, DatasetClips::Check::kNone}) {
    const auto clips = DatasetClips::Open(path, check);
    ASSERT_FALSE(clips);
    EXPECT_THAT(clips.error().Message(), HasSubstr("was expected"));
  }
}

}  // namespace
}  // namespace mocurate
