// SPDX-License-Identifier: Apache-2.0
// gzip by zlib, in one call.
#include "base/packing/gzip_bytes.hpp"

#include <zlib.h>

#include <limits>

#include "cluxel/error.hpp"

namespace cluxel {

std::string gzipped(std::string_view bytes) {
  constexpr int kGzip = 16, kWindow = 15, kLevel = 6, kMemory = 8;
  z_stream stream{};
  if (bytes.size() > std::numeric_limits<uInt>::max() ||
      deflateInit2(&stream, kLevel, Z_DEFLATED, kGzip + kWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ErrorKind::BudgetExceeded, "a block of " + std::to_string(bytes.size()) +
                                               " bytes cannot be compressed; take fewer points or free memory");
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace cluxel
