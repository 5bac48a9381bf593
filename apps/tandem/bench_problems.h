#pragma once
/// `tandem bench --problems`: files of planning problems instead of a workcell.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "options.h"

namespace tandem::app {

/// What a problem file needs beside it.
struct ProblemOptions {
  std::string file;
  std::vector<std::string> urdf, srdf, joints, sets;
  bool verbose = false;

  /// @return the option --problems, which the others need.
  CLI::Option* add_to(CLI::App& command);
};

/// What both kinds of bench do with their result.
struct BenchOutput {
  std::string json;
  bool force = false;
};

/// Runs the problems, prints the table, writes the JSON.   @return the exit code.
int bench_problems(const ProblemOptions& problems, const std::vector<std::string>& packages,
                   int cycles, const PlanningOptions& planning, const BenchOutput& output);

/// One line on a terminal, written over and over.
class BenchProgress {
 public:
  void show(bool success, const std::string& name, std::size_t done, std::size_t total);
  void clear() const;

 private:
  int failed_ = 0;
};

}  // namespace tandem::app
