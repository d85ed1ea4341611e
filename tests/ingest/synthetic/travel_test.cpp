// The studio's actions travel, bend and are named as the papers' figures need them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/pi.h"
#include "core/formats/babel.h"
#include "ingest/synthetic/take_plan.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

constexpr std::int64_t kPeople = 3;

/// Performances of one class by several people, without the errors of a sensor.
std::vector<std::pair<PlannedTake, Motion>> Performed(const SetClass& kind, std::int64_t seed,
                                                      const SkeletonPtr& skeleton) {
  StudioOptions options;
  options.seed = seed;
  const std::vector<SetClass> classes = {kind};
  const auto takes = PlanTakes(options, classes, {kPeople, 2, 30.0, 0.3, 0.8});
  const auto cast = Cast(seed, kPeople, *skeleton);
  std::vector<std::pair<PlannedTake, Motion>> performed;
  for (PlannedTake take : *takes) {
    take.kind = &kind;  // `classes` ends with this function
    const Subject& subject = cast[static_cast<std::size_t>(take.subject - 1)];
    performed.emplace_back(take, PerformScript(take.script, subject, skeleton, FrameRate{30, 1}));
  }
  return performed;
}

/// Calls `check(take, motion, where)` for five seeds and both skeletons.
template <class Check>
void ForPeople(const SetClass& kind, const Check& check) {
  for (const char* name : {"smpl24", "kinect20"}) {
    const auto skeleton = LoadSkeleton(name);
    ASSERT_TRUE(skeleton);
    for (std::int64_t seed = 1; seed <= 5; ++seed) {
      for (const auto& [take, motion] : Performed(kind, seed, *skeleton)) {
        check(take, motion,
              std::string(kind.label) + ", " + name + ", seed " + std::to_string(seed) + ", " + take.Key());
      }
    }
  }
}

/// Largest minus smallest root coordinate of a person who faces +z, metres.
Vector3d RootSpan(const Motion& motion, double heading) {
  const Quaterniond ahead(Eigen::AngleAxisd(-heading, Vector3d::UnitY()));
  Vector3d low = ahead * motion.root_translation.front(), high = low;
  for (const Vector3d& root : motion.root_translation) {
    low = low.cwiseMin(ahead * root);
    high = high.cwiseMax(ahead * root);
  }
  return high - low;
}

/// Angle between the vertical and the line from the pelvis to the middle of the shoulders, degrees.
double TrunkInclination(const Motion& motion, int frame) {
  const auto at = [&](const char* joint) { return motion.joints.at(frame, *motion.skeleton->FindJoint(joint)); };
  const Vector3d trunk = 0.5 * (at("left_shoulder") + at("right_shoulder") - at("left_hip") - at("right_hip"));
  return std::acos(trunk.normalized().y()) * 180.0 / kPi;
}

const SetClass& Uestc(const std::string& label) {
  const auto& classes = UestcClasses();
  return *std::find_if(classes.begin(), classes.end(), [&](const SetClass& kind) { return kind.label == label; });
}

TEST(StudioTravel, ThreeExercisesOfUestcTravelAlongOneAxisEach) {
  struct Travel {
    const char* label;
    int axis;      ///< left, up, forwards
    double least;  ///< metres
  };
  for (const Travel& travel :
       {Travel{"left-stretching", 0, 0.25}, {"rope-skipping", 1, 0.05}, {"forward-lunging", 2, 0.30}}) {
    double least = 1e9, ratio = 1e9;
    ForPeople(Uestc(travel.label), [&](const PlannedTake& take, const Motion& motion, const std::string& where) {
      const Vector3d span = RootSpan(motion, take.script.heading);
      const double other = std::max(span[(travel.axis + 1) % 3], span[(travel.axis + 2) % 3]);
      EXPECT_GT(span[travel.axis], travel.least) << where;
      EXPECT_GT(span[travel.axis], other) << where << ": spans " << span.transpose();
      EXPECT_LT((motion.root_translation.back() - motion.root_translation.front()).norm(), 0.05) << where;
      least = std::min(least, span[travel.axis]);
      ratio = std::min(ratio, span[travel.axis] / other);
    });
    RecordProperty(std::string(travel.label) + "_least_mm", static_cast<int>(1000.0 * least));
    RecordProperty(std::string(travel.label) + "_ratio_percent", static_cast<int>(100.0 * ratio));
  }
}

