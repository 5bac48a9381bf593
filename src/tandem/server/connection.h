#pragma once
/// One client's connection with bounds on time and size, as the HTTP library sees it.

#include <httplib.h>

#include <array>
#include <functional>
#include <stop_token>
#include <thread>

#include "tandem/core/stop.h"

namespace tandem::server {

/// The library's own time-outs start anew with every byte, so a client that sends one now and then
/// would hold its thread for ever. Here a request has one deadline as a whole, and so has a reply.
class Connection final : public httplib::Stream {
 public:
  struct Bounds {
    std::size_t request;  ///< [byte] head and body.
    double reading;       ///< [s] for the whole request.
    double writing;       ///< [s] for the whole reply, from its first byte on.
    double hurry;         ///< [s] instead of `reading` while others wait.
  };

  /// Closes `socket` in the end.
  /// @param others_wait  whether other clients wait for a thread.
  Connection(int socket, const Bounds& bounds, std::stop_token token,
             std::function<bool()> others_wait);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() override;

  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* ptr, size_t size) override;
  ssize_t write(const char* ptr, size_t size) override;
  /// The library hands these on to handlers. The port is the socket, for HangUp.
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  int socket() const override { return socket_; }

 private:
  /// Waits until the socket is ready for `events`; false if it is `too_late` first.
  bool wait(short events, const std::function<bool()>& too_late) const;
  bool out_of_time() const;

  int socket_;
  Bounds bounds_;
  std::stop_token token_;
  std::function<bool()> others_wait_;
  Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> reply_begin_;
  std::size_t received_ = 0;
  std::array<char, 16384> buffer_;
  std::size_t next_ = 0, end_ = 0;
};

/// A stop token that also stops when the client goes away: nobody waits for the answer any more.
class HangUp {
 public:
  HangUp(int socket, std::stop_token token);
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::jthread watcher_;
};

}  // namespace tandem::server
