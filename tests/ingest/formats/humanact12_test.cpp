// The plan of HumanAct12 has the counts of the real set, and its 34 variants move plausibly.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "ingest/synthetic/humanact12_set.h"

namespace mocurate {
namespace {

std::vector<PlannedRecording> Planned(std::int64_t seed, std::int64_t subjects, std::int64_t clips,
                                      const std::vector<std::string>& actions) {
  StudioOptions options;
  options.seed = seed;
  options.subjects = subjects;
  options.clips = clips;
  options.actions = actions;
  return PlanHumanAct12(options);
}

constexpr FrameRate kRate{15, 1};

TEST(HumanAct12Set, MatchesClassesCountsAndLengthsOfTheRealSet) {
  const std::vector<PlannedRecording> recordings = Planned(1, 0, 0, {});
  std::map<std::string, int> coarse;
  std::map<int, int> subjects;
  std::set<std::string> fine;
  std::vector<int> spans;
  for (const PlannedRecording& recording : recordings) {
    for (const CutClip& clip : recording.clips) {
      ++coarse[std::string(clip.variant->code).substr(0, 2)];
      ++subjects[recording.subject];
      fine.insert(clip.variant->code);
      spans.push_back(clip.last - clip.first + 1);
    }
  }
  EXPECT_EQ(spans.size(), 1191u);
  EXPECT_EQ(fine.size(), 34u);
  const std::map<std::string, int> published = {{"01", 215}, {"02", 47},  {"03", 50},  {"04", 94},
                                                {"05", 88},  {"06", 218}, {"07", 54},  {"08", 77},
                                                {"09", 56},  {"10", 61},  {"11", 140}, {"12", 91}};
  EXPECT_EQ(coarse, published);
  const std::vector<int> of_subject = {91, 96, 99, 93, 84, 85, 103, 98, 81, 89, 142, 130};
  for (int s = 1; s <= 12; ++s) EXPECT_EQ(subjects[s], of_subject[s - 1]) << s;
  // Real set: min 8, median 60, mean 77.4, max 471.
  std::sort(spans.begin(), spans.end());
  EXPECT_GE(spans.front(), 8);
  EXPECT_LE(spans.back(), 471);
  EXPECT_NEAR(spans[spans.size() / 2], 60, 3);
  EXPECT_NEAR(std::accumulate(spans.begin(), spans.end(), 0.0) / static_cast<double>(spans.size()), 77.4, 2.0);
}

TEST(HumanAct12Set, PlacesClipsInSequenceInTheirRecording) {
  for (const PlannedRecording& recording : Planned(1, 0, 0, {})) {
    int before = 0;
    for (std::size_t i = 0; i < recording.clips.size(); ++i) {
      const CutClip& clip = recording.clips[i];
      EXPECT_GE(clip.first, recording.script.actions[i].begin);
      EXPECT_LT(clip.last, recording.script.actions[i].end);
      EXPECT_GT(clip.first, before);
      before = clip.last;
      EXPECT_EQ(clip.variant->group, recording.group);
    }
    EXPECT_LT(before, recording.script.frames);
    EXPECT_LT(before, 10000) << "frame numbers have four digits";
  }
}

TEST(HumanAct12Set, KeepsTheSameClipsInASmallerSet) {
  const std::vector<PlannedRecording> all = Planned(1, 0, 0, {});
  const std::vector<PlannedRecording> some = Planned(1, 2, 0, {"walk"});
  ASSERT_EQ(some.size(), 8u);
  for (const PlannedRecording& recording : some) {
    for (const CutClip& clip : recording.clips) EXPECT_STREQ(clip.variant->label, "walk");
    const int span = recording.clips[0].last - recording.clips[0].first;
    const bool is_there = std::any_of(all.begin(), all.end(), [&](const PlannedRecording& other) {
      if (other.subject != recording.subject || other.time != recording.time) return false;
      return std::any_of(other.clips.begin(), other.clips.end(), [&](const CutClip& clip) {
        return clip.variant == recording.clips[0].variant && clip.last - clip.first == span;
      });
    });
    EXPECT_TRUE(is_there);
  }
}

class Variants : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto loaded = LoadSkeleton("smpl24");
    ASSERT_TRUE(loaded) << loaded.error().Message();
    skeleton = *loaded;
    subject = Cast(1, 4, *skeleton)[0];
  }

  /// One performance of four seconds at 60 Hz.
  Motion Perform(const std::string& action, bool seated = false) const {
    Script script;
    Manner manner;
    manner.active_s = 4.0;
    manner.cycles = NaturalPeriod(action) > 0.0 ? 4.0 / NaturalPeriod(action) : 1.0;
    manner.seated = seated;
    script.actions = {{action, 0, 240, manner}};
    script.frames = 240;
    return PerformScript(script, subject, skeleton, FrameRate{60, 1});
  }

  int Joint(const std::string& name) const { return *skeleton->FindJoint(name); }

