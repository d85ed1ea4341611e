// Lengths and angles in another unit than the file, its folder or its source declares: the cause is reported.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/formats/amc.h"
#include "core/formats/bvh.h"
#include "core/formats/opensim_table.h"
#include "tests/formats/corruption.h"
#include "tests/ingest/changed_files.h"
#include "tests/support/acclaim_writers.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using Json = nlohmann::json;

const Json* FindCode(const Json& inspection, const std::string& code) {
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") == code) return &finding;
  }
  return nullptr;
}

class WrongUnits : public ChangedFiles {
 protected:
  /// Six clips of KARD, the last `scaled` of them multiplied.
  void WriteKard(double factor, int scaled) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(TestData()) / "kinect/kard")) {
      if (entry.path().extension() == ".txt") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (int i = 0; i < 6; ++i) {
      std::istringstream in(*ReadFile(files[static_cast<std::size_t>(i)]));
      std::ostringstream out;
      int column = 0;
      for (double value = 0.0; in >> value;)
        out << value * (i >= 6 - scaled ? factor : 1.0) << (++column % 3 == 0 ? '\n' : ' ');
      Written(DisplayPath(files[static_cast<std::size_t>(i)].filename()), out.str());
    }
  }

  /// Expects an error of this code for an edited CMU skeleton and motion, in an inspection and in a run.
  void ExpectAcclaim(const std::string& skeleton, const std::string& motion, const std::string& code) {
    Written("01.asf", skeleton);
    Written("01_01.amc", motion);
    const Json inspection = Inspect();
    const Json* finding = FindCode(inspection, code);
    ASSERT_NE(finding, nullptr) << inspection.at("findings").dump(1);
    EXPECT_EQ(finding->at("severity"), "error");
    EXPECT_THAT(ErrorCodes(RunOne(From("cmu_amc"))), Contains(code));
  }
  static std::string Cmu(const std::string& name) { return Recorded("cmu/asf_amc/" + name); }
  /// The CMU motion under unit keyword `word`, with angles multiplied by `factor`; those of the root only if `root`.
  static std::string Angles(const std::string& word, double factor, bool root = true) {
    AmcOptions options;
    Amc amc = *ParseAmc(Cmu("01_01.amc"), options, "01_01.amc");
    for (const AmcBone& bone : amc.bones) {
      if (!root && bone.name == "root") continue;
      for (int f = 0; f < amc.frames; ++f) {
        for (int c = bone.name == "root" ? 3 : 0; c < bone.channels; ++c)
          amc.values[static_cast<std::size_t>(f) * amc.channel_count + bone.first_channel + c] *= factor;
      }
    }
    amc.degrees = word == ":DEGREES";
    return WriteAmc(amc);
  }
};

TEST_F(WrongUnits, AreThoseOfAClipAmongOthers) {
  WriteKard(100.0, 1);
  const Json inspection = Inspect();
  EXPECT_EQ(Value(inspection.at("clips")[0], "units"), "mm");
  EXPECT_EQ(Value(inspection.at("clips")[5], "units"), "0.00001 m");
  EXPECT_EQ(inspection.at("groups")[0].at("units").at("value"), "mm");
  EXPECT_LT(inspection.at("groups")[0].at("units").at("share"), 1.0);
  EXPECT_EQ(CountCode(RunAll(From("kard")), "units_contradiction"), 1u)
      << "a run knows the declared unit and reports the clip";
}

TEST_F(WrongUnits, EstimatesTheUnitOfAUniformlyScaledFolder) {
  WriteKard(100.0, 6);
  const Json inspection = Inspect();
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(Value(clip, "units"), "0.00001 m");
    EXPECT_EQ(clip.at("units").at("from"), "measured");
    EXPECT_LT(clip.at("units").at("confidence"), 0.55) << "not a common unit";
  }
  for (const Json& clip : inspection.at("groups")) EXPECT_EQ(clip.at("units").at("value"), "0.00001 m");
}

