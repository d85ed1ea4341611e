// `mocurate eval`: published weights on published motions, files of other programs, and refused input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "core/store/feature_file.h"
#include "core/store/hdf5_file.h"
#include "core/store/store.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::WriteText;
namespace fs = std::filesystem;

#define REQUIRE_GOLDENS() \
  if (std::getenv("MOCURATE_GOLDENS") == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is unset"

fs::path Published(const std::string& name) { return fs::path(std::getenv("MOCURATE_GOLDENS")) / "published" / name; }

Result Eval(const ScratchFolder& folder, std::vector<std::string> arguments, bool weights = true) {
  arguments.insert(arguments.begin(), "eval");
  arguments.push_back("--json");
  if (std::find(arguments.begin(), arguments.end(), "-j") == arguments.end())
    arguments.insert(arguments.end(), {"-j", "1"});
  program::Surroundings surroundings;
  surroundings.before_start = [weights] {
    if (weights) setenv("MOCURATE_WEIGHTS", Published("").c_str(), 1);
    if (!weights) unsetenv("MOCURATE_WEIGHTS");
  };
  return program::RunProgram(folder, arguments, surroundings);
}

double ValueOf(const Result& result, std::size_t row, const std::string& metric) {
  return result.Json()["rows"][row]["metrics"][metric]["value"].get<double>();
}

bool Warns(const Result& result, const std::string& code) {
  const nlohmann::json json = result.Json();
  for (const auto& warning : json["warnings"]) {
    if (warning["code"] == code) return true;
  }
  return false;
}

std::vector<float> GoldenFloats(const std::string& path) {
  const auto reader = store::Hdf5Reader::Open(fs::path(std::getenv("MOCURATE_GOLDENS")) / "recogniser.h5");
  const auto array = reader->Read(path, store::FieldType::kFloat32);
  return array ? array->as<float>() : std::vector<float>();
}

double Worst(const std::vector<float>& a, const std::vector<float>& b) {
  double worst = a.size() == b.size() && !a.empty() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) worst = std::max<double>(worst, std::fabs(a[i] - b[i]));
  return worst;
}

struct PublishedCase {
  std::string protocol, joints, bones, golden;
  std::vector<std::string> set;
  double accuracy;
};

/// The figures of goldens/README.md, and logits and features of the released code.
TEST(Eval, PublishedWeightsScorePublishedMotionsAsTheReleasedCode) {
  REQUIRE_GOLDENS();
  const std::string humanact = "humanact12/vanila_vae_tf/motion_joints500000.npy",
                    ntu = "ntu_rgbd_vibe/vanila_vae_tf_2/motion_joints300000.npy",
                    ntu_lie = "ntu_rgbd_vibe/vanilla_vae_lie_mse_kld01/motion_joints50000.npy",
                    cmu = "mocap/vanila_vae_tf_2/motion_joints210000.npy",
                    cmu_lie = "mocap/vanilla_vae_lie_mse_kld01/motion_joints50000.npy";
  const std::vector<std::string> at_origin = {"--set", "extractor.generated_root=first_frame"};
  const PublishedCase cases[] = {
      {"a2m-humanact12", humanact, "", "humanact12/vanila_vae_tf/as_stored", {}, 0.75},
      {"a2m-humanact12", humanact, "", "humanact12/vanila_vae_tf/first_root_at_origin", at_origin, 0.75},
      {"a2m-ntu13", ntu, "", "ntu_rgbd_vibe/vanila_vae_tf_2/as_stored", {}, 0.75},
      {"a2m-ntu13", ntu_lie, ntu, "ntu_rgbd_vibe/vanilla_vae_lie_mse_kld01/fk", {}, 0.95},
      {"a2m-ntu13", ntu_lie, ntu, "ntu_rgbd_vibe/vanilla_vae_lie_mse_kld01/fk_first_root_at_origin", at_origin, 1.0},
      {"a2m-cmu8", cmu, "", "mocap/vanila_vae_tf_2/as_stored", {}, 0.25},
      {"a2m-cmu8", cmu_lie, cmu, "mocap/vanilla_vae_lie_mse_kld01/fk", {}, 0.65}};
  const ScratchFolder folder;
  for (const PublishedCase& one : cases) {
    std::vector<std::string> arguments = {
        "--protocol",  one.protocol,
        "--generated", "set=" + Published(one.joints).string(),
        "--labels",    (Published(one.joints).parent_path() / "motion_class.npy").string(),
        "-o",          (folder / "out").string()};
    if (!one.bones.empty()) arguments.insert(arguments.end(), {"--bone-lengths", Published(one.bones).string()});
    arguments.insert(arguments.end(), one.set.begin(), one.set.end());
    const Result result = Eval(folder, arguments);
    ASSERT_EQ(result.exit_code, 0) << one.golden << "\n" << result.err;
    EXPECT_DOUBLE_EQ(ValueOf(result, 0, "accuracy"), one.accuracy) << one.golden;
    const auto features = ReadFeatures(folder / "out/features/set.h5");
    ASSERT_TRUE(features) << features.error().Message();
    EXPECT_LE(Worst(features->logits, GoldenFloats("/" + one.golden + "/h0_zero/logits")), 5e-5) << one.golden;
    EXPECT_LE(Worst(features->features, GoldenFloats("/" + one.golden + "/h0_zero/features30")), 5e-5) << one.golden;
  }
}

