#pragma once
/// A server that listens while a test runs, and ways to talk to it.

// clang-format off
#include <Eigen/Geometry>  // First: what follows defines a macro that Eigen uses as a name.
#include <httplib.h>
// clang-format on

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "small_cell.h"
#include "tandem/io/plan_file.h"
#include "tandem/server/server.h"

namespace tandem::test {

using nlohmann::json;

inline constexpr const char* kPage =
    R"(<!doctype html><script id="tandem-data" type="application/json">null</script><p>page)";

/// The small cell behind a server.
class LiveServer : public testing::Test {
 protected:
  void start(const std::function<void(server::ServerOptions&, server::PageData&)>& change = {}) {
    server::PageData data{.scene = server::describe_scene(*cell_)};
    server::ServerOptions options;
    options.page = kPage;
    options.plan_json = [this](const pipeline::Plan& plan) {
      return io::plan_json(plan, *cell_, "plan.json");
    };
    if (change) change(options, data);
    auto started = server::Server::start(cell_, std::move(data), options);
    ASSERT_TRUE(started) << started.error().message;
    server_.emplace(std::move(*started));
  }

  httplib::Client client() const {
    httplib::Client client("127.0.0.1", server_->port());
    client.set_read_timeout(60);
    return client;
  }

  /// What is answered at `path`; its status in `status`.
  json get(const std::string& path, int status = 200) const {
    const auto response = client().Get(path);
    EXPECT_TRUE(response) << path << ": " << httplib::to_string(response.error());
    return response ? parsed(*response, status) : json();
  }
  json post(const std::string& path, const std::string& body, int status = 200) const {
    const auto response = client().Post(path, body, "application/json");
    EXPECT_TRUE(response) << path << ": " << httplib::to_string(response.error());
    return response ? parsed(*response, status) : json();
  }

  static json parsed(const httplib::Response& response, int status) {
    EXPECT_EQ(response.status, status) << response.body.substr(0, 300);
    EXPECT_EQ(response.get_header_value("Content-Type"), "application/json");
    json value = json::parse(response.body, nullptr, false);
    EXPECT_FALSE(value.is_discarded()) << response.body.substr(0, 300);
    return value;
  }

  static std::vector<double> list_of(const Eigen::VectorXd& q) { return {q.begin(), q.end()}; }

  std::shared_ptr<const world::Workcell> cell_ = small_cell();
  std::optional<server::Server> server_;
};

/// A bare connection, for what no well-behaved client does.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { ::close(socket_); }

  bool connected() const { return connected_; }

  /// Sends as much as is taken; false once the other side has closed.
  bool send(const std::string& text) const {
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = ::send(socket_, text.data() + done, text.size() - done, MSG_NOSIGNAL);
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  /// Everything until the other side closes, or `seconds` pass.
  std::string receive(double seconds = 20) const {
    std::string text;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      pollfd entry{socket_, POLLIN, 0};
      if (::poll(&entry, 1, 20) <= 0) continue;
      char buffer[4096];
      const ssize_t count = ::recv(socket_, buffer, sizeof(buffer), 0);
      if (count <= 0) break;
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }

  /// Whether the other side closes within `seconds`.
  bool closes_within(double seconds) const {
    const auto begin = std::chrono::steady_clock::now();
    receive(seconds);
    return std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(seconds);
  }

 private:
  int socket_;
  bool connected_;
};

/// "HTTP/1.1 404 ..." to 404; 0 if it is no answer.
inline int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") && answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
}

}  // namespace tandem::test
