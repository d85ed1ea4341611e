#include "train/networks/macvae.h"

#include "train/layers/frames.h"
#include "train/layers/rotations.h"

namespace mocurate {

using torch::Tensor;

namespace {

constexpr double kMarkerDistance = 0.05;  // metres, along the axes of a joint (multiact.md I)

}  // namespace

Macvae::Macvae(const MacvaeOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
               const NetworkSizes& sizes)
    : options_(options),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay),
      tree_(sizes.parents, sizes.rest_offset) {
  sizes_.joints = sizes.joints;
  sizes_.input = (options.released() ? 3 : 6) * sizes_.joints + 3;
  sizes_.words = std::max<std::int64_t>(options.vocabulary, sizes.words);
  sizes_.frames = data.frames;
  if (sizes.skin && options.points == PointChoice::kVertices) skin_.emplace(*sizes.skin, sizes.parents);
  encoder_ = register_module("encoder", MacvaeEncoder(options, sizes_));
  decoder_ = register_module("decoder", MacvaeDecoder(options, sizes_));
  prior_ = register_module("priornet", MacvaePrior(options, sizes_));
  if (!options.postprocessor) return;
  smoothing_ = torch::nn::Conv2d(torch::nn::Conv2dOptions(1, sizes_.output(), {5, sizes_.output()}));
  auto layer = std::make_shared<torch::nn::Module>(), postprocessor = std::make_shared<torch::nn::Module>();
  layer->register_module("conv1", smoothing_);
  postprocessor->register_module("layer", layer);
  register_module("postprocessor", postprocessor);
}

std::vector<OptimiserGroup> Macvae::Groups() { return {AdamWGroup(*this, learning_rate_, weight_decay_)}; }

Tensor Macvae::ReadFrames(const Tensor& rotation, const Tensor& place) const {
  const Tensor numbers =
      options_.released() ? NumbersOf(rotation, PoseChoice::kAxisAngle) : Columns6D(rotation);  // (L,B,J,3 or 6)
  return torch::cat({numbers.flatten(-2), place}, 2);
}

Macvae::Frames Macvae::FramesOf(const Batch& batch) const {
  const std::int64_t J = sizes_.joints;
  if (batch.features.defined()) {  // rotation vectors and places
    const Tensor vectors = batch.features.slice(2, 0, 3 * J).reshape({batch.frames(), batch.size(), J, 3});
    Frames frames{batch.features, MatricesOf(vectors, PoseChoice::kAxisAngle), batch.features.slice(2, 3 * J)};
    if (!options_.released()) frames.read = ReadFrames(frames.rotation, frames.place);
    return frames;
  }
  Frames frames{Tensor(), batch.rotation, batch.motion.slice(2, 0, 3)};
  frames.read = ReadFrames(frames.rotation, frames.place);
  if (batch.valid.defined()) frames.read = frames.read * batch.valid.unsqueeze(2);
  return frames;
}

Macvae::Smoothed Macvae::Smooth(const Frames& frames, const Tensor& decoded, const Tensor& parts,
                                std::int64_t count) const {
  const Tensor rotation = frames.rotation.slice(0, 0, count);
  const Tensor context6 =
      (options_.one_layout() ? Columns6D(rotation) : NumbersOf(rotation, PoseChoice::kRotation6D)).flatten(-2);
  const Tensor context = torch::cat({context6, frames.place.slice(0, 0, count)}, 2);  // (count,B,G)
  const Tensor time = torch::arange(count, parts.options()).unsqueeze(1);             // (count,1)
  const Tensor begin = parts.select(1, 0), end = parts.sum(1);                        // (B)
  const Tensor fill = (options_.fills_last() ? end - begin : end) - 1;
  const Tensor at = torch::where(time < end, time - begin, fill.unsqueeze(0)).clamp(0, decoded.size(0) - 1);
  Smoothed rows;
  rows.before = torch::where((time < begin).unsqueeze(2), context, RowsAt(decoded, at));
  rows.after = smoothing_ ? ConvolveFrames(rows.before, smoothing_->weight, smoothing_->bias, 2) : rows.before;
  return rows;
}

