#include "options.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <optional>

#include "commands.h"
#include "tandem/core/names.h"
#include "tandem/io/workcell_yaml.h"

namespace tandem::app {

using coordination::Interpolation;
using pipeline::Preset;
using pipeline::Strategy;

namespace {

constexpr Strategy kStrategies[] = {Strategy::kCentralized, Strategy::kDecoupled, Strategy::kAuto};
constexpr Interpolation kInterpolations[] = {Interpolation::kLinear, Interpolation::kCubic,
                                             Interpolation::kQuintic};
constexpr Preset kPresets[] = {Preset::kDefault, Preset::kPaper};

template <class Values>
std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.emplace_back(to_string(value));
  return names;
}

template <class Values>
auto named(const Values& values, const std::string& name) {
  for (const auto value : values) {
    if (to_string(value) == name) return value;
  }
  return *std::begin(values);
}

/// The whole of `text` as a number; empty if it is none.
template <class Number>
std::optional<Number> parsed(const std::string& text) {
  Number number{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
  return number;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput:
    case ErrorCode::kNotFound:
    case ErrorCode::kIo:
    case ErrorCode::kUnsupported:
      return kUsage;
    case ErrorCode::kCancelled:
      return kInterrupted;
    default:
      return kFailed;
  }
}

}  // namespace

CLI::Validator one_of(const std::vector<std::string>& names) {
  return CLI::Validator(
      [names](const std::string& text) {
        const bool known = std::find(names.begin(), names.end(), text) != names.end();
        return known ? std::string() : "there is no " + text + name_hint(text, names);
      },
      "");
}

CLI::Validator positive_number(double most) {
  return CLI::Validator(
      [most](const std::string& text) {
        const auto number = parsed<double>(text);
        if (number && *number > 0 && *number <= most) return std::string();
        return "'" + text + "' is not a number above 0" +
               (std::isfinite(most) ? " and up to " + std::to_string(std::lround(most)) : "");
      },
      "");
}

CLI::Validator whole_number(std::uint64_t least) {
  return CLI::Validator(
      [least](const std::string& text) {
        const auto number = parsed<std::uint64_t>(text);
        return number && *number >= least
                   ? std::string()
                   : "'" + text + "' is not a whole number from " + std::to_string(least) + " up";
      },
      "");
}

void CellOptions::add_packages(CLI::App& command) {
  command
      .add_option("--package-path", packages,
                  "Where package:// paths are looked for, before ROS_PACKAGE_PATH; repeatable")
      ->type_name("DIR")
      ->allow_extra_args(false)
      ->check(CLI::Validator(CLI::ExistingDirectory).description(""));
}

CLI::Option* CellOptions::add_to(CLI::App& command) {
  CLI::Option* cell =
      command.add_option("CELL", file, "Workcell file (YAML)")->required()->type_name("");
  add_packages(command);
  return cell;
}

Result<std::shared_ptr<const world::Workcell>> CellOptions::load() const {
  return io::load_workcell(file, {packages.begin(), packages.end()});
}

void PlanningOptions::add_to(CLI::App& command) {
  const char* group = "Planning options";
  preset = to_string(values.preset);
  strategy = to_string(values.strategy);
  interpolation = to_string(values.interpolation);
  command
      .add_option("--preset", preset,
                  "default: the fastest that keeps every promise;\n"
                  "paper: the paper's modules and parameters, nothing repaired")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of(names_of(kPresets)))
      ->group(group);
  command
      .add_option("--strategy", strategy,
                  "centralized: all arms together, as one robot with all their joints;\n"
                  "decoupled: each arm alone at the same time, then their motions coordinated;\n"
                  "auto: decoupled, and centralized where the arms hinder each other")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of(names_of(kStrategies)))
      ->group(group);
  command
      .add_option("--interpolation", interpolation,
                  "How the preset paper runs through coordinated places: linear makes\n"
                  "velocities jump, which is an error")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of(names_of(kInterpolations)))
      ->group(group);
  command
      .add_flag("!--no-plpp", values.plpp,
                "Leave out the path length post-processor: sooner ready, longer paths")
      ->group(group);
  command.add_option("--seed", values.seed, "Same seed, same answer")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(0))
      ->group(group);
  command.add_option("--deadline", values.deadline, "Give up after S seconds per query")
      ->type_name("S")
      ->capture_default_str()
      ->check(positive_number())
      ->group(group);
}

pipeline::PlanOptions PlanningOptions::with(std::stop_token token) const {
  pipeline::PlanOptions options = values;
  options.preset = named(kPresets, preset);
  options.strategy = named(kStrategies, strategy);
  options.interpolation = named(kInterpolations, interpolation);
  options.token = std::move(token);
  return options;
}

void add_force(CLI::App& command, bool& force) {
  command.add_flag("--force", force, "Overwrite files that exist");
}

int report(const std::string& command, const Error& error) {
  std::cerr << "tandem " << command << ": " << error.message << std::endl;
  return exit_code(error.code);
}

int print(const std::string& command, const std::string& text) {
  std::cout << text << std::flush;
  if (std::cout) return kOk;
  return report(command, {ErrorCode::kIo, "cannot write to standard output"});
}

bool shows_progress() { return ::isatty(STDERR_FILENO) == 1; }

}  // namespace tandem::app
