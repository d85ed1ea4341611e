// Scripts become long motions: each step continues the one before, at any position.

#include "train/generators/long_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "core/motion/operations.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/checkpoint/checkpoint.h"
#include "train/trainer/trainer.h"

namespace mocurate {
namespace {

/// Barely trained networks of every kind that generates scripts, once for the suite.
class LongMotion : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<ScratchFolder>();
    folder_ = *scratch_;
    samples_ = SampleDataset(3);
    for (const auto& [name, options] : Networks()) {
      const auto set = PackTrainingSet(samples_, NeedsOf(options));
      ASSERT_TRUE(set) << set.error().Message();
      const auto trained = TrainNetwork(*set, options, {});
      ASSERT_TRUE(trained) << name << ": " << trained.error().Message();
      ASSERT_TRUE(WriteCheckpoint(*trained, folder_ / (name + ".h5")));
    }
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static std::map<std::string, NetworkOptions> Networks() {
    NetworkOptions macvae(NetworkKind::kMacvae), actor(NetworkKind::kActor), ssmct(NetworkKind::kSsmct);
    macvae.macvae.width = ssmct.ssmct.width = actor.actor.latent = 16;
    macvae.macvae.layers = ssmct.ssmct.layers = actor.actor.layers = 1;
    macvae.macvae.feed_forward = ssmct.ssmct.feed_forward = actor.actor.feed_forward = 16;
    macvae.macvae.fill = FillChoice::kLast;
    actor.data.part = ClipPart::kAction;
    actor.data.input = RecogniserInputKind::kWhole;
    for (NetworkOptions* network : {&macvae, &actor, &ssmct}) {
      network->data.frames = 40;
      network->learning.iterations = 3;
      network->learning.batch = 4;
    }
    NetworkOptions released = macvae, zero = macvae, whole = macvae, one = macvae;
    released.macvae.fill = FillChoice::kReleased;
    zero.macvae.canonical = CanonicalChoice::kZero;
    whole.macvae.whole_previous = true;
    one.macvae.separate_latents = false;
    one.macvae.protocol = Protocol::kPaper;
    return {{"macvae", macvae}, {"released", released}, {"zero", zero},  {"whole", whole},
            {"one", one},       {"actor", actor},       {"ssmct", ssmct}};
  }

  static std::shared_ptr<const MotionGenerator> Load(const std::string& name) {
    auto loaded = MotionGenerator::Load(folder_ / (name + ".h5"));
    EXPECT_TRUE(loaded) << loaded.error().Message();
    return std::move(*loaded);
  }

  static LongMotionNetworks With(const std::string& main, const std::string& first = "", const std::string& fill = "") {
    LongMotionNetworks networks;
    networks.main = Load(main);
    if (!first.empty()) networks.first = Load(first);
    if (!fill.empty()) networks.fill = Load(fill);
    return networks;
  }

  /// The previous action of a sample.
  static std::shared_ptr<const Clip> PreviousOf(std::size_t row) {
    const Clip& clip = samples_.clips[row];
    return std::make_shared<const Clip>(*Cut(clip, 0, PartsOf(clip)->frames[0]));
  }

  static MotionRequest Continuing(std::size_t row, std::vector<ScriptStep> script) {
    MotionRequest request;
    request.seed = 7 + row;
    request.script = std::move(script);
    request.previous = PreviousOf(row);
    request.previous_clip = request.previous->id();
    request.frames = request.previous->motion->frame_count();
    return request;
  }