  /// Largest distance in metres of a joint from its first position.
  static double Reach(const Motion& motion, int joint, int from) {
    double reach = 0.0;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Vector3d own = motion.joints.at(f, joint) - motion.joints.at(f, from);
      const Vector3d first = motion.joints.at(0, joint) - motion.joints.at(0, from);
      reach = std::max(reach, (own - first).norm());
    }
    return reach;
  }

  SkeletonPtr skeleton;
  Subject subject;
};

TEST_F(Variants, StayWithinHumanJointAndSpeedLimits) {
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    const Motion motion = Perform(variant.action, variant.seated > 0.5);
    EXPECT_TRUE(motion.Check()) << variant.action;
    double fastest = 0.0;
    for (int f = 1; f < motion.frame_count(); ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        fastest = std::max(fastest, (motion.joints.at(f, j) - motion.joints.at(f - 1, j)).norm() * 60.0);
        const auto& limits = skeleton->joints[j].limits;
        if (!limits) continue;
        const Vector3d vector = LogQuaternion(motion.rotation_at(f, j));
        for (int a = 0; a < 3; ++a) {
          EXPECT_GE(vector[a], limits->min[a] - 1e-6) << variant.action << " " << skeleton->joints[j].name;
          EXPECT_LE(vector[a], limits->max[a] + 1e-6) << variant.action << " " << skeleton->joints[j].name;
        }
      }
    }
    EXPECT_LT(fastest, 12.0) << variant.action;
    EXPECT_GT(fastest, 0.3) << variant.action;
  }
}

TEST_F(Variants, KeepThePersonOnTheFloor) {
  for (const HumanAct12Variant& variant : HumanAct12Variants()) {
    const std::string label = variant.label;
    const Motion motion = Perform(variant.action, variant.seated > 0.5);
    for (int f = 0; f < motion.frame_count(); ++f) {
      double lowest = 1e9;
      for (const char* name : {"left_foot", "right_foot", "left_ankle", "right_ankle"}) {
        lowest = std::min(lowest, motion.joints.at(f, Joint(name)).y());
      }
      EXPECT_GT(lowest, -0.02) << variant.action << " frame " << f;
      const bool flies = label == "jump" || label == "run";
      EXPECT_LT(lowest, flies ? 0.5 : 0.12) << variant.action << " frame " << f;
    }
  }
}

TEST_F(Variants, MoveTheNamedHand) {
  const int left = Joint("left_wrist"), right = Joint("right_wrist");
  const int left_shoulder = Joint("left_shoulder"), right_shoulder = Joint("right_shoulder");
  for (const auto& [action, leads_right] : std::map<std::string, bool>{{"drink_bottle_right", true},
                                                                       {"drink_bottle_left", false},
                                                                       {"lift_dumbbell_right", true},
                                                                       {"lift_dumbbell_left", false},
                                                                       {"eat_right", true},
                                                                       {"eat_left", false},
                                                                       {"phone_left", false},
                                                                       {"boxing_right_upwards", true},
                                                                       {"boxing_left_upwards", false}}) {
    const Motion motion = Perform(action);
    const double of_right = Reach(motion, right, right_shoulder), of_left = Reach(motion, left, left_shoulder);
    EXPECT_GT(leads_right ? of_right : of_left, 1.05 * (leads_right ? of_left : of_right)) << action;
    EXPECT_GT(leads_right ? of_right : of_left, 0.3) << action;
  }
}

TEST_F(Variants, BringADrinkingEatingOrCallingHandToTheHead) {
  for (const char* action : {"drink_bottle_right", "drink_cup_left", "eat_right", "eat_both_hands", "phone_left"}) {
    const Motion motion = Perform(action);
    double nearest = 1e9;
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (const char* hand : {"left_hand", "right_hand"}) {
        nearest = std::min(nearest, (motion.joints.at(f, Joint(hand)) - motion.joints.at(f, Joint("head"))).norm());
      }
    }
    EXPECT_LT(nearest, 0.20) << action;
  }
}

TEST_F(Variants, KeepTheThighsLevelWhenSitting) {
  const Motion motion = Perform("steering_wheel", true);
  const Vector3d thigh = motion.joints.at(120, Joint("left_knee")) - motion.joints.at(120, Joint("left_hip"));
  EXPECT_LT(std::abs(thigh.normalized().y()), 0.2);
}

TEST_F(Variants, JoinActionsWithoutJumps) {
  const PlannedRecording recording = Planned(3, 1, 2, {}).front();
  const Motion motion = PerformScript(recording.script, subject, skeleton, kRate);
  for (int f = 1; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      const double speed = (motion.joints.at(f, j) - motion.joints.at(f - 1, j)).norm() * 15.0;
      ASSERT_LT(speed, 12.0) << skeleton->joints[j].name << " frame " << f;
    }
  }
  // The subject ends at the start position with the initial orientation.
  const Vector3d gone = motion.root_translation.back() - motion.root_translation.front();
  EXPECT_LT(gone.norm(), 1.5);
  EXPECT_FALSE(Transitions(recording.script, kRate).empty());
}

}  // namespace
}  // namespace mocurate
