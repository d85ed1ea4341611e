// Inspection reports on every recorded file, compared with known facts. No report may be wrong; a report may be unknown
// only where the table gives a reason. docs/real_sets.md is generated from this table and the files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/file.h"
#include "tests/ingest/inspections.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kDocument = fs::path(kSourceFolder) / "docs" / "real_sets.md";

/// Known facts on the clips of a set. An empty value cannot be determined; `why` gives the reason.
struct RealSet {
  const char* name;
  const char* folder;  ///< inspected folder
  const char* files;   ///< prefix of the file paths below it
  const char* units;
  const char* up;
  const char* handedness;
  double rate_hz;  ///< 0: not in the files
  const char* why = "";
  /// Fields that some files do not determine, for the reason `why`.
  std::set<std::string> suspect = {};
  double recorded_hz = 0.0;  ///< known from the authors when the files do not contain it

  bool MayLack(const std::string& field) const;
};

constexpr const char* kPixels = "pixels: no person in 3-D";
constexpr const char* kStill = "a standing person with hanging arms shows no handedness";
constexpr const char* kNoRateAndStill =
    "no rate in the files, and the motion does not determine it; a standing person with hanging arms shows no "
    "handedness";
constexpr const char* kNoRate = "no rate in the files, and the motion does not determine it";
constexpr const char* kNoisy = "feet and knees are too noisy to determine the handedness";
constexpr const char* kNoSkeleton = "rotations whose skeleton is not in the folder";

