#include <fcntl.h>
#include <signal.h>
#include <spawn.h>

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <mutex>

#include "commands.h"
#include "plan_input.h"
#include "stop_signals.h"
#include "tandem/server/capture.h"
#include "tandem/server/server.h"

extern char** environ;

namespace tandem::app {

namespace {

using server::CaptureOptions;

constexpr int kSmallest = 64, kLargest = 4096;  // [px]
constexpr double kCaptureTime = 120;            // [s] to start a browser and draw.
constexpr double kTimePerSecond = 30;           // [s] on top, per second of a video.

struct ViewCommand {
  CellOptions cell;  ///< Its file: instead of the one that the plan names.
  std::string shown, host, page, png, webm, size = "1280x720";
  int port = 0;
  double time = 0, fps = 25;
  bool no_open = false, force = false;

  std::vector<std::string> outputs() const {
    std::vector<std::string> files;
    for (const std::string& file : {page, png, webm}) {
      if (!file.empty()) files.push_back(file);
    }
    return files;
  }
};

/// What is shown, ready for a page.
struct Shown {
  std::shared_ptr<const world::Workcell> cell;
  server::PageData data;
  double duration = 0;  ///< [s] of the plan, 0 without one.
};

bool is_plan(const std::string& file) { return std::filesystem::path(file).extension() == ".json"; }

/// The two numbers of "1280x720"; empty if it is none of that kind.
std::optional<std::pair<int, int>> parse_size(const std::string& text) {
  int width = 0, height = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, height);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  if (std::min(width, height) < kSmallest || std::max(width, height) > kLargest) {
    return std::nullopt;
  }
  return std::pair{width, height};
}

Result<void> check_outputs(const ViewCommand& command) {
  const std::vector<std::string> files = command.outputs();
  for (const std::string& file : files) {
    if (std::count(files.begin(), files.end(), file) > 1) {
      return fail(ErrorCode::kInvalidInput, file + " is named for two outputs");
    }
    if (auto writable = io::check_writable(file, command.force); !writable) return writable;
  }
  return {};
}

Result<Shown> load(const ViewCommand& command) {
  CellOptions cell_options = command.cell;
  if (!is_plan(command.shown)) {
    cell_options.file = command.shown;
    auto cell = cell_options.load();
    if (!cell) return std::unexpected(cell.error());
    return Shown{*cell, {.scene = server::describe_scene(**cell)}};
  }
  const auto plan = io::load_plan(command.shown);
  if (!plan) return std::unexpected(plan.error());
  const auto cell = load_cell(cell_options, command.shown, *plan);
  if (!cell) return std::unexpected(cell.error());
  if (const std::string why = mismatch(*plan, **cell); !why.empty()) {
    return fail(ErrorCode::kInvalidInput, command.shown + ": " + why);
  }
  std::ifstream stream(command.shown, std::ios::binary);
  return Shown{*cell,
               {.scene = server::describe_scene(**cell),
                .plan = {std::istreambuf_iterator<char>(stream), {}},
                .clearance = server::describe_clearance(collision::CompiledCell(*cell),
                                                        plan->trajectory, server::kClearanceRate)},
               plan->trajectory.duration()};
}

Result<void> check_times(const ViewCommand& command, const Shown& shown) {
  if (!command.webm.empty() && shown.duration == 0) {
    return fail(ErrorCode::kInvalidInput,
                "--webm needs a motion: name a plan file instead of a workcell");
  }
  if (command.time > shown.duration) {
    return fail(ErrorCode::kInvalidInput, "--time " + std::to_string(command.time) +
                                              " is past the end of what is shown, " +
                                              std::to_string(shown.duration) + " s");
  }
  return {};
}

Result<void> write_captures(const ViewCommand& command, const Shown& shown, const std::string& page,
                            const std::stop_token& token) {
  const auto [width, height] = *parse_size(command.size);
  const auto write = [&](const std::string& file, CaptureOptions::Kind kind,
                         double time) -> Result<void> {
    if (file.empty()) return {};
    const auto bytes = server::capture(
        shown.cell, shown.data, page,
        {.kind = kind, .time = command.time, .width = width, .height = height, .fps = command.fps},
        StopCondition::after(time, token));
    if (!bytes) return std::unexpected(bytes.error());
    return io::write_file(file, *bytes, command.force);
  };
  if (auto done = write(command.png, CaptureOptions::Kind::kPng, kCaptureTime); !done) return done;
  return write(command.webm, CaptureOptions::Kind::kWebm,
               kCaptureTime + kTimePerSecond * shown.duration);
}

Result<void> write_outputs(const ViewCommand& command, const Shown& shown, const std::string& page,
                           const std::stop_token& token) {
  if (!command.page.empty()) {
    const auto filled = server::fill_page(page, shown.data);
    if (!filled) return std::unexpected(filled.error());
    auto written = io::write_file(command.page, *filled, command.force);
    if (!written) return written;
  }
  return write_captures(command, shown, page, token);
}

/// Shows the address to the desktop, if there is one; without one the printed address has to do.
void open_address(std::string address) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {0, 1, 2}) {
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl+C ends the server, not the browser.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  std::string program = "xdg-open";
  char* arguments[] = {program.data(), address.data(), nullptr};
  pid_t process = -1;
  ::posix_spawnp(&process, program.c_str(), &files, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
}

int serve(const ViewCommand& command, const Shown& shown, std::string page,
          const std::stop_token& token) {
  const auto plan_json = [&](const pipeline::Plan& plan) {
    // Beside the workcell, where the name of its file needs no folder.
    return io::plan_json(plan, *shown.cell, shown.cell->spec().file.parent_path() / "plan.json");
  };
  server::ServerOptions options{
      .port = command.port, .page = std::move(page), .plan_json = plan_json};
  if (!command.host.empty()) {
    options.host = command.host;
    options.loopback_only = false;
  }
  const auto server = server::Server::start(shown.cell, shown.data, options);
  if (!server) return report("view", server.error());
  const int printed = print("view", server->address() + "\n");
  if (printed != kOk) return printed;
  std::cerr << "tandem view: showing " << command.shown << "; Ctrl+C ends it" << std::endl;
  if (!command.no_open) open_address(server->address());
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any().wait(lock, token, [] { return false; });
  return kOk;
}

int run(const ViewCommand& command) {
  const auto failed = [](const Error& error) { return report("view", error); };
  if (auto writable = check_outputs(command); !writable) return failed(writable.error());
  const StopSignals signals;
  auto page = server::viewer_page();
  if (!page) return failed(page.error());
  const auto shown = load(command);
  if (!shown) return failed(shown.error());
  if (auto fitting = check_times(command, *shown); !fitting) return failed(fitting.error());
  const std::vector<std::string> outputs = command.outputs();
  if (outputs.empty()) return serve(command, *shown, std::move(*page), signals.token());
  auto written = write_outputs(command, *shown, *page, signals.token());
  if (!written) return failed(written.error());
  std::string text;
  for (const std::string& file : outputs) text += "written: " + file + "\n";
  return print("view", text);
}

void add_outputs(CLI::App& sub, ViewCommand& command) {
  const char* group = "Files instead of a browser";
  const auto file = [&](const char* name, std::string& value, const char* words) {
    auto* option = sub.add_option(name, value, words);
    option->type_name("FILE")->group(group);
    return option;
  };
  file("--export", command.page, "Write the page with everything in it: opens without tandem");
  auto* png = file("--png", command.png, "Write a picture, needs Chromium");
  auto* webm = file("--webm", command.webm, "Write a video of the motion, needs Chromium");
  sub.add_option("--time", command.time, "Instant that the picture shows, needs --png")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::Validator(CLI::NonNegativeNumber).description(""))
      ->needs(png)
      ->group(group);
  sub.add_option("--fps", command.fps, "Pictures per second of the video, needs --webm")
      ->type_name("N")
      ->capture_default_str()
      ->check(positive_number(120))
      ->needs(webm)
      ->group(group);
  sub.add_option("--size", command.size, "Of picture and video [px]")
      ->type_name("WxH")
      ->capture_default_str()
      ->check(CLI::Validator(
          [](const std::string& text) {
            return parse_size(text)
                       ? std::string()
                       : "'" + text + "' is no size from " + std::to_string(kSmallest) + "x" +
                             std::to_string(kSmallest) + " to " + std::to_string(kLargest) + "x" +
                             std::to_string(kLargest);
          },
          ""))
      ->group(group);
  add_force(sub, command.force);
}

}  // namespace

