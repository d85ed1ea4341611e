// Motion sets of other programs: dumps of MDM and ACTOR, Lie parameters, and their labels.

#include "ingest/read_motions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/formats/pickle_writer.h"
#include "core/motion/kinematics.h"
#include "ingest/inspect/source_declaration.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class OtherPrograms : public ::testing::Test {
 protected:
  void SetUp() override { folder = FreshFolder("other_programs"); }
  void TearDown() override { fs::remove_all(folder); }

  static MotionsOptions Arrays(const fs::path& path, const std::string& skeleton = "smpl24") {
    MotionsOptions options;
    options.ingest.path = path;
    SourceOptions& source = options.ingest.source;
    source.name = "dump";
    source.format = "npy";
    source.files = "{recording}.npy";
    source.recording = "{file}";
    source.person = kUnknownPerson;
    source.units = "m";
    source.axes = "+x +y +z";
    source.rate_hz = 20;
    source.skeleton = skeleton;
    source.damaged_rows = DamagedRows::kRefuse;
    source.checks.IgnoreAll();
    options.classes = {"walk", "sit", "jump"};
    return options;
  }
  static std::vector<std::string> Labels(const Expected<ReadMotions>& read) {
    std::vector<std::string> labels;
    for (const Clip& clip : read->set.clips) labels.push_back(clip.label);
    return labels;
  }
  fs::path folder;
};

/// Value k of joint j in frame f of motion n: all values differ.
double ValueAt(std::size_t n, std::size_t f, std::size_t j, std::size_t k) {
  return 0.5 * static_cast<double>(n) + 0.01 * static_cast<double>(f) + 0.001 * static_cast<double>(j * 3 + k);
}

/// (motions..., joints, 3, frames)
NpyArray FramesLast(std::vector<std::size_t> shape) {
  NpyArray array;
  array.dtype = "<f8";
  const std::size_t frames = shape.back(), joints = shape[shape.size() - 3];
  std::size_t motions = 1;
  for (std::size_t i = 0; i + 3 < shape.size(); ++i) motions *= shape[i];
  array.shape = std::move(shape);
  for (std::size_t n = 0; n < motions; ++n) {
    for (std::size_t j = 0; j < joints; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t f = 0; f < frames; ++f) array.values.push_back(ValueAt(n, f, j, k));
      }
    }
  }
  return array;
}

void ExpectMotion(const Clip& clip, std::size_t n, std::size_t frames) {
  ASSERT_EQ(clip.motion->frame_count(), static_cast<int>(frames));
  EXPECT_DOUBLE_EQ(clip.rate.hz(), 20.0);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < 24; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_NEAR(clip.motion->joints.at(static_cast<int>(f), static_cast<int>(j))[static_cast<int>(k)],
                    ValueAt(n, f, j, k), 1e-6);
      }
    }
  }
}

TEST_F(OtherPrograms, ReadActorDumpsBySampleClassJointCoordinateAndFrame) {
  Put(folder / "generation.npy", WriteNpy(FramesLast({2, 3, 24, 3, 7})));
  Put(folder / "labels.txt", "walk\nsit\njump\nwalk\nsit\njump\n");
  const auto labels = ReadMotionLabels(folder / "labels.txt");
  ASSERT_TRUE(labels) << labels.error().Message();
  const auto read = ReadAllMotions(Arrays(folder / "generation.npy"), *labels);
  ASSERT_TRUE(read) << read.error().Message();
  ASSERT_EQ(read->set.clips.size(), 6u);
  EXPECT_TRUE(read->refused.empty());
  EXPECT_THAT(Labels(read), ElementsAre("walk", "sit", "jump", "walk", "sit", "jump"));
  EXPECT_THAT(read->set.labels, ElementsAre("walk", "sit", "jump")) << "in class order";
  for (std::size_t n = 0; n < 6; ++n) ExpectMotion(read->set.clips[n], n, 7);
}

TEST_F(OtherPrograms, ReadMdmResultsWithLabelsAndLengths) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("motion");
  writer.Array(FramesLast({3, 24, 3, 7}));
  writer.Text("text");
  writer.BeginList();
  for (const char* text : {"sit", "jump", "walk"}) writer.Text(text);
  writer.End();
  writer.Text("lengths");
  NpyArray lengths;
  lengths.dtype = "<i8";
  lengths.shape = {3};
  lengths.values = {7, 4, 6};
  writer.Array(lengths);
  writer.End();
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
  header += std::string(117 - header.size(), ' ') + "\n";
  Put(folder / "results.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + writer.Finish("results").value());
  const auto read = ReadAllMotions(Arrays(folder / "results.npy"));
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(Labels(read), ElementsAre("sit", "jump", "walk"));
  const std::size_t frames[] = {7, 4, 6};
  for (std::size_t n = 0; n < 3; ++n) ExpectMotion(read->set.clips[n], n, frames[n]);
}

