#include "plan_input.h"

namespace tandem::app {

Result<std::shared_ptr<const world::Workcell>> load_cell(const CellOptions& cell,
                                                         const std::string& plan_file,
                                                         const io::PlanFile& plan) {
  CellOptions chosen = cell;
  if (chosen.file.empty()) chosen.file = plan.workcell;
  if (chosen.file.empty()) {
    return fail(ErrorCode::kInvalidInput,
                plan_file + " names no workcell (it was built in memory); give it by --workcell");
  }
  const auto loaded = chosen.load();
  return loaded ? io::in_scene_of(plan, *loaded) : loaded;
}

std::string mismatch(const io::PlanFile& plan, const world::Workcell& cell) {
  const auto joined = [](const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  };
  std::vector<std::string> arms;
  for (const world::Arm& arm : cell.arms()) arms.push_back(arm.name);
  if (plan.arms != arms) {
    return "the plan is for arms " + joined(plan.arms) + ", the workcell has " + joined(arms);
  }
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const world::Arm& arm = cell.arms()[i];
    const auto first = cell.joint_names().begin() + arm.offset;
    const std::vector<std::string> joints(first, first + arm.dof());
    if (plan.joints[i] != joints) {
      return "joints of arm " + arm.name + " are " + joined(plan.joints[i]) +
             " in the plan, in the workcell " + joined(joints);
    }
  }
  return "";
}

}  // namespace tandem::app
