// What every layout of `mocurate export` writes comes back through ingest by its own declaration.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "canon/exports/clip_names.h"
#include "canon/exports/layout.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/bvh.h"
#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "ingest/read_motions.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/swinging_clips.h"

#ifdef MOCURATE_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

struct Written {
  std::map<std::string, std::size_t> clip_of;  ///< file, or name in the lists -> position
  std::vector<std::string> refused;            ///< ids
  std::vector<std::string> notes;
  std::vector<std::string> files;
};

/// `lost`: position of a clip whose files cannot be written.
Written WriteExport(const std::string& layout, const Dataset& dataset, const fs::path& folder,
                    std::optional<std::size_t> lost = std::nullopt) {
  ExportSet set;
  set.skeleton = dataset.skeleton;
  set.joints_only = dataset.joints_only;
  for (const Clip& clip : dataset.clips) set.ids.push_back(clip.id());
  set.labels = dataset.labels;
  set.splits = dataset.splits;
  set.folder = folder;
  for (const std::string& code : CheckCodes()) set.checks[code] = "{action: ignore}";
  Written written;
  const auto write = [&](const std::vector<ExportedFile>& files) {
    for (const ExportedFile& file : files) {
      fs::create_directories((folder / file.path).parent_path());
      std::ofstream(folder / file.path, std::ios::binary) << file.bytes;
      written.files.push_back(file.path);
    }
  };
  const std::unique_ptr<LayoutWriter> writer = FindLayout(layout)->make(set);
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const auto files = writer->Add(i, dataset.clips[i]);
    if (!files) {
      written.refused.push_back(dataset.clips[i].id());
      continue;
    }
    if (i == lost) {
      writer->RemoveLast();
      continue;
    }
    write(*files);
    if (files->empty()) {  // ACTOR's lists: place and class, both from 1
      const int label = dataset.LabelIndex(dataset.clips[i].label) + 1;
      char name[32];
      std::snprintf(name, sizeof(name), "c%04zu_y%02d", written.clip_of.size() + 1, label);
      written.clip_of[name] = i;
      continue;
    }
    written.clip_of[files->front().path] = i;
  }
  const auto tables = writer->Finish(written.notes);
  EXPECT_TRUE(tables) << tables.error().Message();
  if (tables) write(*tables);
  return written;
}

IngestOptions DeclaredBy(const fs::path& file) {
  const auto node = LoadConfig(file);
  EXPECT_TRUE(node) << node.error().Message();
  const auto options = node ? OptionsFromConfig<IngestOptions>(*node->Find("ingest")) : Expected<IngestOptions>();
  EXPECT_TRUE(options) << options.error().Message();
  return options ? *options : IngestOptions();
}

/// By position in the dataset that was written.
std::map<std::size_t, Clip> ReadBack(const Written& written, const fs::path& folder) {
  std::map<std::size_t, Clip> clips;
  const auto read = ReadAllMotions({DeclaredBy(folder / "source.yaml"), {}});
  EXPECT_TRUE(read) << read.error().Message();
  if (!read) return clips;
  for (const RefusedClip& refused : read->refused) ADD_FAILURE() << refused.item << ": " << refused.error.Message();
  for (const Clip& clip : read->set.clips) {
    const std::string& file = clip.provenance.at("file");
    const auto own = written.clip_of.find(file);
    EXPECT_NE(own, written.clip_of.end()) << file;
    if (own != written.clip_of.end()) clips[own->second] = clip;
  }
  return clips;
}

double FarthestJoint(const Motion& a, const Motion& b) {
  if (a.frame_count() != b.frame_count() || a.joint_count() != b.joint_count()) return INFINITY;
  double farthest = 0.0;
  for (int f = 0; f < a.frame_count(); ++f) {
    for (int j = 0; j < a.joint_count(); ++j) {
      farthest = std::max(farthest, (a.joints.at(f, j) - b.joints.at(f, j)).norm());
    }
  }
  return farthest;
}

double FarthestRotation(const Motion& a, const Motion& b, int joints) {
  double farthest = 0.0;
  for (int f = 0; f < a.frame_count(); ++f) {
    for (int j = 0; j < joints; ++j) {
      farthest = std::max(farthest, a.rotation_at(f, j).angularDistance(b.rotation_at(f, j)));
    }
  }
  return farthest;
}

