#pragma once
/// Options that several subcommands share, and how they answer.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tandem/pipeline/plan.h"

namespace tandem::app {

/// CELL and --package-path.
struct CellOptions {
  std::string file;
  std::vector<std::string> packages;

  void add_packages(CLI::App& command);
  CLI::Option* add_to(CLI::App& command);  ///< The option CELL.
  Result<std::shared_ptr<const world::Workcell>> load() const;
};

/// --preset, --strategy, --interpolation, --seed, --deadline: the same everywhere.
struct PlanningOptions {
  std::string preset, strategy, interpolation;
  pipeline::PlanOptions values;

  void add_to(CLI::App& command);
  pipeline::PlanOptions with(std::stop_token token) const;
};

/// --force: outputs never replace a file without it.
void add_force(CLI::App& command, bool& force);

/// Checks for CLI11 options.
CLI::Validator one_of(const std::vector<std::string>& names);
CLI::Validator positive_number(double most = std::numeric_limits<double>::infinity());
CLI::Validator whole_number(std::uint64_t least);

/// Prints "tandem COMMAND: MESSAGE" to stderr and returns the exit code for it.
int report(const std::string& command, const Error& error);
/// Writes `text` to stdout.   @return kOk, or kUsage with a message if stdout cannot be written.
int print(const std::string& command, const std::string& text);
inline constexpr double kHighestRate = 1e6;  ///< [Hz] of samples.

/// Whether progress is worth showing: stderr is a terminal.
bool shows_progress();

}  // namespace tandem::app
