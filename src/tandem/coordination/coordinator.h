#pragma once
/// Coordination of fixed motions: when is which arm where on its own?

#include <cstdint>
#include <functional>
#include <vector>

#include "tandem/collision/certificate.h"
#include "tandem/collision/compiled_cell.h"
#include "tandem/motion/piecewise_cubic.h"

namespace tandem::coordination {

/// Motions that were planned for each arm alone, to be run at the same time.
struct CoordinationProblem {
  const collision::CompiledCell& compiled;  ///< The whole cell.
  /// By arm, in the cell's order; each proven against everything that its arm alone moves.
  std::vector<motion::PiecewiseCubic> arms;

  const world::Workcell& cell() const { return compiled.cell(); }
  const collision::SsvChecker& exact() const { return compiled.exact(); }
};

/// A polyline in coordination space. Between two places all local times run evenly.
struct Schedule {
  std::vector<Eigen::VectorXd> places;  ///< Local times of all arms [s]: first 0, last durations.
  std::vector<double> times;            ///< Real time of each place [s], first 0, increasing.

  double makespan() const { return times.empty() ? 0.0 : times.back(); }
};

/// The schedule through `places` on which no arm runs faster than planned and one always runs as
/// fast: its makespan is the L-infinity length. Places equal to the one before are left out.
Schedule make_schedule(const std::vector<Eigen::VectorXd>& places);

/// Finds when each arm shall be where. Implementations are immutable and thread-safe; equal seeds
/// give equal schedules.
///
/// Waiting, and stops from one instant to the next, are free: a schedule says where the arms may
/// be together, and its makespan is a lower bound of what a robot can follow.
/// Ref: docs/methods.md, "Coordination".
class Coordinator {
 public:
  virtual ~Coordinator() = default;

  /// @return a schedule from all arms at their starts to all at their ends (bit by bit), no arm
  /// faster than planned, every edge proven free; kInfeasible naming the pair that touches at the
  /// start or the goal; kCoordination if there is none, naming what blocks; the stop's error within
  /// 10 ms of the stop.
  virtual Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t seed,
                                      const StopCondition& stop) const = 0;

  /// What a caller makes of a schedule.
  /// @return the makespan from which on further schedules are of no use to it [s].
  using Use = std::function<double(const Schedule&)>;
  /// Hands over schedules that lead around what blocks on different sides: that of coordinate(),
  /// then others. When stops take time, the first need not be the best. Unless an implementation
  /// knows more, that is all.
  /// @return the error of coordinate().
  virtual Result<void> explore(const CoordinationProblem& problem, std::uint64_t seed,
                               const StopCondition& stop, const Use& use) const;
  /// Up to `most` of them (> 0), the others by their makespans.
  Result<std::vector<Schedule>> alternatives(const CoordinationProblem& problem, int most,
                                             std::uint64_t seed, const StopCondition& stop) const;
};

/// The durations of the arms' motions [s].
Eigen::VectorXd durations(const CoordinationProblem& problem);

/// The pairs that coordination is about: those that two arms move.
world::PairSelection pairs_between_arms(const world::Workcell& cell);

/// Throws ContractViolation unless there is one motion per arm, with the arm's joints.
void check_arms(const CoordinationProblem& problem);

/// What every coordinator checks first: all arms at their starts and at their ends touch nowhere.
/// @return kInfeasible naming the end and the pair. Throws as check_arms().
Result<void> check_problem(const CoordinationProblem& problem,
                           collision::CollisionChecker::Scratch& scratch);
/// The same by the fast checker.
Result<void> check_problem(const CoordinationProblem& problem,
                           collision::BatchChecker::Scratch& scratch);

/// The straight edge between two places in coordination space, t in [0, 1].
class PlacesEdge final : public motion::Motion {
 public:
  /// @param arms  must outlive it.   @param a,b  one local time per arm [s].
  PlacesEdge(const std::vector<motion::PiecewiseCubic>& arms, Eigen::VectorXd a, Eigen::VectorXd b);
  int dof() const override { return dof_; }
  double duration() const override { return 1.0; }
  void position(double t, Eigen::Ref<Eigen::VectorXd> q) const override;
  motion::JointState at(double t) const override;
  void deviation(double t0, double t1, Eigen::Ref<Eigen::VectorXd> D) const override;

 private:
  const std::vector<motion::PiecewiseCubic>& arms_;
  Eigen::VectorXd a_, d_;
  int dof_ = 0;
};

/// Proves or refutes that the arms keep apart on the edge between two places. Time 0 is at `a`,
/// 1 at `b`.
collision::Certificate certify_edge(const CoordinationProblem& problem, const Eigen::VectorXd& a,
                                    const Eigen::VectorXd& b, const world::PairSelection& pairs,
                                    collision::CollisionChecker::Scratch& scratch,
                                    const StopCondition& stop = {});
/// The same along a whole schedule, by its times.
collision::Certificate certify_schedule(const CoordinationProblem& problem,
                                        const Schedule& schedule,
                                        collision::CollisionChecker::Scratch& scratch,
                                        const StopCondition& stop = {});

/// "left/panda_hand and right/panda_link5 with left at 1.204 s and right at 0.310 s of their own
/// motions": a pair and the local times of the arms that move it.
std::string describe_blocking(const world::Workcell& cell, int pair, const Eigen::VectorXd& place);

}  // namespace tandem::coordination