Macvae::Pose Macvae::PoseOf(const Tensor& rows) const {
  const std::int64_t T = rows.size(0), B = rows.size(1), J = sizes_.joints;
  return {MatricesOfColumns(rows.slice(2, 0, 6 * J).reshape({T, B, J, 6})), rows.slice(2, 6 * J)};
}

/// (T,B,P,3); `joints` gets (T,B,J,3).
Tensor Macvae::PointsOf(const Tensor& rotation, const Tensor& place, Tensor* joints) const {
  const std::int64_t T = rotation.size(0), B = rotation.size(1), J = sizes_.joints;
  const Tensor rows = rotation.reshape({T * B, J, 3, 3});
  const BodyTree::Posed posed = tree_.Pose(rows);
  const Tensor root = place.unsqueeze(2);  // (T,B,1,3)
  const Tensor centre = posed.joints.view({T, B, J, 3}) + root;
  if (joints != nullptr) *joints = centre;
  if (options_.points == PointChoice::kJoints) return centre;
  if (options_.points == PointChoice::kVertices) return skin_->Vertices(rows).view({T, B, -1, 3}) + root;
  const Tensor axes = posed.rotation.transpose(-1, -2).reshape({T, B, J, 3, 3});  // rows: the joint's axes
  const Tensor markers = (centre.unsqueeze(3) + kMarkerDistance * axes).reshape({T, B, 3 * J, 3});
  return torch::cat({centre, markers}, 2);
}

/// Sum over frames that count, (T,B) of 0 and 1, and over all numbers of a frame.
Tensor Macvae::Sum(const Tensor& x, const Tensor& counted) const { return (x.flatten(2).sum(2) * counted).sum(); }

/// KL of the posterior from the prior, summed over motions, latents and their numbers.
Tensor Macvae::Divergence(const LatentMoments& posterior, const LatentMoments& prior) const {
  const Tensor apart = (posterior.mean - prior.mean).square();
  return (0.5 * (prior.log_variance - posterior.log_variance) +
          (posterior.log_variance.exp() + apart) / (2.0 * prior.log_variance.exp()) - 0.5)
      .sum();
}

