// SPDX-License-Identifier: Apache-2.0
// MD5, SHA1, SHA256, SHA384, SHA512 of a string's UTF-8 bytes.
#include <openssl/evp.h>

#include <array>

#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {
namespace {

Value digest(const EVP_MD* algorithm, Arguments arguments, FunctionContext& context) {
  if (arguments[0].type != Value::Type::String) return {};
  const std::string text = context.terms.textOf(arguments[0]);
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), bytes.data(), &size, algorithm, nullptr) != 1) return {};
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string out;
  for (unsigned i = 0; i < size; ++i) out += {kHex[bytes[i] >> 4], kHex[bytes[i] & 15]};
  return Value::string(std::move(out));
}

}  // namespace

Value md5Function(Arguments arguments, FunctionContext& context) {
  return digest(EVP_md5(), arguments, context);
}
Value sha1Function(Arguments arguments, FunctionContext& context) {
  return digest(EVP_sha1(), arguments, context);
}
Value sha256Function(Arguments arguments, FunctionContext& context) {
  return digest(EVP_sha256(), arguments, context);
}
Value sha384Function(Arguments arguments, FunctionContext& context) {
  return digest(EVP_sha384(), arguments, context);
}
Value sha512Function(Arguments arguments, FunctionContext& context) {
  return digest(EVP_sha512(), arguments, context);
}

}  // namespace cluxel::sparql
