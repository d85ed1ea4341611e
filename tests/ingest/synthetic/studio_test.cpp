#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/store/store.h"
#include "ingest/discover.h"
#include "ingest/stages.h"
#include "ingest/synthetic/actions.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/studio.h"
#include "ingest/synthetic/tracker.h"
#include "tests/support/folders.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

SyntheticOptions SmallCapture() {
  SyntheticOptions options;
  options.actions = {"wave", "kick", "walk"};
  options.subjects = 4;
  options.repetitions = 2;
  return options;
}

SyntheticOptions PerfectTracker(SyntheticOptions options) {
  options.tracker.noise = 0.0;
  options.tracker.dropout_share = 0.0;
  options.tracker.outlier_share = 0.0;
  options.tracker.swap_share = 0.0;
  return options;
}

class Studio : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "capture"); }

  /// The clips of the stage `ingest` from the files of a capture, by clip id.
  std::map<std::string, Clip> Ingested(const SyntheticOptions& options) {
    std::map<std::string, Clip> clips;
    const auto files = CaptureFiles(options);
    EXPECT_TRUE(files) << files.error().Message();
    for (const auto& [name, text] : *files) EXPECT_TRUE(WriteFile(folder_ / "capture" / name, text));
    IngestOptions ingest;
    ingest.path = folder_ / "capture";
    ingest.source = StudioSource();
    const auto discovery = Discover(ingest);
    EXPECT_TRUE(discovery) << discovery.error().Message();
    EXPECT_TRUE(discovery->excluded.empty());
    for (const ItemSpec& item : discovery->items) {
      const StageRequest request{"ingest", item.item, item.options.Whole(), item.inputs, folder_ / "clip.h5", folder_};
      const auto outcome = IngestStage(request);
      EXPECT_TRUE(outcome) << outcome.error().Message();
      for (const Finding& finding : outcome->findings) {
        // The simulated tracker swaps limbs for two frames; outliers beside them may add a finding.
        const bool swap = finding.code == "swapped_sides" && finding.frame_end - finding.frame_begin <= 3;
        if (!swap) ADD_FAILURE() << item.item << ": " << finding.message;
      }
      auto clip = ReadEvidence(request.output);
      EXPECT_TRUE(clip) << clip.error().Message();
      const std::string id = clip->id();
      clips.emplace(id, std::move(*clip));
    }
    return clips;
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_ / "studio";
};

TEST_F(Studio, WritesTheSameBytesOnlyForTheSameSeed) {
  const auto first = CaptureFiles(SmallCapture());
  const auto again = CaptureFiles(SmallCapture());
  SyntheticOptions other = SmallCapture();
  other.seed = 2;
  const auto others = CaptureFiles(other);
  ASSERT_TRUE(first && again && others);
  EXPECT_EQ(first->size(), 3u * 4u * 2u);
  EXPECT_EQ(*first, *again);
  for (const auto& [name, text] : *first) EXPECT_NE(text, others->at(name)) << name;
}

TEST_F(Studio, WritesEachTakeIndependentlyOfTheOthers) {
  SyntheticOptions fewer = SmallCapture();
  fewer.actions = {"kick"};
  fewer.repetitions = 1;
  const auto all = CaptureFiles(SmallCapture());
  const auto few = CaptureFiles(fewer);
  ASSERT_TRUE(all && few);
  for (const auto& [name, text] : *few) EXPECT_EQ(text, all->at(name)) << name;
}

TEST_F(Studio, VariesStatureAndProportions) {
  const auto skeleton = LoadSkeleton("kinect20");
  ASSERT_TRUE(skeleton);
  const auto cast = Cast(SmallCapture().seed, SmallCapture().subjects, **skeleton);
  const int knee = *(*skeleton)->FindJoint("left_knee");
  const int elbow = *(*skeleton)->FindJoint("left_elbow");
  for (std::size_t a = 0; a < cast.size(); ++a) {
    for (std::size_t b = a + 1; b < cast.size(); ++b) {
      EXPECT_GT(std::abs(cast[a].bone_length[knee] - cast[b].bone_length[knee]), 1e-3);
      const double ratio_a = cast[a].bone_length[knee] / cast[a].bone_length[elbow];
      const double ratio_b = cast[b].bone_length[knee] / cast[b].bone_length[elbow];
      EXPECT_GT(std::abs(ratio_a - ratio_b), 1e-4);
    }
  }
}

