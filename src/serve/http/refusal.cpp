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

/// The parameter of a request that helps.
std::string hintFor(Remedy remedy) {
  if (remedy == Remedy::LocalFrame) return "\n  hint: frame=local writes metres of the map frame instead";
  if (remedy == Remedy::NameTime) return "\n  hint: since=TIME tells from when on scans count as later";
  return "";
}

HttpResponse responseOf(const Error& error) {
  const std::string told = error.what() + hintFor(error.remedy());
  switch (error.kind()) {
    case ErrorKind::InvalidArgument:
    case ErrorKind::FaultyInput:
      return textResponse(400, told);
    case ErrorKind::NotFound:
      return textResponse(404, told);
    case ErrorKind::StoreUnavailable: {
      HttpResponse response = textResponse(503, told);
      response.headers.emplace_back("Retry-After", "1");
      return response;
    }
    case ErrorKind::BudgetExceeded:
      return textResponse(503, told + "\nask for less, or raise the limits of the server");
  }
  return textResponse(500, told);
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
