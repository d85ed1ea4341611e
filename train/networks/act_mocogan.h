#pragma once

#include "train/layers/lie_kinematics.h"
#include "train/networks/gru_recogniser.h"
#include "train/networks/network.h"

namespace mocurate {

/// Act-MoCoGAN (a2m_actor.md B.9), a baseline of Action2Motion's tables: MoCoGAN on poses. D = 3 J, C classes, Z = 30,
/// H = 128; all recurrent states start from N(0,1), also when motions are generated.
///
///   generator             z_t ~ N(0,1), Z - GRU(Z,H) - [. | one-hot class] - GRU(H + C,H,2) - Linear(H,D)
///   with Lie              rotations: Linear(H - 6,D - 3) - pi tanh of all but the last 6 numbers of the state;
///                         root: Linear(6,3) of those 6; the output holds the root last
///   motion discriminator  GRU(D,H,2) - Linear(H,30) - tanh - Linear(30,1 + C): real or not, and the class
///   pose discriminator    root-centred pose D - Linear(D,H) - LeakyReLU(0.2) - Linear(H,1)
///
/// Phases: pose discriminator, motion discriminator, generator. Which switches the paper used is not recorded; here
/// the three phases of a step read the same real clips. With `motion_batch` the motion discriminator judges only the
/// first of them, the pose discriminator a frame of each: the released defaults are batches of 3 motions of 20 frames
/// and of 30 poses (motion_batch: 3, batch: 30, frames: 20).
class ActMoCoGan : public Network {
 public:
  ActMoCoGan(const ActMoCoGanOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  std::vector<int> Phases(std::int64_t step, std::int64_t steps) const override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  struct GeneratorImpl : torch::nn::Module {
    GeneratorImpl(std::int64_t latent, std::int64_t classes, std::int64_t hidden, std::int64_t pose, bool lie);
    torch::nn::GRU recurrent_z{nullptr}, recurrent_h{nullptr};
    torch::nn::Linear linear{nullptr}, linear_lie{nullptr}, linear_traj{nullptr};
  };
  TORCH_MODULE(Generator);

  struct PoseDiscriminatorImpl : torch::nn::Module {
    PoseDiscriminatorImpl(std::int64_t pose, std::int64_t hidden);
    torch::Tensor forward(const torch::Tensor& pose) { return main->forward(pose).flatten(); }
    torch::nn::Sequential main{nullptr};
  };
  TORCH_MODULE(PoseDiscriminator);

  enum Phase { kPoseDiscriminator, kMotionDiscriminator, kGenerator };

  torch::Tensor Generate(const torch::Tensor& z, const torch::Tensor& h0_z, const torch::Tensor& h0_h,
                         const torch::Tensor& label);
  torch::Tensor GenerateFrom(Draws& draws, const torch::Tensor& label, std::int64_t frames);
  torch::Tensor Joints(const torch::Tensor& output, const torch::Tensor& bone_length) const;  // (T,B,D)
  torch::Tensor Poses(const torch::Tensor& joints, Draws& draws, const std::string& purpose) const;
  torch::Tensor Judge(const torch::Tensor& joints, Draws& draws, const std::string& purpose);
  std::int64_t Judged(const Batch& batch) const;

  ActMoCoGanOptions options_;
  std::int64_t classes_, pose_;
  double learning_rate_, weight_decay_;
  LieLayer kinematics_;
  Generator generator_{nullptr};
  GruClassifier motion_discriminator_{nullptr};
  PoseDiscriminator pose_discriminator_{nullptr};
};

}  // namespace mocurate
