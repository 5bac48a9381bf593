#pragma once
/// The public face: load a cell, plan a query, use the trajectory.

#include "tandem/io/plan_file.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/planner.h"

namespace tandem {

using io::load_workcell;
using io::save_plan;
using motion::JointState;
using pipeline::Plan;
using pipeline::plan;
using pipeline::Planner;
using pipeline::PlanOptions;
using pipeline::Preset;
using pipeline::Strategy;
using world::Workcell;

}  // namespace tandem