TEST(Eval, HasPublishedNumbersAndNamesMissingInputs) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string();
  const Result result = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", joints});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = result.Json();
  EXPECT_EQ(json["protocol"], "a2m-humanact12");
  EXPECT_EQ(json["variant"], "given");
  EXPECT_EQ(json["extractor"], "a2m-humanact12");
  EXPECT_EQ(json["rows"][0]["motions"], 20);
  EXPECT_TRUE(json["rows"][0]["metrics"]["FID_train"]["value"].is_null());
  EXPECT_TRUE(json["rows"][0]["metrics"]["accuracy"]["value"].is_null());
  EXPECT_TRUE(Warns(result, "no_real_motions"));
  EXPECT_TRUE(Warns(result, "no_labels"));
  const auto& first = json["published"][0];
  EXPECT_EQ(first["method"], "Real motions");
  EXPECT_EQ(first["metric"], "FID_train");
  EXPECT_EQ(first["value"], 0.092);
  EXPECT_EQ(first["pm_kind"], "a2m_1.96_sd_over_sqrt_n");
}

/// `copies` of the motions, each a little larger and with its own ripple of 2 mm.
NpyArray Varied(const NpyArray& published, int copies) {
  NpyArray varied = published;
  varied.shape[0] = static_cast<std::size_t>(copies) * published.shape[0];
  varied.values.clear();
  for (int c = 0; c < copies; ++c) {
    for (std::size_t i = 0; i < published.values.size(); ++i) {
      varied.values.push_back(published.values[i] * (1.0 + 0.004 * c) +
                              0.002 * std::sin(0.37 * static_cast<double>(i) + c));
    }
  }
  varied.dtype = "<f4";
  return varied;
}

NpyArray PublishedMotions() {
  const std::string bytes = ReadText(Published("humanact12/vanila_vae_tf/motion_joints500000.npy"));
  return *ParseNpy(bytes, "joints");
}

