#pragma once

#include <map>
#include <string>

#include "train/networks/network.h"

namespace mocurate {

using NamedTensors = std::map<std::string, torch::Tensor>;

/// Parts of a network on given inputs, for comparison with other implementations:
///
///   GruRecogniser  "motion" (T,B,D), "hidden" (layers,B,H): "features", "logits"
///   StGcn          "rotation_6d" (T,B,6V): "features", "logits", as after training
///   Action2Motion  "prior_input", "decoder_input" (T,B,...): the states, means and outputs of T calls without
///   feedback.
///                  "mu1", "logvar1", "mu2", "logvar2": "kl", summed
///   CondGru        "motion" (T,B,D), "label" (B): "output" (T,B,D), each from the true pose before
///   ActMoCoGan     "z" (T,B,Z), "h0_z" (1,B,H), "h0_h" (2,B,H), "classes" (B): "generator", as the released code
///   orders
///                  it. "motion" (T,B,D), "h0" (2,B,H): "discriminator" (B,1 + C)
///   TwoStageGan    "z_0" (B,Z), "noise" (T-1,B,Z), "classes" (B): "motion" (T,B,D). "motion", "classes": "critic" (B)
///   Actor          "z" (1,B,E), "label" (B), "frames" (1): "frames" (T,B,F)
///   Macvae         "encoder_positions" (L,E); "transition" (B): "decoder_positions" (L,B,E); "frames", "parts",
///   "word",
///                  "z" (B,K,E): "prior_mean", "prior_log_variance" (B,K,E), "decoded" (L,B,G), "smoothed" (L,B,G)
///   Ssmct          "frames" (T,B,3J+3) rotation vectors and places, "parts" (B,3): "filled" (T,B,G), 0 at padding
struct NetworkParts {
  static NamedTensors Of(Network& network, const NamedTensors& inputs);
};

}  // namespace mocurate
