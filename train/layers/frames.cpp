#include "train/layers/frames.h"

#include <vector>

namespace mocurate {

using torch::Tensor;

Tensor RowsAt(const Tensor& rows, const Tensor& at) {
  const std::int64_t B = rows.size(1), W = rows.size(2);
  const Tensor flat = (at * B + torch::arange(B, at.options())).reshape({-1});
  return rows.reshape({-1, W}).index_select(0, flat).view({at.size(0), B, W});
}

Tensor PartOf(const Tensor& parts, std::int64_t frames) {
  const Tensor time = torch::arange(frames, parts.options()).unsqueeze(1);  // (T,1)
  Tensor part = torch::zeros({frames, parts.size(0)}, parts.options());
  Tensor end = torch::zeros({parts.size(0)}, parts.options());
  for (int k = 0; k < 3; ++k) {
    end = end + parts.select(1, k);
    part = part + (time >= end.unsqueeze(0)).to(torch::kInt64);
  }
  return part;
}

Tensor ConvolveTaps(const Tensor& x, const Tensor& weight, const Tensor& bias) {
  const std::int64_t taps = weight.size(1) / x.size(2), T = x.size(0) - taps + 1;
  std::vector<Tensor> of_tap;
  for (std::int64_t k = 0; k < taps; ++k) of_tap.push_back(x.slice(0, k, k + T));
  return torch::linear(torch::cat(of_tap, 2), weight, bias);
}

}  // namespace mocurate