struct RoundTrip {
  const char* layout;
  double joints_m;  ///< largest error of a joint after the round trip
  bool rotations;   ///< come back
  bool names;       ///< persons come back; recordings where their names are names for files
  bool fine_labels;
};

class EveryLayout : public testing::TestWithParam<RoundTrip> {};

INSTANTIATE_TEST_SUITE_P(Exports, EveryLayout,
                         testing::Values(RoundTrip{"npz", 0.0, false, true, true},
                                         RoundTrip{"humanact12", 1e-12, false, false, true},
                                         RoundTrip{"actor", 1e-9, true, false, false},
                                         RoundTrip{"amass_babel", 0.1, true, true, false},  // bones of smpl24
                                         RoundTrip{"csv", 1e-6, false, true, true},
                                         RoundTrip{"bvh", 1e-7, true, true, true}),
                         [](const auto& round_trip) { return std::string(round_trip.param.layout); });

TEST_P(EveryLayout, ComesBackByItsOwnDeclaration) {
  const RoundTrip& expected = GetParam();
  const Dataset dataset = SwingingSet("smpl24");
  const ScratchFolder folder;
  const Written written = WriteExport(expected.layout, dataset, folder.path());
  EXPECT_THAT(written.refused, IsEmpty());
  const std::map<std::size_t, Clip> back = ReadBack(written, folder.path());
  ASSERT_EQ(back.size(), dataset.clips.size());
  for (const auto& [position, clip] : back) {
    SCOPED_TRACE(dataset.clips[position].id());
    const Clip& original = dataset.clips[position];
    EXPECT_LE(FarthestJoint(*clip.motion, *original.motion), expected.joints_m);
    EXPECT_EQ(clip.motion->rate, original.motion->rate);
    EXPECT_EQ(clip.label, original.label);
    EXPECT_EQ(clip.identity.source, "studio");
    EXPECT_EQ(clip.identity.licence, "CC0");
    EXPECT_EQ(clip.fine_label, expected.fine_labels ? original.fine_label : "");
    EXPECT_EQ(clip.identity.person == original.identity.person, expected.names);
    EXPECT_EQ(clip.motion->joints_only(), !expected.rotations);
    if (!expected.rotations) continue;
    const int joints = std::string(expected.layout) == "amass_babel" ? 22 : 24;  // SMPL-H has fingers for hands
    EXPECT_LT(FarthestRotation(*clip.motion, *original.motion, joints), 1e-7);
    EXPECT_LT((clip.motion->root_translation[5] - original.motion->root_translation[5]).norm(), 1e-7);
  }
  if (!expected.names) return;
  EXPECT_EQ(back.at(0).identity.recording, "take 1");
  EXPECT_EQ(back.at(1).identity.recording, "take_ 2");
  EXPECT_EQ(back.at(2).identity.recording, "long.0-20");
  EXPECT_EQ(back.at(3).identity.recording, "long.40-71");
}

/// The classes in their order, and the splits that a declaration supports.
TEST_P(EveryLayout, DeclaresClassesAndSplits) {
  const ScratchFolder folder;
  WriteExport(GetParam().layout, SwingingSet("smpl24"), folder.path());
  const auto node = LoadConfig(folder.path() / "source.yaml");
  ASSERT_TRUE(node) << node.error().Message();
  const ConfigNode* assemble = node->Find("assemble");
  std::vector<std::string> classes, splits;
  for (const ConfigNode& one : assemble->Find("classes")->sequence) classes.push_back(one.Find("name")->scalar);
  EXPECT_THAT(classes, ElementsAre("walk", "exercise/training, hard", "never"));
  if (const ConfigNode* declared = assemble->Find("splits")) {
    for (const ConfigNode& one : declared->sequence) {
      splits.push_back(one.Find("name")->scalar + " by " + one.Find("by")->scalar);
    }
  }
  const std::string layout = GetParam().layout;
  if (layout == "actor") {
    EXPECT_THAT(splits, IsEmpty()) << "its clips come back without persons";
  } else if (layout == "amass_babel") {
    EXPECT_THAT(splits, ElementsAre("mixed by role", "persons by person"));
  } else {
    EXPECT_THAT(splits, ElementsAre("persons by person"));
  }
}

