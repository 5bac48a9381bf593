#include "tandem/robot/model.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tandem/core/bounds.h"
#include "tandem/core/contract.h"

namespace tandem::robot {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::unexpected<Error> invalid(const std::string& message, const std::string& where = "") {
  return fail(ErrorCode::kInvalidInput, where.empty() ? message : where + ": " + message);
}

template <class T>
Result<void> check_names(const std::vector<T>& items, const std::string& kind) {
  std::unordered_map<std::string_view, int> seen;
  for (const T& item : items) {
    if (item.name.empty()) return invalid("a " + kind + " has no name", item.where);
    if (++seen[item.name] > 1) {
      return invalid(kind + " '" + item.name + "' exists twice; rename one", item.where);
    }
  }
  return {};
}

/// Sets parent_joint of all links; says which link has two parents, or which roots there are.
Result<int> connect(std::vector<Link>& links, const std::vector<Joint>& joints) {
  const int count = static_cast<int>(links.size());
  for (Link& link : links) link.parent_joint = -1;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    for (const int link : {joint.parent_link, joint.child_link}) {
      if (link < 0 || link >= count) {
        return invalid("joint '" + joint.name + "' connects link index " + std::to_string(link) +
                           "; expected 0 to " + std::to_string(count - 1),
                       joint.where);
      }
    }
    Link& child = links[at(joint.child_link)];
    if (child.parent_joint >= 0) {
      return invalid("link '" + child.name + "' is the child of two joints, '" +
                         joints[at(child.parent_joint)].name + "' and '" + joint.name +
                         "'; remove one",
                     joint.where);
    }
    child.parent_joint = static_cast<int>(i);
  }
  std::vector<int> roots;
  for (int i = 0; i < count; ++i) {
    if (links[at(i)].parent_joint < 0) roots.push_back(i);
  }
  if (roots.size() > 1) {
    return invalid("links '" + links[at(roots[0])].name + "' and '" + links[at(roots[1])].name +
                       "' are both roots; every link but one needs a joint that carries it",
                   links[at(roots[1])].where);
  }
  if (roots.empty()) {
    return invalid("link '" + links[0].name + "' is part of a cycle: there is no root link",
                   links[0].where);
  }
  return roots[0];
}

/// Links depth-first from `root`, children in the order of their joints.
std::vector<int> depth_first(int root, const std::vector<Link>& links,
                             const std::vector<Joint>& joints) {
  std::vector<std::vector<int>> children(links.size());
  for (const Joint& joint : joints) children[at(joint.parent_link)].push_back(joint.child_link);
  std::vector<int> order, pending = {root};
  while (!pending.empty()) {
    const int link = pending.back();
    pending.pop_back();
    order.push_back(link);
    const std::vector<int>& below = children[at(link)];
    pending.insert(pending.end(), below.rbegin(), below.rend());
  }
  return order;
}

/// Reorders so that link k + 1 is the child of joint k, parents first.
Result<void> sort_tree(std::vector<Link>& links, std::vector<Joint>& joints) {
  const auto root = connect(links, joints);
  if (!root) return std::unexpected(root.error());
  const std::vector<int> order = depth_first(*root, links, joints);
  std::vector<int> new_link(links.size(), -1), new_joint(joints.size(), -1);
  for (std::size_t k = 0; k < order.size(); ++k) {
    new_link[at(order[k])] = static_cast<int>(k);
    if (k > 0) new_joint[at(links[at(order[k])].parent_joint)] = static_cast<int>(k) - 1;
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (new_link[i] < 0)
      return invalid("link '" + links[i].name + "' is part of a cycle; a robot must be a tree",
                     links[i].where);
  }
  std::vector<Link> sorted_links(links.size());
  std::vector<Joint> sorted_joints(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = sorted_joints[at(new_joint[i])] = std::move(joints[i]);
    joint.parent_link = new_link[at(joint.parent_link)];
    joint.child_link = new_link[at(joint.child_link)];
    if (joint.mimic && joint.mimic->joint >= 0 &&
        joint.mimic->joint < static_cast<int>(joints.size())) {
      joint.mimic->joint = new_joint[at(joint.mimic->joint)];
    }
  }
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted_links[k] = std::move(links[at(order[k])]);
    sorted_links[k].parent_joint = static_cast<int>(k) - 1;
  }
  links = std::move(sorted_links);
  joints = std::move(sorted_joints);
  return {};
}

/// Empty if the limits are consistent, else what is wrong.
std::string limit_fault(const JointLimits& limits) {
  const auto number = [](double value) { return std::to_string(value); };
  if (!(limits.lower <= limits.upper)) {
    return "lower limit " + number(limits.lower) + " is not below upper limit " +
           number(limits.upper);
  }
  if (limits.lower == std::numeric_limits<double>::infinity() ||
      limits.upper == -std::numeric_limits<double>::infinity()) {
    return "its position limits leave no finite value";
  }
  for (const auto& [name, value] : {std::pair{"velocity", limits.velocity},
                                    {"acceleration", limits.acceleration},
                                    {"jerk", limits.jerk}}) {
    if (!(value > 0)) {
      return std::string(name) + " limit " + number(value) + " is not positive";
    }
  }
  return {};
}

