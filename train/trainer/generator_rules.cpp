#include "train/trainer/generator_rules.h"

#include "train/data/training_clips.h"

namespace mocurate {

double SelfFeedProbability(const GeneratorOptions& options) {
  if (options.self_feed_probability) return *options.self_feed_probability;
  return options.protocol == Protocol::kReleased ? 0.6 : 0.4;
}

Action2MotionConfig ConfigOf(const GeneratorOptions& options, const Skeleton& skeleton, int classes) {
  const bool released = options.protocol == Protocol::kReleased;
  Action2MotionConfig config;
  config.joints = skeleton.joint_count();
  config.classes = classes;
  config.hidden = static_cast<int>(options.hidden);
  config.latent = static_cast<int>(options.latent);
  if (options.lie) config.lie = ChainsOf(skeleton);
  config.exp = options.lie_exp == LieExpChoice::kReleased ? LieExp::kReleased : LieExp::kExact;
  switch (options.time_counter) {
    case TimeChoice::kProtocol:
      config.time_counter = !options.lie ? TimeCounter::kNone : released ? TimeCounter::kReleased : TimeCounter::kPaper;
      break;
    case TimeChoice::kNone:
      config.time_counter = TimeCounter::kNone;
      break;
    case TimeChoice::kReleased:
      config.time_counter = TimeCounter::kReleased;
      break;
    case TimeChoice::kPaper:
      config.time_counter = TimeCounter::kPaper;
      break;
  }
  const bool raw = options.feedback == FeedbackChoice::kProtocol ? released : options.feedback == FeedbackChoice::kRaw;
  config.feedback = raw ? Feedback::kRaw : Feedback::kJoints;
  const bool mean =
      options.reconstruction == LossChoice::kProtocol ? released : options.reconstruction == LossChoice::kMean;
  config.reconstruction = mean ? Reconstruction::kMean : Reconstruction::kSquaredNorm;
  config.kl_weight = options.kl_weight ? *options.kl_weight : !released ? 0.01 : options.lie ? 1e-3 : 1e-4;
  return config;
}

Expected<Action2MotionConfig> ConfigOf(const Checkpoint& checkpoint, const std::string& where) {
  const Expected<GeneratorOptions> options = OptionsFromJson<GeneratorOptions>(checkpoint.options, where);
  if (!options) return Forward(options);
  if (checkpoint.skeleton == nullptr || checkpoint.labels.empty()) {
    return Fail(ErrorCode::kInconsistent, "the checkpoint has no skeleton or no labels", where);
  }
  const Action2MotionConfig config =
      ConfigOf(*options, *checkpoint.skeleton, static_cast<int>(checkpoint.labels.size()));
  ParameterList expected = Action2MotionParameters(config);
  if (Status fits = CopyValues(checkpoint.parameters, where, expected); !fits) return Forward(fits);
  return config;
}

}  // namespace mocurate