TEST_P(EveryLayout, GivesTheSameBytesAgain) {
  const ScratchFolder once, twice;
  const Dataset dataset = SwingingSet("smpl24");
  const Written first = WriteExport(GetParam().layout, dataset, once.path());
  WriteExport(GetParam().layout, dataset, twice.path());
  for (const std::string& file : first.files) {
    EXPECT_EQ(ReadFile(once.path() / file).value(), ReadFile(twice.path() / file).value()) << file;
  }
}

TEST_P(EveryLayout, TakesEveryNameOfAStranger) {
  Dataset dataset = SwingingSet("smpl24");
  dataset.labels[0] = "clips.csv";
  dataset.labels[1] = std::string(300, 'x');
  for (Clip& clip : dataset.clips) clip.label = clip.label == "walk" ? dataset.labels[0] : dataset.labels[1];
  dataset.clips[0].identity.recording = "CON";
  dataset.clips[1].identity.recording = "\xFF\ntake" + std::string(300, 'y');
  dataset.clips[1].fine_label = "\x1b\xE2\x80\xAE";
  dataset.clips[2].identity.person = dataset.clips[3].identity.person = "..";
  for (Clip& clip : dataset.clips) clip.identity.source = "source.yaml";
  const ScratchFolder folder;
  const Written written = WriteExport(GetParam().layout, dataset, folder.path());
  EXPECT_THAT(written.refused, IsEmpty());
  for (const std::string& file : written.files) {
    EXPECT_TRUE(fs::is_regular_file(folder.path() / file)) << file;
    EXPECT_EQ(file.find("../"), std::string::npos) << file;
    for (const char c : file) EXPECT_TRUE(c >= 0x20 && c < 0x7F) << file;
  }
  const std::map<std::size_t, Clip> back = ReadBack(written, folder.path());
  ASSERT_EQ(back.size(), dataset.clips.size());
  for (const auto& [position, clip] : back) EXPECT_EQ(clip.label, dataset.clips[position].label);
  if (GetParam().layout == std::string("actor")) return;  // one file
  const std::string table = ReadFile(folder.path() / "clips.csv").value();
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_FALSE(FirstNotUtf8(table));
}

TEST_P(EveryLayout, ListsNoClipWhoseFilesCouldNotBeWritten) {
  if (GetParam().layout == std::string("actor")) return;  // no clip has a file of its own
  const ScratchFolder folder;
  const Written written = WriteExport(GetParam().layout, SwingingSet("smpl24"), folder.path(), 2);
  const std::string table = ReadFile(folder.path() / "clips.csv").value();
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  EXPECT_EQ(ReadBack(written, folder.path()).size(), 3u);
}

TEST_P(EveryLayout, RefusesAClipThatItCannotTakeAndNoOther) {
  const std::string layout = GetParam().layout;
  Dataset dataset = SwingingSet("smpl24");
  Clip& odd = dataset.clips[1];
  const bool holds_rate = layout == "npz" || layout == "bvh" || layout == "amass_babel";
  odd.rate = odd.motion->rate = FrameRate{60, 1};
  const ScratchFolder folder;
  const Written written = WriteExport(layout, dataset, folder.path());
  if (holds_rate) {
    EXPECT_THAT(written.refused, IsEmpty());
  } else {
    EXPECT_THAT(written.refused, ElementsAre(odd.id()));
  }
  EXPECT_EQ(written.clip_of.size(), holds_rate ? 4u : 3u);
  if (layout == "npz") {
    EXPECT_FALSE(fs::exists(folder.path() / "source.yaml")) << "one declaration has one rate";
    return;
  }
  const std::map<std::size_t, Clip> back = ReadBack(written, folder.path());
  EXPECT_EQ(back.size(), written.clip_of.size());
  if (!holds_rate) return;
  ASSERT_EQ(back.count(1), 1u);
  EXPECT_EQ(back.at(1).motion->rate, (FrameRate{60, 1}));
}

