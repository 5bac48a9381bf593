#include "tandem/world/workcell_builder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "tandem/core/contract.h"
#include "tandem/core/names.h"

namespace tandem::world {

namespace {

constexpr int kMostArms = 32;  // Bits of an ArmMask.

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

/// `what` is "robot", "arm", ...
template <class Spec>
Result<void> check_unique(const std::vector<Spec>& specs, const std::string& what) {
  std::set<std::string> seen;
  for (const Spec& spec : specs) {
    if (spec.name.empty()) {
      return refuse(ErrorCode::kInvalidInput, spec.where, what + " without a name; give it one");
    }
    if (!seen.insert(spec.name).second) {
      return refuse(ErrorCode::kInvalidInput, spec.where,
                    what + " '" + spec.name + "' exists twice; rename one");
    }
  }
  return {};
}

bool is_free(const robot::Joint& joint) { return joint.position_index >= 0; }

/// Name of the limit that a planned joint lacks, or "".
std::string missing_limit(const robot::JointLimits& limits) {
  if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper)) return "position";
  if (!std::isfinite(limits.velocity)) return "velocity";
  if (!std::isfinite(limits.acceleration)) return "acceleration";
  return "";
}

/// What a planner cannot work with, or "": ranges and steps through them would overflow.
std::string absurd_limit(const robot::JointLimits& limits) {
  constexpr double kFastest = 1e12;  // Per s, s^2, s^3.
  const auto beyond = [](const char* name, double value, double most, const char* text) {
    std::ostringstream words;
    words << "a " << name << " limit of " << value << ", it must be at most " << text;
    return std::abs(value) > most ? words.str() : "";
  };
  for (const double end : {limits.lower, limits.upper}) {
    if (auto fault = beyond("position", end, kFarthest, "1e8 rad or m"); !fault.empty()) {
      return fault + "; a joint that turns without end may have several turns";
    }
  }
  for (const auto& [name, value] :
       {std::pair{"velocity", limits.velocity}, {"acceleration", limits.acceleration}}) {
    if (auto fault = beyond(name, value, kFastest, "1e12"); !fault.empty()) return fault;
  }
  return std::isfinite(limits.jerk) ? beyond("jerk", limits.jerk, kFastest, "1e12") : "";
}

}  // namespace

Result<std::shared_ptr<const Workcell>> Workcell::make(WorkcellSpec spec) {
  return WorkcellBuilder(std::move(spec)).build();
}

Result<std::shared_ptr<const Workcell>> WorkcellBuilder::build() {
  const WorkcellSpec& spec = cell_->spec_;
  Result<void> done = check_names();
  if (done) done = place_robots();
  if (done) done = resolve_arms();
  if (done) done = fix_positions();
  for (const RobotSpec& robot : spec.robots) {
    if (done) done = add_robot_bodies(robot);
  }
  if (done) done = add_obstacles();
  if (done) done = add_attached();
  if (done) done = check_body_padding();
  if (done) done = skip_pairs();
  if (done) make_pairs(Marked(cell_->bodies_.size(), true));
  if (done) done = resolve_queries();
  if (done) done = check_changes();
  if (!done) return std::unexpected(done.error());
  return cell_;
}

