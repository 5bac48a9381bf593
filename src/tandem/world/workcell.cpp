#include "tandem/world/workcell.h"

#include <algorithm>
#include <bit>
#include <cstdio>

#include "tandem/core/contract.h"
#include "tandem/core/names.h"

namespace tandem::world {

namespace {

ArmMask bit(int arm) {
  expects(0 <= arm && arm < 32, "an arm index is between 0 and 31");
  return ArmMask{1} << arm;
}

/// Enough digits to tell a value from the limit that it exceeds.
std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

template <class Named>
int find_by_name(const std::vector<Named>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  return found == all.end() ? -1 : static_cast<int>(found - all.begin());
}

}  // namespace

PairScope PairScope::arm(int i, ArmMask standing) { return {bit(i), bit(i) | standing}; }

PairScope PairScope::between(int i, int j) { return {bit(i) | bit(j), ~ArmMask{0}}; }

PairScope PairScope::several() { return {.least = 2}; }

int Workcell::find_arm(std::string_view name) const { return find_by_name(arms_, name); }

int Workcell::find_body(std::string_view name) const { return find_by_name(bodies_, name); }

PairSelection Workcell::select(const PairScope& scope) const {
  PairSelection selection;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const ArmMask mask = pairs_[i].moved_by;
    if ((mask & scope.required) == scope.required && (mask & ~scope.permitted) == 0 &&
        std::popcount(mask) >= scope.least) {
      selection.push_back(static_cast<int>(i));
    }
  }
  return selection;
}

std::string Workcell::describe_pair(int pair) const {
  expects(0 <= pair && pair < static_cast<int>(pairs_.size()), "pair is an index into pairs()");
  const BodyPair& p = pairs_[static_cast<std::size_t>(pair)];
  return bodies_[static_cast<std::size_t>(p.a)].name + " and " +
         bodies_[static_cast<std::size_t>(p.b)].name;
}

void Workcell::positions(const Eigen::Ref<const Eigen::VectorXd>& q,
                         Eigen::VectorXd& positions) const {
  expects(q.size() == dof_, "q has one entry per joint of the cell's arms");
  positions = fixed_positions_;
  for (const Arm& arm : arms_) {
    for (int j = 0; j < arm.dof(); ++j) {
      positions[arm.columns[static_cast<std::size_t>(j)]] = q[arm.offset + j];
    }
  }
}

void Workcell::forward_kinematics(const Eigen::Ref<const Eigen::VectorXd>& q,
                                  Eigen::VectorXd& positions, robot::LinkPoses& X_WL) const {
  this->positions(q, positions);
  robot::forward_kinematics(model_, positions, X_WL);
}

Result<const std::vector<Query>*> Workcell::find_list(std::string_view name) const {
  if (name.empty()) return &queries_;
  const int found = find_by_name(lists_, name);
  if (found >= 0) return &lists_[static_cast<std::size_t>(found)].queries;
  std::vector<std::string> known;
  for (const QueryList& list : lists_) known.push_back(list.name);
  return fail(ErrorCode::kNotFound, "workcell '" + spec_.name + "' has no list '" +
                                        std::string(name) + "'" + name_hint(name, known));
}

const std::vector<Query>* Workcell::list_of(std::string_view query) const {
  if (find_by_name(queries_, query) >= 0) return &queries_;
  for (const QueryList& list : lists_) {
    if (find_by_name(list.queries, query) >= 0) return &list.queries;
  }
  return nullptr;
}

Result<const Query*> Workcell::find_query(std::string_view name) const {
  if (const std::vector<Query>* list = list_of(name)) {
    return &(*list)[static_cast<std::size_t>(find_by_name(*list, name))];
  }
  const std::string what = "workcell '" + spec_.name + "' has no query '" + std::string(name) + "'";
  const int list = find_by_name(lists_, name);
  if (list >= 0 && !lists_[static_cast<std::size_t>(list)].queries.empty()) {
    return fail(ErrorCode::kNotFound,
                what + ", but a list of this name; name one of its queries, such as '" +
                    lists_[static_cast<std::size_t>(list)].queries.front().name + "'");
  }
  std::vector<std::string> known;
  for (const Query& query : queries_) known.push_back(query.name);
  for (const QueryList& further : lists_) {
    for (const Query& query : further.queries) known.push_back(query.name);
  }
  return fail(ErrorCode::kNotFound, what + name_hint(name, known));
}

const Query& Workcell::query(std::string_view name) const {
  const auto found = find_query(name);
  if (!found) throw ContractViolation(found.error().message);
  return **found;
}

Result<Eigen::VectorXd> Workcell::named_state(int arm, std::string_view name) const {
  expects(0 <= arm && arm < static_cast<int>(arms_.size()), "arm is an index into arms()");
  const Arm& a = arms_[static_cast<std::size_t>(arm)];
  if (a.group.empty()) {
    return fail(ErrorCode::kNotFound,
                "arm '" + a.name + "' is a chain of links and has no named state '" +
                    std::string(name) + "'; define the arm by an SRDF group, or give joint values");
  }
  const RobotSpec& robot = spec_.robots[static_cast<std::size_t>(a.robot)];
  const robot::NamedState* state = robot.semantics.find_state(a.group, name);
  if (!state) {
    std::vector<std::string> known;
    for (const robot::NamedState& s : robot.semantics.states) {
      if (s.group == a.group) known.push_back(s.name);
    }
    return fail(ErrorCode::kNotFound, "group '" + a.group + "' of arm '" + a.name +
                                          "' has no state '" + std::string(name) + "'" +
                                          name_hint(name, known));
  }
  Eigen::VectorXd values(a.dof());
  for (int j = 0; j < a.dof(); ++j) {
    const std::size_t prefix = robot.name.size() + 1;
    const std::string joint = joint_names_[static_cast<std::size_t>(a.offset + j)].substr(prefix);
    const auto value = state->values.find(joint);
    if (value == state->values.end()) {
      return fail(ErrorCode::kInvalidInput, "state '" + state->name + "' of group '" + a.group +
                                                "' gives no value for joint '" + joint +
                                                "'; add it to the SRDF's group_state");
    }
    values[j] = value->second;
  }
  return values;
}

Result<void> Workcell::check_position_limits(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  expects(q.size() == dof_, "q has one entry per joint of the cell's arms");
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    // Written so that NaN fails.
    if (lower_[i] <= q[i] && q[i] <= upper_[i]) continue;
    return fail(ErrorCode::kInfeasible, "joint '" + joint_names_[static_cast<std::size_t>(i)] +
                                            "' is at " + digits(q[i]) + ", outside its limits [" +
                                            digits(lower_[i]) + ", " + digits(upper_[i]) + "]");
  }
  return {};
}

}  // namespace tandem::world