  static inline std::unique_ptr<ScratchFolder> scratch_;
  static std::filesystem::path folder_;
  static Dataset samples_;
};

std::filesystem::path LongMotion::folder_;
Dataset LongMotion::samples_;

TEST_F(LongMotion, HasAllPartsOfItsScriptAndIsAMotion) {
  for (const auto& [main, first, fill] :
       {std::tuple("macvae", "actor", ""), std::tuple("released", "actor", ""), std::tuple("zero", "actor", ""),
        std::tuple("whole", "actor", ""), std::tuple("one", "actor", ""), std::tuple("actor", "", "ssmct"),
        std::tuple("actor", "", "")}) {
    MotionRequest request;
    request.label = 2;
    request.frames = 9;
    request.seed = 3;
    request.script = {{0, 4, 11}, {1, 3, 8}, {2, 5, 7}};
    const auto set = GenerateLongMotions(With(main, first, fill), {request});
    ASSERT_TRUE(set) << main << ": " << set.error().Message();
    const Clip& clip = set->clips[0];
    EXPECT_EQ(clip.motion->frame_count(), 9 + 15 + 11 + 12);
    EXPECT_EQ(request.answered_frames(), clip.motion->frame_count());
    EXPECT_TRUE(clip.motion->Check()) << main;
    for (int f = 1; f < clip.motion->frame_count(); ++f) {
      for (int j = 0; j < 5; ++j) {
        EXPECT_GE(clip.motion->rotation_at(f, j).dot(clip.motion->rotation_at(f - 1, j)), 0.0) << main << " " << f;
      }
    }
    ASSERT_EQ(clip.segments.size(), 7u);
    EXPECT_EQ(clip.segments[3].label, "transition");
    EXPECT_EQ(clip.segments[4].label, "quick");
    EXPECT_NEAR(clip.segments[4].begin_s, clip.rate.FrameTime(9 + 15 + 3), 1e-9);
    EXPECT_TRUE(WriteDataset(*set, folder_ / "made.h5"));
  }
}

TEST_F(LongMotion, MovesWithTheMotionThatItContinues) {
  const LongMotionNetworks networks = With("macvae");
  MotionRequest request = Continuing(1, {{0, 4, 10}, {2, 4, 8}});
  const auto still = GenerateLongMotions(networks, {request});
  RigidTransform moved;
  moved.rotation = Quaterniond(Eigen::AngleAxisd(1.1, Vector3d::UnitY()));
  moved.translation = Vector3d(3.0, 0.2, -1.0);
  Clip previous = *request.previous;
  Transform(moved, previous);
  request.previous = std::make_shared<const Clip>(previous);
  const auto turned = GenerateLongMotions(networks, {request});
  ASSERT_TRUE(still && turned);
  for (const int frame : {0, 5, 20}) {
    for (int j = 0; j < 5; ++j) {
      const Vector3d wanted = moved * Vector3d(still->clips[0].motion->joints.at(frame, j));
      EXPECT_LT((wanted - Vector3d(turned->clips[0].motion->joints.at(frame, j))).norm(), 2e-4) << frame << " " << j;
    }
  }
}

TEST_F(LongMotion, SnappedPartsBeginWhereTheLastFrameStands) {
  LongMotionNetworks networks = With("macvae");
  const MotionRequest request = Continuing(1, {{0, 4, 10}});
  const Motion before = *request.previous->motion;
  for (const bool snap : {true, false}) {
    networks.snap = snap;
    const auto set = GenerateLongMotions(networks, {request});
    ASSERT_TRUE(set);
    const double apart = (set->clips[0].motion->root_translation[0] - before.root_translation.back()).norm();
    EXPECT_EQ(apart < 1e-9, snap) << apart;
  }
}

TEST_F(LongMotion, DoesNotDependOnThreadsOrNeighbours) {
  const LongMotionNetworks networks = With("macvae");
  std::vector<MotionRequest> requests;
  for (std::size_t row = 0; row < 600; ++row) {  // more than are worked on at once
    requests.push_back(Continuing(row % 9, {{static_cast<int>(row % 3), 4, 9}}));
    requests.back().seed = row;
  }
  const auto one = GenerateLongMotions(networks, requests, 1), three = GenerateLongMotions(networks, requests, 3);
  ASSERT_TRUE(one && three);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    EXPECT_EQ(one->clips[i].motion->joints.xyz, three->clips[i].motion->joints.xyz);
  }
  const auto alone = GenerateLongMotions(networks, {requests[4]});
  for (std::size_t k = 0; k < alone->clips[0].motion->joints.xyz.size(); ++k) {
    ASSERT_NEAR(alone->clips[0].motion->joints.xyz[k], one->clips[4].motion->joints.xyz[k], 1e-4);
  }
}

