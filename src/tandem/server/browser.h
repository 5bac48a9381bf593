#pragma once
/// A headless Chromium of our own, for as long as a picture takes.

#include <filesystem>
#include <memory>
#include <string>

#include "tandem/core/result.h"

namespace tandem::server {

/// TANDEM_CHROMIUM if set, else chromium on the PATH.
/// @return kNotFound naming the package to install.
Result<std::filesystem::path> find_chromium();

/// Runs from its making to its end, with a profile folder that nobody else sees.
class Browser {
 public:
  /// Opens `address` in a window of `width` x `height` [px].
  /// @return kIo if the program cannot be started or there is no room for its profile.
  static Result<Browser> open(const std::filesystem::path& program, const std::string& address,
                              int width, int height);
  Browser(Browser&&) noexcept;
  Browser& operator=(Browser&&) noexcept;
  /// Ends the program and all it started, and removes its profile.
  ~Browser();

  bool running() const;
  /// The end of what it has printed: for messages.
  std::string last_words() const;

 private:
  class Impl;
  explicit Browser(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tandem::server
