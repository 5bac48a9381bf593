#pragma once
/// A plan file and the workcell it belongs to, as several subcommands take them.

#include "options.h"
#include "tandem/io/plan_file.h"

namespace tandem::app {

/// The cell that `plan` names, or `cell.file` instead where it is given, as it stands during the
/// plan's motion.
Result<std::shared_ptr<const world::Workcell>> load_cell(const CellOptions& cell,
                                                         const std::string& plan_file,
                                                         const io::PlanFile& plan);

/// What speaks against the plan being one of this cell; empty if nothing does.
std::string mismatch(const io::PlanFile& plan, const world::Workcell& cell);

}  // namespace tandem::app