TEST_F(LongMotion, InterpolationGoesEvenlyAndAlignmentJoinsHeadingsAndPlaces) {
  const Motion before = *PreviousOf(1)->motion;
  Motion after = *PreviousOf(2)->motion;
  const Motion between = Between(before, after, 3);
  EXPECT_TRUE(between.Check());
  const Vector3d from = before.root_translation.back(), to = after.root_translation.front();
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((between.root_translation[static_cast<std::size_t>(k)] - (from + 0.25 * (k + 1) * (to - from))).norm(),
              1e-12);
  }
  const double whole = before.rotation_at(before.frame_count() - 1, 1).angularDistance(after.rotation_at(0, 1));
  EXPECT_NEAR(between.rotation_at(1, 1).angularDistance(after.rotation_at(0, 1)), 0.5 * whole, 1e-9);
  const RigidTransform aligned = AlignedTo(before, after, 4);
  const Vector3d place = aligned * after.root_translation.front();
  EXPECT_NEAR(place.x(), from.x() + 4 * 0.01, 1e-9);  // it continues by 1 cm a frame
  EXPECT_NEAR(place.y(), after.root_translation.front().y(), 1e-9);
  EXPECT_LT(
      (aligned.rotation * after.rotation_at(0, 0)).angularDistance(before.rotation_at(before.frame_count() - 1, 0)),
      1e-6);
}

TEST_F(LongMotion, RefusesWhatItsNetworksCannotAnswer) {
  const auto refused = [&](const LongMotionNetworks& networks, const MotionRequest& request) {
    const auto set = GenerateLongMotions(networks, {request});
    EXPECT_FALSE(set);
    return set ? Error() : set.error();
  };
  const LongMotionNetworks networks = With("macvae");
  EXPECT_EQ(refused(networks, Continuing(1, {{0, 4, 10}, {9, 4, 8}})).where, "request 0, step 2");
  EXPECT_EQ(refused(networks, Continuing(1, {{0, 39, 10}})).code, ErrorCode::kInconsistent);  // the table ends at 38
  EXPECT_EQ(refused(networks, Continuing(1, {{0, 4, 3}, {1, 4, 8}})).where, "request 0, step 2");  // 4 are read
  EXPECT_EQ(refused(networks, Continuing(1, {{0, 20, 17}})).code, ErrorCode::kInconsistent);  // 41 with the 4 before
  MotionRequest alone;
  alone.label = 0;
  alone.frames = 9;
  alone.script = {{1, 4, 9}};
  EXPECT_EQ(refused(networks, alone).code, ErrorCode::kInconsistent);  // no network generates the first action
  MotionRequest other = Continuing(1, {{0, 4, 10}});
  Clip faster = *other.previous;
  faster.motion->rate.numerator *= 2;
  other.previous = std::make_shared<const Clip>(faster);
  EXPECT_EQ(refused(networks, other).code, ErrorCode::kInconsistent);  // another rate
  auto longer = std::make_shared<Skeleton>(*samples_.skeleton);
  longer->joints.push_back(longer->joints.back());
  faster = *Continuing(1, {}).previous;
  faster.motion->skeleton = faster.motion->rotation_reference = longer;
  other.previous = std::make_shared<const Clip>(faster);
  EXPECT_EQ(refused(networks, other).code, ErrorCode::kInconsistent);  // another skeleton
  other = Continuing(1, {{0, 4, 10}});
  other.bone_length = {0.0, 1.0};
  EXPECT_EQ(refused(networks, other).code, ErrorCode::kInconsistent);
  EXPECT_EQ(refused(With("ssmct"), alone).code, ErrorCode::kInconsistent);
  EXPECT_EQ(refused(With("macvae", "ssmct"), alone).code, ErrorCode::kInconsistent);
  EXPECT_EQ(refused(With("actor", "", "actor"), alone).code, ErrorCode::kInconsistent);
  EXPECT_TRUE(GenerateLongMotions(With("actor"), {alone}));
  alone.script.clear();
  EXPECT_EQ(refused(networks, alone).code, ErrorCode::kInconsistent);  // a label alone
}

