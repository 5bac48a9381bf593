#pragma once
/// What a path planner may ask of the world.

#include <functional>
#include <memory>

#include "tandem/collision/certificate.h"
#include "tandem/collision/compiled_cell.h"

namespace tandem::planning {

/// Cost of the questions asked so far.
struct ValidityStats {
  long states = 0;
  long edges = 0;
  double seconds = 0;  ///< Wall time inside checks [s].
};

struct ArmQuestions;

/// Validity of configurations and straight edges. One object per thread.
class Validity {
 public:
  virtual ~Validity() = default;
  virtual bool state(const Eigen::VectorXd& q) = 0;
  /// The edge between a and b, both ends included; the same answer for (b, a).
  virtual bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) = 0;
  /// Whether parts of an accepted edge need not be asked about: a proof covers them, samples do
  /// not.
  virtual bool holds_in_part() const { return false; }
  virtual const ValidityStats& stats() const = 0;
  /// Whether the same questions can be asked by who moves. Then by_arm() is not null, and made when
  /// it is first asked for; what it answers is counted in stats().
  virtual bool splits_by_arm() const { return false; }
  virtual ArmQuestions* by_arm() { return nullptr; }
};

/// A configuration or edge is valid if every arm accepts it alone, and `between` does.
struct ArmQuestions {
  struct Arm {
    Eigen::Index offset, dof;         ///< Its entries of q.
    std::unique_ptr<Validity> alone;  ///< Does not depend on the other entries.
  };
  std::vector<Arm> arms;
  std::unique_ptr<Validity> between;  ///< What takes two arms or more.
};

/// Checks an edge at points at most `resolution` apart in the sum of joint distances (L1) [rad].
/// This is the paper's local planner: collisions between samples go unseen, so a part of an
/// accepted edge may be rejected. The checker must outlive it.
std::unique_ptr<Validity> make_sampled_validity(const collision::CollisionChecker& checker,
                                                world::PairSelection selection, double resolution);
/// The same in any space, where `is_free` answers for its points.
std::unique_ptr<Validity> make_sampled_validity(std::function<bool(const Eigen::VectorXd&)> is_free,
                                                double resolution);

/// Accepts an edge only with the continuous-time certificate. The checker must outlive it.
/// @param stop  rejects edges once it says so, and ends a long certificate.
std::unique_ptr<Validity> make_certified_validity(const collision::SsvChecker& checker,
                                                  world::PairSelection selection,
                                                  const collision::CertificateOptions& options = {},
                                                  const StopCondition& stop = {});

/// The same by the batch checker: proven as well, and much faster. The checker must outlive it.
std::unique_ptr<Validity> make_batch_validity(const collision::BatchChecker& checker,
                                              const world::PairSelection& selection,
                                              const StopCondition& stop = {});

std::unique_ptr<Validity> make_batch_validity(const collision::BatchChecker& checker,
                                              collision::BatchChecker::Pairs pairs,
                                              const StopCondition& stop = {});

/// The same for all pairs of the cell, with questions by arm. The cell must outlive it.
std::unique_ptr<Validity> make_batch_validity_by_arm(const collision::CompiledCell& cell,
                                                     const StopCondition& stop = {});

/// The paper's extent of a planning space: the sum of joint ranges, a joint without limits counted
/// as one turn [rad]. Ref: "Planner Parameters".
double l1_extent(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace tandem::planning
