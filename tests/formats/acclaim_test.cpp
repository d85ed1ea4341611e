#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "core/base/text.h"
#include "core/formats/amc.h"
#include "core/formats/asf.h"
#include "core/formats/bvh.h"
#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"
#include "tests/support/acclaim_writers.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

const char* const kArm =
    "# a remark\n:version 1.10\n:name arm\n:units\n  mass 1\n  length 0.45\n  angle deg\n:documentation\n  two bones\n"
    ":root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n:bonedata\n"
    "  begin\n    id 1\n    name upper\n    direction 1 0 0\n    length 2\n    axis 0 0 90 XYZ\n    dof rx rz\n"
    "    limits (-10 20)\n           (-inf inf)\n  end\n"
    "  begin\n    id 2\n    name fixed\n    direction 0 1 0\n    length 1\n    axis 0 0 0 XYZ\n  end\n"
    "  begin\n    id 3\n    name lower\n    direction 0 0 2\n    length 3\n    axis 0 0 0 XYZ\n    dof ry\n  end\n"
    ":hierarchy\n  begin\n    root upper\n    upper fixed\n    fixed lower\n  end\n";
const char* const kWave =
    ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 0 0 0\nupper 0 90\nlower 90\n2\nroot 4 5 6 0 90 0\n"
    "upper 0 0\nlower 0\n";

Asf Arm() { return ParseAsf(kArm, "arm.asf").value(); }

Expected<Amc> Wave(const std::string& text, const Asf& asf, DamagedRows damaged = DamagedRows::kRefuse) {
  return ParseAmc(text, {&asf, damaged}, "wave.amc");
}

/// The arm skeleton with one piece of its text replaced.
Expected<Asf> AlteredArm(const std::string& from, const std::string& to) {
  return ParseAsf(Replaced(kArm, from, to), "arm.asf");
}

TEST(Asf, ReadsBonesFromTheHierarchyWithDofAndLimitsInDeclaredUnits) {
  const Asf asf = Arm();
  ASSERT_EQ(asf.bones.size(), 3u);
  EXPECT_EQ(asf.bones[0].parent, -1);
  EXPECT_EQ(asf.bones[2].parent, 1);
  EXPECT_THAT(asf.bones[0].dof, ElementsAre(AcclaimChannel::kRx, AcclaimChannel::kRz));
  EXPECT_EQ(asf.bones[0].limits[0].most, 20.0);
  EXPECT_TRUE(std::isinf(asf.bones[0].limits[1].least));
  EXPECT_EQ(asf.length_unit, 0.45);
  EXPECT_TRUE(asf.degrees);
  EXPECT_TRUE(AsfOffset(asf.bones[2]).isApprox(Vector3d(0, 0, 3))) << "offset: direction times length";
}

TEST(Asf, ReadsTheSameTreeWhenChildrenAreListedBeforeParents) {
  const Asf asf = AlteredArm("    root upper\n    upper fixed\n    fixed lower\n",
                             "    fixed lower\n    upper fixed\n    root upper\n")
                      .value();
  EXPECT_THAT(asf.Order(), ElementsAre(0, 1, 2));
  EXPECT_EQ(asf.bones[2].parent, 1);
}

TEST(Acclaim, RotatesABoneAboutItsOwnAxes) {
  const Asf asf = Arm();
  const Amc amc = Wave(kWave, asf).value();
  std::vector<Vector3d> ends;
  Vector3d root;
  AcclaimForward(asf, amc, 0, ends, &root);
  EXPECT_TRUE(root.isApprox(Vector3d(1, 2, 3)));
  // upper: C and L rotate about z, x becomes y. fixed: y becomes -x. lower: 90 degrees about y, z becomes x, then y.
  EXPECT_TRUE(ends[0].isApprox(Vector3d(1, 4, 3), 1e-12)) << ends[0].transpose();
  EXPECT_TRUE(ends[1].isApprox(Vector3d(0, 4, 3), 1e-12)) << ends[1].transpose();
  EXPECT_TRUE(ends[2].isApprox(Vector3d(0, 7, 3), 1e-12)) << ends[2].transpose();
  AcclaimForward(asf, amc, 1, ends);
  EXPECT_TRUE(ends[0].isApprox(Vector3d(4, 5, 4), 1e-12)) << "the root rotates by 90 degrees about y";
}