TEST_F(Studio, RoundTripsNoiseFreeTracksToTheGroundTruth) {
  SyntheticOptions options = PerfectTracker(SmallCapture());
  options.actions = KnownActions();
  options.repetitions = 1;
  const auto clips = Ingested(options);
  const auto truth = SyntheticTruth(options);
  ASSERT_TRUE(truth) << truth.error().Message();
  ASSERT_EQ(truth->motion.size(), clips.size());
  for (const auto& [id, motion] : truth->motion) {
    ASSERT_EQ(clips.count(id), 1u) << id;
    EXPECT_TRUE(motion.Check()) << id;
    const JointTracks& tracks = *clips.at(id).evidence.tracks;
    ASSERT_EQ(tracks.positions.frames, motion.frame_count());
    for (std::size_t k = 0; k < tracks.names.size(); ++k) {
      const int joint = *motion.skeleton->FindJoint(tracks.names[k]);
      for (int f = 0; f < motion.frame_count(); ++f) {
        ASSERT_LT((tracks.positions.at(f, static_cast<int>(k)) - motion.joints.at(f, joint)).norm(), 1e-3) << id;
      }
    }
  }
}

TEST_F(Studio, ProducesTheErrorsOfTheTrackerOptions) {
  SyntheticOptions options = SmallCapture();
  options.repetitions = 4;
  const auto clips = Ingested(options);
  const auto truth = SyntheticTruth(options);
  ASSERT_TRUE(truth);
  double squares = 0.0;
  int samples = 0, near = 0, gross = 0, lost = 0;
  for (const auto& [id, motion] : truth->motion) {
    const JointTracks& tracks = *clips.at(id).evidence.tracks;
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int k = 0; k < tracks.positions.joints; ++k) {
        ++samples;
        if (tracks.confidence[static_cast<std::size_t>(f) * tracks.positions.joints + k] == 0.0) {
          ++lost;
          continue;
        }
        const double error =
            (tracks.positions.at(f, k) - motion.joints.at(f, *motion.skeleton->FindJoint(tracks.names[k]))).norm();
        if (error > 0.105) ++gross;
        if (error > 0.105) continue;
        ++near;
        squares += error * error;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / near), options.tracker.noise, 0.001);
  EXPECT_NEAR(static_cast<double>(lost) / samples, options.tracker.dropout_share, 0.01);
  EXPECT_NEAR(static_cast<double>(gross) / (samples - lost), options.tracker.outlier_share, 0.005);
}

TEST_F(Studio, ProducesPlausibleHumanMotion) {
  SyntheticOptions options = SmallCapture();
  options.actions = KnownActions();
  const auto truth = SyntheticTruth(options);
  ASSERT_TRUE(truth);
  for (const auto& [id, motion] : truth->motion) {
    const Skeleton& skeleton = *motion.skeleton;
    double fastest = 0.0, travelled = 0.0;
    for (int f = 1; f < motion.frame_count(); ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        const double speed = (motion.joints.at(f, j) - motion.joints.at(f - 1, j)).norm() * motion.rate.hz();
        fastest = std::max(fastest, speed);
        travelled = std::max(travelled, (motion.joints.at(f, j) - motion.joints.at(0, j)).norm());
      }
    }
    EXPECT_LT(fastest, 12.0) << id;
    EXPECT_GT(fastest, 0.6) << id;
    EXPECT_GT(travelled, 0.2) << id;
    // In the first frame the person faces the sensor: left hip at +x, toes towards +z.
    EXPECT_GT(motion.joints.at(0, *skeleton.FindJoint("left_hip")).x(),
              motion.joints.at(0, *skeleton.FindJoint("right_hip")).x());
    EXPECT_GT(motion.joints.at(0, *skeleton.FindJoint("left_foot")).z(),
              motion.joints.at(0, *skeleton.FindJoint("left_ankle")).z());
  }
}

