#include "tandem/server/server.h"

#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <thread>

#include "tandem/core/contract.h"
#include "tandem/server/answers.h"
#include "tandem/server/connection.h"

namespace tandem::server {

namespace {

constexpr double kHurry = 0.5;                               // [s]
constexpr std::size_t kLongestHead = std::size_t{64} << 10;  // [byte]
constexpr const char* kJson = "application/json";

/// A fixed number of threads that knows how many clients wait for one.
class CountingQueue final : public httplib::TaskQueue {
 public:
  CountingQueue(int threads, std::atomic<int>& waiting)
      : pool_(static_cast<std::size_t>(threads)), waiting_(waiting) {}
  void enqueue(std::function<void()> task) override {
    ++waiting_;
    pool_.enqueue([this, task = std::move(task)] {
      --waiting_;
      task();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  httplib::ThreadPool pool_;
  std::atomic<int>& waiting_;
};

/// The library's server with our bounds around each connection.
class BoundedServer final : public httplib::Server {
 public:
  BoundedServer(const ServerOptions& options, std::stop_token token)
      : bounds_{options.longest_body + kLongestHead, options.reading, options.writing, kHurry},
        token_(std::move(token)) {
    new_task_queue = [this, threads = options.threads] {
      return new CountingQueue(threads, waiting_);
    };
  }

 private:
  // One request per connection: on loopback a new one costs nothing, and none is held idle.
  bool process_and_close_socket(socket_t socket) override {
    Connection connection(socket, bounds_, token_, [this] { return waiting_ > 0; });
    bool closed = false;
    try {
      return process_request(connection, true, closed, [](httplib::Request& request) {
        // A thousand overlapping ranges, or an hour of compression, are more than was asked for.
        request.ranges.clear();
        request.headers.erase("Accept-Encoding");
      });
    } catch (const std::exception&) {
      return false;  // The library's own, about one request: it costs that client the connection.
    }
  }

  Connection::Bounds bounds_;
  std::stop_token token_;
  std::atomic<int> waiting_ = 0;
};

void reply(httplib::Response& response, const Answer& answer) {
  response.status = answer.status;
  response.set_content(answer.json, kJson);
}

/// The name in "name:port" and "[::1]:port".
std::string host_name(const std::string& host) {
  const std::size_t colon = host.rfind(':');
  const bool is_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  return is_port ? host.substr(0, colon) : host;
}

bool is_loopback(const std::string& name) {
  return name == "127.0.0.1" || name == "localhost" || name == "[::1]";
}

std::string for_address(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

const char* explanation(int status) {
  switch (status) {
    case 400:
      return "the request is not well-formed HTTP";
    case 413:
      return "the request's body is too long";
    case 414:
      return "the request's address is too long";
    default:
      return "the request cannot be served";
  }
}

}  // namespace

class Server::Impl {
 public:
  Impl(std::shared_ptr<const world::Workcell> cell, PageData data, const ServerOptions& options)
      : data_(std::move(data)),
        options_(options),
        answers_(std::move(cell), options.plan_json),
        http_(options, stop_.get_token()) {
    http_.set_payload_max_length(options.longest_body);
    // The default would let a second server share the port.
    http_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    http_.set_default_headers({{"Cache-Control", "no-store"},
                               {"X-Content-Type-Options", "nosniff"},
                               {"Cross-Origin-Resource-Policy", "same-origin"}});
    add_doors();
    add_routes();
  }

  ~Impl() {
    stop_.request_stop();
    http_.stop();
    if (thread_.joinable()) thread_.join();
  }

  Result<void> start() {
    if (options_.port == 0) {
      port_ = http_.bind_to_any_port(options_.host);
    } else if (http_.bind_to_port(options_.host, options_.port)) {
      port_ = options_.port;
    }
    if (port_ <= 0) {
      std::string place = for_address(options_.host);
      if (options_.port != 0) place.append(":").append(std::to_string(options_.port));
      return fail(ErrorCode::kIo, "cannot listen on " + place +
                                      "; is the port in use, or the address not of this machine?");
    }
    thread_ = std::thread([this] { http_.listen_after_bind(); });
    // Stopping a server that does not run yet would be forgotten.
    while (!http_.is_running()) std::this_thread::yield();
    return {};
  }

  int port() const { return port_; }
  std::string address() const {
    return "http://" + for_address(options_.host) + ":" + std::to_string(port_) + "/";
  }

 private:
  /// The methods of a path; empty if the path is unknown.
  std::string method_of(const std::string& path) const {
    if (path == "/api/plan") return "GET, POST";
    if (path == "/api/ik") return "POST";
    if (path == "/api/capture") return options_.on_capture ? "POST" : "";
    const bool known = path == "/" || path == "/favicon.ico" || path == "/api/scene" ||
                       path == "/api/clearance" || path == "/api/query" || mesh_index(path) >= 0;
    return known ? "GET" : "";
  }

  /// Of "/mesh/INDEX"; -1 if it names no mesh.
  long mesh_index(const std::string& path) const {
    constexpr std::string_view kPrefix = "/mesh/";
    if (!path.starts_with(kPrefix)) return -1;
    unsigned index = 0;
    const char* end = path.data() + path.size();
    const auto parsed = std::from_chars(path.data() + kPrefix.size(), end, index);
    const bool whole = parsed.ec == std::errc() && parsed.ptr == end;
    return whole && index < data_.scene.meshes.size() ? static_cast<long>(index) : -1;
  }

  /// Why a request may not come in at all; status 200 if it may.
  Answer at_the_door(const httplib::Request& request) const {
    const std::string host = request.get_header_value("Host");
    if (request.get_header_value_count("Host") != 1 ||
        (options_.loopback_only && !is_loopback(host_name(host)))) {
      return refusal(403, "forbidden", "this server answers on this machine's own address only");
    }
    const std::string origin = request.get_header_value("Origin");
    if (!origin.empty() && !origin.ends_with("://" + host)) {
      return refusal(403, "forbidden", "this server answers its own page only");
    }
    const std::string allowed = method_of(request.path);
    if (allowed.empty()) return refusal(404, "not_found", "there is nothing at this path");
    const auto is_method = [&](const char* method) {
      return request.method == method && allowed.find(method) != std::string::npos;
    };
    if (!is_method("GET") && !is_method("POST")) {
      return refusal(405, "method_not_allowed", "this path is for " + allowed);
    }
    if (request.has_header("Content-Encoding")) {
      return refusal(415, "unsupported", "send the body as it is, not encoded");
    }
    return {};
  }

  void add_doors() {
    using HandlerResponse = httplib::Server::HandlerResponse;
    http_.set_pre_routing_handler(
        [this](const httplib::Request& request, httplib::Response& response) {
          const Answer answer = at_the_door(request);
          if (answer.status == 200) return HandlerResponse::Unhandled;
          if (answer.status == 405) response.set_header("Allow", method_of(request.path));
          reply(response, answer);
          return HandlerResponse::Handled;
        });
    http_.set_error_handler(httplib::Server::HandlerWithResponse([](const httplib::Request&,
                                                                    httplib::Response& response) {
      if (response.body.empty()) {
        reply(response, refusal(response.status, "invalid_request", explanation(response.status)));
      }
      return HandlerResponse::Handled;
    }));
    http_.set_exception_handler([](const httplib::Request&, httplib::Response& response,
                                   std::exception_ptr thrown) {
      std::string what = "unknown";
      try {
        std::rethrow_exception(std::move(thrown));
      } catch (const std::exception& exception) {
        what = exception.what();
      } catch (...) {
      }
      reply(response, refusal(500, "internal", "a defect of tandem, please report it: " + what));
    });
  }

  void add_routes() {
    const auto serve = [this](const char* path, const std::string& text, const char* type) {
      http_.Get(path, [&text, type](const httplib::Request&, httplib::Response& response) {
        response.set_content(text, type);
      });
    };
    serve("/", options_.page, "text/html; charset=utf-8");
    serve("/api/scene", data_.scene.json, kJson);
    serve("/api/plan", data_.plan, kJson);
    serve("/api/clearance", data_.clearance, kJson);
    http_.Get("/favicon\\.ico",
              [](const httplib::Request&, httplib::Response& response) { response.status = 204; });
    http_.Get("/mesh/.*", [this](const httplib::Request& request, httplib::Response& response) {
      send_mesh(mesh_index(request.path), response);
    });
    http_.Get("/api/query", [this](const httplib::Request& request, httplib::Response& response) {
      reply(response, request.has_param("name")
                          ? answers_.query(request.get_param_value("name"))
                          : refusal(400, "invalid_input", "parameter name is missing"));
    });
    http_.Post("/api/plan", [this](const httplib::Request& request, httplib::Response& response) {
      const HangUp client(request.remote_port, stop_.get_token());
      reply(response, answers_.plan(request.body, client.token()));
    });
    http_.Post("/api/ik", [this](const httplib::Request& request, httplib::Response& response) {
      reply(response, answers_.ik(request.body, stop_.get_token()));
    });
    if (!options_.on_capture) return;
    http_.Post("/api/capture",
               [this](const httplib::Request& request, httplib::Response& response) {
                 options_.on_capture({request.get_header_value("Content-Type"), request.body});
                 response.set_content("{}", kJson);
               });
  }

  void send_mesh(long index, httplib::Response& response) const {
    const std::filesystem::path& file = data_.scene.meshes[static_cast<std::size_t>(index)];
    const auto bytes = read_mesh(file);
    if (!bytes) {
      reply(response, refusal(404, to_string(bytes.error().code), bytes.error().message));
      return;
    }
    response.set_content(*bytes, mesh_type(file));
  }

  const PageData data_;
  const ServerOptions options_;
  std::stop_source stop_;
  Answers answers_;
  BoundedServer http_;
  std::thread thread_;
  int port_ = -1;
};

Result<Server> Server::start(std::shared_ptr<const world::Workcell> cell, PageData data,
                             const ServerOptions& options) {
  expects(cell != nullptr && options.plan_json, "a server needs a workcell and a plan writer");
  expects(options.threads > 0 && options.reading > 0 && options.writing > 0,
          "a server needs threads and time");
  auto impl = std::make_unique<Impl>(std::move(cell), std::move(data), options);
  if (auto started = impl->start(); !started) return std::unexpected(started.error());
  return Server(std::move(impl));
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;
int Server::port() const { return impl_->port(); }
std::string Server::address() const { return impl_->address(); }

}  // namespace tandem::server
