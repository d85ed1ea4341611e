// Requests for networks that generate scripts, and the scored part of a generated motion.

#include "eval/protocols/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "core/motion/action_parts.h"
#include "core/motion/operations.h"
#include "tests/train/toy_dataset.h"

namespace mocurate {
namespace {

FeaturesOptions Asking(ScriptDraw script, std::int64_t motions = 0) {
  FeaturesOptions options;
  options.script = script;
  options.motions = motions;
  options.replacement = false;
  return options;
}

std::vector<int> EveryRow(const Dataset& set) {
  std::vector<int> rows(set.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

TEST(Scripts, AskForEachSampleOnceAfterItsOwnPreviousMotion) {
  const Dataset set = SampleDataset(1);
  const auto requests = DrawScripts(set, EveryRow(set), EveryRow(set), Asking(ScriptDraw::kAfterSample), 0);
  ASSERT_TRUE(requests) << requests.error().Message();
  std::set<std::string> asked;
  for (const MotionRequest& request : *requests) {
    asked.insert(request.previous_clip);
    const auto clip = std::find_if(set.clips.begin(), set.clips.end(),
                                   [&](const Clip& one) { return one.id() == request.previous_clip; });
    const ActionParts parts = *PartsOf(*clip);
    EXPECT_EQ(request.previous->motion->frame_count(), parts.frames[0]);
    ASSERT_EQ(request.script.size(), 1u);
    EXPECT_EQ(request.script[0].label, set.LabelIndex(clip->label));
    EXPECT_EQ(request.script[0].transition_frames, parts.frames[1]);
    EXPECT_EQ(request.script[0].frames, parts.frames[2]);
  }
  EXPECT_EQ(asked.size(), set.clips.size());
}

TEST(Scripts, AfterGeneratedMotionsHaveAClassAsPreviousAction) {
  const Dataset set = SampleDataset(2);  // every fourth previous action is "bow", no class
  const auto requests = DrawScripts(set, EveryRow(set), EveryRow(set), Asking(ScriptDraw::kAfterGenerated), 0);
  ASSERT_TRUE(requests);
  for (const MotionRequest& request : *requests) {
    EXPECT_EQ(request.previous, nullptr);
    // In the set slow follows quick, quick walk, walk slow.
    EXPECT_EQ(request.label, (request.script[0].label + 1) % 3);
  }
}

TEST(Scripts, ChainsFollowWhatTheSamplesSay) {
  const Dataset set = SampleDataset(2);
  FeaturesOptions options = Asking(ScriptDraw::kChain, 50);
  options.steps = 5;
  options.step = 5;
  const auto requests = DrawScripts(set, EveryRow(set), EveryRow(set), options, 0),
             again = DrawScripts(set, EveryRow(set), EveryRow(set), options, 0);
  const auto other = DrawScripts(set, EveryRow(set), EveryRow(set), options, 1);
  ASSERT_TRUE(requests && again && other);
  ASSERT_EQ(requests->size(), 50u);
  std::set<int> first;
  bool differs = false;
  for (std::size_t i = 0; i < 50; ++i) {
    const MotionRequest& request = (*requests)[i];
    first.insert(request.label);
    int before = request.label;
    ASSERT_EQ(request.script.size(), 4u) << "the first of five steps precedes the script";
    for (const ScriptStep& step : request.script) {
      EXPECT_EQ((step.label + 1) % 3, before) << "an action follows its predecessor in a sample";
      EXPECT_EQ(step.transition_frames, 4);
      before = step.label;
    }
    EXPECT_EQ(request.seed, (*again)[i].seed);
    differs = differs || request.seed != (*other)[i].seed;
  }
  EXPECT_EQ(first.size(), 3u);
  EXPECT_TRUE(differs);
  options.step = 2;
  EXPECT_EQ((*DrawScripts(set, EveryRow(set), EveryRow(set), options, 0))[7].script.size(), 1u);
}

TEST(Scripts, RefuseClipsThatAreNoSamples) {
  const Dataset set = TurningDataset(1);
  const auto requests = DrawScripts(set, EveryRow(set), EveryRow(set), Asking(ScriptDraw::kAfterSample), 0);
  ASSERT_FALSE(requests);
  EXPECT_EQ(requests.error().code, ErrorCode::kInconsistent);
}

TEST(Scripts, AStepIsScoredInTheFrameOfWhatCameBeforeIt) {
  const Dataset set = SampleDataset(1);
  MotionRequest request;
  request.frames = 6;
  request.script = {{0, 4, 5}, {1, 3, 2}};
  Motion answer = *set.clips[4].motion;  // faces elsewhere
  const Motion action = StepOfAnswer(answer, request, 1, ClipPart::kAction);
  EXPECT_EQ(action.frame_count(), 5);
  // The frame before the transition stands at the origin and faces +z: the root's rotation is about the vertical alone.
  const Quaterniond anchor = answer.rotation_at(5, 0);
  EXPECT_LT((anchor.conjugate() * answer.rotation_at(10, 0)).angularDistance(action.rotation_at(0, 0)), 1e-9);
  const Vector3d moved = anchor.conjugate() * Vector3d(answer.root_translation[10] - answer.root_translation[5]);
  EXPECT_LT((moved - action.root_translation[0]).norm(), 1e-9);
  EXPECT_EQ(StepOfAnswer(answer, request, 2, ClipPart::kTransition).frame_count(), 3);
  EXPECT_EQ(StepOfAnswer(answer, request, 0, ClipPart::kAction).frame_count(), 6) << "the first action";
  // With a previous motion the answer begins behind it.
  Clip previous = *Cut(set.clips[4], 0, 6);
  Clip rest = *Cut(set.clips[4], 6, 20);
  request.previous = std::make_shared<const Clip>(previous);
  const Motion same = StepOfAnswer(*rest.motion, request, 1, ClipPart::kAction);
  for (std::size_t k = 0; k < same.joints.xyz.size(); ++k) EXPECT_NEAR(same.joints.xyz[k], action.joints.xyz[k], 1e-9);
}

}  // namespace
}  // namespace mocurate
