#include "tandem/robot/joint_limits.h"

#include "model_promises.h"

namespace tandem::fuzz {
namespace {

bool same_limits(const robot::Model& a, const robot::Model& b) {
  for (std::size_t k = 0; k < a.joints().size(); ++k) {
    const robot::JointLimits &m = a.joints()[k].limits, &n = b.joints()[k].limits;
    if (m.lower != n.lower || m.upper != n.upper || m.velocity != n.velocity ||
        m.acceleration != n.acceleration || m.jerk != n.jerk) {
      return false;
    }
  }
  return true;
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  robot::Model model = fuzz::arm_model();
  const auto applied = robot::parse_joint_limits(fuzz::text_of(data, size), "input.yaml", model);
  if (applied) {
    fuzz::check_model(model);
  } else {
    fuzz::require(!applied.error().message.empty(), "a refusal says why");
    fuzz::require(fuzz::same_limits(model, fuzz::arm_model()), "an error changes no limit");
  }
  return 0;
}
