#include "stop_signals.h"

#include <unistd.h>

#include "commands.h"

namespace tandem::app {

namespace {

constexpr int kLeave = SIGUSR1;  // Tells the waiting thread that nobody needs it any more.

sigset_t awaited() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, kLeave}) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

// A handler may call next to nothing safely; a thread that waits for signals may do as it likes.
StopSignals::StopSignals() {
  const sigset_t signals = awaited();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
  waiter_ = std::thread([this, signals] {
    for (int signal = 0; sigwait(&signals, &signal) == 0 && signal != kLeave;) {
      if (source_.stop_requested()) ::_exit(kInterrupted);
      source_.request_stop();
    }
  });
}

StopSignals::~StopSignals() {
  pthread_kill(waiter_.native_handle(), kLeave);
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace tandem::app
