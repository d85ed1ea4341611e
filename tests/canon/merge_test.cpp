// Several datasets as one: what is united, what is checked again, what is refused.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "canon/values/merge.h"
#include "canon/values/set_files.h"
#include "canon/values/subset.h"
#include "tests/canon/value_sets.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

MergePart PartOf(const std::string& name, const Dataset& dataset) {
  return {name, dataset, "", [dataset](std::size_t row) -> Expected<std::string> {
            return MotionFingerprint(*dataset.clips[row].motion);
          }};
}

Dataset Where(const std::string& condition, const Dataset& dataset = SixClips()) {
  return SubsetOf(dataset, *Condition::Parse(condition), "whole.h5")->dataset;
}

Expected<MergedDataset> Merge(const std::vector<Dataset>& datasets) {
  std::vector<MergePart> parts;
  for (const Dataset& dataset : datasets) parts.push_back(PartOf(std::string(1, char('A' + parts.size())), dataset));
  return MergeDatasets(parts);
}

/// Of people who are not in SixClips.
Dataset OtherPeople() {
  Dataset others = SixClips();
  for (Clip& clip : others.clips) {
    clip.identity.person += "x";
    for (double& value : clip.motion->joints.xyz) value += 0.01;
  }
  others.findings.clear();
  return others;
}

/// The same with rotations, of a person whose rotations refer to another rest pose.
Dataset WithRotations(const SkeletonPtr& skeleton, const std::string& person) {
  Dataset dataset;
  dataset.skeleton = skeleton;
  Clip clip = ClipMoving(person, "a", 10, 2, 8, 1);
  const std::size_t cells = 10 * static_cast<std::size_t>(skeleton->joint_count());
  clip.motion = MakeMotion(skeleton, clip.rate, std::vector<Vector3d>(10, Vector3d(0, 1, 0)),
                           std::vector<Quaterniond>(cells, Quaterniond::Identity()), {});
  dataset.clips = {clip};
  dataset.labels = {"a"};
  return dataset;
}

TEST(Merge, OfAllPartsOfADatasetIsTheDataset) {
  const Dataset whole = SixClips();
  const std::vector<Dataset> parts = {Where("label == b or person == p3"), Where("not (label == b or person == p3)"),
                                      Where("person == p2")};
  const auto merged = Merge(parts);
  ASSERT_TRUE(merged) << merged.error().Message();
  EXPECT_EQ(IdsOf(merged->dataset), IdsOf(whole));
  EXPECT_EQ(merged->dataset.labels, whole.labels);
  EXPECT_EQ(merged->dataset.splits[0].train, whole.splits[0].train);
  EXPECT_EQ(merged->dataset.splits[0].validation, whole.splits[0].validation);
  EXPECT_EQ(merged->dataset.splits[0].test, whole.splits[0].test);
  EXPECT_EQ(merged->dataset.splits[0].rule, "drawn") << "as in all parts";
  const auto count = [](const std::vector<Finding>& findings, const std::string& code) {
    const auto codes = CodesOfFindings(findings);
    return std::count(codes.begin(), codes.end(), code);
  };
  EXPECT_EQ(count(merged->findings, "repeated_clip"), 2);
  EXPECT_EQ(count(merged->dataset.findings, "position_jump"), 3) << "each once, also for the clip in two parts";
  for (std::size_t i = 0; i < merged->origins.size(); ++i) {
    const auto [part, row] = merged->origins[i];
    EXPECT_EQ(parts[part].clips[row].id(), whole.clips[i].id());
  }
}

TEST(Merge, UnitesLabelsInTheOrderOfTheFirst) {
  Dataset others = OtherPeople();
  others.labels = {"z", "b", "a"};
  others.fine_labels = {{"z fast", 0}, {"b at once", 1}};
  others.clips[0].label = "z";
  others.clips[0].fine_label = "";
  const auto merged = Merge({SixClips(), others});
  ASSERT_TRUE(merged) << merged.error().Message();
  EXPECT_THAT(merged->dataset.labels, ElementsAre("a", "b", "c", "z"));
  ASSERT_EQ(merged->dataset.fine_labels.size(), 3u);
  EXPECT_EQ(merged->dataset.fine_labels[2].name, "z fast");
  EXPECT_EQ(merged->dataset.fine_labels[2].parent, 3);
  EXPECT_THAT(CodesOfFindings(merged->findings), ElementsAre("mixed_rates"));
  EXPECT_THAT(merged->dataset.splits[0].leak_check, ::testing::StartsWith("ok"));
  EXPECT_THAT(merged->dataset.recipe, HasSubstr("six clips"));

  others.fine_labels[1].parent = 2;
  const auto conflict = Merge({SixClips(), others});
  ASSERT_FALSE(conflict) << "'b at once' of class b, and of class a";
  EXPECT_EQ(conflict.error().code, ErrorCode::kInconsistent);
}

