#include "tests/train/network_parts.h"

#include <vector>

#include "train/layers/gru_layer.h"
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

using torch::Tensor;

NamedTensors NetworkParts::Of(Network& network, const NamedTensors& inputs) {
  const auto given = [&](const char* name) { return inputs.at(name); };
  const auto integers = [&](const char* name) { return inputs.at(name).to(torch::kInt64); };
  if (auto* gru = dynamic_cast<GruRecogniser*>(&network)) {
    const auto heads = gru->classifier_->forward(given("motion"), given("hidden"));
    return {{"features", heads.features}, {"logits", heads.logits}};
  }
  if (auto* graph = dynamic_cast<StGcn*>(&network)) {
    graph->eval();
    const auto heads = graph->Run(given("rotation_6d"));
    return {{"features", heads.features}, {"logits", heads.logits}};
  }
  if (auto* a2m = dynamic_cast<Action2Motion*>(&network)) {
    if (inputs.count("mu1") > 0) {
      return {{"kl", Action2Motion::KlTerms(given("mu1"), given("logvar1"), given("mu2"), given("logvar2")).sum()}};
    }
    const Tensor prior_rows = given("prior_input"), decoder_rows = given("decoder_input");
    const Tensor zero = torch::zeros({prior_rows.size(1), a2m->hidden_});
    const Tensor states = GruLayer(prior_rows, zero, GruWeights(a2m->prior_->gru, a2m->prior_->embed));
    const Tensor first = GruLayer(decoder_rows, zero, GruWeights(a2m->decoder_->first, a2m->decoder_->embed));
    const Tensor second = GruLayer(first, zero, GruWeights(a2m->decoder_->second));
    std::vector<Tensor> outputs;
    for (const Tensor& state : second.unbind(0)) outputs.push_back(a2m->Decode(state));
    return {{"h", states},
            {"mu", a2m->prior_->mu_net->forward(states)},
            {"logvar", a2m->prior_->logvar_net->forward(states)},
            {"decoder_out", torch::stack(outputs)}};
  }
  if (auto* gru = dynamic_cast<CondGru*>(&network)) {
    const Tensor motion = given("motion");
    const Tensor category = gru->linear_c2e_->forward(OneHot(integers("label"), gru->classes_));
    const Tensor rows = torch::cat({motion, category.unsqueeze(0).expand({motion.size(0), -1, -1})}, 2);
    const Tensor states = GruLayer(rows, torch::zeros({motion.size(1), gru->hidden_}), GruWeights(gru->gru_, 0));
    return {{"output", gru->linear_output_->forward(states)}};
  }
  if (auto* gan = dynamic_cast<ActMoCoGan*>(&network)) {
    if (inputs.count("motion") > 0) {
      return {{"discriminator", gan->motion_discriminator_->forward(given("motion"), given("h0")).logits}};
    }
    return {{"generator", gan->Generate(given("z"), given("h0_z"), given("h0_h"), integers("classes"))}};
  }
  if (auto* gan = dynamic_cast<TwoStageGan*>(&network)) {
    const Tensor one_hot = OneHot(integers("classes"), gan->classes_);
    if (inputs.count("motion") > 0) return {{"critic", gan->JudgeMotion(given("motion"), one_hot)}};
    return {{"motion", gan->Motion(given("z_0"), given("noise"), one_hot)}};
  }
  if (auto* actor = dynamic_cast<Actor*>(&network)) {
    const auto frames = given("frames").item<std::int64_t>();
    return {{"frames", actor->decoder_->Generate(given("z")[0], integers("label"), frames)}};
  }
  if (auto* ssmct = dynamic_cast<Ssmct*>(&network)) {
    ssmct->eval();
    Dropout none;
    Batch batch;
    batch.features = given("frames");
    return {{"filled", ssmct->Fill(ssmct->FramesOf(batch), integers("parts"), none)}};
  }
  auto& macvae = dynamic_cast<Macvae&>(network);
  NamedTensors parts;
  const std::int64_t L = macvae.sizes_.frames;
  const Tensor table = EncoderPositions(L, macvae.options_.width, macvae.options_.released());
  parts["encoder_positions"] = table.squeeze(1);
  if (inputs.count("transition") > 0) {
    parts["decoder_positions"] = DecoderPositions(integers("transition"), table, L);
  }
  if (inputs.count("frames") == 0) return parts;
  macvae.eval();
  Dropout none;
  Batch batch;
  batch.features = given("frames");
  batch.parts = integers("parts");
  batch.label = batch.parts.select(1, 0);
  const auto frames = macvae.FramesOf(batch);
  const LatentMoments prior = macvae.prior_->forward(frames.read, batch.parts, integers("word"));
  parts["prior_mean"] = prior.mean;
  parts["prior_log_variance"] = prior.log_variance;
  parts["decoded"] = macvae.decoder_->forward(given("z"), batch.parts, L, none);
  parts["smoothed"] = macvae.Smooth(frames, parts["decoded"], batch.parts, L).after;
  return parts;
}

}  // namespace mocurate
