#include "train/layers/dropout.h"

#include <cmath>
#include <string>

#include "train/layers/keep_mask.h"

namespace mocurate {
namespace {

using torch::Tensor;

struct Masked : torch::autograd::Function<Masked> {
  static Tensor Apply(const Tensor& x, const Tensor& kept, double scale) {
    if (!x.device().is_cpu()) return x * kept.to(x.device()) * scale;
    const Tensor dense = x.contiguous();
    Tensor result = torch::empty_like(dense);
    ApplyKept(dense.data_ptr<float>(), kept.data_ptr<std::uint8_t>(), dense.numel(), static_cast<float>(scale),
              result.data_ptr<float>());
    return result;
  }

  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& x, const Tensor& kept, double scale) {
    context->save_for_backward({kept});
    context->saved_data["scale"] = scale;
    return Apply(x, kept, scale);
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    return {Apply(gradient[0], context->get_saved_variables()[0], context->saved_data["scale"].toDouble()), Tensor(),
            Tensor()};
  }
};

}  // namespace

Tensor Dropout::operator()(const Tensor& x) {
  if (!active()) return x;
  double scale = 1.0;
  const Tensor kept = Kept(x.numel(), scale).view(x.sizes());
  return Masked::apply(x, kept, scale);
}

Tensor Dropout::Kept(std::int64_t count, double& scale) {
  const auto dropped = static_cast<std::uint32_t>(std::lround(rate_ * 65536.0));
  const Tensor kept = torch::empty({count}, torch::kUInt8);
  FillKept(draws_->Key("dropout/" + std::to_string(calls_++)), count, dropped, kept.data_ptr<std::uint8_t>());
  scale = 65536.0 / (65536.0 - dropped);
  return kept;
}

}  // namespace mocurate
