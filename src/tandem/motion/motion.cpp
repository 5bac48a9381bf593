#include "tandem/motion/motion.h"

#include <algorithm>

namespace tandem::motion {

void StraightEdge::position(double t, Eigen::Ref<Eigen::VectorXd> q) const {
  q = a_ + std::clamp(t, 0.0, 1.0) * d_;
}

JointState StraightEdge::at(double t) const {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(a_.size());
  JointState state{zero, t < 0 || t > 1 ? zero : d_, zero, zero};
  position(t, state.q);
  return state;
}

void StraightEdge::deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const {
  D = d_.cwiseAbs() * (0.5 * (t1 - t0));
}

}  // namespace tandem::motion