Result<void> WorkcellBuilder::check_names() const {
  const WorkcellSpec& spec = cell_->spec_;
  const std::string file = spec.file.string();
  if (spec.robots.empty()) {
    return refuse(ErrorCode::kInvalidInput, file, "a workcell needs at least one robot");
  }
  if (spec.arms.empty()) {
    return refuse(ErrorCode::kInvalidInput, file,
                  "a workcell needs at least one arm; nothing in it could move");
  }
  if (spec.arms.size() > kMostArms) {
    return refuse(
        ErrorCode::kUnsupported, file,
        "the workcell has " + std::to_string(spec.arms.size()) + " arms; at most 32 are supported");
  }
  for (const RobotSpec& robot : spec.robots) {
    if (robot.name.find('/') != std::string::npos) {
      return refuse(ErrorCode::kInvalidInput, robot.where,
                    "robot '" + robot.name +
                        "': its name must not contain '/', which separates it "
                        "from the names of its links");
    }
    if (!is_rigid(robot.X_WB)) {
      return refuse(ErrorCode::kInvalidInput, robot.where,
                    "robot '" + robot.name + "': its base pose is not a rigid pose within 1e8 m");
    }
  }
  Result<void> done = check_unique(spec.robots, "robot");
  if (done) done = check_unique(spec.arms, "arm");
  if (done) done = check_unique(spec.queries, "query");
  if (done) done = check_unique(spec.lists, "list");
  for (const QueryListSpec& list : spec.lists) {
    if (done && list.name.find('/') != std::string::npos) {
      return refuse(ErrorCode::kInvalidInput, list.where,
                    "list '" + list.name +
                        "': its name must not contain '/', which separates it from the names of "
                        "its queries");
    }
    if (done) done = check_unique(list.queries, "query");
  }
  return done;
}

Result<void> WorkcellBuilder::place_robots() {
  std::vector<robot::Placement> placements;
  for (const RobotSpec& robot : cell_->spec_.robots) {
    placements.push_back({&robot.model, robot.name + "/", robot.X_WB});
  }
  Result<robot::Model> merged = robot::merge(cell_->spec_.name, placements);
  if (!merged) {
    return refuse(merged.error().code, cell_->spec_.file.string(), merged.error().message);
  }
  cell_->model_ = std::move(*merged);
  owner_.assign(cell_->model_.joints().size(), -1);
  return {};
}

int WorkcellBuilder::owner(int joint) const {
  const robot::Joint& j = cell_->model_.joints()[static_cast<std::size_t>(joint)];
  return owner_[static_cast<std::size_t>(j.mimic ? j.mimic->joint : joint)];
}

Result<void> WorkcellBuilder::resolve_arms() {
  for (const ArmSpec& spec : cell_->spec_.arms) {
    if (auto done = resolve_arm(spec); !done) {
      return refuse(done.error().code, spec.where,
                    "arm '" + spec.name + "': " + done.error().message);
    }
  }
  return {};
}

Result<void> WorkcellBuilder::resolve_arm(const ArmSpec& spec) {
  const std::vector<std::string> robots = names_of(cell_->spec_.robots);
  const auto robot = std::ranges::find(robots, spec.robot);
  if (robot == robots.end()) {
    return fail(ErrorCode::kNotFound,
                "there is no robot '" + spec.robot + "'" + name_hint(spec.robot, robots));
  }
  if (spec.group.empty() == spec.base.empty()) {
    return fail(ErrorCode::kInvalidInput,
                "it needs either an SRDF group, or a base and a tip link, not both");
  }
  if (!is_rigid(spec.X_LE)) {
    return fail(ErrorCode::kInvalidInput, "its tool is not a rigid pose within 1e8 m");
  }
  const int index = static_cast<int>(robot - robots.begin());
  Result<Arm> arm = spec.base.empty() ? find_group(spec, index) : find_chain(spec, index);
  if (!arm) return std::unexpected(arm.error());
  if (arm->joints.empty()) {
    return fail(ErrorCode::kInvalidInput, "it has no movable joint; choose another group or chain");
  }
  const std::vector<int>& above_tip = cell_->model_.moving_ancestors(arm->tip_link);
  if (std::ranges::find_first_of(above_tip, arm->joints) == above_tip.end()) {
    return fail(ErrorCode::kInvalidInput,
                "none of its joints moves the tip '" + spec.tip + "'; choose a tip below them");
  }
  arm->name = spec.name;
  arm->robot = index;
  arm->group = spec.group;
  arm->X_LE = spec.X_LE;
  arm->offset = cell_->dof_;
  for (const int joint : arm->joints) {
    if (auto done = stack_joint(*arm, joint); !done) return std::unexpected(done.error());
    arm->columns.push_back(cell_->model_.joints()[static_cast<std::size_t>(joint)].position_index);
  }
  cell_->arms_.push_back(std::move(*arm));
  return {};
}

