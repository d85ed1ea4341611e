// What inspection says of every recorded file, beside what is known to be true of it. No answer may be wrong, and none
// may be missing but where the file cannot tell. docs/real_sets.md is made from this table and the files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/file.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kDocument = fs::path(MOCURATE_SOURCE_FOLDER) / "docs" / "real_sets.md";

/// What is known of the clips of a set. "" for a value: nothing can tell it, and `why` says so.
struct RealSet {
  const char* name;
  const char* folder;  ///< that is inspected
  const char* files;   ///< begin of their names below it
  const char* units;
  const char* up;
  const char* handedness;
  double rate_hz;  ///< 0: the files do not say it
  const char* why = "";
  /// Fields with a truth that some of the files cannot tell, for the same reason.
  std::set<std::string> doubtful = {};

  bool MayLack(const std::string& field) const;
};

constexpr const char* kPixels = "pixels: no person in 3-D";
constexpr const char* kNoRate = "no rate in the files, and nothing tells it";
constexpr const char* kNoisy = "feet and knees are too noisy to tell the hand";
constexpr const char* kNoSkeleton = "rotations whose skeleton is not in the folder";

const std::vector<RealSet>& RealSets() {
  static const std::vector<RealSet> sets = {
      {"KARD", "kinect/kard", "a", "mm", "+y", "left", 0, kNoRate},
      {"KARD, pixels and depth", "kinect/kard", "screen/", "", "-y", "right", 0, kPixels, {"up", "handedness"}},
      {"MSR-Action3D", "kinect/msr_action3d", "a", "m", "+y", "right", 0, kNoRate},
      {"MSR-Action3D, pixels and depth (mirrored)", "kinect/msr_action3d", "screen/", "", "-y", "left", 0, kPixels},
      {"UTKinect", "kinect/utkinect", "", "m", "+y", "right", 0, kNoRate},
      {"Florence3D", "kinect/florence3d", "", "mm", "+y", "right", 0, kNoRate},
      {"CAD-60", "kinect/cad60", "", "mm", "+y", "right", 0, kNoRate},
      {"NTU RGB+D", "ntu", "", "m", "+y", "right", 0, kNoRate},
      {"Bandai 1", "bvh/bandai1", "", "cm", "+y", "right", 30},
      {"Bandai 2", "bvh/bandai2", "", "cm", "+y", "right", 30},
      {"BVH of PyMO", "bvh/misc", "omimo", "inch", "+y", "right", 120.005},
      {"BVH of bvh-toolbox, walk", "bvh/misc", "olafhaag_walk01", "cm", "+y", "right", 24},
      {"BVH of mocapbank", "bvh/misc", "olafhaag_test_mocapbank", "cm", "+y", "right", 30},
      {"BVH of Mixamo", "bvh/misc", "olafhaag_test_freebvh", "cm", "+y", "right", 30},
      {"BVH of two rotation orders", "bvh/misc", "kevinxie4c_walk", "cm", "+y", "right", 120.005},
      {"BVH of two frames", "bvh/misc", "kevinxie4c_sample", "inch", "+y", "right", 30},
      {"BVH of Noitom", "bvh/misc", "chenzunh23", "cm", "+y", "right", 90.001},
      {"BVH of Xia's set", "bvh/misc", "dme_xia", "0.0564 m", "+y", "right", 120.005},
      {"BVH of four bars", "bvh/misc", "fairmotion", "", "", "", 60, "no person: a chain of four joints"},
      {"BVH from video (MediaPipe)", "bvh/misc", "nlarion", "cm", "-y", "right", 15, kNoisy, {"handedness"}},
      {"CMU 01_01 as BVH", "cmu/asf_amc", "01_01.bvh", "0.0564 m", "+y", "right", 120},
      {"CMU 01_01", "cmu/asf_amc", "01_", "0.0564 m", "+y", "right", 0, "the rate stands in no file"},
      {"CMU 02, 07, 09", "cmu/asf_amc", "0", "", "", "", 0, kNoSkeleton},
      {"Acclaim of 1995, walk", "cmu/acclaim_old", "walk", "inch", "+y", "right", 0, "the rate stands in no file"},
      {"Acclaim of 1995, four bones", "cmu/acclaim_old", "skel", "", "", "", 0, "no person: four bones"},
      {"CMU exponential maps", "cmu/expmap", "", "", "", "", 0, kNoSkeleton},
      {"HDM05", "hdm05", "", "0.0564 m", "+y", "right", 120},
      {"AMASS sample", "amass_babel", "", "m", "+z", "right", 120},
      {"Action2Motion, joints", "humanact12", "a2m_generated/humanact12_tf", "m", "-y", "right", 0, kNoRate},
      {"Action2Motion, Lie parameters", "humanact12", "a2m_generated/humanact12_lie", "", "", "", 0,
       "no positions: rotations in a file named joints"},
      {"HumanML3D sample", "humanact12", "humanml3d_sample", "m", "+y", "right", 0, kNoRate},
      {"Pose2Sim, triangulated", "pose2sim", "reference_3d", "m", "+z", "right", 0, kNoRate},
      {"Pose2Sim, OpenSim angles", "pose2sim", "opensim", "m", "", "", 60, kNoSkeleton},
      {"Pose2Sim, keypoints", "pose2sim", "", "px", "", "", 0, kPixels},
      {"Rendered sequence", "clouds", "rendered_seq", "m", "-y", "right", 12},
      {"Rendered stills", "clouds", "rendered_body", "m", "-y", "right", 0, "stills have no rate"},
      {"Panoptic", "cameras", "panoptic", "cm", "-y", "right", 29.97}};
  return sets;
}