TEST(ExportedSegments, AreBabelsFrameLabels) {
  const Dataset dataset = SwingingSet("smpl24");
  const ScratchFolder folder;
  const Written written = WriteExport("amass_babel", dataset, folder.path());
  const std::map<std::size_t, Clip> back = ReadBack(written, folder.path());
  ASSERT_EQ(back.count(2), 1u);
  const std::vector<Segment>& segments = back.at(2).segments;
  ASSERT_THAT(segments, SizeIs(2));
  EXPECT_EQ(segments[0].label, "step");
  EXPECT_EQ(segments[0].category, "walk, step");
  EXPECT_DOUBLE_EQ(segments[1].begin_s, 0.25);
  EXPECT_DOUBLE_EQ(segments[1].end_s, 0.6);
  EXPECT_EQ(segments[1].category, "turn") << "BABEL's programs read categories: the label is one";
  // By the first split: train, val and test.
  const fs::path babel = folder.path() / "babel_v1.0_release";
  std::map<std::string, std::string> files;
  for (const char* part : {"train", "val", "test"}) {
    const auto sequences = nlohmann::json::parse(ReadFile(babel / (std::string(part) + ".json")).value());
    for (const auto& [sid, sequence] : sequences.items()) {
      EXPECT_FALSE(sequence["seq_ann"].contains("babel_lid")) << "the source does not state it";
      files[sequence["feat_p"].get<std::string>()] = part;
    }
  }
  EXPECT_EQ(files, (std::map<std::string, std::string>{{"studio/studio/anna/take 1_poses.npz", "train"},
                                                       {"studio/studio/anna/take_ 2_poses.npz", "val"},
                                                       {"studio/studio/bob/long.0-20_poses.npz", "train"},
                                                       {"studio/studio/bob/long.40-71_poses.npz", "test"}}));
}

/// A person with legs of `legs` times the usual length who stands for a second, the root at height `root`, bent at hips
/// and knees a little; or who falls past all of it.
Clip StandingClip(const std::string& recording, double legs, double root, bool falls) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (const int joint : {4, 5, 7, 8}) bones[joint] *= legs;  // knees and ankles
  std::vector<Vector3d> places;
  for (int f = 0; f < 30; ++f) places.emplace_back(0.0, falls ? root - 0.1 * f : root, 0.0);
  std::vector<Quaterniond> rotation(30 * 24, Quaterniond::Identity());
  for (int f = 0; f < 30; ++f) rotation[f * 24] = ExpQuaternion(Vector3d(0.0, 0.02 * f, 0.0));
  Clip clip;
  clip.identity = StudioTake("anna", recording, 0, 30);
  clip.label = "walk";
  clip.rate = FrameRate{30, 1};
  clip.motion = MakeMotion(skeleton, clip.rate, places, rotation, bones);
  return clip;
}

double LowestFoot(const Motion& motion) {
  double lowest = INFINITY;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (const int foot : {10, 11}) lowest = std::min(lowest, motion.joints.at(f, foot).y());
  }
  return lowest;
}

