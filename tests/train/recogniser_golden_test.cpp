#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/formats/npy.h"
#include "tests/support/golden.h"
#include "train/recognisers/recogniser.h"

namespace mocurate {
namespace {

struct PublishedSet {
  std::string data, run, weights, joints;
  int frames, dim, classes;
};

const PublishedSet kSets[] = {
    {"humanact12", "vanila_vae_tf", "action_recognition_model_humanact12.tar", "motion_joints500000.npy", 60, 72, 12},
    {"ntu_rgbd_vibe", "vanila_vae_tf_2", "action_recognition_model_vibe_v2.tar", "motion_joints300000.npy", 60, 54, 13},
    {"mocap", "vanila_vae_tf_2", "action_recognition_model_mocap_new.tar", "motion_joints210000.npy", 100, 60, 8},
};

std::vector<float> Motions(const PublishedSet& set) {
  const auto bytes = ReadFile(golden::PathOf("published/" + set.data + "/" + set.run + "/" + set.joints));
  const Expected<NpyArray> array = ParseNpy(*bytes, set.joints);
  return std::vector<float>(array->values.begin(), array->values.end());
}

double Worst(const std::vector<float>& a, const std::vector<float>& b) {
  double worst = a.size() == b.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double difference = std::fabs(static_cast<double>(a[i]) - b[i]);
    worst = difference <= worst ? worst : difference;
  }
  return worst;
}

void AtOrigin(const PublishedSet& set, std::vector<float>& motions) {
  const std::size_t size = static_cast<std::size_t>(set.frames) * set.dim;
  for (std::size_t n = 0; n < motions.size() / size; ++n) {
    const float root[3] = {motions[n * size], motions[n * size + 1], motions[n * size + 2]};
    for (std::size_t i = 0; i < size; ++i) motions[n * size + i] -= root[i % 3];
  }
}

TEST(RecogniserGolden, PublishedWeightsGiveThePublishedLogits) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("recogniser.h5"));
  for (const PublishedSet& set : kSets) {
    const auto recogniser = Recogniser::LoadPublished(golden::PathOf("published/" + set.weights));
    ASSERT_TRUE(recogniser) << recogniser.error().Message();
    ASSERT_EQ((*recogniser)->class_count(), set.classes);
    std::vector<float> motions = Motions(set);
    for (const std::string placed : {"as_stored", "first_root_at_origin"}) {
      if (placed == "first_root_at_origin") AtOrigin(set, motions);
      for (const std::string start : {"h0_zero", "h0_randn"}) {
        RecogniserHidden hidden;
        if (start == "h0_randn") hidden.given = file.Floats(set.data + "/h0_randn_hidden").values;
        const auto output = (*recogniser)->Run(motions.data(), 20, set.frames, set.dim, hidden);
        ASSERT_TRUE(output) << output.error().Message();
        const std::string group = set.data + "/" + set.run + "/" + placed + "/" + start;
        EXPECT_LE(Worst(output->logits, file.Floats(group + "/logits").values), 5e-5) << group;
        EXPECT_LE(Worst(output->features, file.Floats(group + "/features30").values), 5e-5) << group;
        const auto predicted = file.Integers(group + "/pred");
        for (int i = 0; i < 20; ++i) EXPECT_EQ(output->Predicted(i), predicted[i]) << group << " " << i;
      }
    }
  }
}

TEST(RecogniserGolden, AMotionOfVariableLengthEndsAtItsLastFrame) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("recogniser.h5"));
  const PublishedSet& set = kSets[0];
  const auto recogniser = Recogniser::LoadPublished(golden::PathOf("published/" + set.weights));
  ASSERT_TRUE(recogniser) << recogniser.error().Message();
  std::vector<int> lengths;
  for (const std::int64_t length : file.Integers("actor_variable_length/lengths").values) {
    lengths.push_back(static_cast<int>(length));
  }
  const std::vector<float> motions = Motions(set);
  for (const std::string start : {"h0_zero", "h0_randn"}) {
    RecogniserHidden hidden;
    if (start == "h0_randn") hidden.given = file.Floats("humanact12/h0_randn_hidden").values;
    const auto output = (*recogniser)->Run(motions.data(), 20, 60, 72, hidden, lengths);
    ASSERT_TRUE(output) << output.error().Message();
    const std::string group = "actor_variable_length/" + start;
    EXPECT_LE(Worst(output->logits, file.Floats(group + "/logits").values), 5e-5) << group;
    EXPECT_LE(Worst(output->features, file.Floats(group + "/features30").values), 5e-5) << group;
  }
}

TEST(RecogniserGolden, MotionsOfAnotherSkeletonAreRefused) {
  MOCURATE_NEEDS_GOLDENS();
  const auto recogniser = Recogniser::LoadPublished(golden::PathOf("published/" + kSets[0].weights));
  ASSERT_TRUE(recogniser) << recogniser.error().Message();
  const std::vector<float> motion(60 * 54, 0.0f);
  const auto output = (*recogniser)->Run(motion.data(), 1, 60, 54);
  ASSERT_FALSE(output);
  EXPECT_NE(output.error().what.find("54"), std::string::npos) << output.error().what;
  EXPECT_NE(output.error().what.find("72"), std::string::npos) << output.error().what;
}

}  // namespace
}  // namespace mocurate
