// SPDX-License-Identifier: Apache-2.0
// How the HTTP server stops, and what it does when the system refuses it something.
#include "serve/http/http_server.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cluxel/error.hpp"
#include "serve/http_client.hpp"

/// The fault of the next call of accept4(); 0: none.
static std::atomic<int> next_fault_of_accept{0};

/// In place of that of the system.
extern "C" int accept4(int listener, sockaddr* address, socklen_t* length, int flags) {
  if (const int fault = next_fault_of_accept.exchange(0); fault != 0) {
    errno = fault;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_accept4, listener, address, length, flags));
}

namespace cluxel::serve {
namespace {

constexpr std::size_t kLargeBody = std::size_t{3} << 20U;
constexpr const char* kGet = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";

HttpResponse hello(const HttpRequest&) {
  return {200, "text/plain", "hello\n", {}};
}

/// The socket that listens on the port, as the system knows it.
int listenerOn(int port) {
  for (int descriptor = 3; descriptor < 1024; ++descriptor) {
    sockaddr_in address{};
    socklen_t length = sizeof address;
    int listens = 0;
    socklen_t size = sizeof listens;
    if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &length) == 0 &&
        ::getsockopt(descriptor, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 && listens != 0 &&
        ntohs(address.sin_port) == port)
      return descriptor;
  }
  return -1;
}

TEST(HttpServer, AnswersWhatRunsWhenItStopsAlsoWithALargeBody) {
  std::promise<void> begun, stopped;
  const HttpHandler slow = [&](const HttpRequest&) {
    begun.set_value();
    stopped.get_future().wait();
    return HttpResponse{200, "text/plain", std::string(kLargeBody, 'x'), {}};
  };
  HttpServer server({}, slow);
  std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
  const Client client(server.port());
  client.send(kGet);
  begun.get_future().wait();
  server.stop();
  stopped.set_value();
  EXPECT_EQ(bodyOf(client.rest()).size(), kLargeBody);
  EXPECT_NO_THROW(run.get());
  EXPECT_FALSE(Client(server.port()).isOpen());
}

TEST(HttpServer, StopsAlsoBeforeItRunsAndWhenAskedByManyWhileClientsCome) {
  HttpServer early({}, hello);
  early.stop();
  early.run();
  for (int round = 0; round < 20; ++round) {
    HttpServer server({}, hello);
    std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
      threads.emplace_back([&] {
        const Client client(server.port());
        client.send(kGet);
        client.readTo("hello\n");
        if (round % 2 == 0) Client(server.port()).send("GET / HT");  // hangs up
        server.stop();
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_NO_THROW(run.get());
  }
}

/// The number that the next file gets.
int lowestFreeFile() {
  const int descriptor = ::dup(STDERR_FILENO);
  ::close(descriptor);
  return descriptor;
}

/// Lets the process open `count` more files, as long as it lives.
class FewMoreFiles {
 public:
  explicit FewMoreFiles(int count) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit few = before_;
    few.rlim_cur = static_cast<rlim_t>(lowestFreeFile() + count);
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewMoreFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FewMoreFiles(const FewMoreFiles&) = delete;
  FewMoreFiles& operator=(const FewMoreFiles&) = delete;

 private:
  rlimit before_{};
};

TEST(HttpServer, GoesOnAfterAFaultThatPasses) {
  HttpServer server({}, hello);
  std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
  for (const int fault : {ECONNABORTED, EMFILE, ENFILE, ENOBUFS, ENOMEM, EPERM, EPROTO, EINTR, ENETUNREACH}) {
    next_fault_of_accept = fault;
    for (int i = 0; i < 2; ++i) {  // the call that waits takes the first, and the next call fails
      const Client client(server.port());
      client.send(kGet);
      ASSERT_EQ(bodyOf(client.readTo("hello\n")), "hello\n") << fault;
    }
    EXPECT_EQ(next_fault_of_accept, 0) << fault;
  }
  server.stop();
  EXPECT_NO_THROW(run.get());
}

TEST(HttpServer, WaitsWhileTooManyFilesAreOpenAndStopsAlsoThen) {
  for (const bool stops : {false, true}) {
    HttpServer server({}, hello);
    std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
    auto few = std::make_unique<FewMoreFiles>(1);
    const Client client(server.port());  // takes the last one
    client.send(kGet);
    if (stops) {
      server.stop();
      EXPECT_EQ(run.wait_for(std::chrono::seconds(120)), std::future_status::ready);
    }
    few.reset();
    if (!stops) {
      EXPECT_EQ(bodyOf(client.readTo("hello\n")), "hello\n");
      server.stop();
    }
    EXPECT_NO_THROW(run.get());
  }
}

TEST(HttpServer, TellsThatTooManyFilesAreOpenAndLeavesNoneOpen) {
  const int before = lowestFreeFile();
  for (int count = 0; count < 2; ++count) {
    try {
      const FewMoreFiles few(count);
      const HttpServer server({}, hello);
      ADD_FAILURE() << "with " << count << " more files";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable) << error.what();
    }
    EXPECT_EQ(lowestFreeFile(), before);
  }
  HttpServer first({}, hello);
  const int with_first = lowestFreeFile();
  HttpOptions taken;
  taken.port = first.port();
  EXPECT_THROW(HttpServer(taken, hello), Error);
  EXPECT_EQ(lowestFreeFile(), with_first);
}

TEST(HttpServer, TellsThatTheSystemClosedItsSocketAndEndsConnectionsThatAreIdle) {
  HttpOptions patient;
  patient.idle_time = std::chrono::hours(1);
  HttpServer server(patient, hello);
  std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
  const Client idle(server.port());
  idle.send(kGet);
  EXPECT_EQ(bodyOf(idle.readTo("hello\n")), "hello\n");
  const int listener = listenerOn(server.port());
  ASSERT_GE(listener, 0);
  ::shutdown(listener, SHUT_RDWR);  // accept() fails
  EXPECT_THROW(run.get(), Error);
  EXPECT_EQ(idle.rest(), "");
  EXPECT_FALSE(Client(server.port()).isOpen());
}

/// Stacks of new threads that are larger than the address space, as long as it lives.
class NoMoreThreads {
 public:
  NoMoreThreads() {
    ::pthread_getattr_default_np(&before_);
    pthread_attr_t large;
    ::pthread_attr_init(&large);
    ::pthread_attr_setstacksize(&large, std::size_t{1} << 50U);
    ::pthread_setattr_default_np(&large);
    ::pthread_attr_destroy(&large);
  }
  ~NoMoreThreads() {
    ::pthread_setattr_default_np(&before_);
    ::pthread_attr_destroy(&before_);
  }
  NoMoreThreads(const NoMoreThreads&) = delete;
  NoMoreThreads& operator=(const NoMoreThreads&) = delete;

 private:
  pthread_attr_t before_{};
};

TEST(HttpServer, RefusesAConnectionForWhichThereIsNoThreadAndGoesOn) {
  HttpServer server({}, hello);
  std::future<void> run = std::async(std::launch::async, [&] { server.run(); });
  const Client first(server.port());
  first.send(kGet);
  EXPECT_EQ(bodyOf(first.readTo("hello\n")), "hello\n");
  {
    const NoMoreThreads none;
    const Client refused(server.port());
    EXPECT_EQ(refused.rest().substr(0, 12), "HTTP/1.1 503");
  }
  first.send(kGet);
  EXPECT_EQ(bodyOf(first.readTo("hello\n")), "hello\n") << "others go on";
  const Client later(server.port());
  later.send(kGet);
  EXPECT_EQ(bodyOf(later.readTo("hello\n")), "hello\n");
  server.stop();
  EXPECT_NO_THROW(run.get());
}

}  // namespace
}  // namespace cluxel::serve
