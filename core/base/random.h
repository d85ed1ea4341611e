#pragma once

#include <cstdint>
#include <string_view>

namespace mocurate {

namespace internal {
/// One block of Philox 4x32-10.
void Philox(const std::uint32_t (&counter)[4], const std::uint32_t (&key)[2], std::uint32_t (&block)[4]);
}  // namespace internal

/// Counter-based generator keyed by (seed, purpose, item): the same numbers for any number of workers, no global state.
/// Philox 4x32-10 (Salmon et al. 2011); the key is a hash of the three.
class Random {
 public:
  Random(std::uint64_t seed, std::string_view purpose, std::string_view item = {});

  std::uint32_t Next();
  /// Uniform in [0, 1), 53 bits.
  double Uniform();
  double Uniform(double low, double high);
  /// Uniform in [0, bound); bound > 0. Without modulo bias.
  std::uint64_t Below(std::uint64_t bound);
  /// Standard normal (Box-Muller).
  double Normal();

 private:
  void Refill();
  std::uint32_t key_[2];
  std::uint64_t counter_ = 0;
  std::uint32_t block_[4] = {};
  int used_ = 4;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace mocurate
