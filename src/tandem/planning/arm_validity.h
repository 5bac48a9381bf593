#pragma once
/// What one arm may do, asked of the whole cell.

#include "tandem/planning/validity.h"

namespace tandem::planning {

/// Configurations and edges of one arm's joints. One object per thread.
class ArmValidity final : public Validity {
 public:
  /// @param arm     must outlive it.
  /// @param others  dof of the cell: where the other arms stand, which changes no answer.
  ArmValidity(const ArmQuestions::Arm& arm, const Eigen::VectorXd& others)
      : arm_(arm), from_(others), to_(others) {}

  bool state(const Eigen::VectorXd& q) override {
    from_.segment(arm_.offset, arm_.dof) = q;
    return arm_.alone->state(from_);
  }
  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
    from_.segment(arm_.offset, arm_.dof) = a;
    to_.segment(arm_.offset, arm_.dof) = b;
    return arm_.alone->edge(from_, to_);
  }
  bool holds_in_part() const override { return arm_.alone->holds_in_part(); }
  const ValidityStats& stats() const override { return arm_.alone->stats(); }

 private:
  const ArmQuestions::Arm& arm_;
  Eigen::VectorXd from_, to_;
};

}  // namespace tandem::planning