TEST_F(Studio, KeepsTheStandingFootInPlace) {
  SyntheticOptions options = SmallCapture();
  options.actions = {"walk"};
  const auto truth = SyntheticTruth(options);
  ASSERT_TRUE(truth);
  for (const auto& [id, motion] : truth->motion) {
    const int toe[2] = {*motion.skeleton->FindJoint("left_foot"), *motion.skeleton->FindJoint("right_foot")};
    double slide = 0.0;
    for (int f = 1; f < motion.frame_count(); ++f) {
      double step[2];
      for (int side = 0; side < 2; ++side)
        step[side] = (motion.joints.at(f, toe[side]) - motion.joints.at(f - 1, toe[side])).norm();
      slide += std::min(step[0], step[1]);
    }
    EXPECT_LT(slide / motion.frame_count() * motion.rate.hz(), 0.35) << id;  // m/s of the slower foot
    EXPECT_GT((motion.root_translation.back() - motion.root_translation.front()).norm(), 0.8) << id;
  }
}

TEST_F(Studio, CapturesOnlyTrackerOutput) {
  const StageRequest request{"capture", "capture", OptionsToJson(SmallCapture()), {}, folder_ / "capture.json",
                             folder_};
  const auto outcome = CaptureStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const auto text = ReadFile(request.output);
  ASSERT_TRUE(text);
  const auto artifact = nlohmann::json::parse(*text);
  ASSERT_EQ(artifact.size(), 1u);
  for (const auto& [name, content] : artifact.at("files").items()) {
    EXPECT_EQ(content.get<std::string>().find_first_not_of("0123456789.-e \n"), std::string::npos) << name;
  }
  const auto perfect = CaptureFiles(PerfectTracker(SmallCapture()));
  ASSERT_TRUE(perfect);
  for (const auto& [name, content] : artifact.at("files").items()) EXPECT_NE(content, perfect->at(name));
  EXPECT_EQ(outcome->summary.dump().find("noise"), std::string::npos);
}

TEST_F(Studio, WritesTheGroundTruthOfACaptureInTheTruthStage) {
  const nlohmann::json options = {{"synthetic", OptionsToJson(SmallCapture())}};
  const StageRequest request{"truth", "truth", options, {}, folder_ / "truth.h5", folder_};
  const auto outcome = TruthStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const auto truth = ReadTruth(request.output);
  ASSERT_TRUE(truth) << truth.error().Message();
  EXPECT_EQ(truth->motion.size(), 24u);
}

TEST_F(Studio, DeclaresTheDemoFilesCorrectly) {
  const auto node = LoadConfig(fs::path(kSourceFolder) / "configs/demo.yaml");
  ASSERT_TRUE(node) << node.error().Message();
  const ConfigNode* ingest = node->Find("ingest");
  ASSERT_NE(ingest, nullptr);
  const auto options = OptionsFromConfig<IngestOptions>(*ingest);
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(OptionsToJson(options->source), OptionsToJson(StudioSource()));
  EXPECT_TRUE(options->synthetic.enabled);
  EXPECT_EQ(*options->source.rate_hz, options->synthetic.rate_hz);
  EXPECT_GE(options->synthetic.actions.size(), 6u);
  EXPECT_GE(options->synthetic.subjects, 4);
}

TEST_F(Studio, SuggestsTheNearestActionForAnUnknownOne) {
  SyntheticOptions options = SmallCapture();
  options.actions = {"wawe"};
  const auto files = CaptureFiles(options);
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().code, ErrorCode::kConfig);
  EXPECT_THAT(files.error().Message(), ::testing::HasSubstr("'wave'"));
}

}  // namespace
}  // namespace mocurate