TEST(StudioTravel, PeopleStretchLeftwardsAndLungeForwards) {
  ForPeople(Uestc("left-stretching"), [](const PlannedTake& take, const Motion& motion, const std::string& where) {
    const Quaterniond ahead(Eigen::AngleAxisd(-take.script.heading, Vector3d::UnitY()));
    int farthest = 0;
    const auto left = [&](int f) { return (ahead * motion.root_translation[f]).x(); };
    for (int f = 0; f < motion.frame_count(); ++f) farthest = left(f) > left(farthest) ? f : farthest;
    EXPECT_GT(left(farthest) - left(0), 0.25) << where;
    EXPECT_GT(motion.joints.at(farthest, *motion.skeleton->FindJoint("right_wrist")).y(),
              motion.joints.at(farthest, *motion.skeleton->FindJoint("head")).y())
        << where << ": an arm over the head";
  });
  ForPeople(Uestc("forward-lunging"), [](const PlannedTake& take, const Motion& motion, const std::string& where) {
    const Quaterniond ahead(Eigen::AngleAxisd(-take.script.heading, Vector3d::UnitY()));
    double farthest = 0.0;
    for (const Vector3d& root : motion.root_translation)
      farthest = std::max(farthest, (ahead * (root - motion.root_translation[0])).z());
    EXPECT_GT(farthest, 0.30) << where;
  });
}

TEST(StudioTravel, RopeSkippersHopAtTheRhythmOfARope) {
  ForPeople(Uestc("rope-skipping"), [](const PlannedTake& take, const Motion& motion, const std::string& where) {
    const double standing = motion.root_translation.front().y();
    int hops = 0;
    for (int f = 1; f < motion.frame_count(); ++f) {
      const auto above = [&](int at) { return motion.root_translation[at].y() > standing + 0.02; };
      hops += above(f) && !above(f - 1) ? 1 : 0;
    }
    const ScriptedAction& action = take.script.actions.front();
    const double per_second = hops / FrameRate{30, 1}.FrameTime(action.end - action.begin);
    EXPECT_GT(per_second, 1.5) << where;
    EXPECT_LT(per_second, 3.0) << where;
  });
}

TEST(StudioTravel, PeopleBendDownByMoreThan70Degrees) {
  double least = 180.0;
  ForPeople({0, "bend down", "bend_down", 0}, [&](const PlannedTake&, const Motion& motion, const std::string& where) {
    double most = 0.0;
    for (int f = 0; f < motion.frame_count(); ++f) most = std::max(most, TrunkInclination(motion, f));
    EXPECT_GT(most, 70.0) << where;
    EXPECT_LT(most, 120.0) << where;
    EXPECT_LT(TrunkInclination(motion, 0), 25.0) << where;
    EXPECT_LT(TrunkInclination(motion, motion.frame_count() - 1), 25.0) << where;
    least = std::min(least, most);
  });
  RecordProperty("bend_down_least_degrees", static_cast<int>(least));
}

std::set<std::string> ClassesOf(const std::string& recipe) {
  const auto node = LoadConfig(std::filesystem::path(kSourceFolder) / "configs/recipes" / (recipe + ".yaml"));
  EXPECT_TRUE(node) << node.error().Message();
  std::set<std::string> names;
  for (const ConfigNode& kind : node->Find("assemble")->Find("classes")->sequence)
    names.insert(kind.Find("name")->scalar);
  return names;
}

TEST_F(Layouts, TheBabelVocabularyHasTheClassesOfItsRecipe) {
  StudioOptions options = Perfect(StudioLayout::kAmass);
  options.vocabulary = StudioVocabulary::kBabel;
  options.subjects = 5;
  options.clips = 8;
  Write(options);
  std::set<std::string> labels;
  for (const char* part : {"train.json", "val.json"}) {
    const auto sequences = ParseBabel(Bytes(std::string("amass/babel_v1.0_release/") + part), part);
    ASSERT_TRUE(sequences) << sequences.error().Message();
    for (const BabelSequence& sequence : *sequences) {
      for (const BabelLabel& label : sequence.frame_anns.front().labels) {
        for (const std::string& category : *label.act_cat) EXPECT_TRUE(IsFrequentBabelCategory(category)) << category;
        if (label.proc_label != "transition") labels.insert(*label.proc_label);
      }
    }
  }
  EXPECT_EQ(labels, ClassesOf("babel_studio"));
  const std::set<std::string> set = ClassesOf("babel53");
  const auto known =
      std::count_if(labels.begin(), labels.end(), [&](const auto& label) { return set.count(label) != 0; });
  EXPECT_EQ(known, 19) << "the recipe's comment counts them";
  EXPECT_EQ(labels.size(), 23u);
}

}  // namespace
}  // namespace mocurate
