// SPDX-License-Identifier: Apache-2.0
// A request that is not answered: the HTTP status with a plain message.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

#include "serve/http/http_message.hpp"

namespace cluxel::serve {

/// Thrown by handlers. what() says what is wrong and what to do.
class Refusal : public std::runtime_error {
 public:
  Refusal(int status, const std::string& message, HeaderList headers = {})
      : std::runtime_error(message), status_(status), headers_(std::move(headers)) {}
  int status() const { return status_; }
  const HeaderList& headers() const { return headers_; }

 private:
  int status_;
  HeaderList headers_;
};

/// The server is busy: status 503 with Retry-After.
Refusal busy(const std::string& message);
/// The client has hung up: status 499, which stands in the log only.
Refusal abandoned();

/// A plain text of one or more lines.
HttpResponse textResponse(int status, std::string text);
/// The response to what a handler threw. Faults of a request are 400, unknown names 404, a store that cannot be read or
/// is being written 503, an exceeded budget 503, all else 500.
HttpResponse responseTo(const std::exception_ptr& fault);

}  // namespace cluxel::serve