TEST(Eval, RealComesFirstRowsFollowAndReleasedDrawsAsThePaperDoes) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  WriteText(folder / "real.npy", WriteNpy(Varied(PublishedMotions(), 3)));
  WriteText(folder / "a.npy", WriteNpy(Varied(PublishedMotions(), 2)));
  NpyArray frozen = Varied(PublishedMotions(), 2);  // the first frame of each motion
  for (std::size_t i = 0; i < frozen.values.size(); ++i) {
    frozen.values[i] = frozen.values[i / (60 * 72) * (60 * 72) + i % 72];
  }
  WriteText(folder / "b.npy", WriteNpy(frozen));
  const std::vector<std::string> arguments = {"--protocol",  "a2m-humanact12",
                                              "--generated", "a=" + (folder / "a.npy").string(),
                                              "--generated", "b=" + (folder / "b.npy").string(),
                                              "--real",      (folder / "real.npy").string(),
                                              "-o",          (folder / "out").string()};
  const Result given = Eval(folder, arguments);
  ASSERT_EQ(given.exit_code, 0) << given.err;
  const nlohmann::json rows = given.Json()["rows"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["name"], "Real");
  EXPECT_LT(ValueOf(given, 1, "FID_train"), ValueOf(given, 2, "FID_train"));
  EXPECT_LT(given.Json()["comparisons"][0]["metrics"]["FID_train"]["p"].get<double>(), 0.05);
  for (const char* file :
       {"metrics.json", "tables/table.md", "tables/table.tex", "tables/table.csv", "features/a.h5"}) {
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
  }
  WriteText(folder / "outside/victim", "old");
  fs::rename(folder / "out/tables", folder / "tables");
  fs::create_directory_symlink(folder / "outside", folder / "out/tables");
  EXPECT_EQ(Eval(folder, arguments).exit_code, 74) << "a link below the named folder";
  fs::remove(folder / "out/tables");
  fs::rename(folder / "tables", folder / "out/tables");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "outside"), {}), 1);
  std::vector<std::string> released = arguments;
  for (const char* option : {"variant=released", "released.repetitions=3", "released.motions=50"}) {
    released.insert(released.end(), {"--set", option});
  }
  const Result drawn = Eval(folder, released);
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  const nlohmann::json drawn_rows = drawn.Json()["rows"];
  for (const auto& row : drawn_rows) {
    EXPECT_EQ(row["metrics"]["FID_train"]["repetitions"].size(), 3u);
    EXPECT_EQ(row["metrics"]["FID_train"]["interval_kind"], "a2m_1.96_sd_over_sqrt_n");
  }
  EXPECT_THAT(drawn_rows[1]["assumed"].get<std::vector<std::string>>(),
              ::testing::Contains("same_motions_in_every_repetition"));
  EXPECT_EQ(drawn.out, Eval(folder, released).out) << "same inputs, same bytes";
  released.insert(released.end(), {"-j", "2"});
  const ScratchFolder other;  // another cache
  EXPECT_EQ(drawn_rows, Eval(other, released).Json()["rows"]) << "with any number of jobs";
}

TEST(Eval, LabelsComeFromFilesNamesOfFilesAndTables) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const NpyArray all = PublishedMotions();
  const std::size_t each = all.values.size() / all.shape[0];
  for (std::size_t i = 0; i < 4; ++i) {
    NpyArray one;
    one.shape = {60, 24, 3};
    one.dtype = "<f4";
    one.values.assign(all.values.begin() + static_cast<std::ptrdiff_t>(i * each),
                      all.values.begin() + static_cast<std::ptrdiff_t>((i + 1) * each));
    const char* names[] = {"warm_up0_3d", "run1_3d", "Turn steering wheel_02", "phone-3"};
    WriteText(folder / ("named/" + std::string(names[i]) + ".npy"), WriteNpy(one));
  }
  const auto labels = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"--protocol", "a2m-humanact12", "--generated", "n=" + (folder / "named").string(), "-o",
                               (folder / "out").string()});
    const Result result = Eval(folder, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const auto features = ReadFeatures(folder / "out/features/n.h5");
    return features ? features->label : std::vector<int>();
  };
  EXPECT_EQ(labels({}), (std::vector<int>{8, 9, 2, 0})) << "by clip id";
  WriteText(folder / "table.csv",
            "name,label\nphone-3,walk\nrun1_3d,11\nwarm_up0_3d,jump\nTurn steering wheel_02,sit\n");
  EXPECT_EQ(labels({"--labels", (folder / "table.csv").string()}), (std::vector<int>{6, 1, 11, 3}));
  WriteText(folder / "lines.txt", "throw\nthrow\neat\nthrow\n");
  EXPECT_EQ(labels({"--labels", (folder / "lines.txt").string()}), (std::vector<int>{11, 11, 7, 11}));
}

struct BadInput {
  std::string what;
  std::vector<std::string> arguments;
  int exit_code;
};

