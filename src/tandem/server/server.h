#pragma once
/// The server that the viewer's page talks to. The interface is docs/viewer.md.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "tandem/pipeline/plan.h"
#include "tandem/server/page.h"

namespace tandem::server {

/// The text of a plan's file.
using PlanWriter = std::function<Result<std::string>(const pipeline::Plan&)>;

/// What the page sends back when it was opened to take a picture.
struct Capture {
  std::string type;  ///< "image/png", "video/webm"; "text/plain" for a reason why there is none.
  std::string bytes;
};

struct ServerOptions {
  std::string host = "127.0.0.1";  ///< Address to listen on.
  int port = 0;                    ///< 0 takes a free one.
  /// Requests must name this machine's loopback in their Host header. Without it a page of any
  /// origin can reach the server once its name resolves to 127.0.0.1 (DNS rebinding).
  bool loopback_only = true;
  int threads = 16;
  std::size_t longest_body = std::size_t{1} << 20;  ///< [byte]
  double reading = 10;  ///< [s] for a whole request; half a second while others wait.
  double writing = 60;  ///< [s] for a whole reply.
  std::string page;     ///< HTML.
  PlanWriter plan_json;
  /// Given, POST /api/capture exists and calls it, from any thread.
  std::function<void(Capture)> on_capture = {};
};

/// Serves from its making to its end. A request sees the cell, its plan and meshes, nothing else of
/// the machine.
class Server {
 public:
  /// @return kIo if the address cannot be listened on.
  static Result<Server> start(std::shared_ptr<const world::Workcell> cell, PageData data,
                              const ServerOptions& options);
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  /// Stops: cuts connections, ends planning, within a fraction of a second.
  ~Server();

  int port() const;
  std::string address() const;  ///< "http://127.0.0.1:8080/"

 private:
  class Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tandem::server
