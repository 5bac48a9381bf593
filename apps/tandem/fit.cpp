#include "tandem/fitting/fit.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "options.h"
#include "stop_signals.h"
#include "tandem/io/plan_file.h"
#include "tandem/io/table.h"
#include "tandem/io/volumes_file.h"
#include "tandem/robot/urdf.h"

namespace tandem::app {

namespace {

using fitting::LinkFit;
using io::Table;

struct FitCommand {
  CellOptions robot;  // Its packages.
  std::string urdf, output;
  std::vector<std::string> links, kinds;
  fitting::FitOptions options;
  double time = std::numeric_limits<double>::infinity();
  bool json = false, force = false;
};

constexpr const char* kKinds[] = {"sphere", "capsule", "rounded_rectangle", "box"};

std::array<int, 4> kinds_of(const LinkFit& fit) {
  std::array<int, 4> counts{};
  for (const auto& volume : fit.volumes_L) ++counts[static_cast<std::size_t>(volume.size_count())];
  return counts;
}

double excess_percent(const LinkFit& fit) {
  return fit.solid > 0 ? 100 * fit.excess / fit.solid : 0.0;
}

std::string table_text(const std::vector<LinkFit>& fits) {
  Table table;
  table.row({"link", "source", "triangles", "spheres", "capsules", "rectangles", "boxes",
             "solid [l]", "excess", "mean [mm]", "protrusion [mm]", "time [s]"});
  double solid = 0, excess = 0, area = 0, seconds = 0;
  for (const LinkFit& fit : fits) {
    std::vector<std::string> row{fit.link, fit.source, std::to_string(fit.triangles)};
    for (const int count : kinds_of(fit)) row.push_back(std::to_string(count));
    row.insert(row.end(), {Table::number(1e3 * fit.solid, 3) + (fit.is_closed ? "" : "*"),
                           Table::number(excess_percent(fit), 1) + " %",
                           Table::number(fit.area > 0 ? 1e3 * fit.excess / fit.area : 0.0, 1),
                           Table::number(1e3 * fit.protrusion, 1),
                           Table::number(fit.seconds, 1) + (fit.cut_short ? "+" : "")});
    table.row(std::move(row));
    solid += fit.solid;
    excess += fit.excess;
    area += fit.area;
    seconds += fit.seconds;
  }
  std::vector<std::string> sum{"all", "", "", "", "", "", "", Table::number(1e3 * solid, 3)};
  sum.push_back(Table::number(solid > 0 ? 100 * excess / solid : 0.0, 1) + " %");
  sum.push_back(Table::number(area > 0 ? 1e3 * excess / area : 0.0, 1));
  sum.insert(sum.end(), {"", Table::number(seconds, 1)});
  table.row(std::move(sum));
  std::string notes;
  for (const LinkFit& fit : fits) {
    if (!fit.is_closed) notes = "* the mesh is open: its solid is a guess by winding numbers\n";
  }
  return table.text() + notes;
}

std::string json_text(const robot::Model& model, const FitCommand& command,
                      const std::vector<LinkFit>& fits) {
  nlohmann::ordered_json links = nlohmann::ordered_json::array();
  for (const LinkFit& fit : fits) {
    nlohmann::ordered_json counts;
    for (std::size_t i = 0; i < std::size(kKinds); ++i) counts[kKinds[i]] = kinds_of(fit)[i];
    links.push_back({{"link", fit.link},
                     {"source", fit.source},
                     {"triangles", fit.triangles},
                     {"closed", fit.is_closed},
                     {"volumes", counts},
                     {"solid_m3", fit.solid},
                     {"excess_m3", fit.excess},
                     {"area_m2", fit.area},
                     {"protrusion_m", fit.protrusion},
                     {"seconds", fit.seconds},
                     {"cut_short", fit.cut_short}});
  }
  const nlohmann::ordered_json all{{"robot", model.name()},
                                   {"count", command.options.count},
                                   {"starts", command.options.starts},
                                   {"seed", command.options.seed},
                                   {"padding_m", command.options.padding},
                                   {"kinds", command.kinds},
                                   {"links", links}};
  return all.dump(2) + "\n";
}

std::string file_text(const robot::Model& model, const FitCommand& command,
                      const std::vector<LinkFit>& fits) {
  const auto& options = command.options;
  std::string comment = "Swept sphere volumes of robot " + model.name() +
                        " in link frames [m], made by tandem fit from\n" +
                        std::filesystem::path(command.urdf).filename().string() + ": at most " +
                        std::to_string(options.count) + " per link, " +
                        std::to_string(options.starts) + " starts, seed " +
                        std::to_string(options.seed);
  if (!options.kinds.all()) {
    comment += ", of";
    for (const std::string& kind : command.kinds) comment += " " + kind;
  }
  if (options.padding > 0) comment += ", padding " + std::to_string(options.padding) + " m";
  comment +=
      ".\nProven to contain the surface of each link's collision geometry. Excess is the volume "
      "outside of\nit, protrusion the largest distance of a volume's surface from it, both before "
      "padding.";
  std::vector<io::VolumesEntry> entries;
  for (const LinkFit& fit : fits) {
    entries.push_back({fit.link,
                       fit.source + ": excess " + Table::number(excess_percent(fit), 1) + " % of " +
                           Table::number(1e3 * fit.solid, 3) + " l, protrusion " +
                           Table::number(1e3 * fit.protrusion, 1) + " mm",
                       fit.volumes_L});
  }
  return io::volumes_text(comment, entries);
}

void show_progress(const std::string& link, int number, int total) {
  if (!shows_progress()) return;
  std::cerr << "\r\033[K" << number << "/" << total << ", " << link << std::flush;
}

int run(const FitCommand& command) {
  const auto failed = [](const Error& error) { return report("fit", error); };
  if (!command.output.empty()) {
    auto writable = io::check_writable(command.output, command.force);
    if (!writable) return failed(writable.error());
  }
  const StopSignals signals;
  const auto model = robot::load_urdf(
      command.urdf, robot::PackagePath::with_environment(
                        {command.robot.packages.begin(), command.robot.packages.end()}));
  if (!model) return failed(model.error());
  const auto fits =
      fitting::fit_links(*model, command.links, command.options,
                         StopCondition::after(command.time, signals.token()), show_progress);
  if (shows_progress()) std::cerr << "\r\033[K" << std::flush;
  if (!fits) return failed(fits.error());
  if (!command.output.empty()) {
    auto written = io::write_file(command.output, file_text(*model, command, *fits), command.force);
    if (!written) return failed(written.error());
  }
  const int printed =
      print("fit", command.json ? json_text(*model, command, *fits) : table_text(*fits));
  for (const LinkFit& fit : *fits) {
    if (!fit.cut_short) continue;
    std::cerr << "tandem fit: the time ran out; the volumes are proven, but a longer --time may "
                 "find tighter ones"
              << std::endl;
    break;
  }
  return printed;
}

void add_options(CLI::App& sub, FitCommand& command) {
  sub.add_option("URDF", command.urdf, "Robot")->required()->type_name("");
  sub.add_option("-o,--output", command.output, "Write the volumes file here")->type_name("FILE");
  add_force(sub, command.force);
  command.robot.add_packages(sub);
  sub.add_option("--link", command.links, "Fit this link only; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  sub.add_option("--count", command.options.count, "Most volumes per link")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(1) & CLI::Range(1, 32).description(""));
  sub.add_option("--kinds", command.kinds,
                 "Which may be used, of sphere, capsule, rounded_rectangle, box;\n"
                 "the first two are the fastest to check")
      ->type_name("KIND,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kKinds), std::end(kKinds)))
                  .description(""));
  sub.add_option("--starts", command.options.starts,
                 "Searches begun per number of volumes: more find tighter ones")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(1) & CLI::Range(1, 100000).description(""));
  sub.add_option("--time", command.time, "End after S seconds with the best so far; else no limit")
      ->type_name("S")
      ->check(positive_number());
  sub.add_option("--seed", command.options.seed,
                 "Same seed, same volumes, if time does not run out")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_number(0));
  sub.add_option("--padding", command.options.padding, "Metres to sweep the volumes further by")
      ->type_name("M")
      ->check(positive_number(10));
  sub.add_flag("--json", command.json, "Print JSON instead of a table");
}

}  // namespace

