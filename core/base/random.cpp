#include "core/base/random.h"

#include <cmath>
#include <string>

#include "core/base/sha256.h"

namespace mocurate {
namespace {

constexpr double kTwoPi = 6.283185307179586476925286766559;

std::uint32_t High(std::uint64_t product) { return static_cast<std::uint32_t>(product >> 32); }
std::uint32_t Low(std::uint64_t product) { return static_cast<std::uint32_t>(product); }

std::string LittleEndian(std::uint64_t value) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>((value >> (8 * i)) & 0xFF);
  return bytes;
}

/// First 64 bits of SHA-256 over seed, length of purpose, purpose, item.
std::uint64_t KeyOf(std::uint64_t seed, std::string_view purpose, std::string_view item) {
  const std::string hex =
      Sha256().Add(LittleEndian(seed)).Add(LittleEndian(purpose.size())).Add(purpose).Add(item).Hex();
  std::uint64_t key = 0;
  for (int i = 0; i < 16; ++i) {
    const char c = hex[static_cast<std::size_t>(i)];
    key = (key << 4) | static_cast<std::uint64_t>(c <= '9' ? c - '0' : c - 'a' + 10);
  }
  return key;
}

}  // namespace

namespace internal {

void Philox(const std::uint32_t (&counter)[4], const std::uint32_t (&key)[2], std::uint32_t (&block)[4]) {
  std::uint32_t c[4] = {counter[0], counter[1], counter[2], counter[3]};
  std::uint32_t k[2] = {key[0], key[1]};
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t first = std::uint64_t{0xD2511F53u} * c[0];
    const std::uint64_t second = std::uint64_t{0xCD9E8D57u} * c[2];
    c[0] = High(second) ^ c[1] ^ k[0];
    c[2] = High(first) ^ c[3] ^ k[1];
    c[1] = Low(second);
    c[3] = Low(first);
    k[0] += 0x9E3779B9u;
    k[1] += 0xBB67AE85u;
  }
  for (int i = 0; i < 4; ++i) block[i] = c[i];
}

}  // namespace internal

Random::Random(std::uint64_t seed, std::string_view purpose, std::string_view item) {
  const std::uint64_t key = KeyOf(seed, purpose, item);
  key_[0] = Low(key);
  key_[1] = High(key);
}

void Random::Refill() {
  const std::uint32_t counter[4] = {Low(counter_), High(counter_), 0, 0};
  internal::Philox(counter, key_, block_);
  ++counter_;
  used_ = 0;
}

std::uint32_t Random::Next() {
  if (used_ == 4) Refill();
  return block_[used_++];
}

double Random::Uniform() {
  const std::uint64_t high = Next() >> 5;
  const std::uint64_t low = Next() >> 6;
  return static_cast<double>((high << 26) | low) / 9007199254740992.0;
}

double Random::Uniform(double low, double high) { return low + (high - low) * Uniform(); }

std::uint64_t Random::Below(std::uint64_t bound) {
  if (bound < 2) return 0;
  // The first 2^64 mod bound values would be drawn once too often.
  const std::uint64_t refused = (0 - bound) % bound;
  for (;;) {
    const std::uint64_t high = Next();
    const std::uint64_t drawn = (high << 32) | Next();
    if (drawn >= refused) return drawn % bound;
  }
}

double Random::Normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
  const double angle = kTwoPi * Uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace mocurate