TEST_F(OtherPrograms, ReadLieParametersWithTheirBones) {
  const SkeletonPtr skeleton = LoadSkeleton("humanact12").value();
  Random random(3, "lie", "");
  NpyArray array;
  array.dtype = "<f8";
  array.shape = {2, 5, 72};
  for (int i = 0; i < 2 * 5 * 72; ++i) array.values.push_back(0.3 * random.Normal());
  Put(folder / "lie.npy", WriteNpy(array));
  MotionsOptions options = Arrays(folder / "lie.npy", "humanact12");
  for (int j = 0; j < 24; ++j) options.ingest.source.lie_bone_lengths.push_back(j == 0 ? 0.0 : 0.1 + 0.01 * j);
  const auto read = ReadAllMotions(options);
  ASSERT_TRUE(read) << read.error().Message();
  for (int n = 0; n < 2; ++n) {
    for (int f = 0; f < 5; ++f) {
      std::vector<Vector3d> expected(24);
      LieForward(*skeleton, array.values.data() + (n * 5 + f) * 72, options.ingest.source.lie_bone_lengths,
                 LieExp::kReleased, expected.data());
      const Motion& motion = *read->set.clips[static_cast<std::size_t>(n)].motion;
      for (int j = 0; j < 24; ++j) {
        EXPECT_LT((motion.joints.at(f, j) - expected[static_cast<std::size_t>(j)]).norm(), 1e-6) << j;
      }
    }
  }
  options.ingest.source.lie_bone_lengths.pop_back();
  const auto refused = ReadAllMotions(options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConfig) << refused.error().Message();
}

TEST_F(OtherPrograms, NameABadMotionAndReadTheOthers) {
  NpyArray array = FramesLast({3, 24, 3, 7});
  array.values[24 * 3 * 7 + 11] = std::nan("");
  Put(folder / "bad.npy", WriteNpy(array));
  const auto read = ReadAllMotions(Arrays(folder / "bad.npy"));
  ASSERT_TRUE(read) << read.error().Message();
  ASSERT_EQ(read->set.clips.size(), 2u);
  ASSERT_EQ(read->refused.size(), 1u);
  EXPECT_NE(read->refused[0].item.find("0001"), std::string::npos) << read->refused[0].item;
}

/// Four motions of 20 frames that end in 8 zeros, 8 repeats, nothing, and that are nothing but zeros.
NpyArray Padded() {
  NpyArray array;
  array.dtype = "<f8";
  array.shape = {4, 20, 24, 3};
  for (std::size_t n = 0; n < 4; ++n) {
    for (std::size_t f = 0; f < 20; ++f) {
      const bool zero = n == 3 || (n == 0 && f >= 12);
      const std::size_t shown = n == 1 ? std::min<std::size_t>(f, 11) : f;
      for (std::size_t k = 0; k < 72; ++k) array.values.push_back(zero ? 0.0 : 1.0 + ValueAt(n, shown, k / 3, k % 3));
    }
  }
  return array;
}

std::vector<int> FramesOf(const ReadMotions& read) {
  std::vector<int> frames;
  for (const Clip& clip : read.set.clips) frames.push_back(clip.motion->frame_count());
  return frames;
}

TEST_F(OtherPrograms, PadMotionsWithZerosAndRepeats) {
  Put(folder / "padded.npy", WriteNpy(Padded()));
  MotionsOptions options = Arrays(folder / "padded.npy");
  const auto as_given = ReadAllMotions(options);
  ASSERT_TRUE(as_given) << as_given.error().Message();
  EXPECT_THAT(FramesOf(*as_given), ElementsAre(20, 20, 20, 20));
  EXPECT_EQ(as_given->padded.motions, 0);
  options.padding = PaddingAction::kCut;
  const auto cut = ReadAllMotions(options);
  ASSERT_TRUE(cut) << cut.error().Message();
  EXPECT_THAT(FramesOf(*cut), ElementsAre(12, 12, 20));
  EXPECT_EQ(cut->padded.motions, 2);
  EXPECT_EQ(cut->padded.frames, 16);
  ASSERT_EQ(cut->refused.size(), 1u) << "nothing but zeros";
  EXPECT_NE(cut->refused[0].item.find("0003"), std::string::npos);
  const auto& findings = cut->set.findings;
  EXPECT_EQ(std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.code == "padding_cut"; }),
            2);
  options.padding = PaddingAction::kKeep;
  const auto kept = ReadAllMotions(options);
  EXPECT_THAT(FramesOf(*kept), ElementsAre(20, 20, 20, 20));
  EXPECT_EQ(kept->padded.motions, 3);
}