Result<int> WorkcellBuilder::find_link(const ArmSpec& spec, int robot,
                                       const std::string& link) const {
  const int found = cell_->model_.find_link(spec.robot + "/" + link);
  if (found >= 0) return found;
  const RobotSpec& r = cell_->spec_.robots[static_cast<std::size_t>(robot)];
  return fail(ErrorCode::kNotFound, "robot '" + spec.robot + "' has no link '" + link + "'" +
                                        name_hint(link, names_of(r.model.links())));
}

Result<Arm> WorkcellBuilder::find_group(const ArmSpec& spec, int robot) const {
  const RobotSpec& r = cell_->spec_.robots[static_cast<std::size_t>(robot)];
  const robot::Group* group = r.semantics.find_group(spec.group);
  if (!group && r.semantics.groups.empty()) {
    return fail(
        ErrorCode::kNotFound,
        "robot '" + spec.robot + "' has no group '" + spec.group +
            "', nor any other; give it an SRDF, or define the arm by its base and tip link");
  }
  if (!group) {
    return fail(ErrorCode::kNotFound, "robot '" + spec.robot + "' has no group '" + spec.group +
                                          "'" +
                                          name_hint(spec.group, names_of(r.semantics.groups)));
  }
  Arm arm{};
  for (const int joint : group->joints) {
    const std::string& name = r.model.joints()[static_cast<std::size_t>(joint)].name;
    arm.joints.push_back(cell_->model_.find_joint(spec.robot + "/" + name));
  }
  std::ranges::sort(arm.joints);
  if (spec.tip.empty() && group->tip_link < 0) {
    return fail(ErrorCode::kInvalidInput,
                "group '" + spec.group + "' is not one chain of links; name the tip link");
  }
  const std::string& tip =
      spec.tip.empty() ? r.model.links()[static_cast<std::size_t>(group->tip_link)].name : spec.tip;
  const Result<int> link = find_link(spec, robot, tip);
  if (!link) return std::unexpected(link.error());
  arm.tip_link = *link;
  return arm;
}

Result<Arm> WorkcellBuilder::find_chain(const ArmSpec& spec, int robot) const {
  if (spec.tip.empty()) {
    return fail(ErrorCode::kInvalidInput,
                "it has the base link '" + spec.base + "' but no tip; name the tip link");
  }
  const Result<int> base = find_link(spec, robot, spec.base);
  if (!base) return std::unexpected(base.error());
  const Result<int> tip = find_link(spec, robot, spec.tip);
  if (!tip) return std::unexpected(tip.error());
  const Result<std::vector<int>> chain = cell_->model_.chain(*base, *tip);
  if (!chain) return std::unexpected(chain.error());
  Arm arm{};
  arm.tip_link = *tip;
  for (const int joint : *chain) {
    if (is_free(cell_->model_.joints()[static_cast<std::size_t>(joint)])) {
      arm.joints.push_back(joint);
    }
  }
  return arm;
}