Result<void> check_joint(Joint& joint) {
  const std::string name =
      (joint.where.empty() ? "" : joint.where + ": ") + "joint '" + joint.name + "': ";
  if (!joint.X_PJ.matrix().allFinite() || !joint.X_PJ.linear().isUnitary(1e-6) ||
      joint.X_PJ.translation().cwiseAbs().maxCoeff() > kFarthest) {
    return invalid(name +
                   "its frame in the parent link is not a rotation and a translation of at most "
                   "1e8 m");
  }
  if (joint.type == JointType::kFixed) {
    joint.mimic.reset();
    return {};
  }
  const double length = joint.axis_J.norm();
  if (!std::isfinite(length) || length < 1e-9) {
    return invalid(name + "its axis must be finite and not zero");
  }
  // A unit axis stays as it is: renormalising would spoil exact coordinate axes.
  if (std::abs(length - 1.0) > 1e-15) joint.axis_J /= length;
  if (const std::string fault = limit_fault(joint.limits); !fault.empty()) {
    return invalid(name + fault);
  }
  return {};
}

/// Replaces a mimic of a mimic by one of the joint at the chain's end.
Result<void> resolve_mimic(std::vector<Joint>& joints, Joint& joint) {
  const std::string name =
      (joint.where.empty() ? "" : joint.where + ": ") + "joint '" + joint.name + "': ";
  Mimic& mimic = *joint.mimic;
  for (std::size_t steps = 0;; ++steps) {
    if (mimic.joint < 0 || mimic.joint >= static_cast<int>(joints.size())) {
      return invalid(name + "it follows joint index " + std::to_string(mimic.joint) +
                     ", which does not exist");
    }
    if (!(std::abs(mimic.multiplier) <= kFarthest && std::abs(mimic.offset) <= kFarthest)) {
      return invalid(name + "its mimic multiplier and offset must be finite, at most 1e8");
    }
    const Joint& source = joints[at(mimic.joint)];
    if (source.type == JointType::kFixed) {
      return invalid(name + "it follows '" + source.name + "', which is fixed");
    }
    if (&source == &joint || steps > joints.size()) {
      return invalid(name + "it follows itself through its mimic chain");
    }
    if (!source.mimic) return {};
    // Checked again in the next round: products of factors grow.
    mimic = {source.mimic->joint, mimic.multiplier * source.mimic->multiplier,
             mimic.multiplier * source.mimic->offset + mimic.offset};
  }
}

}  // namespace

const char* to_string(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return "fixed";
    case JointType::kRevolute:
      return "revolute";
    case JointType::kContinuous:
      return "continuous";
    case JointType::kPrismatic:
      return "prismatic";
  }
  return "unknown";
}

Result<Model> Model::make(std::string name, std::vector<Link> links, std::vector<Joint> joints) {
  if (links.empty()) return invalid("robot '" + name + "' has no links");
  if (auto named = check_names(links, "link"); !named) return std::unexpected(named.error());
  if (auto named = check_names(joints, "joint"); !named) return std::unexpected(named.error());
  if (auto sorted = sort_tree(links, joints); !sorted) return std::unexpected(sorted.error());
  for (Joint& joint : joints) {
    if (auto checked = check_joint(joint); !checked) return std::unexpected(checked.error());
  }
  for (Joint& joint : joints) {
    if (!joint.mimic) continue;
    if (auto found = resolve_mimic(joints, joint); !found) return std::unexpected(found.error());
  }

  Model model;
  model.name_ = std::move(name);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    joints[k].position_index = -1;
    if (joints[k].type == JointType::kFixed || joints[k].mimic) continue;
    joints[k].position_index = model.position_count_++;
    model.position_joints_.push_back(static_cast<int>(k));
  }
  model.moving_ancestors_.resize(links.size());
  for (std::size_t k = 0; k < joints.size(); ++k) {
    std::vector<int>& above = model.moving_ancestors_[k + 1];
    above = model.moving_ancestors_[at(joints[k].parent_link)];
    if (joints[k].type == JointType::kFixed) continue;
    const int mover = joints[k].mimic ? joints[k].mimic->joint : static_cast<int>(k);
    if (std::ranges::find(above, mover) == above.end()) above.push_back(mover);
  }
  model.links_ = std::move(links);
  model.joints_ = std::move(joints);
  return model;
}

int Model::find_link(std::string_view name) const {
  const auto found = std::ranges::find(links_, name, &Link::name);
  return found == links_.end() ? -1 : static_cast<int>(found - links_.begin());
}

int Model::find_joint(std::string_view name) const {
  const auto found = std::ranges::find(joints_, name, &Joint::name);
  return found == joints_.end() ? -1 : static_cast<int>(found - joints_.begin());
}

Result<std::vector<int>> Model::chain(int base_link, int tip_link) const {
  const int count = static_cast<int>(links_.size());
  expects(base_link >= 0 && base_link < count, "base_link is one of the model's");
  expects(tip_link >= 0 && tip_link < count, "tip_link is one of the model's");
  std::vector<int> chain;
  for (int link = tip_link; link != base_link;) {
    const int joint = links_[at(link)].parent_joint;
    if (joint < 0) {
      return invalid("link '" + links_[at(tip_link)].name + "' is not below link '" +
                     links_[at(base_link)].name + "'");
    }
    chain.push_back(joint);
    link = joints_[at(joint)].parent_link;
  }
  std::ranges::reverse(chain);
  return chain;
}

void Model::set_limits(int joint, const JointLimits& limits) {
  expects(joint >= 0 && joint < static_cast<int>(joints_.size()), "joint is one of the model's");
  expects(limit_fault(limits).empty(), "limits are ordered and positive");
  Joint& changed = joints_[at(joint)];
  changed.limits = limits;
  if (changed.type != JointType::kRevolute && changed.type != JointType::kContinuous) return;
  const bool bounded = std::isfinite(limits.lower) || std::isfinite(limits.upper);
  changed.type = bounded ? JointType::kRevolute : JointType::kContinuous;
}

}  // namespace tandem::robot
