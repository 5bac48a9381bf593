/// The command line. What it does is in the library; here are options, words and exit codes.

#include <iostream>

#include "commands.h"
#include "version.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 the job was done and the answer is no (no plan found, a query that\n"
    "cannot be reached, a plan that fails verification); 2 options or files that cannot be used;\n"
    "130 interrupted.\n\n"
    "Example:\n"
    "  tandem plan scenarios/gearbox/workcell.yaml pick_gears -o plan.json\n"
    "  tandem verify plan.json\n\n"
    "tandem COMMAND --help tells more.";

/// "tandem plan: MESSAGE" for the command that was being read.
int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  std::string name = "tandem";
  for (const CLI::App* command : app.get_subcommands()) name += " " + command->get_name();
  std::cerr << name << ": " << error.what() << "; see " << name << " --help" << std::endl;
  return tandem::app::kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Coordinated motions for robot arms that share a workspace.", "tandem");
  app.set_version_flag("--version", kVersionText, "Version and commit");
  app.require_subcommand(1);
  app.footer(kFooter);
  int exit_code = tandem::app::kOk;
  tandem::app::add_plan(app, exit_code);
  tandem::app::add_check(app, exit_code);
  tandem::app::add_fit(app, exit_code);
  tandem::app::add_verify(app, exit_code);
  tandem::app::add_bench(app, exit_code);
#ifdef TANDEM_WITH_SERVER
  tandem::app::add_view(app, exit_code);
#endif
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  }
  return exit_code;
}