TEST(Eval, BadInputEndsWithItsCode) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string(),
                    classes = Published("humanact12/vanila_vae_tf/motion_class.npy").string(),
                    raw = Published("ntu_rgbd_vibe/vanilla_vae_lie_mse_kld01/motion_joints50000.npy").string();
  NpyArray flipped = PublishedMotions();
  for (std::size_t i = 1; i < flipped.values.size(); i += 3) flipped.values[i] = -flipped.values[i];
  WriteText(folder / "flipped.npy", WriteNpy(flipped));
  NpyArray centimetres = PublishedMotions();
  for (double& value : centimetres.values) value *= 100.0;
  WriteText(folder / "cm.npy", WriteNpy(centimetres));
  WriteText(folder / "few.txt", "walk\nrun\n");
  WriteText(
      folder / "unknown.txt", "sleep\n" + [] {
        std::string rest;
        for (int i = 0; i < 19; ++i) rest += "walk\n";
        return rest;
      }());
  WriteText(folder / "empty.npy", "");
  // An array of objects whose pickle asks for os.system.
  std::string evil("\x93NUMPY\x01\x00", 8);
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
  header += std::string(117 - header.size(), ' ') + "\n";
  evil += std::string("\x76\x00", 2) + header + "cos\nsystem\n(S'true'\ntR.";
  WriteText(folder / "evil.npy", evil);
  const std::string folder_of = folder.path().string() + "/";
  const BadInput cases[] = {
      {"head below the feet", {"--generated", folder_of + "flipped.npy"}, 3},
      {"another unit", {"--generated", folder_of + "cm.npy"}, 3},
      {"Lie parameters as joints", {"--generated", raw}, 3},
      {"too few labels", {"--generated", joints, "--labels", folder_of + "few.txt"}, 3},
      {"a label that the extractor lacks", {"--generated", joints, "--labels", folder_of + "unknown.txt"}, 3},
      {"an empty file", {"--generated", folder_of + "empty.npy"}, 3},
      {"a pickle that tries to execute", {"--generated", folder_of + "evil.npy"}, 3},
      {"no such file", {"--generated", folder_of + "nowhere.npy"}, 3},
      {"no such protocol", {"--generated", joints, "--protocol", "a2m-humanact"}, 2},
      {"no such option", {"--generated", joints, "--set", "varian=released"}, 2},
      {"lie without bone lengths", {"--generated", joints, "--values", "lie"}, 2},
      {"weights that are not here", {"--generated", joints, "--protocol", "actor-uestc40"}, 4}};
  for (const BadInput& bad : cases) {
    std::vector<std::string> arguments = bad.arguments;
    if (std::find(arguments.begin(), arguments.end(), "--protocol") == arguments.end()) {
      arguments.insert(arguments.end(), {"--protocol", "a2m-humanact12"});
    }
    const Result result = Eval(folder, arguments);
    EXPECT_EQ(result.exit_code, bad.exit_code) << bad.what << ": " << result.err;
    EXPECT_EQ(result.Json()["error"]["exit_code"], bad.exit_code) << bad.what;
  }
  const Result unset =
      Eval(folder, {"--protocol", "a2m-humanact12", "--generated", joints, "--labels", classes}, false);
  EXPECT_EQ(unset.exit_code, 4) << unset.err;
}

TEST(Eval, AMotionWithNanIsNamedAndTheOthersAreScored) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  NpyArray broken = PublishedMotions();
  broken.values[7 * 60 * 72 + 100] = std::nan("");
  WriteText(folder / "broken.npy", WriteNpy(broken));
  const Result result = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", (folder / "broken.npy").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.Json()["rows"][0]["motions"], 19);
  ASSERT_TRUE(Warns(result, "clip_refused"));
  EXPECT_THAT(result.out, ::testing::HasSubstr("0007"));
}

TEST(Eval, AFailedRowDoesNotAffectOthers) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string();
  const std::string other = Published("ntu_rgbd_vibe/vanila_vae_tf_2/motion_joints300000.npy").string();
  const Result result =
      Eval(folder, {"--protocol", "a2m-humanact12", "--generated", "good=" + joints, "--generated", "bad=" + other});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  ASSERT_EQ(result.Json()["rows"].size(), 1u);
  EXPECT_EQ(result.Json()["rows"][0]["name"], "good");
  EXPECT_TRUE(result.Json()["failed"].contains("bad"));
}