struct Answers {
  int right = 0, unknown = 0, wrong = 0;
  std::string found;  ///< "+y 432, none 1"
};

struct Outcome {
  const RealSet* set = nullptr;
  std::set<std::string> files;
  int clips = 0, frames = 0;
  std::map<std::string, Answers> fields;
  std::map<std::string, int> facing;
};

Json Truth(const RealSet& set, const std::string& field) {
  if (field == "rate_hz") return set.rate_hz > 0.0 ? Json(set.rate_hz) : Json();
  const std::string text = field == "units" ? set.units : field == "up" ? set.up : set.handedness;
  return text.empty() ? Json() : Json(text);
}

/// Whether the reason is about this field: it has no truth, or is named.
bool RealSet::MayLack(const std::string& field) const {
  return *why != '\0' && (Truth(*this, field).is_null() || doubtful.count(field) > 0);
}

const std::vector<std::string> kFields = {"units", "up", "handedness", "rate_hz"};

std::vector<Outcome> LookAtAll() {
  std::vector<Outcome> outcomes;
  std::map<std::string, Json> inspections;
  std::set<std::string> seen;
  for (const RealSet& set : RealSets()) {
    const fs::path folder = fs::path(std::getenv("MOCURATE_TEST_DATA")) / set.folder;
    if (inspections.count(set.folder) == 0) inspections[set.folder] = InspectPath(folder, std::nullopt);
    Outcome outcome;
    outcome.set = &set;
    std::map<std::string, std::map<std::string, int>> values;
    for (const Json& clip : inspections[set.folder].at("clips")) {
      const std::string file = clip.at("file").get<std::string>() + clip.value("id", std::string());
      if (clip.at("file").get<std::string>().rfind(set.files, 0) != 0) continue;
      // A set of longer names stands before that of shorter ones.
      if (!seen.insert(std::string(set.folder) + "/" + file).second) continue;
      outcome.files.insert(clip.at("file").get<std::string>());
      ++outcome.clips;
      outcome.frames += Value(clip, "frames").is_null() ? 0 : Value(clip, "frames").get<int>();
      for (const std::string& field : kFields) {
        const Json value = Value(clip, field.c_str()), truth = Truth(set, field);
        Answers& answers = outcome.fields[field];
        const bool near = value.is_number() && truth.is_number() &&
                          std::abs(value.get<double>() - truth.get<double>()) < 2e-3 * truth.get<double>();
        if (value.is_null()) {
          ++answers.unknown;
        } else if (near || value == truth) {
          ++answers.right;
        } else {
          ++answers.wrong;
          ADD_FAILURE() << set.name << " " << clip.at("id") << ": " << field << " is said to be "
                        << clip.at(field).dump() << ", true is " << truth.dump();
        }
        ++values[field][value.is_null() ? "unknown" : value.is_string() ? value.get<std::string>() : value.dump()];
      }
      const Json facing = Value(clip, "facing");
      ++outcome.facing[facing.is_null() ? "unknown" : facing.get<std::string>()];
    }
    for (auto& [field, counts] : values) {
      std::string& found = outcome.fields[field].found;
      for (const auto& [value, count] : counts) {
        found += (found.empty() ? "" : ", ") + value + (counts.size() > 1 ? " " + std::to_string(count) : "");
      }
    }
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

std::string DocumentOf(const std::vector<Outcome>& outcomes) {
  std::string text =
      "# What inspection says of recorded files\n\n"
      "Every recorded set that the tests know, what `mocurate inspect` finds in its files without any declaration, and "
      "whether it is true.\n"
      "What is true is in `tests/ingest/real_sets_test.cpp`, which fails where an answer is wrong, or missing without "
      "a "
      "reason.\n"
      "`MOCURATE_TEST_DATA=DATA MOCURATE_REGENERATE=1 test_ingest --gtest_filter='RealSets*'` makes this page again; "
      "numbers behind values are clips.\n"
      "`facing` is a habit of each clip, of which no truth is known: it is not judged.\n\n"
      "| set | files | clips | frames | units | up | handedness | rate, Hz | facing | true? |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Outcome& o : outcomes) {
    text += "| " + std::string(o.set->name) + " | " + std::to_string(o.files.size()) + " | " + std::to_string(o.clips) +
            " | " + std::to_string(o.frames);
    int unknown = 0, wrong = 0;
    for (const std::string& field : kFields) {
      const Answers& answers = o.fields.at(field);
      text += " | " + answers.found;
      unknown += answers.unknown;
      wrong += answers.wrong;
    }
    std::string facing;
    for (const auto& [value, count] : o.facing) {
      facing += (facing.empty() ? "" : ", ") + value + (o.facing.size() > 1 ? " " + std::to_string(count) : "");
    }
    text += " | " + facing + " | " + (wrong > 0 ? "no: " + std::to_string(wrong) + " wrong" : "yes") +
            (unknown > 0 ? std::string("; unknown: ") + o.set->why : "") + " |\n";
  }
  return text;
}

TEST(RealSets, NoAnswerIsWrongAndNoneIsMissingWithoutAReason) {
  if (std::getenv("MOCURATE_TEST_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_TEST_DATA is not set";
  const std::vector<Outcome> outcomes = LookAtAll();
  for (const Outcome& outcome : outcomes) {
    EXPECT_GT(outcome.clips, 0) << outcome.set->name;
    for (const std::string& field : kFields) {
      const Answers& answers = outcome.fields.at(field);
      EXPECT_EQ(answers.wrong, 0) << outcome.set->name << " " << field;
      EXPECT_TRUE(answers.unknown == 0 || outcome.set->MayLack(field))
          << outcome.set->name << " " << field << ": " << answers.found << ", and no reason is given for this field";
    }
  }
  const std::string document = DocumentOf(outcomes);
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    ASSERT_FALSE(HasFailure()) << "the page stays as it is: it says what is true";
    ASSERT_TRUE(WriteFile(kDocument, document));
    return;
  }
  const auto written = ReadFile(kDocument);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_TRUE(*written == document) << "run MOCURATE_REGENERATE=1 test_ingest --gtest_filter='RealSets*'";
}

}  // namespace
}  // namespace mocurate