TEST(ExportedAmass, StandsOnTheFloorWhereOneIsKnown) {
  Dataset dataset;
  dataset.skeleton = *LoadSkeleton("smpl24");
  dataset.labels = {"walk"};
  dataset.clips = {StandingClip("a_rooted", 1.1, 0.0, false), StandingClip("b_falling", 1.0, 0.0, true),
                   StandingClip("c_levelled", 0.9, 0.0, false), StandingClip("d_jumping", 1.0, 5.0, true)};
  dataset.clips[1].provenance[kHeightOrigin] = kOriginRoot;
  // On a floor that was measured over a set, where this clip stands on a step of 0.3 m.
  dataset.clips[2].motion->root_translation.assign(30, Vector3d(0.0, 0.3 - LowestFoot(*dataset.clips[2].motion), 0.0));
  ComputeJoints(*dataset.clips[2].motion);
  dataset.clips[2].provenance[kHeightOrigin] = dataset.clips[3].provenance[kHeightOrigin] = kOriginFloor;
  const ScratchFolder folder;
  const std::map<std::size_t, Clip> back = ReadBack(WriteExport("amass_babel", dataset, folder.path()), folder.path());
  ASSERT_EQ(back.size(), 4u);
  EXPECT_NEAR(LowestFoot(*back.at(0).motion), 0.0, 0.005);
  EXPECT_NEAR(back.at(1).motion->root_translation[7].y(), dataset.clips[1].motion->root_translation[7].y(), 1e-7);
  EXPECT_NEAR(LowestFoot(*back.at(2).motion), 0.3, 0.005) << "on the shorter legs of the person, on those of smpl24";
  EXPECT_NEAR(back.at(3).motion->root_translation[7].y(), dataset.clips[3].motion->root_translation[7].y(), 1e-7);
  const std::string table = ReadFile(folder.path() / "clips.csv").value();
  const std::vector<std::string_view> lines = SplitText(table, '\n');
  std::vector<std::string> origins;
  std::vector<double> raised;
  const std::vector<std::string_view> header = SplitText(lines.at(0), ',');
  ASSERT_EQ(header.at(9), "origin");
  ASSERT_EQ(header.at(10), "raised_m");
  for (std::size_t i = 1; i <= 4; ++i) {
    const std::vector<std::string_view> cells = SplitText(lines.at(i), ',');
    origins.emplace_back(cells.at(9));
    raised.push_back(ParseDouble(cells.at(10)).value());
  }
  EXPECT_THAT(origins, ElementsAre("floor", "root", "floor", "floor"));
  for (std::size_t i = 0; i < 4; ++i) {
    const double moved = back.at(i).motion->root_translation[0].y() - dataset.clips[i].motion->root_translation[0].y();
    EXPECT_NEAR(raised[i], moved, 1e-5);
  }
  EXPECT_GT(raised[0], 0.8);
  EXPECT_EQ(raised[1], 0.0);
}

TEST(ExportedHumanAct12, KeepsNamesOfTheSetAndMakesOthers) {
  Dataset dataset;
  dataset.skeleton = *LoadSkeleton("humanact12");
  dataset.labels = {"warm_up", "walk"};
  dataset.clips = {Swinging(dataset.skeleton, StudioTake("P02", "P02G01R03F0010T0039A0102", 0, 30), "warm_up", 0.0),
                   Swinging(dataset.skeleton, StudioTake("P02", "P02G02R01F0010T0039A0103", 0, 30), "walk", 1.0),
                   Swinging(dataset.skeleton, StudioTake("anna", "walk", 5, 25), "walk", 2.0),
                   Swinging(dataset.skeleton, StudioTake("bob", "walk", 5, 25), "walk", 3.0)};
  dataset.clips[0].fine_label = "warm_up_pectoral";
  const ScratchFolder folder;
  const Written written = WriteExport("humanact12", dataset, folder.path());
  std::map<std::size_t, std::string> names;
  for (const auto& [name, position] : written.clip_of) names[position] = name;
  EXPECT_EQ(names[0], "P02G01R03F0010T0039A0102.npy") << "the set's own name";
  EXPECT_EQ(names[1], "P02G01R01F0000T0029A0200.npy") << "its name has another class";
  EXPECT_EQ(names[2], "P01G01R01F0005T0024A0200.npy");
  EXPECT_EQ(names[3], "P03G01R01F0005T0024A0200.npy");
  const auto array = ParseNpy(ReadFile(folder.path() / names[0]).value(), "clip");
  ASSERT_TRUE(array) << array.error().Message();
  EXPECT_EQ(array->dtype, "<f8");
  const Vector3d head = dataset.clips[0].motion->joints.at(0, 15);
  const double* written_head = array->values.data() + 3 * 15;
  EXPECT_NEAR(written_head[0], head.x(), 1e-12);
  EXPECT_NEAR(written_head[1], -head.y(), 1e-12) << "y points down";
  EXPECT_NEAR(written_head[2], -head.z(), 1e-12) << "a person facing +z faces the camera";
}

TEST(ExportedActor, RefusesWhatItsListsCannotHold) {
  Dataset dataset = SwingingSet("smpl24");
  dataset.clips[0].label = "";
  const ScratchFolder folder;
  EXPECT_THAT(WriteExport("actor", dataset, folder.path()).refused, ElementsAre(dataset.clips[0].id()));
  const Dataset others = SwingingSet("openni15");
  const ScratchFolder none;
  EXPECT_THAT(WriteExport("actor", others, none.path()).refused, SizeIs(4));
}

