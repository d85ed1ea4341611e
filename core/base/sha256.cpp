#include "core/base/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <stdexcept>

#include "core/base/file.h"

namespace mocurate {

struct Sha256::Impl {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : impl_(std::make_unique<Impl>()) {
  if (impl_->context == nullptr || EVP_DigestInit_ex(impl_->context, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL offers no SHA-256");
  }
}

Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

Sha256& Sha256::Add(std::string_view bytes) { return Add(bytes.data(), bytes.size()); }

Sha256& Sha256::Add(const void* bytes, std::size_t size) {
  EVP_DigestUpdate(impl_->context, bytes, size);
  return *this;
}

std::string Sha256::Hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(impl_->context, digest.data(), &size);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  hex.reserve(2 * std::size_t{size});
  for (unsigned int i = 0; i < size; ++i) {
    hex += kDigits[digest[i] >> 4];
    hex += kDigits[digest[i] & 15];
  }
  return hex;
}

std::string Sha256Hex(std::string_view bytes) { return Sha256().Add(bytes).Hex(); }

Expected<std::string> Sha256OfFile(const std::filesystem::path& path) {
  Sha256 hasher;
  const Status read = ReadFileInParts(path, [&](std::string_view part) { hasher.Add(part); });
  if (!read) return Forward(read);
  return hasher.Hex();
}

}  // namespace mocurate