void add_fit(CLI::App& app, int& exit_code) {
  CLI::App* sub = app.add_subcommand("fit", "Fit swept sphere volumes to a robot's meshes");
  auto command = std::make_shared<FitCommand>();
  add_options(*sub, *command);
  sub->footer(
      "Encloses each link's collision geometry (meshes, boxes, cylinders; spheres are kept) in a\n"
      "few spheres, capsules, rounded rectangles and rounded boxes with little excess volume, as\n"
      "few and as simple as pays. That they contain it is proven. Prints a table: what each link\n"
      "was fitted to, its volumes by kind, the solid's volume, what the volumes add to it, also "
      "as\n"
      "mean thickness over its surface, and how far they protrude.\n\n"
      "Example:\n"
      "  tandem fit robot.urdf --package-path packages -o robot.volumes.yaml\n\n"
      "Exit codes: 0 done, 2 options or files that cannot be used, 130 interrupted (nothing is\n"
      "written).");
  sub->callback([command, &exit_code] {
    if (command->kinds.empty()) command->kinds.assign(std::begin(kKinds), std::end(kKinds));
    command->options.kinds = 0;
    for (std::size_t i = 0; i < std::size(kKinds); ++i) {
      command->options.kinds[i] = std::ranges::count(command->kinds, kKinds[i]) > 0;
    }
    exit_code = run(*command);
  });
}

}  // namespace tandem::app