const std::vector<RealSet>& RealSets() {
  static const std::vector<RealSet> sets = {
      {"KARD", "kinect/kard", "a", "mm", "+y", "left", 0, kNoRateAndStill, {"handedness"}, 30},
      {"KARD, pixels and depth", "kinect/kard", "screen/", "", "-y", "right", 0, kPixels, {"up", "handedness"}},
      {"MSR-Action3D", "kinect/msr_action3d", "a", "m", "+y", "right", 15, kStill, {"handedness"}},
      {"MSR-Action3D, pixels and depth (mirrored)", "kinect/msr_action3d", "screen/", "", "-y", "left", 15, kPixels},
      {"UTKinect", "kinect/utkinect", "", "m", "+y", "right", 0, kNoRateAndStill, {"handedness"}, 15},
      {"Florence3D", "kinect/florence3d", "", "mm", "+y", "right", 0, kNoRateAndStill, {"handedness"}, 15},
      {"CAD-60", "kinect/cad60", "", "mm", "+y", "right", 30},
      {"NTU RGB+D", "ntu", "", "m", "+y", "right", 30},
      {"Bandai 1", "bvh/bandai1", "", "cm", "+y", "right", 30},
      {"Bandai 2", "bvh/bandai2", "", "cm", "+y", "right", 30},
      {"BVH of PyMO", "bvh/misc", "omimo", "inch", "+y", "right", 120.005},
      {"BVH of bvh-toolbox, walk", "bvh/misc", "olafhaag_walk01", "cm", "+y", "right", 24},
      {"BVH of mocapbank", "bvh/misc", "olafhaag_test_mocapbank", "cm", "+y", "right", 30},
      {"BVH of Mixamo", "bvh/misc", "olafhaag_test_freebvh", "cm", "+y", "right", 30},
      {"BVH of two rotation orders", "bvh/misc", "kevinxie4c_walk", "cm", "+y", "right", 120.005},
      {"BVH of two frames", "bvh/misc", "kevinxie4c_sample", "inch", "+y", "right", 30},
      {"BVH of Noitom", "bvh/misc", "chenzunh23", "cm", "+y", "right", 90.001},
      {"BVH of Xia's set", "bvh/misc", "dme_xia", "2.2222222222222 inch", "+y", "right", 120.005},
      {"BVH of four bars", "bvh/misc", "fairmotion", "", "", "", 60, "no person: a chain of four joints"},
      {"BVH from video (MediaPipe)", "bvh/misc", "nlarion", "cm", "-y", "right", 15, kNoisy, {"handedness"}},
      {"CMU 01_01 as BVH", "cmu/asf_amc", "01_01.bvh", "2.2222222222222 inch", "+y", "right", 120},
      {"CMU 01_01", "cmu/asf_amc", "01_", "2.2222222222222 inch", "+y", "right", 0, kNoRate, {}, 120},
      {"CMU 02, 07, 09", "cmu/asf_amc", "0", "", "", "", 0, kNoSkeleton},
      {"Acclaim of 1995, walk", "cmu/acclaim_old", "walk", "inch", "+y", "right", 0, "no file contains the rate"},
      {"Acclaim of 1995, four bones", "cmu/acclaim_old", "skel", "", "", "", 0, "no person: four bones"},
      {"CMU exponential maps", "cmu/expmap", "", "", "", "", 0, kNoSkeleton},
      {"HDM05", "hdm05", "", "2.2222222222222 inch", "+y", "right", 120},
      {"AMASS sample", "amass_babel", "", "m", "+z", "right", 120},
      {"Action2Motion, joints", "humanact12", "a2m_generated/humanact12_tf", "m", "-y", "right", 0, kNoRate},
      {"Action2Motion, Lie parameters", "humanact12", "a2m_generated/humanact12_lie", "", "", "", 0,
       "no positions: rotations in a file named joints"},
      {"HumanML3D sample", "humanact12", "humanml3d_sample", "m", "+y", "right", 0, kNoRate, {}, 20},
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

struct SetOutcome {
  const RealSet* set = nullptr;
  std::set<std::string> files;
  int clips = 0, frames = 0;
  std::map<std::string, Answers> fields;
  std::map<double, int> contradicted;  ///< clips whose motion contradicts the true rate times this factor
  std::map<std::string, int> facing;
};

Json TrueValue(const RealSet& set, const std::string& field) {
  if (field == "rate_hz") return set.rate_hz > 0.0 ? Json(set.rate_hz) : Json();
  const std::string text = field == "units" ? set.units : field == "up" ? set.up : set.handedness;
  return text.empty() ? Json() : Json(text);
}

const std::vector<double> kFactors = {0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};

/// Whether the motion of a clip contradicts a rate.
bool ContradictsRate(const Json& clip, double rate_hz) {
  const Json& reported = clip.at("rate_hz");
  const Json& shown = reported.contains("measured") ? reported.at("measured") : reported;
  if (!shown.contains("range")) return false;
  const Json &lowest = shown.at("range")[0], &highest = shown.at("range")[1];
  return (!lowest.is_null() && rate_hz < lowest) || (!highest.is_null() && rate_hz > highest);
}

/// Whether `why` applies to this field: it has no true value, or is listed in `suspect`.
bool RealSet::MayLack(const std::string& field) const {
  return *why != '\0' && (TrueValue(*this, field).is_null() || suspect.count(field) > 0);
}

const std::vector<std::string> kFields = {"units", "up", "handedness", "rate_hz"};

std::vector<SetOutcome> InspectAll() {
  std::vector<SetOutcome> outcomes;
  std::map<std::string, Json> inspections;
  std::set<std::string> visited;
  for (const RealSet& set : RealSets()) {
    const fs::path folder = fs::path(std::getenv("MOCURATE_DATA")) / set.folder;
    if (inspections.count(set.folder) == 0) inspections[set.folder] = InspectPath(folder, std::nullopt);
    SetOutcome outcome;
    outcome.set = &set;
    std::map<std::string, std::map<std::string, int>> values;
    for (const Json& clip : inspections[set.folder].at("clips")) {
      const std::string file = clip.at("file").get<std::string>() + clip.value("id", std::string());
      if (clip.at("file").get<std::string>().rfind(set.files, 0) != 0) continue;
      // Sets with longer prefixes are listed before those with shorter ones.
      if (!visited.insert(std::string(set.folder) + "/" + file).second) continue;
      outcome.files.insert(clip.at("file").get<std::string>());
      ++outcome.clips;
      outcome.frames += Value(clip, "frames").is_null() ? 0 : Value(clip, "frames").get<int>();
      for (const std::string& field : kFields) {
        const Json value = Value(clip, field.c_str()), truth = TrueValue(set, field);
        Answers& answers = outcome.fields[field];
        const bool near = value.is_number() && truth.is_number() &&
                          std::abs(value.get<double>() - truth.get<double>()) < 2e-3 * truth.get<double>();
        if (value.is_null()) {
          ++answers.unknown;
        } else if (near || value == truth) {
          ++answers.right;
        } else {
          ++answers.wrong;
          ADD_FAILURE() << set.name << " " << clip.at("id") << ": " << field << " is reported as "
                        << clip.at(field).dump() << ", true is " << truth.dump();
        }
        ++values[field][value.is_null() ? "unknown" : value.is_string() ? value.get<std::string>() : value.dump()];
      }
      const double rate = set.rate_hz > 0.0 ? set.rate_hz : set.recorded_hz;
      for (const double factor : kFactors)
        outcome.contradicted[factor] += rate > 0.0 && ContradictsRate(clip, factor * rate) ? 1 : 0;
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

std::string DocumentOf(const std::vector<SetOutcome>& outcomes) {
  std::string text =
      "# Inspection reports on recorded files\n\n"
      "Each row: a recorded set, what `mocurate inspect` reports on its files without a declaration, and whether it "
      "is\n"
      "correct. `tests/ingest/formats/recorded_sets_test.cpp` has the known facts. It fails on a wrong answer, and on "
      "an\n"
      "unknown one without a reason. Numbers after values count clips. `facing` has no known truth and is not "
      "checked.\n"
      "To make this page again: `MOCURATE_DATA=DATA MOCURATE_REGENERATE=1 test_ingest --gtest_filter='RealSets*'`.\n\n"
      "| set | files | clips | frames | units | up | handedness | rate, Hz | facing | true? |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const SetOutcome& o : outcomes) {
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
  text +=
      "\n## Wrong rates\n\n"
      "Number of clips whose motion contradicts the true rate times a factor, as `rate_suspect` reports it. At factor "
      "1 "
      "there is none.\n"
      "Walking and running reveal rates that are too low or too high. Other motions reveal only rates that are "
      "too\nhigh, because people may move slowly.\n"
      "For sets without a rate in their files, the true rate is the one that the authors publish.\n\n"
      "| sets | clips | 1/8 | 1/4 | 1/2 | 1 | 2 | 4 | 8 |\n|---|---|---|---|---|---|---|---|---|\n";
  const std::vector<std::pair<std::string, std::vector<std::string>>> rows = {
      {"BVH", {"Bandai", "BVH", "CMU 01_01 as BVH"}},
      {"AMC", {"HDM05", "CMU 01_01"}},
      {"KARD", {"KARD"}},
      {"MSR-Action3D", {"MSR-Action3D"}},
      {"UTKinect", {"UTKinect"}},
      {"Florence3D", {"Florence3D"}},
      {"CAD-60, NTU RGB+D", {"CAD-60", "NTU RGB+D"}}};
  for (const auto& [name, sets] : rows) {
    int clips = 0;
    std::map<double, int> contradicted;
    for (const SetOutcome& o : outcomes) {
      const std::string set = o.set->name;
      const bool is_bvh = set == "CMU 01_01 as BVH";
      const bool wanted = std::any_of(sets.begin(), sets.end(), [&](const std::string& begin) {
        return begin == set || (begin != "CMU 01_01" && set.rfind(begin, 0) == 0);
      });
      if (!wanted || (is_bvh && name != "BVH") || set.find("pixels") != std::string::npos) continue;
      clips += o.clips;
      for (const auto& [factor, count] : o.contradicted) contradicted[factor] += count;
    }
    text += "| " + name + " | " + std::to_string(clips);
    for (const double factor : kFactors) text += " | " + std::to_string(contradicted[factor]);
    text += " |\n";
  }
  return text;
}

TEST(RealSets, HaveNoWrongAnswerAndNoUnexplainedUnknown) {
  if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::vector<SetOutcome> outcomes = InspectAll();
  for (const SetOutcome& outcome : outcomes) {
    EXPECT_GT(outcome.clips, 0) << outcome.set->name;
    EXPECT_EQ(outcome.contradicted.at(1.0), 0) << outcome.set->name << ": the motion contradicts the true rate";
    for (const std::string& field : kFields) {
      const Answers& answers = outcome.fields.at(field);
      EXPECT_EQ(answers.wrong, 0) << outcome.set->name << " " << field;
      EXPECT_TRUE(answers.unknown == 0 || outcome.set->MayLack(field))
          << outcome.set->name << " " << field << ": " << answers.found << ", without a reason for this field";
    }
  }
  const std::string document = DocumentOf(outcomes);
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    ASSERT_FALSE(HasFailure()) << "the page is not written while an answer is wrong";
    ASSERT_TRUE(WriteFile(kDocument, document));
    return;
  }
  const auto written = ReadFile(kDocument);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_TRUE(*written == document) << "run MOCURATE_REGENERATE=1 test_ingest --gtest_filter='RealSets*'";
}

}  // namespace
}  // namespace mocurate