TEST(Acclaim, AppliesAnglesInFileOrderAboutFixedAxes) {
  const double degree = M_PI / 180;
  const Matrix3d x = Eigen::AngleAxisd(10 * degree, Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d y = Eigen::AngleAxisd(20 * degree, Vector3d::UnitY()).toRotationMatrix();
  const Matrix3d z = Eigen::AngleAxisd(30 * degree, Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(AcclaimMatrix({Vector3d(10, 20, 30), "XYZ"}, degree).isApprox(z * y * x, 1e-14));
  EXPECT_TRUE(AcclaimMatrix({Vector3d(30, 20, 10), "ZYX"}, degree).isApprox(x * y * z, 1e-14));
}

TEST(Acclaim, AppliesTheAngleUnitOfTheMotionToTheMotionOnly) {
  const Asf asf = Arm();
  const std::string radians =
      Replaced(Replaced(kWave, ":DEGREES", ":RADIANS"), "upper 0 90", "upper 0 1.5707963267948966");
  std::vector<Vector3d> ends;
  AcclaimForward(asf, Wave(radians, asf).value(), 0, ends);
  EXPECT_TRUE(ends[0].isApprox(Vector3d(1, 4, 3), 1e-12)) << ends[0].transpose();
}

TEST(Acclaim, RoundTripsThroughTheWriter) {
  const Asf asf = Arm();
  const std::string written = WriteAsf(asf);
  const auto again = ParseAsf(written, "again.asf");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(WriteAsf(*again), written);
  EXPECT_EQ(again->bones[0].axis, asf.bones[0].axis);
  EXPECT_EQ(again->bones[2].direction, asf.bones[2].direction);
  const Amc amc = Wave(kWave, asf).value();
  const auto motion = Wave(WriteAmc(amc), asf);
  ASSERT_TRUE(motion) << motion.error().Message();
  EXPECT_EQ(motion->values, amc.values);
  EXPECT_EQ(motion->frame_numbers, amc.frame_numbers);
  EXPECT_EQ(WriteAmc(*motion), WriteAmc(amc));
}

TEST(Acclaim, ReportsTheLineOfEveryDamagedField) {
  ExpectEveryDamagedWordIsNamed(
      kArm, [](const std::string& text) { return StatusOf(ParseAsf(text, "file")); },
      [](std::string_view line, std::string_view word) {
        const bool infinite = word.find("inf") != std::string_view::npos;  // "nan" is tested on the other limit
        const bool remark = line.front() == '#' || line == "  two bones";
        const bool ends_remarks = word == ":root";  // when damaged it reads as a line of the documentation
        return remark || ends_remarks || word == "arm" || infinite ||
               (line.find("name ") != std::string_view::npos && word != "name");
      });
  const Asf asf = Arm();
  ExpectEveryDamagedWordIsNamed(
      kWave,
      [&](const std::string& text) {
        return StatusOf(ParseAmc(text, {&asf, DamagedRows::kRefuse}, "file"));
      },
      nullptr);
}

TEST(Asf, RejectsContradictionsWithTheirLine) {
  ExpectMalformed(ParseAsf("", "arm.asf"), "arm.asf");
  ExpectMalformed(AlteredArm("(-inf inf)\n", "(-inf inf)\n (1 2)\n"), "arm.asf:26");
  ExpectMalformed(AlteredArm("length 3", "length 1e300"), "arm.asf:37");
  ExpectMalformed(AlteredArm("    fixed lower\n", ""), "arm.asf:45");
  ExpectMalformed(AlteredArm("    root upper\n", "    lower upper\n"), "arm.asf:46");
  ExpectMalformed(AlteredArm("direction 1 0 0", "direction 0 0 0"), "arm.asf:25");
  ExpectMalformed(AlteredArm("dof rx rz", "dof rx rx"), "arm.asf:22");
  ExpectMalformed(AlteredArm(":root", "root"), "arm.asf:46");
  ExpectMalformed(AlteredArm(":bonedata", ":bonedat"), "arm.asf:15");
  ExpectMalformed(AlteredArm("name fixed", "name upper"), "arm.asf:32");
  ExpectMalformed(AlteredArm("order TX TY TZ RX RY RZ", "order TX TY TZ RX RZ"), "arm.asf:11");
  ExpectMalformed(AlteredArm("  order TX TY TZ RX RY RZ\n", ""), "arm.asf");
  const std::string text = kArm;
  for (std::size_t length = 0; length < text.size() - 2; ++length) {
    EXPECT_FALSE(ParseAsf(text.substr(0, length), "arm.asf")) << length;
  }
}

TEST(Asf, ReportsARootWithoutAxisAndRejectsItWhenTheRootIsRotated) {
  const std::string axis = "  axis XYZ\n  position", rotated = "orientation 0 90 0";
  EXPECT_TRUE(Arm().findings.empty());
  const auto still = AlteredArm(axis, "  position");
  ASSERT_TRUE(still) << still.error().Message();
  ASSERT_EQ(still->findings.size(), 1u);
  EXPECT_EQ(still->findings[0].code, "root_axis_missing");
  EXPECT_EQ(still->findings[0].severity, Severity::kWarning);
  const auto root = ParseAsf(Replaced(Replaced(kArm, axis, "  position"), "orientation 0 0 0", rotated), "arm.asf");
  ASSERT_TRUE(root) << root.error().Message();
  EXPECT_EQ(root->findings.at(0).severity, Severity::kError);
}

TEST(Amc, ReportsABoneThatIsMissingInOneFrame) {
  const Asf asf = Arm();
  const auto amc = Wave(Replaced(kWave, "upper 0 90\n", ""), asf);
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_FALSE(amc->has(0, amc->Find("upper")));
  EXPECT_TRUE(amc->has(1, amc->Find("upper")));
  ASSERT_EQ(amc->findings.size(), 1u);
  EXPECT_EQ(amc->findings[0].code, "bone_missing");
  EXPECT_EQ(amc->findings[0].joint, "upper");
  EXPECT_EQ(amc->findings[0].value, 1.0);
}

TEST(Amc, KeepsLaterValuesInPlaceAfterARowOfWrongLength) {
  const Asf asf = Arm();
  const std::string damaged = Replaced(kWave, "upper 0 90\n", "upper 0\n");
  ExpectMalformed(Wave(damaged, asf), "wave.amc:5");
  const auto amc = Wave(damaged, asf, DamagedRows::kReport);
  ASSERT_TRUE(amc);
  EXPECT_FALSE(amc->has(0, amc->Find("upper")));
  EXPECT_EQ(amc->value(0, amc->bones[2].first_channel), 90.0);
  EXPECT_EQ(amc->value(1, 0), 4.0);
  EXPECT_EQ(amc->findings[0].code, "row_length");
  EXPECT_EQ(amc->findings[0].joint, "upper");
  EXPECT_EQ(amc->findings[0].frame_begin, 0);
  EXPECT_EQ(amc->findings[0].value, 1.0);
}

TEST(Amc, RejectsATruncatedFile) {
  const Asf asf = Arm();
  ExpectMalformed(Wave(Replaced(kWave, "upper 0 0\nlower 0\n", ""), asf), "wave.amc:9");
  ExpectMalformed(Wave(Replaced(kWave, "root 4 5 6 0 90 0\nupper 0 0\nlower 0\n", ""), asf), "wave.amc:8");
  ExpectMalformed(Wave("", asf), "wave.amc");
}

/// Five frames of the arm.
std::string FiveFrames() {
  std::string text = ":FULLY-SPECIFIED\n:DEGREES\n";
  for (int frame = 1; frame <= 5; ++frame)
    text += std::to_string(frame) + "\nroot 1 2 3 0 0 0\nupper 0 90\nlower " + std::to_string(10 * frame) + "\n";
  return text;
}

TEST(Amc, KeepsCompleteFramesOfATruncatedFileAndReportsItOnce) {
  const Asf asf = Arm();
  const std::string text = FiveFrames();
  const std::size_t fifth = text.find("\n5\n") + 1;
  // Up to the name of the last row: a cut within the last number cannot be detected.
  for (std::size_t end = fifth + 2; end < text.size() - 4; ++end) {
    const auto amc = Wave(text.substr(0, end), asf, DamagedRows::kReport);
    ASSERT_TRUE(amc) << end << amc.error().Message();
    EXPECT_EQ(amc->frames, 4) << text.substr(fifth, end - fifth);
    EXPECT_EQ(amc->values.size(), 4u * 9u);
    EXPECT_TRUE(amc->damaged.empty());
    ASSERT_EQ(amc->findings.size(), 1u) << amc->findings[0].message;
    EXPECT_EQ(amc->findings[0].code, "cut_off");
    EXPECT_EQ(amc->findings[0].severity, Severity::kError);
    EXPECT_EQ(amc->findings[0].frame_begin, 4);
    EXPECT_FALSE(Wave(text.substr(0, end), asf)) << end;
  }
}

TEST(Amc, MarksAFrameDamagedWhenABoneOfMostFramesIsMissing) {
  const Asf asf = Arm();
  const std::string text = FiveFrames();
  const std::pair<const char*, const char*> damages[] = {{"", "bone_missing"},
                                                         {"upperr 0 90\n", "bone_unknown"},
                                                         {"upper 0 90 1\n", "row_length"},
                                                         {"upper 0 90\nupper 0 90\n", "bone_twice"}};
  for (const auto& [row, code] : damages) {
    std::string damaged = text;
    const std::size_t at = damaged.find("upper", damaged.find("\n3\n"));
    damaged.replace(at, std::string("upper 0 90\n").size(), row);
    const auto amc = Wave(damaged, asf, DamagedRows::kReport);
    ASSERT_TRUE(amc) << code << amc.error().Message();
    EXPECT_EQ(amc->frames, 5);
    EXPECT_THAT(amc->damaged, ElementsAre(2)) << code;
    ASSERT_EQ(amc->findings.size(), 1u) << code;
    EXPECT_EQ(amc->findings[0].code, code);
    EXPECT_EQ(amc->findings[0].frame_begin, 2);
    EXPECT_EQ(amc->findings[0].action, FindingAction::kDropped);
    EXPECT_FALSE(Wave(damaged, asf)) << code << " is rejected without DamagedRows::kReport";
  }
}

TEST(Amc, ReportsConsecutiveFramesWithoutTheSameBoneOnce) {
  const Asf asf = Arm();
  std::string text = FiveFrames();
  for (const char* frame : {"\n2\n", "\n3\n"}) {
    const std::size_t at = text.find("upper", text.find(frame));
    text.erase(at, std::string("upper 0 90\n").size());
  }
  const auto amc = Wave(text, asf, DamagedRows::kReport);
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_THAT(amc->damaged, ElementsAre(1, 2));
  ASSERT_EQ(amc->findings.size(), 1u);
  EXPECT_EQ(amc->findings[0].code, "bone_missing");
  EXPECT_EQ(amc->findings[0].joint, "upper");
  EXPECT_EQ(amc->findings[0].frame_begin, 1);
  EXPECT_EQ(amc->findings[0].frame_end, 3);
  EXPECT_EQ(amc->findings[0].value, 2.0);
}

TEST(Amc, RejectsDecimalCommas) {
  const Asf asf = Arm();
  ExpectMalformed(Wave(Replaced(kWave, "root 1 2 3", "root 1,5 2,5 3"), asf, DamagedRows::kReport), "wave.amc:4");
}

TEST(Amc, KeepsAndReportsFrameNumbersThatJump) {
  const Asf asf = Arm();
  const auto amc = Wave(Replaced(kWave, "\n2\nroot", "\n7\nroot"), asf);
  ASSERT_TRUE(amc);
  EXPECT_THAT(amc->frame_numbers, ElementsAre(1, 7));
  ASSERT_EQ(amc->findings.size(), 1u);
  EXPECT_EQ(amc->findings[0].code, "frame_number");
}

TEST(Amc, LeavesDamagedFramesForNumbersThatAreSkipped) {
  const Asf asf = Arm();
  const Amc two = Wave(kWave, asf).value();
  Amc four = two;
  four.frames = 4;
  four.frame_numbers = {1, 2, 5, 6};
  four.values.insert(four.values.end(), two.values.begin(), two.values.end());
  four.present.insert(four.present.end(), two.present.begin(), two.present.end());
  const auto amc = Wave(WriteAmc(four), asf);
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_EQ(amc->frames, 6);
  EXPECT_THAT(amc->frame_numbers, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(amc->damaged, ElementsAre(2, 3));
  EXPECT_EQ(amc->value(4, 0), two.value(0, 0));
  EXPECT_FALSE(amc->has(2, 0));
  ASSERT_EQ(amc->findings.size(), 1u);
  EXPECT_EQ(amc->findings[0].code, "time_gap");
  EXPECT_EQ(amc->findings[0].frame_begin, 2);
  EXPECT_EQ(amc->findings[0].frame_end, 4);
  four.frame_numbers = {1, 2, 3, 40000};
  ExpectError(Wave(WriteAmc(four), asf), ErrorCode::kInconsistent, "wave.amc");
  four.frame_numbers = {1, 5, 9, 13};
  EXPECT_EQ(Wave(WriteAmc(four), asf)->frames, 4) << "a count in steps of four";
}

TEST(Amc, TakesTheBonesFromTheFirstFrameWithoutASkeleton) {
  const auto amc = ParseAmc(kWave, {}, "wave.amc");
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_EQ(amc->channel_count, 9);
  EXPECT_EQ(WriteAmc(*amc), kWave);
}

TEST(Amc, RejectsSparseFramesWithoutAllocatingThem) {
  std::string text = "1\n";
  for (int i = 0; i < 20000; ++i) text += "b" + std::to_string(i) + " 1\n";
  for (int frame = 2; frame < 20000; ++frame) text += std::to_string(frame) + "\nb0 1\n";
  ExpectMalformed(ParseAmc(text, {}, "sparse.amc"), "sparse.amc:20040");
}

TEST(Amc, RejectsBonesWithoutNumbersThatTakeMoreMemoryThanTheFileMay) {
  Asf asf = Arm();
  std::string text = ":DEGREES\n";
  for (int frame = 1; frame <= 2000; ++frame) {
    text += std::to_string(frame) + "\nroot 1 2 3 0 0 0\nupper 0 90\nlower 90\n";
  }
  EXPECT_TRUE(Wave(text, asf));
  const AsfBone fixed = asf.bones[1];
  for (int bone = 0; bone < 2000; ++bone) {
    asf.bones.push_back(fixed);
    asf.bones.back().name += std::to_string(bone);
  }
  ExpectMalformed(Wave(text, asf), "wave.amc");
}

// Recorded files.

TEST(AcclaimFiles, RoundTripEverySkeletonAndMotion) {
  const auto cmu = RecordedData("cmu"), hdm05 = RecordedData("hdm05");
  if (cmu.empty() || hdm05.empty()) GTEST_SKIP() << "CMU or HDM05 data not found";
  int clips = 0, frames = 0;
  for (const auto& path : FilesEndingIn(hdm05, ".amc")) {
    const Asf asf = ParseAsf(Bytes(hdm05 / (path.filename().string().substr(0, 6) + ".asf")), "asf").value();
    const auto amc = ParseAmc(Bytes(path), {&asf, DamagedRows::kRefuse}, path.filename().string());
    ASSERT_TRUE(amc) << amc.error().Message();
    EXPECT_TRUE(amc->findings.empty()) << amc->findings[0].message;
    ++clips, frames += amc->frames;
    EXPECT_EQ(ParseAmc(WriteAmc(*amc), {&asf, DamagedRows::kRefuse}, "again").value().values, amc->values);
  }
  EXPECT_EQ(clips, 33);
  EXPECT_EQ(frames, 8245);
  for (const auto& [skeleton, motion, count] : {std::tuple{"asf_amc/01.asf", "asf_amc/01_01.amc", 2751},
                                                {"asf_amc/12.asf", "asf_amc/02_01.amc", 343},
                                                {"asf_amc/12.asf", "asf_amc/07_01.amc", 316},
                                                {"asf_amc/12.asf", "asf_amc/09_01.amc", 148},
                                                {"acclaim_old/walk.asf", "acclaim_old/walk.amc", 58},
                                                {"acclaim_old/skel.asf", "acclaim_old/skel.amc", 12}}) {
    const auto asf = ParseAsf(Bytes(cmu / skeleton), skeleton);
    ASSERT_TRUE(asf) << asf.error().Message();
    EXPECT_EQ(WriteAsf(ParseAsf(WriteAsf(*asf), skeleton).value()), WriteAsf(*asf));
    const auto amc = ParseAmc(Bytes(cmu / motion), {&*asf, DamagedRows::kRefuse}, motion);
    ASSERT_TRUE(amc) << amc.error().Message();
    EXPECT_EQ(amc->frames, count) << motion;
  }
}

TEST(AcclaimFiles, KeepTheRootOrderAndFrameNumbersOfOldDialects) {
  const auto folder = RecordedData("cmu/acclaim_old");
  if (folder.empty()) GTEST_SKIP() << "CMU data not found";
  const Asf walk = ParseAsf(Bytes(folder / "walk.asf"), "walk.asf").value();
  EXPECT_EQ(walk.root_order[3], AcclaimChannel::kRz);
  EXPECT_TRUE(walk.bones[static_cast<std::size_t>(walk.Find("hips1"))].dof.empty());
  const Asf skel = ParseAsf(Bytes(folder / "skel.asf"), "skel.asf").value();
  ASSERT_EQ(skel.findings.size(), 1u);
  EXPECT_EQ(skel.findings[0].code, "bone_id_twice");
  const Amc motion = ParseAmc(Bytes(folder / "skel.amc"), {&skel, DamagedRows::kRefuse}, "skel.amc").value();
  EXPECT_THAT(motion.frame_numbers, ElementsAre(1, 2, 3, 4, 5, 6, 4, 5, 6, 6, 4, 5));
  // In walk.asf the feet are below the head for every order of the root angles.
  const Amc steps = ParseAmc(Bytes(folder / "walk.amc"), {&walk, DamagedRows::kRefuse}, "walk.amc").value();
  std::vector<Vector3d> ends;
  for (int f = 0; f < steps.frames; ++f) {
    AcclaimForward(walk, steps, f, ends);
    EXPECT_LT(ends[static_cast<std::size_t>(walk.Find("leftlowleg"))].y() + 40,
              ends[static_cast<std::size_t>(walk.Find("neck"))].y())
        << f;
  }
}

TEST(AcclaimFiles, MatchTheJointsOfAnotherParserOnHdm05) {
  const auto folder = RecordedData("hdm05");
  if (folder.empty()) GTEST_SKIP() << "HDM05 data not found";
  const std::string script = "/usr/bin/python3 -c \"import scipy.io as s;m=s.loadmat('" +
                             (folder / "mat/HDM_bd_depositFloorR_001_120.amc.mat").string() +
                             "',squeeze_me=True)['mot'];j=m['jointTrajectories'].item();n=m['boneNames'].item();"
                             "[print(n[b],f,*map(repr,map(float,j[b][:,f]))) for b in range(len(n)) for f in "
                             "range(j[b].shape[1])]\" 2>/dev/null";
  FILE* pipe = popen(script.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string text;
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) text.append(buffer, n);
  if (pclose(pipe) != 0) GTEST_SKIP() << "python3-scipy is not installed";
  const Asf asf = ParseAsf(Bytes(folder / "HDM_bd.asf"), "HDM_bd.asf").value();
  const Amc amc =
      ParseAmc(Bytes(folder / "01/HDM_bd_depositFloorR_001_120.amc"), {&asf, DamagedRows::kRefuse}, "amc").value();
  std::vector<std::vector<Vector3d>> ends(static_cast<std::size_t>(amc.frames));
  std::vector<Vector3d> roots(ends.size());
  for (int f = 0; f < amc.frames; ++f) {
    AcclaimForward(asf, amc, f, ends[static_cast<std::size_t>(f)], &roots[static_cast<std::size_t>(f)]);
  }
  std::istringstream rows(text);
  std::string bone;
  std::size_t frame = 0, compared = 0;
  double worst = 0;
  for (Vector3d theirs; rows >> bone >> frame >> theirs.x() >> theirs.y() >> theirs.z(); ++compared) {
    const int index = asf.Find(bone);
    ASSERT_LT(frame, ends.size());
    const Vector3d ours = index < 0 ? roots[frame] : ends[frame][static_cast<std::size_t>(index)];
    worst = std::max(worst, (ours / asf.length_unit - theirs).norm());
  }
  EXPECT_EQ(compared, 31u * 301u);
  EXPECT_LE(worst, 1e-4) << "inches";
  RecordProperty("worst_inches", FormatDouble(worst));
}

TEST(AcclaimFiles, MatchTheLegsOfTheBvhOfTheSameCmuTake) {
  const auto folder = RecordedData("cmu/asf_amc");
  if (folder.empty()) GTEST_SKIP() << "CMU data not found";
  const Asf asf = ParseAsf(Bytes(folder / "01.asf"), "01.asf").value();
  const Amc amc = ParseAmc(Bytes(folder / "01_01.amc"), {&asf, DamagedRows::kRefuse}, "01_01.amc").value();
  const Bvh bvh = ParseBvh(Bytes(folder / "01_01.bvh"), "01_01.bvh").value();
  ASSERT_EQ(bvh.frames, amc.frames + 1) << "the BVH has one extra first frame";
  std::vector<std::tuple<int, int>> pairs;
  for (const auto& [bone, joint] : {std::pair{"lfemur", "LeftLeg"},
                                    {"ltibia", "LeftFoot"},
                                    {"lfoot", "LeftToeBase"},
                                    {"rfemur", "RightLeg"},
                                    {"rtibia", "RightFoot"},
                                    {"rfoot", "RightToeBase"}}) {
    for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
      if (bvh.joints[j].name == joint) pairs.emplace_back(asf.Find(bone), static_cast<int>(j));
    }
  }
  ASSERT_EQ(pairs.size(), 6u);
  std::vector<Vector3d> ends, joints;
  double worst = 0;
  for (int f = 0; f < amc.frames; f += 7) {
    AcclaimForward(asf, amc, f, ends);
    BvhForward(bvh, f + 1, joints);
    for (const auto& [bone, joint] : pairs) {
      worst = std::max(worst, (ends[static_cast<std::size_t>(bone)] - joints[static_cast<std::size_t>(joint)]).norm());
    }
  }
  EXPECT_LE(worst, 2e-4) << "file units";
}

}  // namespace
}  // namespace mocurate
