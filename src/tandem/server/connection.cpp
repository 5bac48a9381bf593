#include "tandem/server/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <mutex>

namespace tandem::server {

namespace {

constexpr int kSlice_ms = 50;    // Between looks at the clock and the stop token.
constexpr double kLinger = 0.5;  // [s]

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

Connection::Connection(int socket, const Bounds& bounds, std::stop_token token,
                       std::function<bool()> others_wait)
    : socket_(socket),
      bounds_(bounds),
      token_(std::move(token)),
      others_wait_(std::move(others_wait)) {}

// A socket closed over unread bytes is reset, and the client may lose the reply it was sent.
Connection::~Connection() {
  ::shutdown(socket_, SHUT_WR);
  const auto begin = Clock::now();
  const auto too_late = [&] {
    return token_.stop_requested() || others_wait_() || seconds_since(begin) > kLinger;
  };
  while (wait(POLLIN, too_late)) {
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) break;
  }
  ::close(socket_);
}

bool Connection::wait(short events, const std::function<bool()>& too_late) const {
  while (!too_late()) {
    pollfd entry{socket_, events, 0};
    const int ready = ::poll(&entry, 1, kSlice_ms);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool Connection::out_of_time() const {
  if (token_.stop_requested()) return true;
  const double spent = seconds_since(begin_);
  return spent > bounds_.reading || (spent > bounds_.hurry && others_wait_());
}

ssize_t Connection::read(char* ptr, size_t size) {
  if (next_ == end_) {
    if (received_ >= bounds_.request) return -1;
    do {
      if (!wait(POLLIN, [this] { return out_of_time(); })) return -1;
      const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
      if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) return count;
      end_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    } while (end_ == 0);
    next_ = 0;
    received_ += end_;
  }
  const std::size_t count = std::min(size, end_ - next_);
  std::memcpy(ptr, buffer_.data() + next_, count);
  next_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t Connection::write(const char* ptr, size_t size) {
  if (!reply_begin_) reply_begin_ = Clock::now();
  const auto too_late = [this] {
    return token_.stop_requested() || seconds_since(*reply_begin_) > bounds_.writing;
  };
  while (wait(POLLOUT, too_late)) {
    const ssize_t count = ::send(socket_, ptr, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0 || (errno != EINTR && errno != EAGAIN)) return count;
  }
  return -1;
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = socket_;
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

HangUp::HangUp(int socket, std::stop_token token)
    : watcher_([socket, token = std::move(token),
                source = source_](const std::stop_token& done) mutable {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any sleep;  // Ends at once when the answer is done.
        while (!done.stop_requested()) {
          sleep.wait_for(lock, done, std::chrono::milliseconds(kSlice_ms), [] { return false; });
          pollfd entry{socket, POLLRDHUP, 0};
          if (token.stop_requested() || ::poll(&entry, 1, 0) > 0) source.request_stop();
        }
      }) {}

}  // namespace tandem::server