TEST_F(LongMotion, KeepsUsualLengthsOfEachClass) {
  const auto network = ReadCheckpoint(folder_ / "macvae.h5");
  ASSERT_TRUE(network);
  const nlohmann::json& usual = network->facts.at("part_frames");
  ASSERT_EQ(usual.size(), 3u);
  EXPECT_EQ(usual[0][0], 4);
  double sum = 0.0, count = 0.0;
  for (const int row : samples_.splits[0].train) {
    const Clip& clip = samples_.clips[static_cast<std::size_t>(row)];
    if (clip.label != "slow") continue;
    sum += PartsOf(clip)->frames[2];
    ++count;
  }
  EXPECT_EQ(usual[0][1], static_cast<int>(sum / count));
}

TEST(TrainingSamples, HaveWordsInAnOrderThatNoClipMoves) {
  Dataset set = SampleDataset(1);
  set.clips[3].segments[0].label = "arrive";
  const auto packed = PackTrainingSet(set, {true, true});
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->words, (std::vector<std::string>{"slow", "quick", "walk", "transition", "arrive", "bow"}));
  EXPECT_EQ(packed->clips[3].word[0], 4);
  EXPECT_EQ(packed->clips[3].word[1], 3);
  EXPECT_EQ(packed->clips[3].word[2], packed->clips[3].label);
}

TEST(TrainingSamples, AreRefusedWhereTheyAreNone) {
  const auto code = [](Dataset set) {
    const auto packed = PackTrainingSet(set, {true, true});
    return packed ? ErrorCode::kInternal : packed.error().code;
  };
  EXPECT_EQ(code(TurningDataset(1)), ErrorCode::kInconsistent);  // no segments
  Dataset gap = SampleDataset(1);
  gap.clips[2].segments[1].begin_s += 0.2;
  EXPECT_EQ(code(gap), ErrorCode::kInconsistent);
  Dataset bare = SampleDataset(1);
  bare.clips[2].segments.erase(bare.clips[2].segments.begin());
  EXPECT_EQ(code(bare), ErrorCode::kInconsistent);  // nothing before the transition
  NetworkOptions options(NetworkKind::kMacvae);
  options.data.frames = 16;  // clips have 20 to 31
  const auto samples = PackTrainingSet(SampleDataset(1), {true, true});
  const auto trained = TrainNetwork(*samples, options, {});
  ASSERT_FALSE(trained);
  EXPECT_EQ(trained.error().code, ErrorCode::kInconsistent);
}

TEST(TrainingSamples, OfOnePartAreThatPart) {
  const Dataset set = SampleDataset(1);
  const auto whole = PackTrainingSet(set, {true}), action = PackTrainingSet(set, {true, false, ClipPart::kAction});
  ASSERT_TRUE(whole && action);
  const ActionParts parts = *PartsOf(set.clips[0]);
  EXPECT_EQ(action->clips[0].frames, parts.frames[2]);
  const auto skipped = static_cast<std::size_t>(parts.frames[0] + parts.frames[1]);
  EXPECT_EQ(action->joints[0], whole->joints[skipped * 15]);
  EXPECT_EQ(action->rotation[7], whole->rotation[skipped * 20 + 7]);
}

}  // namespace
}  // namespace mocurate