TEST(Merge, ChecksUnitedSplitsForLeaksThatNoPartHasByItself) {
  const auto by_person = [](std::vector<int> train, std::vector<int> test) {
    Dataset dataset = SixClips();
    dataset.splits[0].train = std::move(train);
    dataset.splits[0].validation.clear();
    dataset.splits[0].test = std::move(test);
    return dataset;
  };
  const Dataset first = by_person({0, 1}, {4, 5});
  Dataset second = by_person({4, 5}, {0, 1});
  for (Clip& clip : second.clips) {
    clip.identity.recording += "again";
    for (double& value : clip.motion->joints.xyz) value += 0.01;
  }
  second.findings.clear();
  const auto leaking = Merge({first, second});
  ASSERT_TRUE(leaking) << leaking.error().Message();
  EXPECT_THAT(CodesOfFindings(leaking->findings), ElementsAre("mixed_rates", "split_leak"));
  EXPECT_EQ(leaking->findings[1].severity, Severity::kError);
  EXPECT_THAT(leaking->dataset.splits[0].leak_check, HasSubstr("test/p1, test/p3"));

  for (Clip& clip : second.clips) clip.identity.source = "elsewhere";
  EXPECT_THAT(Merge({first, second})->dataset.splits[0].leak_check, ::testing::StartsWith("ok")) << "other people";
  second.clips[4].motion = first.clips[4].motion;
  second.clips[4].rate = first.clips[4].rate;
  EXPECT_THAT(CodesOfFindings(Merge({first, second})->findings), ElementsAre("mixed_rates", "split_leak"))
      << "one motion is in both parts";

  const Dataset drawn = by_person({0, 2, 4}, {1, 3, 5});
  Dataset drawn_too = second;
  drawn_too.splits = by_person({1, 3}, {0, 2}).splits;
  drawn_too.clips[4].motion->joints.xyz[0] += 0.5;
  EXPECT_THAT(Merge({drawn, drawn_too})->dataset.splits[0].leak_check, ::testing::StartsWith("ok"))
      << "neither keeps persons apart";
}

TEST(Merge, OneFileInTwoSetsUnderTwoNamesLeaks) {
  const auto set = [](const std::vector<std::pair<std::string, double>>& people, bool test) {
    std::vector<Clip> clips;
    for (const auto& [person, pace] : people) {
      clips.push_back(ClipMoving(person, "a", 40, 5, 30, pace));
      clips.back().evidence_sha256 = std::string(64, 'a');
      clips.back().provenance["file"] = "one.skeleton";
    }
    Dataset dataset = SetOf(std::move(clips));
    Split split;
    split.name = "s";
    for (std::size_t row = 0; row < people.size(); ++row) {
      (test ? split.test : split.train).push_back(static_cast<int>(row));
    }
    split.leak_check = "ok: nothing";
    dataset.splits = {split};
    return dataset;
  };
  const auto check_of = [](const Dataset& a, const Dataset& b) {
    const auto merged = Merge({a, b});
    EXPECT_TRUE(merged) << merged.error().Message();
    return merged ? merged->dataset.splits.at(0).leak_check : std::string();
  };
  EXPECT_THAT(check_of(set({{"P1", 1.0}}, false), set({{"Q1", 1.0}}, true)), HasSubstr("1 clip of equal content"));
  EXPECT_THAT(check_of(set({{"P1", 1.0}}, false), set({{"Q1", 1.1}}, true)), HasSubstr("1 clip of equal content"))
      << "fitted otherwise";
  EXPECT_THAT(check_of(set({{"P1", 1.0}, {"P2", 1.2}}, false), set({{"Q1", 1.0}, {"Q2", 1.2}}, true)),
              HasSubstr("2 clips of equal content"));
  EXPECT_THAT(check_of(set({{"P1", 1.0}, {"P2", 1.2}}, false), set({{"Q2", 1.2}}, true)),
              HasSubstr("1 clip of equal content"));
}