TEST(Eval, AMissingFileOnlyFailsItsRow) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string();
  const Result result = Eval(
      folder, {"--protocol", "a2m-humanact12", "--generated", "good=" + joints, "--generated", "typo=nowhere.npy"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(result.Json()["rows"][0]["name"], "good");
  EXPECT_TRUE(result.Json()["failed"].contains("typo"));
}

TEST(Eval, FilesAreLabelledByWholeWordsOfTheirNamesAndListedLabelsFollowTheirNumbers) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const NpyArray all = PublishedMotions();
  const auto write = [&](const std::string& name, std::size_t motion) {
    NpyArray one = all;
    one.shape = {60, 72};
    const auto begin = all.values.begin() + static_cast<std::ptrdiff_t>(motion * 60 * 72);
    one.values.assign(begin, begin + 60 * 72);
    WriteText(folder / name, WriteNpy(one));
  };
  write("named/walk_1.npy", 0);
  write("named/walker_1.npy", 1);
  write("named/run2.npy", 2);
  const Result named = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", "s=" + (folder / "named").string(),
                                     "-o", (folder / "out").string()});
  ASSERT_EQ(named.exit_code, 0) << named.err;
  const auto labels = ReadFeatures(folder / "out/features/s.h5");
  ASSERT_TRUE(labels) << labels.error().Message();
  EXPECT_THAT(labels->label, ::testing::UnorderedElementsAre(1, -1, 2));
  write("numbered/2.npy", 0);
  write("numbered/10.npy", 1);
  WriteText(folder / "labels.txt", "walk\nrun\n");
  const Result numbered =
      Eval(folder, {"--protocol", "a2m-humanact12", "--generated", "s=" + (folder / "numbered").string(), "--labels",
                    (folder / "labels.txt").string(), "-o", (folder / "out2").string()});
  ASSERT_EQ(numbered.exit_code, 0) << numbered.err;
  const auto ordered = ReadFeatures(folder / "out2/features/s.h5");
  ASSERT_TRUE(ordered) << ordered.error().Message();
  for (std::size_t i = 0; i < ordered->clip.size(); ++i) {
    EXPECT_EQ(ordered->label[i], ordered->clip[i].find("10") == std::string::npos ? 1 : 2) << ordered->clip[i];
  }
}

/// A rotation of every position of the published motions.
NpyArray Turned(double (*turn)(const double* position, int axis)) {
  NpyArray turned = PublishedMotions();
  const NpyArray whole = turned;
  for (std::size_t i = 0; i < turned.values.size(); ++i) {
    turned.values[i] = turn(whole.values.data() + i / 3 * 3, static_cast<int>(i % 3));
  }
  return turned;
}

TEST(Eval, MotionsInAnotherFrameAreRefusedOrGiveAWarning) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  WriteText(folder / "z_up.npy", WriteNpy(Turned([](const double* p, int axis) {
              return axis == 0 ? p[0] : axis == 1 ? p[2] : -p[1];
            })));
  WriteText(folder / "away.npy",
            WriteNpy(Turned([](const double* p, int axis) { return axis == 1 ? p[1] : -p[axis]; })));
  const std::vector<std::string> protocol = {"--protocol", "a2m-humanact12", "--generated"};
  const auto scored = [&](const std::string& name) {
    std::vector<std::string> arguments = protocol;
    arguments.push_back((folder / name).string());
    return Eval(folder, arguments);
  };
  EXPECT_EQ(scored("z_up.npy").exit_code, 3);
  const Result away = scored("away.npy");
  EXPECT_EQ(away.exit_code, 0) << away.err;
  EXPECT_TRUE(Warns(away, "facing_away"));
  EXPECT_TRUE(Warns(away, "fewer_than_protocol")) << "20 motions are no row of a table";
}

TEST(Eval, EverySetMayHaveLabelsOfItsOwnAndTheRealSetIsNoGeneratedOne) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string(),
                    labels = Published("humanact12/vanila_vae_tf/motion_class.npy").string();
  std::string walk;
  for (int i = 0; i < 20; ++i) walk += "walk\n";
  WriteText(folder / "walk.txt", walk);
  const Result two = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", "a=" + joints, "--generated",
                                   "b=" + joints, "--labels", labels, "--labels", (folder / "walk.txt").string()});
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_DOUBLE_EQ(ValueOf(two, 0, "accuracy"), 0.75);
  EXPECT_LT(ValueOf(two, 1, "accuracy"), 0.5);
  const Result three = Eval(
      folder, {"--protocol", "a2m-humanact12", "--generated", "a=" + joints, "--labels", labels, "--labels", labels});
  EXPECT_EQ(three.exit_code, 2);
  const Result same = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", joints, "--real", joints});
  EXPECT_TRUE(Warns(same, "motions_are_the_real_ones"));
}

TEST(Eval, RealMotionsWithoutASplitHaveNoTestPart) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const std::string joints = Published("humanact12/vanila_vae_tf/motion_joints500000.npy").string();
  const Result result = Eval(folder, {"--protocol", "a2m-humanact12", "--generated", "s=" + joints, "--real", joints,
                                      "--set", "test_reference=true"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Warns(result, "no_test_part"));
  EXPECT_TRUE(result.Json()["rows"][1]["metrics"]["FID_test"]["value"].is_null());
  EXPECT_EQ(result.Json()["rows"].size(), 2u);
}

