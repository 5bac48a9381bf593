#include "tandem/collision/checker.h"

#include <cmath>
#include <cstdio>
#include <span>

#include "tandem/core/contract.h"

namespace tandem::collision {

void distance_gradient(const world::Workcell& cell, const robot::LinkPoses& X_WL,
                       const PairClearance& clearance, Eigen::Ref<Eigen::VectorXd> gradient) {
  expects(gradient.size() == cell.dof(), "the gradient has one entry per joint of the cell's arms");
  expects(0 <= clearance.pair && clearance.pair < static_cast<int>(cell.pairs().size()),
          "the clearance is that of a pair of this cell");
  gradient.setZero();
  // In blocks of fixed capacity, so that nothing is allocated.
  constexpr std::size_t kBlock = 8;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kBlock>;
  const world::BodyPair& pair = cell.pairs()[static_cast<std::size_t>(clearance.pair)];
  const auto add = [&](int body_index, const Eigen::Vector3d& p_W, double sign) {
    const world::Body& body = cell.bodies()[static_cast<std::size_t>(body_index)];
    for (std::size_t i = 0; i < cell.arms().size(); ++i) {
      if (((body.moved_by >> i) & 1U) == 0) continue;
      const world::Arm& arm = cell.arms()[i];
      const std::span<const int> columns(arm.columns);
      for (std::size_t k = 0; k < columns.size(); k += kBlock) {
        const std::size_t count = std::min(kBlock, columns.size() - k);
        Jacobian J_W(6, static_cast<Eigen::Index>(count));
        robot::jacobian(cell.model(), X_WL, body.link, p_W, columns.subspan(k, count), J_W);
        gradient.segment(arm.offset + static_cast<Eigen::Index>(k),
                         static_cast<Eigen::Index>(count)) +=
            sign * J_W.topRows<3>().transpose() * clearance.nhat_BA_W;
      }
    }
  };
  add(pair.a, clearance.p_WCa, 1.0);
  add(pair.b, clearance.p_WCb, -1.0);
}

std::string describe(const world::Workcell& cell, const PairClearance& clearance) {
  if (clearance.pair < 0) return "no pair";
  char text[48];
  std::snprintf(text, sizeof text, ", %.3g m %s", std::abs(clearance.distance),
                clearance.distance > 0 ? "apart" : "deep");
  return cell.describe_pair(clearance.pair) + text;
}

}  // namespace tandem::collision
