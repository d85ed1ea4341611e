#include "train/networks/actor.h"

#include "train/layers/rotations.h"

namespace mocurate {

using torch::Tensor;

Actor::Actor(const ActorOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
             const NetworkSizes& sizes)
    : options_(options),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay),
      joints_(sizes.joints),
      rows_(sizes.joints + (options.translation && options.NeedsRotations() ? 1 : 0)),
      width_(WidthOf(options.pose)) {
  if (options.NeedsRotations()) {
    if (sizes.skin) skin_.emplace(*sizes.skin, sizes.parents);
    tree_ = BodyTree(sizes.parents, sizes.rest_offset);
  }
  std::tie(encoder_, decoder_) = MakeActorCoders(options, {rows_ * width_, sizes.classes, data.frames});
  register_module("encoder", encoder_);
  register_module("decoder", decoder_);
}

std::vector<OptimiserGroup> Actor::Groups() { return {AdamWGroup(*this, learning_rate_, weight_decay_)}; }

Tensor Actor::FramesOf(const Batch& batch) const {
  if (batch.features.defined()) return batch.features;
  if (!options_.NeedsRotations()) return batch.motion;
  const std::int64_t T = batch.frames(), B = batch.size();
  Tensor rows = NumbersOf(batch.rotation, options_.pose).to(batch.motion.device());  // (T,B,J,W)
  if (options_.translation) {
    const Tensor place = torch::zeros({T, B, 1, width_}, rows.options());
    place.slice(3, 0, 3).copy_((batch.motion.slice(2, 0, 3) - batch.motion[0].slice(1, 0, 3)).unsqueeze(2));
    rows = torch::cat({rows, place}, 2);  // (T,B,J+1,W)
  }
  const Tensor frames = rows.reshape({T, B, rows_ * width_});
  return batch.valid.defined() ? frames * batch.valid.unsqueeze(2) : frames;
}

Tensor Actor::RotationsOf(const Tensor& rows) const {
  return MatricesOf(rows.view({-1, rows_, width_}).slice(1, 0, joints_), options_.pose);
}

Tensor Actor::PlacesOf(const Tensor& rows) const {
  return rows.view({-1, rows_, width_}).select(1, joints_).slice(1, 0, 3);
}

void Actor::AddBodyLosses(const Tensor& decoded, const Tensor& truth, const Tensor& valid, double whole_frames,
                          Losses& losses) const {
  const bool joints = options_.joint_weight > 0.0, vertices = options_.vertex_weight > 0.0 && skin_;
  if (!options_.NeedsRotations() || (!joints && !vertices)) return;
  const std::int64_t T = decoded.size(0), B = decoded.size(1);
  // Rows of the valid frames: padding is no rotation.
  const Tensor chosen = valid.defined() ? valid.reshape({T * B}).nonzero().squeeze(1) : Tensor();
  const auto rows = [&](const Tensor& x) {
    const Tensor all = x.reshape({T * B, x.size(2)});
    return chosen.defined() ? all.index_select(0, chosen) : all;
  };
  const Tensor made = RotationsOf(rows(decoded)), real = RotationsOf(rows(truth));  // (N,J,3,3)
  Tensor moved;  // (N,3) of the roots, made less real
  if (options_.body_translation && options_.translation) {
    const auto since_first = [&](const Tensor& x) {
      const Tensor place = PlacesOf(x.reshape({T * B, x.size(2)})).view({T, B, 3});
      return place - place[0];
    };
    moved = rows(since_first(decoded) - since_first(truth));
  }
  if (joints) {
    const Tensor of_made = tree_.Pose(made).joints, of_real = tree_.Pose(real).joints;  // (N,J,3)
    Tensor apart = of_made - of_real;
    if (moved.defined()) apart = apart + moved.unsqueeze(1);
    const Tensor loss = apart.square().sum() / (whole_frames * 3.0 * static_cast<double>(joints_));
    losses.total = losses.total + options_.joint_weight * loss;
    losses.terms.emplace_back("joint", loss);
  }
  if (vertices) {
    const Tensor loss =
        skin_->SquaredDistance(made, real, moved) / (whole_frames * 3.0 * static_cast<double>(skin_->vertex_count()));
    losses.total = losses.total + options_.vertex_weight * loss;
    losses.terms.emplace_back("vertex", loss);
  }
}

Losses Actor::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  const Tensor truth = FramesOf(batch);  // (T,B,F)
  const std::int64_t T = truth.size(0), B = truth.size(1);
  const double whole_frames = static_cast<double>(batch.valid.defined() ? batch.whole_frames : T * batch.whole);
  Dropout dropout(draws, options_.dropout);
  const CodedMotion motion{truth, batch.label, batch.valid};
  const auto [mean, log_variance] = encoder_->Encode(motion, dropout);  // (B,E)
  const Tensor noise = draws.Normal("latent", 1, B, options_.latent)[0].to(truth.device());
  const Tensor z = mean + torch::exp(0.5 * log_variance) * noise;
  const Tensor decoded = decoder_->Decode(z, motion, dropout);  // (T,B,F); padding is 0 in both

  const Tensor pose = (decoded - truth).square().sum() / (whole_frames * static_cast<double>(truth.size(2)));
  Tensor kl = -0.5 * (1.0 + log_variance - mean.square() - log_variance.exp()).sum();
  if (options_.kl_mean) kl = kl / static_cast<double>(batch.whole);
  Losses losses;
  losses.total = options_.pose_weight * pose + options_.kl_weight * kl;
  losses.terms = {{"pose", pose}, {"kl", kl}};
  losses.outputs = {{"frames", decoded}, {"mean", mean}, {"log_variance", log_variance}, {"z", z}};
  AddBodyLosses(decoded, truth, batch.valid, whole_frames, losses);
  losses.terms.emplace_back("loss", losses.total);
  return losses;
}

Tensor Actor::Encode(const Batch& batch, Draws& draws) {
  Dropout none;
  const auto [mean, log_variance] = encoder_->Encode({FramesOf(batch), batch.label, batch.valid}, none);  // (B,E)
  return mean.unsqueeze(0) + torch::exp(0.5 * log_variance) * draws.Normal("latent", 1, batch.size(), options_.latent);
}

Motions Actor::Answer(const RequestBatch& requests, Draws& draws) {
  const std::int64_t B = requests.label.size(0), T = requests.frames;
  const Tensor z = draws.Normal(kMotionLatent, 1, B, options_.latent)[0];
  Motions motions;
  motions.output = decoder_->Generate(z, requests.label, T);  // (T,B,F)
  if (!options_.NeedsRotations()) {
    motions.joints = motions.output;
    return motions;
  }
  const Tensor rows = motions.output.reshape({T * B, rows_ * width_});
  motions.rotation = MatricesOf(NumbersOf(RotationsOf(rows), PoseChoice::kRotation6D), PoseChoice::kRotation6D)
                         .view({T, B, joints_, 3, 3});  // orthogonal whatever the representation
  const Tensor place = options_.translation ? PlacesOf(rows).view({T, B, 3}) : Tensor();
  motions.joints = tree_.JointsOfBones(motions.rotation, place, requests.bone_length);
  return motions;
}

}  // namespace mocurate
