#include "tandem/server/capture.h"

#include <charconv>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "tandem/server/browser.h"

namespace tandem::server {

namespace {

constexpr std::size_t kLongestCapture = std::size_t{512} << 20;  // [byte]
constexpr auto kLook = std::chrono::milliseconds(50);  // Between looks at the browser and the stop.

/// A number as the page reads it, whatever the locale.
std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

std::string hash_of(const CaptureOptions& options) {
  const bool png = options.kind == CaptureOptions::Kind::kPng;
  return std::string("#paused&capture=") + (png ? "png" : "webm") +
         (png ? "&t=" + number(options.time) : "&fps=" + number(options.fps)) +
         "&width=" + std::to_string(options.width) + "&height=" + std::to_string(options.height);
}

/// The first capture that arrives.
class Mailbox {
 public:
  void put(Capture capture) {
    const std::lock_guard lock(mutex_);
    if (!capture_) capture_ = std::move(capture);
    arrived_.notify_all();
  }
  /// Waits a moment for it.
  std::optional<Capture> look() {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, kLook, [this] { return capture_.has_value(); });
    return std::exchange(capture_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::optional<Capture> capture_;
};

Result<std::string> checked(Capture capture, const CaptureOptions& options) {
  const bool png = options.kind == CaptureOptions::Kind::kPng;
  if (capture.type.starts_with(png ? "image/png" : "video/webm") && !capture.bytes.empty()) {
    return std::move(capture.bytes);
  }
  return fail(ErrorCode::kUnsupported,
              "the viewer's page could not make the picture: " +
                  (capture.type.starts_with("text/plain") ? capture.bytes
                                                          : "it sent '" + capture.type + "'"));
}

}  // namespace

Result<std::string> capture(std::shared_ptr<const world::Workcell> cell, PageData data,
                            std::string page, const CaptureOptions& options,
                            const StopCondition& stop) {
  const auto program = find_chromium();
  if (!program) return std::unexpected(program.error());
  Mailbox mailbox;
  const auto no_planning = [](const pipeline::Plan&) -> Result<std::string> {
    return fail(ErrorCode::kUnsupported, "a page that takes a picture does not plan");
  };
  const auto server = Server::start(
      std::move(cell), std::move(data),
      {.longest_body = kLongestCapture,
       .reading = 60,
       .page = std::move(page),
       .plan_json = no_planning,
       .on_capture = [&mailbox](Capture capture) { mailbox.put(std::move(capture)); }});
  if (!server) return std::unexpected(server.error());
  const auto browser =
      Browser::open(*program, server->address() + hash_of(options), options.width, options.height);
  if (!browser) return std::unexpected(browser.error());
  while (true) {
    if (auto capture = mailbox.look()) return checked(std::move(*capture), options);
    if (!browser->running()) {
      return fail(ErrorCode::kIo, program->string() + " ended before the picture was made: " +
                                      browser->last_words());
    }
    if (stop.cancelled()) return std::unexpected(stop.error("taking the picture"));
    if (stop.timed_out()) {
      return fail(ErrorCode::kTimeout, program->string() +
                                           " took too long to make the picture; is Debian's "
                                           "package chromium whole? It said: " +
                                           browser->last_words());
    }
  }
}

}  // namespace tandem::server
