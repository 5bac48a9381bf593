#pragma once
/// A motion q(t), and what the certificate needs to know of it.

#include <Eigen/Core>

namespace tandem::motion {

/// One instant of a motion.
struct JointState {
  Eigen::VectorXd q;     ///< [rad or m]
  Eigen::VectorXd qd;    ///< [./s]
  Eigen::VectorXd qdd;   ///< [./s^2]
  Eigen::VectorXd qddd;  ///< [./s^3] right-hand limit at an inner knot
};

/// q(t) on [0, duration()]. Implementations are immutable and thread-safe.
class Motion {
 public:
  virtual ~Motion() = default;

  virtual int dof() const = 0;
  virtual double duration() const = 0;  ///< [s], > 0

  /// q at `t`, clamped into [0, duration()]. Allocates nothing once `q` has size dof().
  virtual void position(double t, Eigen::Ref<Eigen::VectorXd> q) const = 0;
  /// Everything at `t`; outside [0, duration()] the motion stands still at its end.
  virtual JointState at(double t) const = 0;
  /// D_j >= max |q_j(t) - q_j(m)| over t in [t0, t1] with m = (t0 + t1) / 2.
  virtual void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const = 0;
};

/// The straight edge from a to b, t in [0, 1].
class StraightEdge final : public Motion {
 public:
  StraightEdge(Eigen::VectorXd a, Eigen::VectorXd b) : a_(std::move(a)), d_(std::move(b)) {
    d_ -= a_;
  }
  int dof() const override { return static_cast<int>(a_.size()); }
  double duration() const override { return 1.0; }
  void position(double t, Eigen::Ref<Eigen::VectorXd> q) const override;
  JointState at(double t) const override;
  void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const override;

 private:
  Eigen::VectorXd a_, d_;
};

}  // namespace tandem::motion
