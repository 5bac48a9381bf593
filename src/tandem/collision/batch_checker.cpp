#include "tandem/collision/batch_checker.h"

#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

struct BatchModel {};
struct BatchPairs {
  world::PairSelection selection;
};
class BatchChecker::Scratch {
 public:
  std::unique_ptr<CollisionChecker::Scratch> exact;
};

void BatchChecker::ScratchDeleter::operator()(Scratch* scratch) const { delete scratch; }

BatchChecker::BatchChecker(const SsvChecker& exact)
    : exact_(exact), model_(std::make_unique<const BatchModel>()) {}
BatchChecker::~BatchChecker() = default;

BatchChecker::Pairs BatchChecker::compile(const world::PairSelection& selection) const {
  return std::make_shared<const BatchPairs>(BatchPairs{selection});
}

BatchChecker::ScratchPtr BatchChecker::make_scratch() const {
  return ScratchPtr(new Scratch{exact_.make_scratch()});
}

bool BatchChecker::are_free(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                            Scratch& scratch) const {
  for (Eigen::Index i = 0; i < Q.cols(); ++i) {
    if (!exact_.is_free(Q.col(i), pairs.selection, *scratch.exact)) return false;
  }
  return true;
}

bool BatchChecker::is_edge_free(const Eigen::Ref<const Eigen::VectorXd>& a,
                                const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                                Scratch& scratch, const StopCondition& stop) const {
  return prove_edge(a, b, pairs, scratch, stop).is_free;
}

EdgeProof BatchChecker::prove_edge(const Eigen::Ref<const Eigen::VectorXd>& a,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const BatchPairs& pairs, Scratch& scratch,
                                   const StopCondition& stop) const {
  const bool forward = std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  const motion::StraightEdge edge =
      forward ? motion::StraightEdge(a, b) : motion::StraightEdge(b, a);
  const Certificate certificate = certify(exact_, edge, pairs.selection, *scratch.exact, {}, stop);
  return {certificate.is_free(), std::min(certificate.least_clearance, kClearanceCap)};
}

double BatchChecker::margin() const { return 0; }

}  // namespace tandem::collision
