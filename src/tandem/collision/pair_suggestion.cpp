#include "tandem/collision/pair_suggestion.h"

#include <cmath>
#include <numbers>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::collision {

namespace {

constexpr const char* kRobot = "robot";
constexpr const char* kGroup = "all joints";

/// The robot alone in a cell, one arm owning every joint.
Result<std::shared_ptr<const world::Workcell>> alone(const world::RobotSpec& robot) {
  world::WorkcellSpec spec;
  spec.name = robot.name;
  spec.robots.push_back(robot);
  world::RobotSpec& copy = spec.robots.back();
  copy.name = kRobot;
  copy.fixed_positions.clear();
  robot::Group all{kGroup, {}, -1};
  for (int i = 0; i < static_cast<int>(copy.model.joints().size()); ++i) {
    const robot::Joint& joint = copy.model.joints()[static_cast<std::size_t>(i)];
    if (joint.position_index < 0) continue;
    all.joints.push_back(i);
    all.tip_link = joint.child_link;
    robot::JointLimits limits = joint.limits;
    if (!std::isfinite(limits.lower)) limits.lower = -std::numbers::pi;
    if (!std::isfinite(limits.upper)) limits.upper = std::numbers::pi;
    limits.velocity = limits.acceleration = 1;  // A cell asks for them; nothing here needs them.
    copy.model.set_limits(i, limits);
  }
  copy.semantics.groups = {all};
  copy.semantics.states.clear();
  world::ArmSpec arm;
  arm.name = arm.robot = kRobot;
  arm.group = kGroup;
  spec.arms.push_back(arm);
  return world::Workcell::make(std::move(spec));
}

/// The nearest link above `link` that is a body; -1 if there is none.
int body_above(const world::Workcell& cell, const std::vector<int>& body_of_link, int link) {
  const robot::Model& model = cell.model();
  for (int joint = model.links()[static_cast<std::size_t>(link)].parent_joint; joint >= 0;) {
    const int parent = model.joints()[static_cast<std::size_t>(joint)].parent_link;
    if (const int body = body_of_link[static_cast<std::size_t>(parent)]; body >= 0) return body;
    joint = model.links()[static_cast<std::size_t>(parent)].parent_joint;
  }
  return -1;
}

/// By pair, whether no body stands between its two.
std::vector<bool> adjacent_pairs(const world::Workcell& cell) {
  std::vector<int> body_of_link(cell.model().links().size(), -1);
  for (std::size_t i = 0; i < cell.bodies().size(); ++i) {
    body_of_link[static_cast<std::size_t>(cell.bodies()[i].link)] = static_cast<int>(i);
  }
  std::vector<int> above(cell.bodies().size());
  for (std::size_t i = 0; i < above.size(); ++i) {
    above[i] = body_above(cell, body_of_link, cell.bodies()[i].link);
  }
  std::vector<bool> adjacent;
  for (const world::BodyPair& pair : cell.pairs()) {
    adjacent.push_back(above[static_cast<std::size_t>(pair.a)] == pair.b ||
                       above[static_cast<std::size_t>(pair.b)] == pair.a);
  }
  return adjacent;
}

/// Counts in how many configurations each pair touches.
class TouchCounter {
 public:
  explicit TouchCounter(std::shared_ptr<const world::Workcell> cell)
      : checker_(std::move(cell)),
        scratch_(checker_.make_scratch()),
        all_(checker_.cell().select(world::PairScope::all())),
        counts_(all_.size(), 0) {}

  void add(const Eigen::VectorXd& q) {
    checker_.clearances(q, all_, 0.0, *scratch_, touching_);
    for (const PairClearance& clearance : touching_) {
      if (clearance.distance <= 0) ++counts_[static_cast<std::size_t>(clearance.pair)];
    }
  }
  int count(std::size_t pair) const { return counts_[pair]; }

 private:
  SsvChecker checker_;
  std::unique_ptr<CollisionChecker::Scratch> scratch_;
  world::PairSelection all_;
  std::vector<PairClearance> touching_;
  std::vector<int> counts_;
};

std::string local_name(const world::Body& body) {
  return body.name.substr(std::string(kRobot).size() + 1);
}

}  // namespace

const char* to_string(SuggestionReason reason) {
  switch (reason) {
    case SuggestionReason::kAdjacent:
      return "Adjacent";
    case SuggestionReason::kDefault:
      return "Default";
    case SuggestionReason::kAlways:
      return "Always";
    case SuggestionReason::kNever:
      return "Never";
  }
  return "unknown";
}

Result<std::vector<PairSuggestion>> suggest_disabled_pairs(const world::RobotSpec& robot,
                                                           const SuggestionOptions& options) {
  expects(options.samples >= 1, "suggesting pairs takes at least one sample");
  const auto made = alone(robot);
  if (!made) return std::unexpected(made.error());
  const world::Workcell& cell = **made;
  const std::vector<bool> adjacent = adjacent_pairs(cell);

  Eigen::VectorXd q =
      Eigen::VectorXd::Zero(cell.dof()).cwiseMax(cell.lower()).cwiseMin(cell.upper());
  TouchCounter at_default(*made), sampled(*made);
  at_default.add(q);
  Rng rng(options.seed);
  for (int k = 0; k < options.samples; ++k) {
    if (options.stop()) return std::unexpected(options.stop.error("suggesting pairs"));
    for (int i = 0; i < cell.dof(); ++i) q[i] = rng.uniform(cell.lower()[i], cell.upper()[i]);
    sampled.add(q);
  }

  std::vector<PairSuggestion> suggestions;
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    const int touched = sampled.count(i);
    SuggestionReason reason;
    if (adjacent[i]) {
      reason = SuggestionReason::kAdjacent;
    } else if (at_default.count(i) > 0) {
      reason = SuggestionReason::kDefault;
    } else if (touched == options.samples) {
      reason = SuggestionReason::kAlways;
    } else if (touched == 0) {
      reason = SuggestionReason::kNever;
    } else {
      continue;
    }
    const world::BodyPair& pair = cell.pairs()[i];
    suggestions.push_back({local_name(cell.bodies()[static_cast<std::size_t>(pair.a)]),
                           local_name(cell.bodies()[static_cast<std::size_t>(pair.b)]), reason});
  }
  return suggestions;
}

}  // namespace tandem::collision
