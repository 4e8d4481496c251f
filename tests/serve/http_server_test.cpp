// SPDX-License-Identifier: Apache-2.0
// How the HTTP server stops, and what it does when the system refuses it something.
#include "serve/http/http_server.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <string>
#include <thread>
#include <vector>

#include "cluxel/error.hpp"
#include "serve/http_client.hpp"

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

TEST(HttpServer, TellsThatTheSystemRefusesConnectionsAndEndsThoseThatAreIdle) {
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
