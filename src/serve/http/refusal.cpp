// SPDX-License-Identifier: Apache-2.0
// Statuses of faults.
#include "serve/http/refusal.hpp"

#include <new>

#include "cluxel/error.hpp"

namespace cluxel::serve {

Refusal busy(const std::string& message) {
  return {503, message, {{"Retry-After", "1"}}};
}

Refusal abandoned() {
  return {499, "the client hung up before the answer was ready"};
}

HttpResponse textResponse(int status, std::string text) {
  if (text.empty() || text.back() != '\n') text += '\n';
  return {status, "text/plain; charset=utf-8", std::move(text), {}};
}

namespace {

HttpResponse responseOf(const Error& error) {
  switch (error.kind()) {
    case ErrorKind::InvalidArgument:
    case ErrorKind::FaultyInput:
      return textResponse(400, error.what());
    case ErrorKind::NotFound:
      return textResponse(404, error.what());
    case ErrorKind::StoreUnavailable: {
      HttpResponse response = textResponse(503, error.what());
      response.headers.emplace_back("Retry-After", "1");
      return response;
    }
    case ErrorKind::BudgetExceeded:
      return textResponse(503, std::string(error.what()) + "\nask for less, or raise the limits of the server");
  }
  return textResponse(500, error.what());
}

}  // namespace

HttpResponse responseTo(const std::exception_ptr& fault) {
  try {
    std::rethrow_exception(fault);
  } catch (const Refusal& refusal) {
    HttpResponse response = textResponse(refusal.status(), refusal.what());
    response.headers = refusal.headers();
    return response;
  } catch (const Error& error) {
    return responseOf(error);
  } catch (const std::bad_alloc&) {
    return textResponse(503, "not enough memory for this request; ask for less");
  } catch (const std::exception& error) {
    return textResponse(500, error.what());
  }
}

}  // namespace cluxel::serve