void add_view(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand("view", "Show a plan or a workcell in a browser");
  auto command = std::make_shared<ViewCommand>();
  sub->add_option("SHOWN", command->shown, "Plan file (.json) or workcell file")
      ->required()
      ->type_name("");
  sub->add_option("--workcell", command->cell.file, "Instead of the workcell that the plan names")
      ->type_name("FILE");
  command->cell.add_packages(*sub);
  sub->add_option("--port", command->port, "Port to serve on; 0 takes a free one")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Validator(CLI::Range(0, 65535)).description(""));
  sub->add_option("--host", command->host,
                  "Address to serve on instead of 127.0.0.1: whoever reaches it\n"
                  "may see the cell and plan in it")
      ->type_name("ADDRESS");
  sub->add_flag("--no-open", command->no_open, "Only print the address");
  add_outputs(*sub, *command);
  sub->footer(
      "Prints the address of a page that shows the cell, the motion, how close it comes, and lets\n"
      "you plan: pick a query, or drag a tool. Ctrl+C ends it. With --export, --png or --webm it\n"
      "writes these files and serves nothing.\n\n"
      "Example:\n"
      "  tandem view plan.json --export plan.html --png plan.png --time 0.5\n\n"
      "Exit codes: 0 ended by Ctrl+C, or the files are written; 1 a picture took too long; 2\n"
      "options or files that cannot be used, no Chromium; 130 interrupted while writing.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace tandem::app