Losses Macvae::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  train();
  const Frames frames = FramesOf(batch);
  const Tensor &parts = batch.parts, &word = batch.word;
  const std::int64_t L = frames.read.size(0), B = batch.size();
  const std::int64_t longest = parts.sum(1).max().item<std::int64_t>();
  Dropout dropout(draws, options_.dropout);
  const LatentMoments prior = prior_->forward(frames.read, parts, word);                 // (B,K,E)
  const LatentMoments posterior = encoder_->forward(frames.read, parts, word, dropout);  // (B,K,E)
  const std::int64_t K = posterior.mean.size(1);
  const Tensor noise = draws.Normal("latent", K, B, options_.width).transpose(0, 1).to(posterior.mean.device());
  const Tensor z = posterior.mean + torch::exp(0.5 * posterior.log_variance) * noise;
  const std::int64_t wanted = options_.fills_last() ? parts.slice(1, 1).sum(1).max().item<std::int64_t>() : longest;
  const Tensor decoded = decoder_->forward(z, parts, wanted, dropout);  // (wanted,B,G)
  // Frames after the action are equal: the convolution reads two of them.
  const std::int64_t count = std::min(L, longest + 2);
  const Smoothed rows = Smooth(frames, decoded, parts, count);
  const Pose made = PoseOf(rows.after);

  const Tensor time = torch::arange(count, parts.options()).unsqueeze(1);
  const Tensor end = parts.sum(1);
  Tensor counted = (time < end).to(torch::kFloat32);  // (count,B)
  if (!options_.released()) counted = counted * (time >= parts.select(1, 0));
  const Tensor real_rotation = frames.rotation.slice(0, 0, count), real_place = frames.place.slice(0, 0, count);
  const auto whole = static_cast<double>(batch.whole);
  const auto frame_count = static_cast<double>(L);
  const double J = static_cast<double>(sizes_.joints);
  const auto share = [&](double frame_numbers, double frames_of_all) {  // released: a mean with padding; paper: a sum
    return options_.released() ? 1.0 / (whole * frames_of_all * frame_numbers) : 1.0 / whole;
  };

  Tensor pose;
  Tensor vectors;
  if (options_.released()) {
    vectors = torch::cat({RotationVectorsOf(made.rotation).flatten(-2), made.place}, 2);  // (count,B,F)
    pose = Sum((vectors - frames.read.slice(0, 0, count)).abs(), counted);
  } else {
    const Tensor real = torch::cat({Columns6D(real_rotation).flatten(-2), real_place}, 2);
    pose = Sum((rows.after - real).abs(), counted);
  }
  pose = pose * share(options_.released() ? 3.0 * J + 3.0 : 6.0 * J + 3.0, frame_count);

  Tensor joints;
  const Tensor made_points = PointsOf(made.rotation, made.place, &joints);
  const Tensor real_points = PointsOf(real_rotation, real_place, nullptr);
  const Tensor apart = made_points - real_points;  // (count,B,P,3)
  const Tensor points = Sum(apart.abs(), counted) * share(3.0 * static_cast<double>(apart.size(2)), frame_count);

  const auto second = [](const Tensor& x) { return x.slice(0, 2) - 2.0 * x.slice(0, 1, -1) + x.slice(0, 0, -2); };
  const Tensor acceleration =
      options_.released() ? Sum(second(joints).square(), counted.slice(0, 2)) * share(3.0 * J, frame_count - 2.0)
                          : Sum(second(apart).abs(), counted.slice(0, 2)) * share(1.0, 1.0);
  const Tensor kl = Divergence(posterior, prior) / whole;

  Losses losses;
  losses.total = options_.pose_weight * pose + options_.point_weight * points +
                 options_.acceleration_weight * acceleration + options_.kl_weight * kl;
  losses.terms = {
      {"pose", pose}, {"point", points}, {"acceleration", acceleration}, {"kl", kl}, {"loss", losses.total}};
  losses.outputs = {{"prior_mean", prior.mean},
                    {"prior_log_variance", prior.log_variance},
                    {"posterior_mean", posterior.mean},
                    {"posterior_log_variance", posterior.log_variance},
                    {"z", z},
                    {"decoded", decoded},
                    {"smoothed", rows.after},
                    {"joints", joints}};
  if (vectors.defined()) losses.outputs.emplace_back("pose", vectors);
  return losses;
}

Motions Macvae::Answer(const RequestBatch& requests, Draws& draws) {
  Dropout none;
  const Tensor& parts = requests.parts;
  const std::int64_t B = parts.size(0);
  Frames frames{Tensor(), requests.previous_rotation, requests.previous_place};
  frames.read = ReadFrames(frames.rotation, frames.place);
  const LatentMoments prior = prior_->forward(frames.read, parts, requests.word);
  const Tensor noise = draws.Normal("latent", prior.mean.size(1), B, options_.width).transpose(0, 1);
  const Tensor z = prior.mean + torch::exp(0.5 * prior.log_variance) * noise;
  const std::int64_t longest = parts.sum(1).max().item<std::int64_t>();
  const std::int64_t T = parts.slice(1, 1).sum(1).max().item<std::int64_t>();
  const Tensor decoded = decoder_->forward(z, parts, options_.fills_last() ? T : longest, none);
  // Two frames behind the longest motion, of which the convolution reads the fill.
  const auto pad = [&](const Tensor& x) {
    std::vector<std::int64_t> shape = x.sizes().vec();
    shape[0] = std::max<std::int64_t>(0, longest + 2 - x.size(0));
    return torch::cat({x, torch::zeros(shape, x.options())});
  };
  frames.rotation = pad(frames.rotation);
  frames.place = pad(frames.place);
  const std::int64_t count = std::min(sizes_.frames, longest + 2);
  const Tensor rows = Smooth(frames, decoded, parts, count).after;
  const Tensor at = torch::arange(T, parts.options()).unsqueeze(1) + parts.select(1, 0).unsqueeze(0);  // (T,B)
  Motions motions;
  motions.output = RowsAt(rows, at.clamp_max(count - 1));
  const Pose made = PoseOf(motions.output);
  motions.rotation = made.rotation;
  motions.joints = tree_.JointsOfBones(made.rotation, made.place, requests.bone_length);
  return motions;
}

}  // namespace mocurate