TEST(ExportedActor, HoldsMoreClassesThanThePublishedFile) {
  Dataset dataset = SwingingSet("smpl24");
  dataset.labels.clear();
  for (int c = 0; c < 15; ++c) dataset.labels.push_back("class " + std::to_string(c));
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) dataset.clips[i].label = dataset.labels[14 - i];
  const ScratchFolder folder;
  const std::map<std::size_t, Clip> back = ReadBack(WriteExport("actor", dataset, folder.path()), folder.path());
  ASSERT_EQ(back.size(), dataset.clips.size());
  EXPECT_EQ(back.at(0).label, "class 14");
}

/// Joint tracks of a tree that is not built in.
TEST(ExportedJoints, OfAForeignTreeComeBackWithIt) {
  auto tree = std::make_shared<Skeleton>();
  tree->name = "insect";
  const char* const names[] = {"body", "head", "left feeler", "right feeler"};
  for (int j = 0; j < 4; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = j - 1 < 2 ? j - 1 : 1;
    joint.mirror = j == 2 ? 3 : j == 3 ? 2 : j;
    if (j > 0) joint.rest_offset = {j == 2 ? 0.2 : j == 3 ? -0.2 : 0.0, 0.4, 0.0};
    tree->joints.push_back(joint);
  }
  ASSERT_TRUE(tree->Check());
  Dataset dataset;
  dataset.skeleton = tree;
  dataset.joints_only = true;
  dataset.labels = {"fly"};
  for (const char* recording : {"a", "b"}) {
    Clip clip = Swinging(tree, StudioTake("fly1", recording, 0, 20), recording[0] == 'a' ? "fly" : "", 1.0);
    clip.motion = MakeJointsOnly(tree, clip.rate, clip.motion->joints);
    dataset.clips.push_back(std::move(clip));
  }
  for (const char* layout : {"humanact12", "csv"}) {
    SCOPED_TRACE(layout);
    const ScratchFolder folder;
    const Written written = WriteExport(layout, dataset, folder.path());
    const std::map<std::size_t, Clip> back = ReadBack(written, folder.path());
    ASSERT_EQ(back.size(), 2u);
    EXPECT_LT(FarthestJoint(*back.at(1).motion, *dataset.clips[1].motion), 1e-6);
    EXPECT_TRUE(SameTree(*back.at(0).motion->skeleton, *tree));
    EXPECT_EQ(back.at(0).label, "fly");
    EXPECT_EQ(back.at(1).label, "");
  }
}

/// Two clips of a tree whose names break lines of text files, open blocks of BVH, are formulas, or are not UTF-8.
TEST(ExportedJoints, WithNamesOfAStrangerStayOneFieldEach) {
  auto tree = std::make_shared<Skeleton>();
  tree->name = "odd\xFF";
  const char* const names[] = {"body", "a\nb {c}", "a_b _c_", "=1+1", "\xFF\x1b\xC2\x9B,\""};
  for (int j = 0; j < 5; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = j - 1;
    joint.mirror = j;
    if (j > 0) joint.rest_offset = {0.0, 0.4, 0.0};
    tree->joints.push_back(joint);
  }
  Dataset dataset;
  dataset.skeleton = tree;
  dataset.clips = {Swinging(tree, StudioTake("p", "r", 0, 20), "", 1.0)};
  for (const char* layout : {"csv", "bvh", "npz"}) {
    SCOPED_TRACE(layout);
    const ScratchFolder folder;
    const Written written = WriteExport(layout, dataset, folder.path());
    ASSERT_THAT(written.refused, IsEmpty());
    EXPECT_THAT(written.notes, Not(IsEmpty()));
    const std::string bytes = ReadFile(folder.path() / written.files.front()).value();
    if (layout == std::string("csv")) {
      const auto lines = SplitText(bytes, '\n');
      ASSERT_EQ(lines.size(), 22u);
      EXPECT_EQ(lines[0],
                "time_s,body_x,body_y,body_z,a_b_{c}_x,a_b_{c}_y,a_b_{c}_z,a_b__c__x,a_b__c__y,a_b__c__z,"
                "'=1+1_x,'=1+1_y,'=1+1_z,______x,______y,______z");
    } else if (layout == std::string("bvh")) {
      const auto bvh = ParseBvh(bytes, "a.bvh");
      ASSERT_TRUE(bvh) << bvh.error().Message();
      std::vector<std::string> read;
      for (const BvhJoint& joint : bvh->joints) read.push_back(joint.name);
      EXPECT_THAT(read, ElementsAre("body", "a_b__c_", "a_b__c__", "=1+1", "___,\""));
    }
  }
}

