#include "train/networks/ssmct.h"

#include <algorithm>

#include "train/layers/frames.h"
#include "train/layers/rotations.h"

namespace mocurate {

using torch::Tensor;

namespace {

constexpr int kTransitionPart = 1, kBehindParts = 3;  // of PartOf
constexpr double kInitialDeviation = 0.02;            // of positions and tags, as BERT's

/// The convolution of Conv1d(...,3).padding(1) over the frames of (T,B,I), by a linear layer. (T,B,O)
Tensor ConvolveOverThree(const Tensor& x, const torch::nn::Conv1d& conv) {
  const Tensor zero = torch::zeros({1, x.size(1), x.size(2)}, x.options());
  const Tensor by_tap = conv->weight.transpose(1, 2).reshape({conv->weight.size(0), -1});  // (O,3 I)
  return ConvolveTaps(torch::cat({zero, x, zero}), by_tap, conv->bias);
}

}  // namespace

FilledMotion SlerpFill(const Tensor& rotation, const Tensor& place, const Tensor& parts) {
  const std::int64_t L = rotation.size(0), B = rotation.size(1), J = rotation.size(2);
  const Tensor begin = parts.select(1, 0), length = parts.select(1, 1);  // (B)
  const Tensor ends = torch::stack({begin - 1, begin + length});         // (2,B)
  const Tensor turns = RowsAt(rotation.flatten(2), ends).view({2, B, J, 3, 3});
  const Tensor places = RowsAt(place, ends);                                                           // (2,B,3)
  const Tensor turn = NumbersOf(turns[0].transpose(-1, -2).matmul(turns[1]), PoseChoice::kAxisAngle);  // (B,J,3)

  const Tensor time = torch::arange(L, parts.options()).unsqueeze(1);                               // (L,1)
  const Tensor weight = (time - begin + 1).to(torch::kFloat32) / (length + 1).to(torch::kFloat32);  // (L,B)
  const Tensor part_turn = MatricesOf(weight.view({L, B, 1, 1}) * turn, PoseChoice::kAxisAngle);    // (L,B,J,3,3)
  const Tensor missing = PartOf(parts, L) == kTransitionPart;                                       // (L,B)
  const Tensor between = places[0] + weight.unsqueeze(2) * (places[1] - places[0]);                 // (L,B,3)
  return {torch::where(missing.view({L, B, 1, 1, 1}), turns[0].matmul(part_turn), rotation),
          torch::where(missing.unsqueeze(2), between, place)};
}

Ssmct::Ssmct(const SsmctOptions& options, const LearningOptions& learning, const TrainingDataOptions& data,
             const NetworkSizes& sizes)
    : options_(options),
      learning_rate_(learning.learning_rate),
      weight_decay_(learning.weight_decay),
      joints_(sizes.joints),
      frames_(data.frames),
      tree_(sizes.parents, sizes.rest_offset) {
  const std::int64_t E = options.width, G = 6 * joints_ + 3;
  input_ = register_module("input", torch::nn::Conv1d(torch::nn::Conv1dOptions(G, E, 3).padding(1)));
  positions_ = register_parameter("positions", kInitialDeviation * torch::randn({frames_, E}));
  tags_ = register_parameter("tags", kInitialDeviation * torch::randn({3, E}));
  encoder_ = register_module(
      "encoder", TransformerStack(TransformerSizes{E, options.heads, options.feed_forward, options.layers}, false));
  output_ = register_module("output", torch::nn::Conv1d(torch::nn::Conv1dOptions(E, G, 3).padding(1)));
}

std::vector<OptimiserGroup> Ssmct::Groups() { return {AdamWGroup(*this, learning_rate_, weight_decay_)}; }

FilledMotion Ssmct::FramesOf(const Batch& batch) const {
  if (!batch.features.defined()) return {batch.rotation, batch.motion.slice(2, 0, 3)};
  const Tensor vectors =
      batch.features.slice(2, 0, 3 * joints_).reshape({batch.frames(), batch.features.size(1), joints_, 3});
  return {MatricesOf(vectors, PoseChoice::kAxisAngle), batch.features.slice(2, 3 * joints_)};
}

/// (L,B,G)
Tensor Ssmct::RowsOf(const Tensor& rotation, const Tensor& place) const {
  return torch::cat({Columns6D(rotation).flatten(-2), place}, 2);
}

/// (L,B,G) of motions whose transitions are not read.
Tensor Ssmct::Fill(const FilledMotion& known, const Tensor& parts, Dropout& dropout) {
  const std::int64_t L = known.rotation.size(0);
  const Tensor part = PartOf(parts, L);  // (L,B)
  const Tensor missing = part == kTransitionPart, padded = part == kBehindParts;
  const Tensor present = padded.logical_not().unsqueeze(2);  // (L,B,1)
  const FilledMotion filled = SlerpFill(known.rotation, known.place, parts);
  const Tensor x = RowsOf(filled.rotation, filled.place) * present;             // (L,B,G)
  const Tensor tag = missing.to(torch::kInt64) + 2 * padded.to(torch::kInt64);  // (L,B)
  Tensor h = ConvolveOverThree(x, input_) + positions_.slice(0, 0, L).unsqueeze(1) + OneHot(tag, 3).matmul(tags_);
  h = encoder_->forward(h, padded.t(), Tensor(), dropout) * present;  // (L,B,E)
  return torch::where(missing.unsqueeze(2), ConvolveOverThree(h, output_), x);
}

/// (...,G) -> (...,J,3,3)
Tensor Ssmct::RotationsOf(const Tensor& rows) const {
  std::vector<std::int64_t> shape = rows.sizes().vec();
  shape.back() = joints_;
  shape.push_back(6);
  return MatricesOfColumns(rows.slice(-1, 0, 6 * joints_).reshape(shape));
}

/// (N,G) -> (N,J,3), bones of the usual person.
Tensor Ssmct::JointsOf(const Tensor& rows) const {
  return tree_.Pose(RotationsOf(rows)).joints + rows.slice(1, 6 * joints_).unsqueeze(1);
}

Losses Ssmct::Loss(const Batch& batch, Draws& draws, int /*phase*/) {
  train();
  Dropout dropout(draws, options_.dropout);
  const std::int64_t longest = batch.parts.sum(1).max().item<std::int64_t>();
  FilledMotion real = FramesOf(batch);
  real.rotation = real.rotation.slice(0, 0, longest);
  real.place = real.place.slice(0, 0, longest);
  const Tensor filled = Fill(real, batch.parts, dropout);  // (longest,B,G)

  const Tensor at = (PartOf(batch.parts, longest) == kTransitionPart).reshape({-1}).nonzero().squeeze(1);  // (N)
  const auto in_transitions = [&](const Tensor& rows) { return rows.flatten(0, 1).index_select(0, at); };  // (N,G)
  const Tensor made = in_transitions(filled), truth = in_transitions(RowsOf(real.rotation, real.place));
  const double frames = std::max(1.0, static_cast<double>(at.size(0)));
  const Tensor pose = (made - truth).abs().sum() / (frames * static_cast<double>(made.size(1)));
  const Tensor joints = JointsOf(made);
  const Tensor joint = (joints - JointsOf(truth)).abs().sum() / (frames * 3.0 * static_cast<double>(joints_));

  Losses losses;
  losses.total = options_.pose_weight * pose + options_.joint_weight * joint;
  losses.terms = {{"pose", pose}, {"joint", joint}, {"loss", losses.total}};
  losses.outputs = {{"filled", filled}, {"joints", joints}};
  return losses;
}

Motions Ssmct::Answer(const RequestBatch& requests, Draws& /*draws*/) {
  Dropout none;
  const std::int64_t B = requests.parts.size(0), P = requests.previous_rotation.size(0);
  const Tensor transition = requests.parts.select(1, 1);  // (B)
  const Tensor surplus = (requests.parts.sum(1) - frames_).clamp_min(0);
  const Tensor skipped = torch::minimum(surplus, requests.parts.select(1, 0) - 1);  // frames of the previous action
  const Tensor begin = requests.parts.select(1, 0) - skipped;
  const Tensor parts = torch::stack({begin, transition, requests.parts.select(1, 2) - (surplus - skipped)}, 1);

  const auto rows_of = [](const Tensor& rotation, const Tensor& place) {  // (.,B,9J+3)
    return torch::cat({rotation.flatten(2), place}, 2);
  };
  const Tensor both = torch::cat({rows_of(requests.previous_rotation, requests.previous_place),
                                  rows_of(requests.next_rotation, requests.next_place)});
  const std::int64_t count = parts.sum(1).max().item<std::int64_t>();
  const Tensor time = torch::arange(count, parts.options()).unsqueeze(1);  // (count,1)
  const Tensor at = torch::where(time < begin, time + skipped, time - begin - transition + P);
  const Tensor rows = RowsAt(both, at.clamp(0, both.size(0) - 1));  // of the transition: any
  const FilledMotion known{rows.slice(2, 0, 9 * joints_).reshape({count, B, joints_, 3, 3}),
                           rows.slice(2, 9 * joints_)};
  const Tensor filled = Fill(known, parts, none);  // (count,B,G)

  const std::int64_t T = transition.max().item<std::int64_t>();
  const Tensor asked = torch::arange(T, parts.options()).unsqueeze(1) + begin;  // (T,B)
  Motions motions;
  motions.output = RowsAt(filled, asked.clamp_max(count - 1));
  motions.rotation = RotationsOf(motions.output);
  motions.joints = tree_.JointsOfBones(motions.rotation, motions.output.slice(2, 6 * joints_), requests.bone_length);
  return motions;
}

}  // namespace mocurate
