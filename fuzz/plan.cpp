#include <algorithm>
#include <cmath>

#include "support.h"
#include "tandem/io/plan_file.h"

namespace tandem::fuzz {
namespace {

void check(const io::PlanFile& plan) {
  Eigen::Index dof = 0;
  for (const auto& joints : plan.joints) dof += static_cast<Eigen::Index>(joints.size());
  require(!plan.arms.empty() && plan.arms.size() == plan.joints.size(), "arms have joints");
  require(plan.start.size() == dof && plan.goal.size() == dof, "ends fit the arms");
  require(plan.start.allFinite() && plan.goal.allFinite(), "ends are finite");
  require(plan.trajectory.dof() == dof, "the trajectory fits the arms");
  const double duration = plan.trajectory.duration();
  require(std::isfinite(duration) && duration > 0, "motions last");
  for (const double part : {0.0, 0.3, 1.0}) {
    require(plan.trajectory.at(part * duration).q.size() == dof, "motions can be asked anywhere");
  }
  for (const motion::ArmMotion& arm : plan.trajectory.arms()) {
    const auto pieces = arm.pieces();
    require(!pieces.empty() && pieces.back().t1 == arm.duration(), "pieces cover the motion");
  }
  require(plan.report.least_clearance >= 0, "clearances are not negative");
  for (const pipeline::Phase& phase : plan.report.phases) {
    for (const Eigen::VectorXd& q : phase.path) {
      require(q.size() == dof && q.allFinite(), "paths fit the arms");
    }
  }
  for (const auto& [name, object] : plan.scene.objects) {
    const Eigen::Isometry3d& X = object.X_LO;
    require(X.matrix().allFinite(), "poses are finite");
    require((X.linear() * X.linear().transpose()).isIdentity(1e-9), "rotations are orthonormal");
  }
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::Folder folder;
  const auto file = folder.write("plan.json", fuzz::text_of(data, size));
  const auto plan = io::load_plan(file);
  if (const io::PlanFile* read = fuzz::accepted(plan)) fuzz::check(*read);
  return 0;
}
