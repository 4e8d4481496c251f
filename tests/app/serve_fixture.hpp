// SPDX-License-Identifier: Apache-2.0
// Starts `cluxel serve` as a process of its own, and talks to it by sockets.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>

#include "app/program_fixture.hpp"

namespace cluxel::app {

/// A response as it came: status, header lines, body.
struct Reply {
  int status = 0;
  std::string head, body;

  bool has(const std::string& header_line) const { return head.find("\r\n" + header_line) != std::string::npos; }
  std::string header(const std::string& name) const {
    const std::size_t at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 4;
    return head.substr(begin, head.find("\r\n", begin) - begin);
  }
};

/// A connection to a port of this machine.
class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool isOpen() const { return is_open_; }
  void send(const std::string& bytes) const {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;
      sent += static_cast<std::size_t>(count);
    }
  }
  void endSending() const { ::shutdown(socket_, SHUT_WR); }
  /// All that comes until the other end closes.
  std::string receiveAll(int patience_ms = 60'000) const {
    std::string all;
    std::array<char, 65536> piece{};
    pollfd entry{socket_, POLLIN, 0};
    while (::poll(&entry, 1, patience_ms) > 0) {
      const ssize_t count = ::recv(socket_, piece.data(), piece.size(), 0);
      if (count <= 0) break;
      all.append(piece.data(), static_cast<std::size_t>(count));
    }
    return all;
  }

 private:
  int socket_;
  bool is_open_ = false;
};

inline Reply replyOf(const std::string& bytes) {
  Reply reply;
  const std::size_t cut = bytes.find("\r\n\r\n");
  reply.head = bytes.substr(0, cut == std::string::npos ? cut : cut + 2);
  if (cut != std::string::npos) reply.body = bytes.substr(cut + 4);
  if (bytes.starts_with("HTTP/1.1 ")) reply.status = std::atoi(bytes.c_str() + 9);
  return reply;
}

/// A running `cluxel serve`.
class Served {
 public:
  /// `program` is a command line without output; `log` takes stderr.
  Served(const std::string& program, const fs::path& log) {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(pipe[1], STDOUT_FILENO);
      const std::string command = "exec " + program + " 2> " + log.string();
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(pipe[1]);
    std::string line;
    for (char c = 0; ::read(pipe[0], &c, 1) == 1 && c != '\n';) line += c;
    ::close(pipe[0]);
    const std::size_t colon = line.rfind(':');
    port_ = colon == std::string::npos ? 0 : std::atoi(line.c_str() + colon + 1);
  }
  ~Served() { stop(SIGKILL); }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  int port() const { return port_; }
  void signal(int number) const { ::kill(pid_, number); }
  bool isRunning() {
    if (pid_ > 0 && ::waitpid(pid_, nullptr, WNOHANG) != 0) pid_ = -1;
    return pid_ > 0;
  }
  /// Its exit code; -1 when a signal ended it.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int stop(int number) {
    if (pid_ <= 0) return -1;
    signal(number);
    return wait();
  }

  std::string exchange(const std::string& bytes) const {
    const Connection connection(port_);
    connection.send(bytes);
    return connection.receiveAll();
  }
  Reply get(const std::string& target, const std::string& headers = "") const {
    return replyOf(
        exchange("GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers + "\r\n"));
  }
  Reply post(const std::string& target, const std::string& type, const std::string& body,
             const std::string& headers = "") const {
    return replyOf(exchange("POST " + target +
                            " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: " + type +
                            "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + headers + "\r\n" + body));
  }
  Reply query(const std::string& text, const std::string& headers = "") const {
    return post("/sparql", "application/sparql-query", text, headers);
  }

 private:
  pid_t pid_ = -1;
  int port_ = 0;
};

class ServeCommand : public Program {
 protected:
  static std::string command(const std::string& arguments) { return program() + "serve --port 0 " + arguments; }
  static Served serve(const std::string& options = "", const std::string& map = "map.clx") {
    return Served(command(path(map).string() + " " + options), path("serve.log"));
  }
  /// For many tests that do not change the map.
  static const Served& shared() {
    if (!shared_) shared_ = new Served(command(path("map.clx").string()), path("shared.log"));
    return *shared_;
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
    Program::TearDownTestSuite();
  }

 private:
  static inline Served* shared_ = nullptr;
};

}  // namespace cluxel::app