TEST_F(WrongUnits, ReportsBvhBonesInMetresWithARootPathInCentimetresOnce) {
  Bvh bvh = *ParseBvh(*ReadFile(TestData() + "/bvh/misc/olafhaag_walk01.bvh"), "walk");
  IngestOptions options = From("bandai2");
  options.source.skeleton = "";
  options.source.rate_hz.reset();
  for (const bool mixed : {false, true}) {
    for (BvhJoint& joint : bvh.joints) joint.offset *= mixed ? 0.01 : 1.0;
    for (BvhJoint& joint : bvh.joints) joint.end_site *= mixed ? 0.01 : 1.0;
    Written("dataset-2_walk_any_1.bvh", mocurate::WriteBvh(bvh));
    options.source.units = mixed ? "m" : "cm";
    const Json inspection = Inspect();
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    const std::vector<std::string> errors =
        mixed ? std::vector<std::string>{"units_contradiction"} : std::vector<std::string>();
    EXPECT_EQ(Codes(inspection, "error"), errors);
    EXPECT_EQ(ErrorCodes(clips[0].outcome), errors);
    EXPECT_TRUE(Codes(inspection, "warning").empty()) << inspection.at("findings").dump(1);
    EXPECT_EQ(clips[0].outcome.findings.size(), errors.size());
    if (mixed) {
      EXPECT_NEAR(FindCode(inspection, "units_contradiction")->at("value"), 0.01, 0.002);
    }
  }
}

TEST_F(WrongUnits, ReportsATooLongBvhPathAsAUnitErrorOnly) {
  const std::string name = "dataset-2_walk-turn-left_active_001.bvh";
  Bvh bvh = *ParseBvh(*ReadFile(TestData() + "/bvh/bandai2/" + name), name);
  const auto hips = std::find_if(bvh.joints.begin(), bvh.joints.end(),
                                 [](const BvhJoint& joint) { return joint.parent == 0 && joint.HasPosition(); });
  ASSERT_NE(hips, bvh.joints.end());
  for (int f = 0; f < bvh.frames; ++f) {
    for (std::size_t c = 0; c < hips->channels.size(); ++c) {
      if (!IsPosition(hips->channels[c])) continue;
      bvh.values[static_cast<std::size_t>(f * bvh.channel_count + hips->first_channel) + c] *= 100.0;
    }
  }
  Written(name, mocurate::WriteBvh(bvh));
  const Json inspection = Inspect();
  EXPECT_EQ(Codes(inspection, "error"), std::vector<std::string>{"units_contradiction"});
  EXPECT_EQ(FindCode(inspection, "position_jump"), nullptr);
}

TEST_F(WrongUnits, ReportsATooLongAmcPathAsAUnitErrorOnly) {
  Amc amc = *ParseAmc(Cmu("01_01.amc"), {}, "01_01.amc");
  for (int f = 0; f < amc.frames; ++f) {
    for (int c = 0; c < 3; ++c) amc.values[static_cast<std::size_t>(f) * amc.channel_count + c] *= 100.0;
  }
  ExpectAcclaim(Cmu("01.asf"), WriteAmc(amc), "units_contradiction");
  EXPECT_THAT(Codes(Inspect(), "error"), ::testing::Not(Contains("rate_suspect")));
}

TEST_F(WrongUnits, ReportsAcclaimAnglesThatContradictTheirHeader) {
  ExpectAcclaim(Cmu("01.asf"), Angles(":DEGREES", M_PI / 180.0), "angle_unit_contradiction");
  Written("01_01.amc", Angles(":RADIANS", M_PI / 180.0));
  EXPECT_EQ(FindCode(Inspect(), "angle_unit_contradiction"), nullptr) << "true radians";
  Written("01_01.amc", Angles(":DEGREES", M_PI / 180.0, false));
  EXPECT_EQ(FindCode(Inspect(), "angle_unit_contradiction"), nullptr) << "a person in the rest pose who rotates";
}

