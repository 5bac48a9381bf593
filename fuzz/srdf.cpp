#include "tandem/robot/srdf.h"

#include <cmath>

#include "support.h"

namespace tandem::fuzz {
namespace {

void check(const robot::Semantics& semantics, const robot::Model& model) {
  for (const robot::Group& group : semantics.groups) {
    for (const int joint : group.joints) {
      require(joint >= 0 && static_cast<std::size_t>(joint) < model.joints().size(),
              "groups hold joints of the model");
      require(model.joints()[static_cast<std::size_t>(joint)].position_index >= 0,
              "joints of groups move by themselves");
    }
    require(group.tip_link >= -1 && group.tip_link < static_cast<int>(model.links().size()),
            "tips are links of the model");
  }
  for (const robot::NamedState& state : semantics.states) {
    require(semantics.find_group(state.group), "states belong to a group");
    for (const auto& [joint, value] : state.values) {
      require(model.find_joint(joint) >= 0 && std::isfinite(value),
              "states have finite values of joints of the model");
    }
  }
  for (const auto& pair : semantics.disabled_pairs) {
    require(model.find_link(pair.link_a) >= 0 && model.find_link(pair.link_b) >= 0,
            "links of disabled pairs exist");
  }
  for (const auto& pair : semantics.ignored_pairs) {
    require(model.find_link(pair.link_a) < 0 || model.find_link(pair.link_b) < 0,
            "only pairs with a link that the model lacks are ignored");
  }
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  const robot::Model& model = fuzz::arm_model();
  const auto semantics = robot::parse_srdf(fuzz::text_of(data, size), "input.srdf", model);
  if (const robot::Semantics* read = fuzz::accepted(semantics)) fuzz::check(*read, model);
  return 0;
}
