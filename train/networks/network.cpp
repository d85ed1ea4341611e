#include "train/networks/network.h"

#include "core/base/random.h"
#include "train/data/batches.h"
#include "train/networks/act_mocogan.h"
#include "train/networks/action2motion.h"
#include "train/networks/actor.h"
#include "train/networks/cond_gru.h"
#include "train/networks/gru_recogniser.h"
#include "train/networks/macvae.h"
#include "train/networks/ssmct.h"
#include "train/networks/st_gcn.h"
#include "train/networks/two_stage_gan.h"

namespace mocurate {

std::vector<int> Network::Phases(std::int64_t /*step*/, std::int64_t /*steps*/) const { return {0}; }

ValidationScore Network::Validate(const Batch& /*batch*/) { return {}; }

OptimiserGroup AdamGroup(const torch::nn::Module& module, double learning_rate, double weight_decay) {
  return {"adam", module.parameters(), OptimiserGroup::Rule::kAdam, learning_rate, weight_decay};
}

OptimiserGroup AdamWGroup(const torch::nn::Module& module, double learning_rate, double weight_decay) {
  return {"adamw", module.parameters(), OptimiserGroup::Rule::kAdamW, learning_rate, weight_decay};
}

ValidationScore ScoreOf(const torch::Tensor& logits, const torch::Tensor& label) {
  const torch::Tensor of_label = torch::log_softmax(logits, 1).gather(1, label.unsqueeze(1));
  return {(logits.argmax(1) == label).sum().item<double>(), -of_label.to(torch::kFloat64).sum().item<double>()};
}

std::shared_ptr<Network> MakeNetwork(const NetworkOptions& options, const NetworkSizes& sizes) {
  Random key(options.seed(), "network.initial");
  torch::manual_seed((static_cast<std::uint64_t>(key.Next()) << 32) | key.Next());
  switch (options.kind) {
    case NetworkKind::kGruRecogniser:
      return std::make_shared<GruRecogniser>(options.recogniser, options.learning, sizes);
    case NetworkKind::kAction2Motion:
      return std::make_shared<Action2Motion>(options.action2motion, options.learning, sizes);
    case NetworkKind::kCondGru:
      return std::make_shared<CondGru>(options.cond_gru, options.learning, sizes);
    case NetworkKind::kActMoCoGan:
      return std::make_shared<ActMoCoGan>(options.act_mocogan, options.learning, sizes);
    case NetworkKind::kTwoStageGan:
      return std::make_shared<TwoStageGan>(options.two_stage_gan, options.learning, sizes);
    case NetworkKind::kActor:
      return std::make_shared<Actor>(options.actor, options.learning, options.data, sizes);
    case NetworkKind::kStGcn:
      return std::make_shared<StGcn>(options.st_gcn, options.learning, sizes);
    case NetworkKind::kMacvae:
      return std::make_shared<Macvae>(options.macvae, options.learning, options.data, sizes);
    case NetworkKind::kSsmct:
      return std::make_shared<Ssmct>(options.ssmct, options.learning, options.data, sizes);
  }
  return nullptr;
}

NetworkSizes SizesOf(const Skeleton& skeleton, std::size_t classes, const std::vector<Vector3d>& rest_offset) {
  NetworkSizes sizes;
  sizes.joints = skeleton.joint_count();
  sizes.classes = static_cast<int>(classes);
  sizes.chains = ChainsOf(skeleton);
  for (const Joint& joint : skeleton.joints) {
    sizes.parents.push_back(joint.parent);
    sizes.rest_offset.push_back(joint.rest_offset);
  }
  if (!rest_offset.empty()) sizes.rest_offset = rest_offset;
  return sizes;
}

torch::Tensor OneHot(const torch::Tensor& label, std::int64_t classes) {
  return torch::one_hot(label, classes).to(torch::kFloat32);
}

}  // namespace mocurate
