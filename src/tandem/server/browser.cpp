#include "tandem/server/browser.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <vector>

extern char** environ;

namespace tandem::server {

namespace fs = std::filesystem;

namespace {

/// WebGL in software, so that every machine draws alike; nothing that talks to the network; sound
/// and video without a person's click; a timer that is not slowed down for want of a screen.
constexpr const char* kFlags[] = {
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--disable-background-timer-throttling",
    "--disable-renderer-backgrounding",
    "--autoplay-policy=no-user-gesture-required",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
};

bool is_program(const fs::path& file) {
  std::error_code ignored;  // What cannot be looked at is no program.
  return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

std::string message_of(int error) { return std::generic_category().message(error); }

}  // namespace

Result<fs::path> find_chromium() {
  const std::string install =
      "; install Debian's package chromium (tools/setup does), or name the program in "
      "TANDEM_CHROMIUM";
  if (const char* named = std::getenv("TANDEM_CHROMIUM"); named && *named) {
    if (is_program(named)) return named;
    return fail(ErrorCode::kNotFound,
                "TANDEM_CHROMIUM is " + std::string(named) + ", which is no program" + install);
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (const fs::path file = fs::path(folder) / "chromium"; is_program(file)) return file;
  }
  return fail(ErrorCode::kNotFound, "there is no chromium on the PATH" + install);
}

class Browser::Impl {
 public:
  explicit Impl(fs::path folder) : folder_(std::move(folder)) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  ~Impl() {
    if (process_ > 0) {
      ::kill(-process_, SIGKILL);
      if (!reaped_) ::waitpid(process_, nullptr, 0);
    }
    // Its children die a moment after it and may still write; what they leave behind is in the
    // system's folder for temporary files.
    std::error_code error;
    for (int attempt = 0; attempt < 50; ++attempt) {
      fs::remove_all(folder_, error);
      if (!error) break;
      ::usleep(20000);
    }
  }

  Result<void> start(const fs::path& program, const std::string& address, int width, int height) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), std::begin(kFlags), std::end(kFlags));
    words.push_back("--window-size=" + std::to_string(width) + "," + std::to_string(height));
    words.push_back("--user-data-dir=" + (folder_ / "profile").string());
    words.push_back(address);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log().c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0600);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    // A group of its own, so that what it starts ends with it; and none of the signals that this
    // program waits for itself.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    const int error =
        ::posix_spawn(&process_, program.c_str(), &files, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error == 0) return {};
    process_ = -1;
    return fail(ErrorCode::kIo, "cannot start " + program.string() + ": " + message_of(error));
  }

  bool running() {
    reaped_ = reaped_ || ::waitpid(process_, nullptr, WNOHANG) == process_;
    return !reaped_;
  }

  std::string last_words() const {
    constexpr std::size_t kMost = 600;
    std::ifstream stream(log());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return text.size() > kMost ? text.substr(text.size() - kMost) : text;
  }

 private:
  fs::path log() const { return folder_ / "log"; }

  fs::path folder_;
  pid_t process_ = -1;
  bool reaped_ = false;
};

Result<Browser> Browser::open(const fs::path& program, const std::string& address, int width,
                              int height) {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  std::string folder = (parent / "tandem-browser-XXXXXX").string();
  if (error || !::mkdtemp(folder.data())) {
    return fail(ErrorCode::kIo, "cannot make a temporary folder " + folder + ": " +
                                    (error ? error.message() : message_of(errno)));
  }
  auto impl = std::make_unique<Impl>(folder);
  if (auto started = impl->start(program, address, width, height); !started) {
    return std::unexpected(started.error());
  }
  return Browser(std::move(impl));
}

Browser::Browser(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Browser::Browser(Browser&&) noexcept = default;
Browser& Browser::operator=(Browser&&) noexcept = default;
Browser::~Browser() = default;
bool Browser::running() const { return impl_->running(); }
std::string Browser::last_words() const { return impl_->last_words(); }

}  // namespace tandem::server
