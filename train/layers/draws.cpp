#include "train/layers/draws.h"

#include "core/base/random.h"

namespace mocurate {
namespace {

using torch::Tensor;

constexpr double kTwoPi = 6.283185307179586476925286766559;

/// `count` numbers of each of the streams, uniform in (0, 1]: (streams, count) float32.
Tensor UniformRows(std::vector<Random> streams, std::int64_t count) {
  Tensor rows = torch::empty({static_cast<std::int64_t>(streams.size()), count}, torch::kFloat32);
  float* value = rows.data_ptr<float>();
  for (Random& stream : streams) {
    for (std::int64_t i = 0; i < count; ++i) *value++ = static_cast<float>((stream.Next() >> 8) + 1) * 0x1p-24f;
  }
  return rows;
}

/// Box-Muller of pairs: (streams, count) standard normal float32.
Tensor NormalRows(std::vector<Random> streams, std::int64_t count) {
  const std::int64_t half = (count + 1) / 2;
  const Tensor uniform = UniformRows(std::move(streams), 2 * half);
  const Tensor radius = uniform.slice(1, 0, half).log().mul_(-2.0).sqrt_();
  const Tensor angle = uniform.slice(1, half) * kTwoPi;
  return torch::cat({radius * angle.cos(), radius * angle.sin()}, 1).slice(1, 0, count);
}

}  // namespace

Draws::Draws(std::uint64_t seed, std::int64_t step, int phase, int shard)
    : seed_(seed), key_(std::to_string(step) + "/" + std::to_string(phase)), shard_("/" + std::to_string(shard)) {}

Draws::Draws(std::vector<std::uint64_t> seeds) : motions_(std::move(seeds)) {}

Tensor Draws::Normal(const std::string& purpose, std::int64_t leading, std::int64_t motions, std::int64_t width) {
  if (const auto given = given_.find(purpose); given != given_.end()) return given->second;
  if (motions_.empty()) {
    return NormalRows({Random(seed_, purpose, key_ + shard_)}, leading * motions * width)
        .view({leading, motions, width});
  }
  std::vector<Random> streams;
  for (const std::uint64_t motion : motions_) streams.emplace_back(motion, purpose);
  return NormalRows(std::move(streams), leading * width)
      .reshape({motions, leading, width})
      .transpose(0, 1)
      .contiguous();
}

Tensor Draws::Uniform(const std::string& purpose, std::int64_t leading, std::int64_t motions, std::int64_t width) {
  if (const auto given = given_.find(purpose); given != given_.end()) return given->second;
  if (motions_.empty()) {
    const Tensor rows = UniformRows({Random(seed_, purpose, key_ + shard_)}, leading * motions * width);
    return (1.0 - rows).view({leading, motions, width});
  }
  std::vector<Random> streams;
  for (const std::uint64_t motion : motions_) streams.emplace_back(motion, purpose);
  const Tensor rows = 1.0 - UniformRows(std::move(streams), leading * width);
  return rows.view({motions, leading, width}).transpose(0, 1).contiguous();
}

Tensor Draws::Classes(const std::string& purpose, std::int64_t motions, std::int64_t classes) {
  Tensor uniform = Uniform(purpose, 1, motions, 1).flatten();
  if (uniform.dtype() == torch::kInt64) return uniform;
  return (uniform * static_cast<double>(classes)).to(torch::kInt64).clamp_(0, classes - 1);
}

std::array<std::uint32_t, 2> Draws::Key(const std::string& purpose) const {
  Random random(seed_, purpose, key_ + shard_);
  const std::uint32_t first = random.Next();
  return {first, random.Next()};
}

bool Draws::Coin(const std::string& purpose, double probability) {
  if (const auto given = given_.find(purpose); given != given_.end()) return given->second.item<double>() != 0.0;
  return Random(seed_, purpose, key_).Uniform() < probability;
}

}  // namespace mocurate