TEST_F(OtherPrograms, StateLengthsInFramesOfTheFileWhoseUnobservedEndsAreCut) {
  NpyArray array = Padded();
  for (std::size_t n = 0; n < 4; ++n) {
    for (std::size_t f = 0; f < 20; ++f) {
      for (std::size_t k = 0; k < 72; ++k)
        array.values[(n * 20 + f) * 72 + k] = f < 3 || f >= 18 ? std::nan("") : 1.0 + ValueAt(n, f, k / 3, k % 3);
    }
  }
  Put(folder / "unseen.npy", WriteNpy(array));
  MotionsOptions options = Arrays(folder / "unseen.npy");
  options.ingest.source.damaged_rows = DamagedRows::kReport;
  Put(folder / "lengths.txt", "12\n20\n21\n2\n");
  const auto read = ReadAllMotions(options, {}, *ReadMotionLengths(folder / "lengths.txt"));
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(FramesOf(*read), ElementsAre(9, 15));
  EXPECT_EQ(read->set.clips.at(0).identity.begin_frame, 3);
  EXPECT_EQ(read->set.clips.at(0).identity.end_frame, 12);
  ASSERT_EQ(read->refused.size(), 2u);
  EXPECT_EQ(std::filesystem::path(read->refused[0].error.where).filename(), "lengths.txt:3");
  EXPECT_EQ(std::filesystem::path(read->refused[1].error.where).filename(), "lengths.txt:4");
}

TEST_F(OtherPrograms, StateTheLengthsOfTheirMotions) {
  Put(folder / "padded.npy", WriteNpy(Padded()));
  MotionsOptions options = Arrays(folder / "padded.npy");
  options.padding = PaddingAction::kCut;
  Put(folder / "lengths.txt", "12\n15\n\n20\n1\n");
  const auto lengths = ReadMotionLengths(folder / "lengths.txt");
  ASSERT_TRUE(lengths) << lengths.error().Message();
  const auto read = ReadAllMotions(options, {}, *lengths);
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(FramesOf(*read), ElementsAre(12, 15, 20)) << "repeats within the stated length are motion";
  NpyArray numbers;
  numbers.dtype = "<i8";
  numbers.shape = {4};
  numbers.values = {12, 21, 20, 20};
  Put(folder / "lengths.npy", WriteNpy(numbers));
  const auto longer = ReadAllMotions(options, {}, *ReadMotionLengths(folder / "lengths.npy"));
  ASSERT_TRUE(longer) << longer.error().Message();
  ASSERT_EQ(longer->refused.size(), 2u) << "a motion has 20 frames; the last is nothing but zeros";
  EXPECT_EQ(std::filesystem::path(longer->refused[0].error.where).filename(), "lengths.npy[1]");
  EXPECT_THAT(FramesOf(*longer), ElementsAre(12, 20));
  Put(folder / "few.txt", "12\n12\n");
  EXPECT_FALSE(ReadAllMotions(options, {}, *ReadMotionLengths(folder / "few.txt")));
  for (const char* bad : {"12\n0\n", "12\n-3\n", "12\n7.5\n", "12\nall\n", "\n"}) {
    Put(folder / "bad.txt", bad);
    const auto refused = ReadMotionLengths(folder / "bad.txt");
    ASSERT_FALSE(refused) << bad;
    if (std::string(bad).size() == 1) continue;
    EXPECT_EQ(std::filesystem::path(refused.error().where).filename(), "bad.txt:2");
  }
}

TEST_F(OtherPrograms, PadRotationsWithZeros) {
  std::string text =
      "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n JOINT spine\n {\n  OFFSET 0 0 50\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  JOINT head\n  {\n"
      "   OFFSET 0 0 40\n   CHANNELS 3 Zrotation Xrotation Yrotation\n   End Site\n   {\n    OFFSET 0 0 10\n   }\n  }\n"
      " }\n}\nMOTION\nFrames: 30\nFrame Time: 0.05\n";
  for (int f = 0; f < 30; ++f) {
    for (int c = 0; c < 12; ++c) text += (f < 27 ? std::to_string((c == 2 ? 90 : 0) + 0.3 * f + c) : "0") + " ";
    text += "\n";
  }
  Put(folder / "a.bvh", text);
  MotionsOptions options = Arrays(folder, "");
  options.ingest.source.format = "bvh";
  options.ingest.source.files = "{recording}.bvh";
  options.ingest.source.units = "cm";
  options.ingest.source.axes = "+x -z +y";
  options.ingest.source.rate_hz.reset();
  options.padding = PaddingAction::kCut;
  const auto read = ReadAllMotions(options);
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_THAT(FramesOf(*read), ElementsAre(27));
}

struct LabelFile {
  std::string name, bytes;
};

TEST_F(OtherPrograms, RejectInvalidLabelFiles) {
  const LabelFile files[] = {{"empty.txt", "\n \n"},
                             {"twice.csv", "a,walk\na,run\n"},
                             {"columns.csv", "a,walk,now\n"},
                             {"mixed.csv", "a,walk\nrun\n"},
                             {"none.npy", "not numpy"}};
  for (const LabelFile& file : files) {
    Put(folder / file.name, file.bytes);
    EXPECT_FALSE(ReadMotionLabels(folder / file.name)) << file.name;
  }
  NpyArray numbers;
  numbers.dtype = "<i8";
  numbers.shape = {3};
  numbers.values = {2, 0, 11};
  Put(folder / "numbers.npy", WriteNpy(numbers));
  EXPECT_THAT(ReadMotionLabels(folder / "numbers.npy")->ordered, ElementsAre("2", "0", "11"));
}

}  // namespace
}  // namespace mocurate
