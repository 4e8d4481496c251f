// SPDX-License-Identifier: Apache-2.0
// Content hashes by OpenSSL's SHA-256.
#include "base/content_hash.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace cluxel {

static_assert(std::endian::native == std::endian::little, "numbers are hashed and stored as they lie in memory");

namespace {

/// Looked up once: that costs more than hashing a few numbers.
const EVP_MD* sha256() {
  static const std::unique_ptr<EVP_MD, decltype(&EVP_MD_free)> algorithm{EVP_MD_fetch(nullptr, "SHA256", nullptr),
                                                                         &EVP_MD_free};
  return algorithm.get();
}

std::string hexOf(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace

struct ContentHasher::State {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

ContentHasher::ContentHasher() : state_(std::make_unique<State>()) {
  if (EVP_DigestInit_ex(state_->context.get(), sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL offers no SHA-256");
}
ContentHasher::~ContentHasher() = default;
ContentHasher::ContentHasher(ContentHasher&&) noexcept = default;
ContentHasher& ContentHasher::operator=(ContentHasher&&) noexcept = default;

ContentHasher& ContentHasher::addBytes(const void* data, std::size_t size) {
  EVP_DigestUpdate(state_->context.get(), data, size);
  return *this;
}

ContentHasher& ContentHasher::addText(std::string_view text) {
  return add(static_cast<std::uint64_t>(text.size())).addBytes(text.data(), text.size());
}

ContentHash ContentHasher::finish() {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  EVP_DigestFinal_ex(state_->context.get(), digest.data(), nullptr);
  ContentHash hash;
  std::copy_n(digest.begin(), hash.bytes.size(), hash.bytes.begin());
  return hash;
}

std::string sha256Of(std::string_view text) {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL offers no SHA-256");
  return hexOf(std::span(digest).first(size));
}

std::string ContentHash::hex() const {
  return hexOf(bytes);
}

ContentHash ContentHash::fromHex(std::string_view digits) {
  constexpr std::string_view values = "0123456789abcdef";
  ContentHash hash;
  if (digits.size() != 2 * hash.bytes.size()) throw std::invalid_argument("a content hash has 32 digits");
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const std::size_t value = values.find(digits[i]);
    if (value == std::string_view::npos) throw std::invalid_argument("not a hexadecimal digit in a content hash");
    hash.bytes[i / 2] = static_cast<std::uint8_t>(hash.bytes[i / 2] << 4U | value);
  }
  return hash;
}

}  // namespace cluxel
