#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "train/checkpoint/parameters.h"
#include "train/networks/lie_kinematics.h"

namespace mocurate {

/// i/(T-1) as released, (i+1)/T as in the paper (a2m_actor.md F3), or none.
enum class TimeCounter { kNone, kReleased, kPaper };
/// What is fed back: the raw decoder output (released) or joints after forward kinematics (paper, F2).
enum class Feedback { kRaw, kJoints };
/// Reconstruction per frame: mean over batch and numbers (released), or squared norm averaged over the batch (paper,
/// F13).
enum class Reconstruction { kMean, kSquaredNorm };

/// Sizes and rules of Action2Motion (a2m_actor.md B.5 to B.8).
struct Action2MotionConfig {
  int joints = 24;
  int classes = 12;
  int hidden = 128;
  int latent = 30;
  std::optional<LieChains> lie;  ///< absent: the variant without Lie
  LieExp exp = LieExp::kReleased;
  TimeCounter time_counter = TimeCounter::kReleased;
  Feedback feedback = Feedback::kRaw;
  Reconstruction reconstruction = Reconstruction::kMean;
  double kl_weight = 1e-3;

  int pose() const { return 3 * joints; }
  int input() const { return pose() + classes + (time_counter == TimeCounter::kNone ? 0 : 1); }
};

/// Parameters of "prior/...", "posterior/..." and "decoder/..." with the released names, values zero.
ParameterList Action2MotionParameters(const Action2MotionConfig& config);

/// Input of one training step: B motions of T frames.
struct Action2MotionBatch {
  int batch = 0;
  int frames = 0;
  std::vector<float> motion;  ///< (T,B,3J) metres, frame-major
  std::vector<int> label;     ///< (B)
  std::vector<float> noise;   ///< (T,B,latent) standard normal
  bool self_feed = true;      ///< feed the model's own prediction back, else the truth
};

struct Action2MotionLoss {
  double total = 0.0;  ///< reconstruction + kl_weight * KL, sums over frames
  double reconstruction = 0.0;
  double kl = 0.0;
};

/// What a step saw on the way, for comparison with other implementations. Frame-major, (T,B,...).
struct Action2MotionTrace {
  std::vector<double> reconstruction, kl;  ///< (T)
  std::vector<float> output, joints;       ///< (T,B,3J) decoder output; joints after kinematics
  std::vector<float> z, mean, log_variance, prior_mean, prior_log_variance;  ///< (T,B,latent)
};

/// Loss of a batch; gradients of all parameters are overwritten (B.6). One thread.
Action2MotionLoss Action2MotionStep(const Action2MotionConfig& config, const Action2MotionBatch& batch,
                                    ParameterList& parameters, Action2MotionTrace* trace = nullptr);

/// The prior and the decoder on given rows, one row of a motion a frame, from zero hidden states and without feedback:
/// for comparison with other implementations.
struct Action2MotionRows {
  int batch = 0;
  int frames = 0;
  std::vector<float> prior;    ///< (T,B,input)
  std::vector<float> decoder;  ///< (T,B,input + latent)
};
struct Action2MotionAnswers {
  std::vector<float> hidden;              ///< (T,B,hidden) of the prior
  std::vector<float> mean, log_variance;  ///< (T,B,latent) of the prior
  std::vector<float> output;              ///< (T,B,3J) of the decoder
};
Action2MotionAnswers Action2MotionForward(const Action2MotionConfig& config, const ParameterList& parameters,
                                          const Action2MotionRows& rows);

/// KL of two diagonal normals, summed over all numbers and divided by `batch` (B.6, 4).
double GaussianKl(const std::vector<float>& mean_q, const std::vector<float>& log_variance_q,
                  const std::vector<float>& mean_p, const std::vector<float>& log_variance_p, int batch);

/// Motions from the prior (B.7): decoder outputs (T,B,3J) for labels (B) and noise (T,B,latent).
std::vector<float> Action2MotionGenerate(const Action2MotionConfig& config, const ParameterList& parameters,
                                         const std::vector<int>& label, int frames, const std::vector<float>& noise,
                                         const std::vector<float>& bone_length);

}  // namespace mocurate