TEST(ExportedTexts, ThatAreNotUtf8AreWrittenByActor) {
  Dataset dataset = SwingingSet("smpl24");
  dataset.clips[2].identity.recording = "\xFFlong";
  const ScratchFolder folder;
  const Written written = WriteExport("actor", dataset, folder.path());
  EXPECT_THAT(written.refused, IsEmpty());
  EXPECT_TRUE(fs::exists(folder.path() / "actor.pkl"));
}

TEST(ExportNames, AreNamesForFilesAndNeverOneForTwo) {
  EXPECT_EQ(NameForFile("walk fast"), "walk fast");
  EXPECT_EQ(NameForFile("a/b:c{d}"), "a_b_c_d_");
  EXPECT_EQ(NameForFile(".hidden"), "_hidden");
  EXPECT_EQ(NameForFile(""), "_");
  EXPECT_EQ(NameForFile("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(NameForFile("\xFFx"), "_x");
  for (const char* name : {".", "/", "-", "=", "\n", "\x7F", "\xC2\x9B", "\xE2\x80\xAE", " "}) {
    EXPECT_EQ(NameForFile(name), "_") << name;
  }
  EXPECT_EQ(NameForFile(".."), "__");
  EXPECT_EQ(NameForFile("-rf"), "_rf");
  EXPECT_EQ(NameForFile(std::string("a\0b", 3)), "a_b");
  EXPECT_EQ(NameForFile("con"), "_con");
  EXPECT_EQ(NameForFile("Lpt1.txt"), "_Lpt1.txt");
  EXPECT_EQ(NameForFile("console"), "console");
  EXPECT_EQ(NameForFile(std::string(199, 'a') + "\xC3\xBC"), std::string(199, 'a')) << "200 bytes of whole characters";
  EXPECT_EQ(FileNames({"clips.csv"}).Of("Clips.csv"), "Clips.csv~2");
  FileNames names;
  EXPECT_EQ(names.Of("a/b"), "a_b");
  EXPECT_EQ(names.Of("a:b"), "a_b~2");
  EXPECT_EQ(names.Of("A_B"), "A_B~3") << "some file systems ignore case";
  EXPECT_EQ(names.Of("a/b"), "a_b");
  const std::vector<std::string> ids = {"s/p1/walk#0-9", "s/p2/walk#0-9", "s/p2/run#0-9"};
  EXPECT_EQ(ClipNames(ids, RecordingNames::kOfPerson).Recording(0), "walk");
  EXPECT_EQ(ClipNames(ids, RecordingNames::kOfSet).Recording(0), "p1_walk");
  EXPECT_EQ(ClipNames(ids, RecordingNames::kOfSet).Recording(2), "run");
}

#ifdef MOCURATE_ASSIMP

void CollectPlaces(const aiNode& node, const std::map<std::string, const aiNodeAnim*>& channels, unsigned frame,
                   const aiMatrix4x4& parent, std::map<std::string, Vector3d>& places) {
  aiMatrix4x4 local = node.mTransformation;
  if (const auto found = channels.find(node.mName.C_Str()); found != channels.end()) {
    const aiNodeAnim& channel = *found->second;
    const aiVectorKey& position = channel.mPositionKeys[channel.mNumPositionKeys > 1 ? frame : 0];
    local = aiMatrix4x4(aiVector3D(1, 1, 1), channel.mRotationKeys[frame].mValue, position.mValue);
  }
  const aiMatrix4x4 global = parent * local;
  places[node.mName.C_Str()] = {global.a4, global.b4, global.c4};
  for (unsigned i = 0; i < node.mNumChildren; ++i) CollectPlaces(*node.mChildren[i], channels, frame, global, places);
}

/// Places of all joints in some frames of a file, read by assimp, against a motion.
void ExpectJointsByAssimp(const std::string& bytes, const char* ending, double metres, double ticks_hz,
                          const Motion& motion) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, ending);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const aiAnimation& animation = *scene->mAnimations[0];
  EXPECT_NEAR(animation.mTicksPerSecond, ticks_hz, 1e-2);
  std::map<std::string, const aiNodeAnim*> channels;
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    channels[animation.mChannels[c]->mNodeName.C_Str()] = animation.mChannels[c];
  }
  for (const int frame : {0, 17, motion.frame_count() - 1}) {
    std::map<std::string, Vector3d> places;
    CollectPlaces(*scene->mRootNode, channels, static_cast<unsigned>(frame), aiMatrix4x4(), places);
    for (int j = 0; j < motion.joint_count(); ++j) {
      const std::string& name = motion.skeleton->joints[j].name;
      ASSERT_EQ(places.count(name), 1u) << name;
      EXPECT_LT((metres * places[name] - motion.joints.at(frame, j)).norm(), 1e-5) << name;
    }
  }
}

