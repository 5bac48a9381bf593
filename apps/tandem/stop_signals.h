#pragma once
/// SIGINT and SIGTERM as a stop token.

#include <signal.h>

#include <stop_token>
#include <thread>

namespace tandem::app {

/// While one lives, the first SIGINT or SIGTERM requests a stop and the second ends the process
/// with code 130. At most one at a time, made before any other thread.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals();

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  sigset_t before_;
  std::thread waiter_;
};

}  // namespace tandem::app
