#pragma once
/// The subcommands. Each adds itself to the app and leaves its exit code in `exit_code`.

#include <CLI/CLI.hpp>

namespace tandem::app {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;         ///< The job was done and the answer is no.
inline constexpr int kUsage = 2;          ///< Options or files that cannot be used.
inline constexpr int kInterrupted = 130;  ///< SIGINT or SIGTERM.

void add_plan(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_fit(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_view(CLI::App& app, int& exit_code);  ///< In builds with the viewer's server only.

}  // namespace tandem::app