/// Takes the joint for the arm and appends it to the cell's q.
Result<void> WorkcellBuilder::stack_joint(const Arm& arm, int joint) {
  const robot::Joint& j = cell_->model_.joints()[static_cast<std::size_t>(joint)];
  int& owner = owner_[static_cast<std::size_t>(joint)];
  if (owner >= 0) {
    return fail(ErrorCode::kInvalidInput,
                "joint '" + j.name + "' belongs to arm '" +
                    cell_->spec_.arms[static_cast<std::size_t>(owner)].name +
                    "' already; a joint can only be in one arm");
  }
  if (const std::string missing = missing_limit(j.limits); !missing.empty()) {
    const std::string local = j.name.substr(j.name.find('/') + 1);
    return fail(ErrorCode::kInvalidInput,
                "joint '" + j.name + "' has no " + missing +
                    " limit; state one in the robot's joint_limits file or in the workcell, under "
                    "`limits: {" +
                    local + ": ...}` of robot '" +
                    cell_->spec_.robots[static_cast<std::size_t>(arm.robot)].name + "'");
  }
  if (const std::string fault = absurd_limit(j.limits); !fault.empty()) {
    return fail(ErrorCode::kInvalidInput, "joint '" + j.name + "' has " + fault);
  }
  owner = static_cast<int>(cell_->arms_.size());
  cell_->joint_names_.push_back(j.name);
  cell_->limits_.push_back(j.limits);
  const Eigen::Index i = cell_->dof_++;
  cell_->lower_.conservativeResize(cell_->dof_);
  cell_->upper_.conservativeResize(cell_->dof_);
  cell_->lower_[i] = j.limits.lower;
  cell_->upper_[i] = j.limits.upper;
  return {};
}

Result<void> WorkcellBuilder::fix_positions() {
  const robot::Model& model = cell_->model_;
  Eigen::VectorXd& fixed = cell_->fixed_positions_;
  fixed = Eigen::VectorXd::Zero(model.position_count());
  for (std::size_t i = 0; i < model.joints().size(); ++i) {
    const robot::Joint& joint = model.joints()[i];
    if (!is_free(joint) || owner_[i] >= 0) continue;
    fixed[joint.position_index] = std::clamp(0.0, joint.limits.lower, joint.limits.upper);
  }
  for (const RobotSpec& robot : cell_->spec_.robots) {
    for (const auto& [name, value] : robot.fixed_positions) {
      const std::string who = "joint '" + name + "' of robot '" + robot.name + "'";
      const int index = model.find_joint(robot.name + "/" + name);
      if (index < 0) {
        return refuse(ErrorCode::kNotFound, robot.where,
                      "there is no " + who + name_hint(name, names_of(robot.model.joints())));
      }
      const robot::Joint& joint = model.joints()[static_cast<std::size_t>(index)];
      if (!is_free(joint)) {
        return refuse(ErrorCode::kInvalidInput, robot.where,
                      who + " is fixed or follows another joint; remove its value");
      }
      if (const int arm = owner(index); arm >= 0) {
        return refuse(ErrorCode::kInvalidInput, robot.where,
                      who + " is moved by arm '" +
                          cell_->arms_[static_cast<std::size_t>(arm)].name + "'; remove its value");
      }
      if (!(joint.limits.lower <= value && value <= joint.limits.upper)) {
        return refuse(ErrorCode::kInvalidInput, robot.where,
                      who + " stands at " + std::to_string(value) + ", outside its limits [" +
                          std::to_string(joint.limits.lower) + ", " +
                          std::to_string(joint.limits.upper) + "]");
      }
      if (std::abs(value) > kFarthest) {
        return refuse(ErrorCode::kInvalidInput, robot.where,
                      who + " stands beyond 1e8 rad or m; give it a value near 0");
      }
      fixed[joint.position_index] = value;
    }
  }
  return {};
}

Result<void> WorkcellBuilder::resolve_queries() {
  Result<void> done = resolve_list(cell_->spec_.queries, "", cell_->queries_);
  for (const QueryListSpec& spec : cell_->spec_.lists) {
    if (!done) return done;
    QueryList list{spec.name, {}};
    done = resolve_list(spec.queries, spec.name + "/", list.queries);
    for (const Query& query : list.queries) {
      if (cell_->list_of(query.name) == nullptr) continue;
      return refuse(ErrorCode::kInvalidInput, spec.where,
                    "query '" + query.name + "' exists twice; rename one");
    }
    cell_->lists_.push_back(std::move(list));
  }
  return done;
}