TEST_F(WrongUnits, ReportsASkeletonInDegreesThatDeclaresRadians) {
  const std::string skeleton = Replaced(Cmu("01.asf"), "angle deg", "angle rad");
  ExpectAcclaim(skeleton, Cmu("01_01.amc"), "angle_unit_contradiction");
  const Json inspection = Inspect();
  const auto places = Places(inspection);
  EXPECT_EQ(std::count(places.begin(), places.end(), "angle_unit_contradiction 01_01.amc"), 1);
  EXPECT_EQ(FindCode(inspection, "angle_unit_contradiction")->at("value"), 20) << "the value of an axis";
  Asf radians = *ParseAsf(Cmu("01.asf"), "01.asf");
  radians.degrees = false;
  for (AsfBone& bone : radians.bones) {
    bone.axis.angles *= M_PI / 180.0;
    for (AsfLimit& limit : bone.limits) limit = {limit.least * M_PI / 180.0, limit.most * M_PI / 180.0};
  }
  Written("01.asf", WriteAsf(radians));
  EXPECT_EQ(FindCode(Inspect(), "angle_unit_contradiction"), nullptr) << "true radians";
}

TEST_F(WrongUnits, ReportsOpenSimCoordinatesThatContradictTheirHeader) {
  const auto found = [&](const std::string& in_degrees, double factor) {
    const std::string name = "pose2sim/opensim_ik_body25b.mot";
    const OpenSimTable table = *ParseOpenSimTable(*ReadFile(fs::path(TestData()) / name), name);
    std::ostringstream out;
    out << "Coordinates\ninDegrees=" << in_degrees << "\nendheader\ntime";
    for (const std::string& label : table.labels) out << '\t' << label;
    for (int row = 0; row < table.rows(); ++row) {
      out << '\n' << table.time_s[static_cast<std::size_t>(row)];
      for (int c = 0; c < static_cast<int>(table.labels.size()); ++c) out << '\t' << factor * table.value(row, c);
    }
    Written("walk.mot", out.str() + "\n");
    const Json inspection = Inspect();
    const Json* finding = FindCode(inspection, "angle_unit_contradiction");
    return finding == nullptr ? 0.0 : finding->at("value").get<double>();
  };
  const double degrees = found("no", 1.0);
  EXPECT_GT(degrees, 10.0);
  EXPECT_NEAR(found("yes", M_PI / 180.0), degrees * M_PI / 180.0, 1e-3);
  EXPECT_EQ(found("yes", 1.0), 0.0);
  EXPECT_EQ(found("no", M_PI / 180.0), 0.0);
}

TEST_F(WrongUnits, ReportsALengthUnitThatContradictsThePersonOrTheSource) {
  ExpectAcclaim(Replaced(Cmu("01.asf"), "length 0.45", "length 1.0"), Cmu("01_01.amc"), "length_unit_contradiction");
  const Json child = Inspect();
  EXPECT_NEAR(FindCode(child, "length_unit_contradiction")->at("value"), 0.75, 0.01);
  Written("01.asf", Replaced(Cmu("01.asf"), "length 0.45", "length 0.4"));
  EXPECT_EQ(FindCode(Inspect(), "length_unit_contradiction"), nullptr) << "body height 1.87 m";
  const IngestOptions options = From("cmu_amc");
  EXPECT_EQ(CountCode(RunAll(options), "length_unit_contradiction"), 1u)
      << "body height 1.67 m with the unit of the source";
  Written("01.asf", Cmu("01.asf"));
  EXPECT_EQ(CountCode(RunAll(options), "length_unit_contradiction"), 0u);
}

TEST_F(WrongUnits, ReportsAnAcclaimLengthThatIsAHundredthOfItsTrueValue) {
  ExpectAcclaim(Replaced(Cmu("01.asf"), "length 0.45", "length 0.0045"), Cmu("01_01.amc"), "length_unit_contradiction");
  Written("01.asf", Cmu("01.asf"));
  EXPECT_TRUE(Codes(Inspect(), "error").empty());
}

}  // namespace
}  // namespace mocurate
