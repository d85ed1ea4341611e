#include "train/trainer/optimisers.h"

#include <sstream>

#include "train/trainer/values.h"

namespace mocurate {
namespace {

using torch::Tensor;
using AdamState = torch::optim::AdamParamState;
using AdamWState = torch::optim::AdamWParamState;
using RmsPropState = torch::optim::RMSpropParamState;

/// The key of a parameter's state: text in libtorch 1, the address in libtorch 2.
template <class Key>
Key KeyOf(const Tensor& parameter) {
  if constexpr (std::is_same_v<Key, std::string>) {
    std::ostringstream address;
    address << parameter.unsafeGetTensorImpl();
    return address.str();
  } else {
    return parameter.unsafeGetTensorImpl();
  }
}

template <class State>
void StoreMoments(const State& own, const std::string& name, OptimiserState& state) {
  state.steps = own.step();
  state.first.push_back(ParameterOf(name, own.exp_avg()));
  state.second.push_back(ParameterOf(name, own.exp_avg_sq()));
}

template <class State>
std::unique_ptr<State> MomentsOf(std::int64_t steps, const Tensor& first, const Tensor& second) {
  auto state = std::make_unique<State>();
  state->step(steps);
  state->exp_avg(first);
  state->exp_avg_sq(second);
  return state;
}

std::unique_ptr<torch::optim::Optimizer> MakeRule(const OptimiserGroup& group) {
  if (group.rule == OptimiserGroup::Rule::kRmsProp) {
    auto options = torch::optim::RMSpropOptions(group.learning_rate).weight_decay(group.weight_decay);
    return std::make_unique<torch::optim::RMSprop>(group.parameters, options);
  }
  if (group.rule == OptimiserGroup::Rule::kAdamW) {
    auto options = torch::optim::AdamWOptions(group.learning_rate)
                       .betas(std::make_tuple(group.beta1, 0.999))
                       .weight_decay(group.weight_decay);
    return std::make_unique<torch::optim::AdamW>(group.parameters, options);
  }
  auto options = torch::optim::AdamOptions(group.learning_rate)
                     .betas(std::make_tuple(group.beta1, 0.999))
                     .weight_decay(group.weight_decay);
  return std::make_unique<torch::optim::Adam>(group.parameters, options);
}

}  // namespace

Optimisers::Optimisers(Network& network) : groups_(network.Groups()) {
  std::map<const at::TensorImpl*, std::string> names;
  for (const auto& named : network.named_parameters()) names[named.value().unsafeGetTensorImpl()] = named.key();
  for (const OptimiserGroup& group : groups_) {
    std::vector<std::string> of_group;
    for (const Tensor& parameter : group.parameters) of_group.push_back(names.at(parameter.unsafeGetTensorImpl()));
    names_.push_back(std::move(of_group));
    rules_.push_back(MakeRule(group));
  }
}

void Optimisers::Step(int phase, const std::vector<Tensor>& gradients, double rate_factor, double largest_norm) {
  const OptimiserGroup& group = groups_[static_cast<std::size_t>(phase)];
  torch::optim::Optimizer& rule = *rules_[static_cast<std::size_t>(phase)];
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    Tensor parameter = group.parameters[i];
    parameter.mutable_grad() = gradients[i];
  }
  if (largest_norm > 0.0) torch::nn::utils::clip_grad_norm_(group.parameters, largest_norm);
  for (auto& of_rule : rule.param_groups()) of_rule.options().set_lr(group.learning_rate * rate_factor);
  rule.step();
  for (Tensor parameter : group.parameters)
    parameter.mutable_grad() = Tensor();  // frees their memory for the next step
}

std::vector<OptimiserState> Optimisers::State() const {
  std::vector<OptimiserState> all;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    OptimiserState state;
    state.name = groups_[g].name;
    const auto& stored = rules_[g]->state();
    using Key = typename std::decay_t<decltype(stored)>::key_type;
    for (std::size_t i = 0; i < groups_[g].parameters.size(); ++i) {
      const auto found = stored.find(KeyOf<Key>(groups_[g].parameters[i]));
      if (found == stored.end()) continue;  // never had a gradient
      if (groups_[g].rule == OptimiserGroup::Rule::kRmsProp) {
        const auto& own = static_cast<const RmsPropState&>(*found->second);
        state.steps = own.step();
        state.second.push_back(ParameterOf(names_[g][i], own.square_avg()));
      } else if (groups_[g].rule == OptimiserGroup::Rule::kAdamW) {
        StoreMoments(static_cast<const AdamWState&>(*found->second), names_[g][i], state);
      } else {
        StoreMoments(static_cast<const AdamState&>(*found->second), names_[g][i], state);
      }
    }
    all.push_back(std::move(state));
  }
  return all;
}

Status Optimisers::Restore(const std::vector<OptimiserState>& state, const std::string& where) {
  if (state.size() != groups_.size()) {
    return Fail(
        ErrorCode::kInconsistent,
        std::to_string(state.size()) + " optimisers are stored, the network has " + std::to_string(groups_.size()),
        where);
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    auto& stored = rules_[g]->state();
    using Key = typename std::decay_t<decltype(stored)>::key_type;
    for (std::size_t i = 0; i < groups_[g].parameters.size(); ++i) {
      const Tensor& parameter = groups_[g].parameters[i];
      if (FindParameter(state[g].second, names_[g][i]) < 0) continue;
      const auto second = FindOfShape(state[g].second, names_[g][i], parameter.sizes(), where);
      if (!second) return Forward(second);
      if (groups_[g].rule == OptimiserGroup::Rule::kRmsProp) {
        auto own = std::make_unique<RmsPropState>();
        own->step(state[g].steps);
        own->square_avg(TensorOf(**second).to(parameter.device()));
        stored[KeyOf<Key>(parameter)] = std::move(own);
        continue;
      }
      const auto first = FindOfShape(state[g].first, names_[g][i], parameter.sizes(), where);
      if (!first) return Forward(first);
      const Tensor of_first = TensorOf(**first).to(parameter.device());
      const Tensor of_second = TensorOf(**second).to(parameter.device());
      if (groups_[g].rule == OptimiserGroup::Rule::kAdamW) {
        stored[KeyOf<Key>(parameter)] = MomentsOf<AdamWState>(state[g].steps, of_first, of_second);
      } else {
        stored[KeyOf<Key>(parameter)] = MomentsOf<AdamState>(state[g].steps, of_first, of_second);
      }
    }
  }
  return {};
}

}  // namespace mocurate