Result<void> WorkcellBuilder::resolve_list(const std::vector<QuerySpec>& specs,
                                           const std::string& prefix,
                                           std::vector<Query>& queries) const {
  for (const QuerySpec& spec : specs) {
    const std::string name = prefix + spec.name;
    auto start = resolve_goals(spec.start, "start of query '" + name + "'");
    if (!start) return refuse(start.error().code, spec.where, start.error().message);
    auto goal = resolve_goals(spec.goal, "goal of query '" + name + "'");
    if (!goal) return refuse(goal.error().code, spec.where, goal.error().message);
    if (spec.goal.empty()) {
      return refuse(ErrorCode::kInvalidInput, spec.where,
                    "query '" + name + "' has no goal; give at least one arm a goal");
    }
    for (std::size_t i = 0; i < start->size(); ++i) {
      if ((*start)[i] || !queries.empty()) continue;
      return refuse(ErrorCode::kInvalidInput, spec.where,
                    "query '" + name + "' has no start for arm '" + cell_->arms_[i].name +
                        "' and there is no query before it; give that arm a start");
    }
    queries.push_back({name, std::move(*start), std::move(*goal), spec.changes});
  }
  return {};
}

/// What the queries of a list do to its objects in turn. Names and order do not depend on where the
/// arms are, so any configuration will do.
Result<void> WorkcellBuilder::check_changes() const {
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(cell_->dof_);
  const auto check = [&](const std::vector<Query>& queries) -> Result<void> {
    std::shared_ptr<const Workcell> cell = cell_;
    for (const Query& query : queries) {
      if (query.changes.empty()) continue;
      auto changed = after_changes(cell, query.changes, q);
      if (!changed) {
        return fail(changed.error().code,
                    changed.error().message + " (before query '" + query.name + "')");
      }
      cell = std::move(*changed);
    }
    return {};
  };
  Result<void> done = check(cell_->queries_);
  for (const QueryList& list : cell_->lists_) {
    if (done) done = check(list.queries);
  }
  return done;
}

Result<std::vector<std::optional<ArmGoal>>> WorkcellBuilder::resolve_goals(
    const std::map<std::string, ArmGoal>& goals, const std::string& where) const {
  std::vector<std::optional<ArmGoal>> by_arm(cell_->arms_.size());
  for (const auto& [name, goal] : goals) {
    const int arm = cell_->find_arm(name);
    if (arm < 0) {
      return refuse(ErrorCode::kNotFound, where,
                    "there is no arm '" + name + "'" + name_hint(name, names_of(cell_->arms_)));
    }
    if (auto done = check_goal(arm, goal); !done) {
      return refuse(done.error().code, where, "arm '" + name + "': " + done.error().message);
    }
    by_arm[static_cast<std::size_t>(arm)] = goal;
  }
  return by_arm;
}

Result<void> WorkcellBuilder::check_goal(int arm, const ArmGoal& goal) const {
  if (const auto* joints = std::get_if<JointGoal>(&goal)) {
    const int dof = cell_->arms_[static_cast<std::size_t>(arm)].dof();
    if (joints->q.size() != dof) {
      return fail(ErrorCode::kInvalidInput, "it has " + std::to_string(dof) + " joints but " +
                                                std::to_string(joints->q.size()) +
                                                " values are given; give one per joint");
    }
    if (!joints->q.allFinite()) {
      return fail(ErrorCode::kInvalidInput, "a joint value is not finite");
    }
  } else if (const auto* state = std::get_if<StateGoal>(&goal)) {
    if (auto values = cell_->named_state(arm, state->name); !values) {
      return std::unexpected(values.error());
    }
  } else if (!is_rigid(std::get<PoseGoal>(goal).X_WE)) {
    return fail(ErrorCode::kInvalidInput, "the goal pose is not a rigid pose within 1e8 m");
  }
  return {};
}

}  // namespace tandem::world