TEST(Merge, ReportsClipsThatASplitDoesNotPlace) {
  Dataset others = OtherPeople();
  others.splits[0].name = "other";
  const auto merged = Merge({SixClips(), others});
  ASSERT_TRUE(merged);
  EXPECT_THAT(CodesOfFindings(merged->findings), IsSupersetOf({"split_incomplete", "split_incomplete"}));
  EXPECT_EQ(merged->dataset.splits.size(), 2u);
  Dataset moved = SixClips();
  std::swap(moved.splits[0].test, moved.splits[0].validation);
  const auto placed = Merge({SixClips(), moved});
  ASSERT_TRUE(placed);
  EXPECT_THAT(CodesOfFindings(placed->findings), IsSupersetOf({"split_part_differs", "split_part_differs"}));
  EXPECT_EQ(placed->dataset.splits[0].test, SixClips().splits[0].test) << "as in the first";
}

TEST(Merge, RefusesOneIdOfTwoClipsAndNamesBothFiles) {
  const auto refused = [](const std::function<void(Clip&)>& change) {
    Dataset changed = SixClips();
    change(changed.clips[2]);
    const auto merged = Merge({SixClips(), changed});
    EXPECT_FALSE(merged);
    EXPECT_EQ(merged.error().code, ErrorCode::kInconsistent);
    EXPECT_EQ(merged.error().where, "B");
    EXPECT_THAT(merged.error().what, HasSubstr("differs from that of A"));
    EXPECT_THAT(merged.error().what, HasSubstr(SixClips().clips[2].id()));
  };
  refused([](Clip& clip) { clip.motion->joints.xyz[7] += 0.001; });
  refused([](Clip& clip) { clip.label = "b"; });
  refused([](Clip& clip) { clip.segments[0].label = "other"; });
  refused([](Clip& clip) { clip.rate = clip.motion->rate = FrameRate{25, 1}; });
  refused([](Clip& clip) { clip.identity.licence = "none"; });
}

TEST(Merge, RefusesOtherTreesRestPosesAndModalitiesOfMotion) {
  const SkeletonPtr skeleton = Skeleton15();
  auto bent = std::make_shared<Skeleton>(*skeleton);
  for (Joint& joint : bent->joints) joint.rest_offset = Eigen::AngleAxisd(0.3, Vector3d::UnitX()) * joint.rest_offset;
  const Dataset straight = WithRotations(skeleton, "p1");
  EXPECT_TRUE(Merge({straight, WithRotations(skeleton, "p2")}));
  for (const auto& other : {WithRotations(bent, "p2"), WithRotations(*LoadSkeleton("smpl24"), "p2"), SixClips()}) {
    const auto merged = Merge({straight, WithRotations(skeleton, "p0"), other});
    ASSERT_FALSE(merged);
    EXPECT_EQ(merged.error().code, ErrorCode::kInconsistent);
    EXPECT_THAT(merged.error().where, ::testing::StartsWith("C"));
  }
  Dataset turned = OtherPeople();
  turned.axes = *AxisConvention::Parse("+x +z -y");
  EXPECT_EQ(Merge({SixClips(), turned}).error().code, ErrorCode::kInconsistent);
}

TEST(Merge, OfFilesWritesWhatTheDatasetsHold) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(Where("person == p2"), folder / "a.h5"));
  ASSERT_TRUE(WriteDataset(Where("person != p2"), folder / "b.h5"));
  const auto files = OpenDatasetFiles({folder / "a.h5", folder / "b.h5"});
  ASSERT_TRUE(files) << files.error().Message();
  std::vector<MergePart> parts;
  for (const DatasetFile& file : *files) {
    parts.push_back({file.name, file.outline, file.clips.content_sha256(),
                     [&file](std::size_t row) { return file.clips.MotionSha256(row); }});
  }
  auto merged = MergeDatasets(parts);
  ASSERT_TRUE(merged) << merged.error().Message();
  std::vector<ClipOrigin> origins;
  for (const auto& [part, row] : merged->origins) origins.push_back(WholeClip(part, row, *files));
  const auto written = WriteFromFiles(merged->dataset, origins, *files, folder / "ab.h5");
  ASSERT_TRUE(written) << written.error().Message();
  const auto read = ReadDataset(folder / "ab.h5");
  ASSERT_TRUE(read) << read.error().Message();
  const Dataset whole = SixClips();
  ASSERT_EQ(IdsOf(*read), IdsOf(whole));
  for (std::size_t i = 0; i < whole.clips.size(); ++i) {
    EXPECT_EQ(MotionFingerprint(*read->clips[i].motion), MotionFingerprint(*whole.clips[i].motion));
  }
  EXPECT_EQ(read->splits[0].train, whole.splits[0].train);
}

}  // namespace
}  // namespace mocurate
