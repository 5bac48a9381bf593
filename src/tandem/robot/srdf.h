#pragma once
/// SRDF reader: groups, named states and disabled collision pairs.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tandem/robot/model.h"

namespace tandem::robot {

/// A planning group, resolved against the model.
struct Group {
  std::string name;
  std::vector<int> joints;  ///< Movable joints that follow no other, in tree order.
  int tip_link = -1;  ///< Tip of its single chain (or deepest link of it); -1 if not one chain.
};

struct NamedState {
  std::string name;
  std::string group;
  std::map<std::string, double> values;  ///< Joint name to value [rad or m].
};

struct DisabledPair {
  std::string link_a, link_b;
  std::string reason;
};

struct Semantics {
  std::vector<Group> groups;
  std::vector<NamedState> states;
  std::vector<DisabledPair> disabled_pairs;  ///< Both links exist.
  /// Pairs that name a link the model lacks: SRDFs are shared between variants of a robot, where
  /// these have no effect. Kept so that a misspelt name can be shown.
  std::vector<DisabledPair> ignored_pairs;

  const Group* find_group(std::string_view name) const;
  const NamedState* find_state(std::string_view group, std::string_view name) const;
};

/// Reads chains, joint lists, link lists and sub-groups (nested, in any order), group states and
/// disabled pairs, less those that `enable_collisions` enables again; other elements have no
/// effect, so pairs that the file does not name are checked. In a state, values of joints that are
/// fixed or follow another are left out.
/// @return kInvalidInput naming file, line, element and value for unknown links, joints or groups,
/// groups that contain themselves, values that are not numbers.
Result<Semantics> load_srdf(const std::filesystem::path& file, const Model& model);
Result<Semantics> parse_srdf(const std::string& text, const std::string& origin,
                             const Model& model);

}  // namespace tandem::robot