TEST(Eval, DoseResponseScoresDamagedCopiesOfRealMotionsBesideTheUndamagedOnes) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  WriteText(folder / "real.npy", WriteNpy(Varied(PublishedMotions(), 2)));
  const std::vector<std::string> arguments = {"--protocol", "a2m-humanact12", "--dose-response",
                                              (folder / "real.npy").string()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return Eval(folder, more);
  };
  const std::string out = (folder / "out").string();
  const Result result = with({"--doses", "jitter_mm=5,50", "--doses", "frozen_share=0.5", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  ASSERT_EQ(result.Json()["rows"].size(), 5u) << "Real, undamaged, three doses";
  EXPECT_EQ(result.Json()["rows"][1]["name"], "undamaged");
  EXPECT_EQ(ValueOf(result, 1, "jerk"), ValueOf(result, 0, "jerk"));
  EXPECT_NEAR(ValueOf(result, 1, "FID_train"), 0.0, 1e-6);
  EXPECT_NEAR(ValueOf(result, 1, "nearest_train"), 0.0, 1e-6);
  EXPECT_GT(ValueOf(result, 3, "FID_train"), ValueOf(result, 2, "FID_train"));
  EXPECT_NEAR(ValueOf(result, 4, "frozen_share"), 0.5, 1e-9);
  EXPECT_EQ(result.Json()["dose_response"]["answers_from"]["frozen_share"]["frozen_share"][0], 0.5);
  for (const char* file : {"tables/dose_response.md", "tables/dose_response.csv", "tables/dose_response.json",
                           "dose_response.svg", "doses/jitter_mm=50.h5"}) {
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
  }
  const std::string csv = ReadText(folder / "out/tables/dose_response.csv");
  const ScratchFolder other;  // another cache
  EXPECT_EQ(Eval(other, {"--protocol", "a2m-humanact12", "--dose-response", (folder / "real.npy").string(), "--doses",
                         "jitter_mm=5,50", "--doses", "frozen_share=0.5", "-o", (other / "out").string(), "-j", "1"})
                .exit_code,
            0);
  EXPECT_EQ(ReadText(other / "out/tables/dose_response.csv"), csv);
  EXPECT_EQ(with({"--doses", "jiter_mm=5"}).exit_code, 2);
  EXPECT_EQ(with({"--doses", "frozen_share=1.5"}).exit_code, 2);
  EXPECT_EQ(with({"--generated", (folder / "real.npy").string()}).exit_code, 2);
  EXPECT_EQ(with({"--doses", "swapped_label_share=0.1"}).exit_code, 3) << "the motions have no labels";
  EXPECT_EQ(Eval(folder, arguments, false).exit_code, 4) << "no weights";
  EXPECT_EQ(Eval(folder, {"--protocol", "a2m-humanact12"}).exit_code, 2) << "nothing to score";
}

/// The fields of the warning with that code about the row; null without one.
nlohmann::json WarningOf(const Result& result, const std::string& code, const std::string& row) {
  const nlohmann::json json = result.Json();
  for (const auto& warning : json["warnings"]) {
    if (warning["code"] == code && warning["row"] == row) return warning;
  }
  return nullptr;
}

/// From frame 40 on every second motion is zero.
NpyArray ZeroPadded(NpyArray motions) {
  const std::size_t each = motions.values.size() / motions.shape[0];
  for (std::size_t m = 0; m < motions.shape[0]; m += 2) {
    const auto begin = motions.values.begin() + static_cast<std::ptrdiff_t>(m * each);
    std::fill(begin + static_cast<std::ptrdiff_t>(each * 2 / 3), begin + static_cast<std::ptrdiff_t>(each), 0.0);
  }
  return motions;
}

TEST(Eval, PaddingIsCutOrScoredAsGiven) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  WriteText(folder / "whole.npy", WriteNpy(PublishedMotions()));
  WriteText(folder / "padded.npy", WriteNpy(ZeroPadded(PublishedMotions())));
  std::string lengths;
  for (int m = 0; m < 20; ++m) lengths += m % 2 == 0 ? "40\n" : "60\n";
  WriteText(folder / "lengths.txt", lengths);
  const std::vector<std::string> both = {"--protocol", "a2m-humanact12", "--generated", "g=" + path("padded.npy")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), both.begin(), both.end());
    return Eval(folder, more);
  };
  const double jerk =
      ValueOf(Eval(folder, {"--protocol", "a2m-humanact12", "--generated", path("whole.npy")}), 0, "jerk");
  const Result cut = with({"--real", path("padded.npy")});
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  for (const char* row : {"g", "Real"}) {
    const nlohmann::json warning = WarningOf(cut, "padding_cut", row);
    ASSERT_TRUE(warning.is_object()) << row;
    EXPECT_EQ(warning["count"], 10);
    EXPECT_EQ(warning["frames"], 200);
  }
  EXPECT_LT(ValueOf(cut, 1, "jerk"), 1.5 * jerk);
  const Result stated = with({"--lengths", path("lengths.txt")});
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_DOUBLE_EQ(ValueOf(stated, 0, "jerk"), ValueOf(cut, 1, "jerk"));
  const Result kept = with({"--padding", "keep"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_EQ(WarningOf(kept, "padding_kept", "g")["count"], 10);
  EXPECT_FALSE(Warns(kept, "padding_cut"));
  EXPECT_GT(ValueOf(kept, 0, "jerk"), 2.0 * jerk);
  WriteText(folder / "lengths.txt", "40\n60\n");
  EXPECT_EQ(with({"--lengths", path("lengths.txt")}).exit_code, 3) << "two lengths for 20 motions";
  EXPECT_EQ(with({"--lengths", path("lengths.txt"), "--padding", "keep"}).exit_code, 2);
  EXPECT_EQ(with({"--lengths", path("nowhere.txt")}).exit_code, 3);
}

TEST(Eval, OfADatasetOnlyZerosAreCut) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  NpyArray repeated = PublishedMotions();
  Dataset set;
  set.joints_only = true;
  set.created_by = "a test";
  set.skeleton = LoadSkeleton("humanact12").value();
  for (int m = 0; m < 3; ++m) {  // zeros at the end, repeats at the end, nothing but zeros
    JointPositions joints(60, 24);
    for (int f = 0; f < 60; ++f) {
      const int shown = m == 1 ? std::min(f, 39) : f;
      const bool zero = m == 2 || (m == 0 && f >= 40);
      for (int k = 0; k < 72 && !zero; ++k) {
        const double value = repeated.values[static_cast<std::size_t>((m * 60 + shown) * 72 + k)];
        joints.xyz[static_cast<std::size_t>(f * 72 + k)] = k % 3 == 0 ? value : -value;  // the arrays are y down
      }
    }
    Clip clip;
    clip.identity = {"made", "p", "take" + std::to_string(m), "", "", "", 0, 60};
    clip.rate = FrameRate{20, 1};
    clip.motion = MakeJointsOnly(set.skeleton, clip.rate, std::move(joints));
    set.clips.push_back(std::move(clip));
  }
  ASSERT_TRUE(WriteDataset(set, folder / "set.h5"));
  const std::vector<std::string> arguments = {"--protocol", "a2m-humanact12", "--generated",
                                              "g=" + (folder / "set.h5").string()};
  const Result cut = Eval(folder, arguments);
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  EXPECT_EQ(WarningOf(cut, "padding_cut", "g")["count"], 1);
  EXPECT_EQ(WarningOf(cut, "padding_cut", "g")["frames"], 20);
  EXPECT_TRUE(Warns(cut, "clip_refused"));
  EXPECT_EQ(cut.Json()["rows"][0]["motions"], 2);
  std::vector<std::string> keep = arguments;
  keep.insert(keep.end(), {"--padding", "keep"});
  const Result kept = Eval(folder, keep);
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_EQ(WarningOf(kept, "padding_kept", "g")["count"], 2);
  EXPECT_EQ(kept.Json()["rows"][0]["motions"], 3);
}

TEST(Doctor, ListsTheWeightsOfAProtocolAndMissingOnes) {
  REQUIRE_GOLDENS();
  const ScratchFolder folder;
  program::Surroundings surroundings;
  surroundings.before_start = [] { setenv("MOCURATE_WEIGHTS", Published("").c_str(), 1); };
  const Result found = program::RunProgram(folder, {"doctor", "--protocol", "a2m-ntu13", "--json"}, surroundings);
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(found.Json()["weights"], "action_recognition_model_vibe_v2.tar");
  EXPECT_TRUE(found.Json()["found"].is_string());
  const Result missing =
      program::RunProgram(folder, {"doctor", "--protocol", "multiact-babel53", "--json"}, surroundings);
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_TRUE(missing.Json()["found"].is_null());
}

}  // namespace
}  // namespace mocurate
