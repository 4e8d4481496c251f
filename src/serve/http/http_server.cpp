// SPDX-License-Identifier: Apache-2.0
// Runs cpp-httplib's parser on streams of its own, and hands requests to the handler as values.
#include "serve/http/http_server.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <memory>

#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "serve/http/http_stream.hpp"
#include "serve/http/http_threads.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"

namespace cluxel::serve {

namespace {

/// The connection that this thread serves.
thread_local HttpStream* current_stream = nullptr;

/// The path of a target that names the server, too, as proxies get it: http://host/path.
std::string pathOf(const std::string& target) {
  const std::size_t scheme = target.find("://");
  if (target.starts_with('/') || scheme == std::string::npos) return target;
  const std::size_t path = target.find_first_of("/?", scheme + 3);
  if (path == std::string::npos) return "/";
  return target[path] == '/' ? target.substr(path) : "/" + target.substr(path);
}

HttpRequest requestOf(const httplib::Request& parsed, std::string body) {
  HttpRequest request{parsed.method, pathOf(parsed.target), {}, std::move(body), parsed.remote_addr};
  request.has_hung_up = [stream = current_stream] { return stream->hasHungUp(); };
  for (const auto& [name, value] : parsed.headers) request.headers.emplace_back(lowerCase(name), value);
  return request;
}

/// cpp-httplib compresses texts as well as it can, which takes seconds for each MiB. Larger bodies are sent as they
/// are.
constexpr std::size_t kMostCompressed = std::size_t{1} << 20U;

void fill(httplib::Response& out, HttpResponse response) {
  out.status = response.status;
  for (const auto& [name, value] : response.headers) out.set_header(name, value);
  if (response.body.size() > kMostCompressed) {
    const auto body = std::make_shared<const std::string>(std::move(response.body));
    return out.set_content_provider(body->size(), response.content_type,
                                    [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                      return sink.write(body->data() + offset, length);
                                    });
  }
  if (!response.content_type.empty()) out.set_header("Content-Type", response.content_type);
  out.body = std::move(response.body);
}

/// Whether the length of the body is a number and given once, or the body comes in chunks. Otherwise a proxy could see
/// another request behind it.
bool hasSoundLength(const httplib::Request& request) {
  const std::string length = request.get_header_value("Content-Length");
  return request.get_header_value_count("Content-Length") < 2 &&
         length.find_first_not_of("0123456789") == std::string::npos &&
         (length.empty() || !request.has_header("Transfer-Encoding")) &&
         (!request.has_header("Transfer-Encoding") ||
          lowerCase(request.get_header_value("Transfer-Encoding")) == "chunked");
}

bool hasBody(const httplib::Request& request) {
  const std::string length = request.get_header_value("Content-Length");
  return request.has_header("Transfer-Encoding") || !(length.empty() || length == "0");
}

/// Messages of what is refused before a handler sees it.
std::string messageOf(int status, HttpStream::Fault fault) {
  if (fault == HttpStream::Fault::HeaderTooLarge) return "the headers of the request are too large";
  if (fault == HttpStream::Fault::TooSlow) return "the request did not arrive in time";
  if (status == 413) return "the body of the request is too large; the server allows less";
  if (status == 414) return "the URL is too long; send the query by POST";
  return status == 400 ? "this is no well-formed HTTP request" : "the request cannot be answered";
}

int statusOf(int status, HttpStream::Fault fault) {
  if (fault == HttpStream::Fault::HeaderTooLarge) return 431;
  return fault == HttpStream::Fault::TooSlow ? 408 : status;
}

/// What is sent without cpp-httplib: it has read no request line.
void writeRefusal(HttpStream& stream, const std::string& status, const std::string& message) {
  const std::string response =
      "HTTP/1.1 " + status + "\r\nConnection: close\r\nContent-Type: text/plain; charset=utf-8" +
      "\r\nContent-Length: " + std::to_string(message.size() + 1) + "\r\n\r\n" + message + "\n";
  stream.closeAfterResponse();
  stream.write(response.data(), response.size());
}

/// Whether accept() may go on after a fault: the system is short of something, or the connection failed before it was
/// taken. Others say that the socket does not listen any more.
bool isPassing(int fault) {
  return fault != EBADF && fault != EINVAL && fault != ENOTSOCK && fault != EFAULT;
}

Error tooManyFiles() {
  return {ErrorKind::StoreUnavailable,
          "the server cannot listen: too many files are open; allow more, or end other programs"};
}

/// Closes the file that it holds.
class OpenFile {
 public:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {
    if (descriptor < 0) throw tooManyFiles();
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace

struct HttpServer::Impl : httplib::Server {
  Impl(const HttpOptions& given, HttpHandler to_handle, AccessLog to_log)
      : options(given), handler(std::move(to_handle)), log(std::move(to_log)), stop_event(::eventfd(0, EFD_CLOEXEC)) {
    set_payload_max_length(options.max_body_bytes);
    set_keep_alive_max_count(kKeepAliveRequests);
    set_keep_alive_timeout(std::chrono::duration_cast<std::chrono::seconds>(options.idle_time).count());
    set_pre_routing_handler([this](const auto& in, auto& out) { return answerWithoutBody(in, out); });
    Post(R"([\s\S]*)", [this](const auto& in, auto& out, const auto& reader) { answerWithBody(in, out, reader); });
    set_error_handler([](const httplib::Request&, httplib::Response& out) { explain(out); });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& out) {
      closeOnce(out);
      out.headers.erase("Accept-Ranges");  // cpp-httplib offers them; every answer is sent whole
    });
    set_logger([this](const auto& in, const auto& out) { record(in, out); });
    // Without SO_REUSEPORT: two servers must not share a port unnoticed.
    set_socket_options([](socket_t sock) {
      const int yes = 1;
      ::setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    bind();
  }

  void bind() {
    errno = 0;
    port = options.port == 0 ? bind_to_any_port(options.host) : options.port;
    const bool is_bound = options.port == 0 ? port > 0 : bind_to_port(options.host, options.port);
    if (!is_bound && (errno == EMFILE || errno == ENFILE)) throw tooManyFiles();
    if (!is_bound)
      throw Error(ErrorKind::InvalidArgument, "the server cannot listen on " + options.host + " port " +
                                                  std::to_string(options.port) +
                                                  ": another program uses it, or the address is not of this machine; "
                                                  "choose another port");
    listener = std::make_unique<const OpenFile>(svr_sock_);
    ::listen(listener->descriptor(), kBacklog);  // cpp-httplib's queue of five connections is short
  }

  /// Returns when the socket listens no more and all connections have ended. Not by cpp-httplib: it ends at faults that
  /// pass, and does not hear that it shall stop while the process may open no more files.
  void takeConnections() {
    HttpThreads threads(options.max_connections);
    while (!is_stopping) {
      const int sock = ::accept4(listener->descriptor(), nullptr, nullptr, SOCK_CLOEXEC);
      if (sock >= 0) {
        threads.enqueue([this, sock] { process_and_close_socket(sock); });
      } else if (isPassing(errno)) {
        waitAfterFault();
      } else {
        break;
      }
    }
    endConnections();
    threads.shutdown();
  }

  /// For a moment, in which the system may get back what it is short of, or until the server ends.
  void waitAfterFault() const {
    constexpr int pause_ms = 10;
    pollfd entry{stop_event.descriptor(), POLLIN, 0};
    ::poll(&entry, 1, pause_ms);
  }

  static HandlerResponse refuse(httplib::Response& out, int status, const std::string& message) {
    endAfter(out);
    fill(out, textResponse(status, message));
    return HandlerResponse::Handled;
  }

  HandlerResponse answerWithoutBody(const httplib::Request& in, httplib::Response& out) {
    if (!hasSoundLength(in))
      return refuse(out, 400,
                    "the length of the body is no number or is given twice, or its transfer encoding is not chunked");
    const bool has_length = in.has_header("Content-Length") || in.has_header("Transfer-Encoding");
    if (in.method == "POST" && !has_length) return refuse(out, 411, "the length of the body is missing");
    const bool is_too_large = in.get_header_value<uint64_t>("Content-Length") > options.max_body_bytes;
    if (in.method == "POST" && !in.is_multipart_form_data() && !in.has_header("Content-Encoding") && !is_too_large)
      return HandlerResponse::Unhandled;
    if (hasBody(in)) endAfter(out);
    if (is_too_large)
      fill(out, textResponse(413, messageOf(413, HttpStream::Fault::None)));
    else if (in.method == "POST")
      fill(out, textResponse(415, "a form of several parts or a compressed body is not taken; send the text as it is"));
    else
      fill(out, handler(requestOf(in, {})));
    return HandlerResponse::Handled;
  }

  void answerWithBody(const httplib::Request& in, httplib::Response& out, const httplib::ContentReader& reader) {
    std::string body;
    const bool is_read = reader([&](const char* bytes, std::size_t count) {
      if (body.size() + count > options.max_body_bytes) {
        out.status = 413;
        return false;
      }
      body.append(bytes, count);
      return true;
    });
    if (is_read) return fill(out, handler(requestOf(in, std::move(body))));
    endAfter(out);
    if (out.status < 400) out.status = 400;
  }

  /// Of responses that cpp-httplib makes itself.
  static void explain(httplib::Response& out) {
    if (!out.body.empty()) return;
    const HttpStream::Fault fault = current_stream->fault();
    endAfter(out);
    fill(out, textResponse(statusOf(out.status, fault), messageOf(out.status, fault)));
  }

  void record(const httplib::Request& in, const httplib::Response& out) const {
    if (!log) return;
    std::string client = in.remote_addr;
    int ignored = 0;
    if (client.empty()) current_stream->get_remote_ip_and_port(client, ignored);
    log({client, in.method, in.target, out.status, std::max(out.body.size(), out.content_length_),
         current_stream->secondsSinceBegin()});
  }

  bool process_and_close_socket(socket_t sock) override {
    HttpStream stream(sock, stop_event.descriptor(), options);
    current_stream = &stream;
    if (HttpThreads::isRefused()) {
      writeRefusal(stream, "503 Service Unavailable\r\nRetry-After: 1",
                   "the server has too many connections; ask again soon");
    } else {
      serveRequests(stream);
    }
    stream.close();
    current_stream = nullptr;
    return true;
  }

  void serveRequests(HttpStream& stream) {
    while (stream.awaitRequest()) {
      bool is_closed = false;
      const bool is_last = is_ending;
      const auto begin_body = [&stream](httplib::Request&) { stream.beginBody(); };
      const bool is_answered = process_request(stream, is_last, is_closed, begin_body);
      if (stream.hasOverlongRequestLine()) refuseUrl(stream);
      if (!is_answered || is_closed || is_last || stream.mustClose()) return;
    }
  }

  void refuseUrl(HttpStream& stream) const {
    writeRefusal(stream, "414 URI Too Long", messageOf(414, HttpStream::Fault::None));
    httplib::Request unread;
    unread.method = unread.target = "-";
    httplib::Response sent;
    sent.status = 414;
    record(unread, sent);
  }

  /// Not by cpp-httplib's stop(): it gives up large bodies that are not yet sent, and closes a socket that accept() may
  /// still use. accept() fails on a socket that is shut down, now or when it is called.
  void stopListening() const { ::shutdown(listener->descriptor(), SHUT_RDWR); }

  /// Connections end when their request is answered, and idle ones at once.
  void endConnections() {
    is_ending = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_event.descriptor(), &one, sizeof one);
  }

  /// A connection that ends is told once, whoever ends it: the client, cpp-httplib or endAfter(); nothing keeps it
  /// then.
  static void closeOnce(httplib::Response& out) {
    if (!out.has_header("Connection")) return;
    out.headers.erase("Connection"), out.headers.erase("Keep-Alive");
    out.set_header("Connection", "close");
  }

  /// The connection ends after the response.
  static void endAfter(httplib::Response& out) {
    current_stream->closeAfterResponse();
    out.set_header("Connection", "close");
  }

  static constexpr int kBacklog = 512;
  static constexpr std::size_t kKeepAliveRequests = 1'000'000;  ///< what responses announce
  HttpOptions options;
  HttpHandler handler;
  AccessLog log;
  OpenFile stop_event;
  std::unique_ptr<const OpenFile> listener;  ///< the socket that cpp-httplib has made, and leaves open
  int port = 0;
  std::atomic<bool> is_ending = false;    ///< no request is read any more
  std::atomic<bool> is_stopping = false;  ///< by stop()
};

HttpServer::HttpServer(const HttpOptions& options, HttpHandler handler, AccessLog log)
    : impl_(std::make_unique<Impl>(options, std::move(handler), std::move(log))) {}
HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return impl_->port;
}

void HttpServer::run() {
  impl_->takeConnections();
  if (impl_->is_stopping) return;
  impl_->stopListening();  // clients need not wait for an answer
  throw Error(
      ErrorKind::StoreUnavailable,
      "the server can take no more connections: the system has closed its socket; what was running is answered; "
      "start it again");
}

void HttpServer::stop() {
  impl_->is_stopping = true;
  impl_->endConnections();
  impl_->stopListening();
}

}  // namespace cluxel::serve
