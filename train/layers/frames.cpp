#include "train/layers/frames.h"

#include <vector>

namespace mocurate {

using torch::Tensor;

namespace {

/// The backward pass has a product for each tap: the frames that a tap reads lie one after the other, so nothing is
/// copied, and the forward pass keeps no copies for it.
struct TapConvolution : torch::autograd::Function<TapConvolution> {
  /// Rows (T B, I) of tap k, and its weights (O,I).
  static Tensor RowsOf(const Tensor& x, std::int64_t k, std::int64_t frames) {
    return x.slice(0, k, k + frames).view({frames * x.size(1), x.size(2)});
  }
  static Tensor TapOf(const Tensor& weight, std::int64_t k, std::int64_t width) {
    return weight.slice(1, k * width, (k + 1) * width);
  }

  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& x, const Tensor& weight,
                        const Tensor& bias) {
    const Tensor dense = x.contiguous();
    const std::int64_t I = x.size(2), taps = weight.size(1) / I, T = x.size(0) - taps + 1;
    // One product: sums of the taps' own would round five times, which a normalisation behind it amplifies.
    std::vector<Tensor> of_tap;
    for (std::int64_t k = 0; k < taps; ++k) of_tap.push_back(RowsOf(dense, k, T));
    context->save_for_backward({dense, weight});
    return torch::addmm(bias, torch::cat(of_tap, 1), weight.t()).view({T, x.size(1), weight.size(0)});
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const Tensor &x = saved[0], &weight = saved[1];
    const std::int64_t I = x.size(2), taps = weight.size(1) / I, T = x.size(0) - taps + 1;
    const Tensor rows = gradient[0].reshape({T * x.size(1), weight.size(0)});
    const Tensor by_x = torch::zeros_like(x), by_weight = torch::empty_like(weight);
    for (std::int64_t k = 0; k < taps; ++k) {
      RowsOf(by_x, k, T).addmm_(rows, TapOf(weight, k, I));
      Tensor of_tap = TapOf(by_weight, k, I);
      torch::mm_out(of_tap, rows.t(), RowsOf(x, k, T));
    }
    return {by_x, by_weight, rows.sum(0)};
  }
};

}  // namespace

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
  return TapConvolution::apply(x, weight, bias);
}

}  // namespace mocurate