TEST(ExportedBvh, IsReadByAssimpInCentimetres) {
  const Dataset dataset = SwingingSet("smpl24");
  const ScratchFolder folder;
  const Written written = WriteExport("bvh", dataset, folder.path());
  ExpectJointsByAssimp(ReadFile(folder.path() / written.files[0]).value(), "bvh", 0.01, 29.97,
                       *dataset.clips[0].motion);
}

TEST(ExportedGlb, IsReadByAssimpWithBodyAndMotion) {
  const Dataset dataset = SwingingSet("smpl24");
  const ScratchFolder folder;
  const Written written = WriteExport("glb", dataset, folder.path());
  EXPECT_THAT(written.refused, IsEmpty());
  const std::string bytes = ReadFile(folder.path() / written.files[0]).value();
  ExpectJointsByAssimp(bytes, "glb", 1.0, 1000.0, *dataset.clips[0].motion);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "glb");
  ASSERT_NE(scene, nullptr);
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const aiMesh& mesh = *scene->mMeshes[0];
  EXPECT_GT(mesh.mNumFaces, 1000u);
  EXPECT_GT(mesh.mNumBones, 15u) << "joints that carry a part of the body";
  const aiNodeAnim& turn = *scene->mAnimations[0]->mChannels[3];
  const double last_ms = 1000.0 * dataset.clips[0].motion->rate.FrameTime(dataset.clips[0].motion->frame_count() - 1);
  EXPECT_NEAR(turn.mRotationKeys[turn.mNumRotationKeys - 1].mTime, last_ms, 0.1);
}

/// The parts of a .glb by its header, and the numbers that its JSON states of the buffer.
TEST(ExportedGlb, IsSoundBinaryGltf) {
  const Dataset dataset = SwingingSet("smpl24");
  const ScratchFolder folder;
  const Written written = WriteExport("glb", dataset, folder.path());
  const std::string bytes = ReadFile(folder.path() / written.files[0]).value();
  const auto word = [&bytes](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes[at], sizeof(value));
    return value;
  };
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), bytes.size());
  ASSERT_EQ(bytes.substr(16, 4), "JSON");
  const nlohmann::json json = nlohmann::json::parse(bytes.substr(20, word(12)));
  const std::size_t length = json.at("buffers")[0].at("byteLength");
  for (const nlohmann::json& accessor : json.at("accessors")) {
    const nlohmann::json& view = json.at("bufferViews")[accessor.at("bufferView").get<std::size_t>()];
    EXPECT_LE(view.value("byteOffset", std::size_t{0}) + view.at("byteLength").get<std::size_t>(), length);
    EXPECT_EQ(view.value("byteOffset", std::size_t{0}) % 4, 0u);
  }
  EXPECT_EQ(json.at("skins")[0].at("joints").size(), 24u);
  EXPECT_EQ(json.at("animations")[0].at("channels").size(), 25u) << "rotations, and the root's place";
  EXPECT_TRUE(
      json.at("accessors")[json.at("animations")[0].at("samplers")[0].at("input").get<std::size_t>()].contains("max"));
}

#else

TEST(ExportedBvh, IsReadByAssimpInCentimetres) { GTEST_SKIP() << "built without libassimp-dev"; }
TEST(ExportedGlb, IsReadByAssimpWithBodyAndMotion) { GTEST_SKIP() << "built without libassimp-dev"; }

#endif

}  // namespace
}  // namespace mocurate
