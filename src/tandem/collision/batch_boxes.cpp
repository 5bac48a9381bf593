#include "tandem/collision/batch_boxes.h"

#include <algorithm>

#include "tandem/collision/batch_work.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

void prove_boxes(const BatchChecker& checker, const Eigen::Ref<const Eigen::MatrixXd>& Q,
                 const Eigen::Ref<const Eigen::MatrixXd>& D, const BatchPairs& pairs,
                 bool want_clearance, BatchChecker::Scratch& work, std::vector<BoxProof>& out) {
  expects(pairs.model == &work.model && &work.exact == &checker.exact(),
          "pairs and scratch were made by this checker");
  expects(Q.rows() == work.model.dof && D.rows() == work.model.dof,
          "Q and D have a row per joint of the cell's arms");
  expects(Q.cols() == D.cols(), "every centre has a column of half edges");
  expects(Q.allFinite() && D.allFinite() && !(D.array() < 0).any(),
          "Q and D are finite, and D is not negative");
  out.clear();
  work.keep = 0;
  work.stride = Q.outerStride();
  work.D_stride = D.outerStride();
  const int lanes = batch_lanes();
  for (Eigen::Index first = 0; first < Q.cols(); first += lanes) {
    work.Q = Q.data() + first * work.stride;
    work.D = D.data() + first * work.D_stride;
    work.count = static_cast<int>(std::min<Eigen::Index>(lanes, Q.cols() - first));
    work.next_pending.clear();
    examine_boxes(pairs, {}, want_clearance, work);
    const BoxFindings& found = work.findings;
    for (int lane = 0; lane < work.count; ++lane) {
      BoxProof proof;
      if ((found.touching >> lane & 1U) != 0) {
        proof.verdict = BoxProof::Verdict::kTouching;
      } else if ((found.open >> lane & 1U) != 0) {
        proof.verdict = BoxProof::Verdict::kOpen;
        if (want_clearance) proof.excess = static_cast<double>(found.excess.lane[lane]);
      } else {
        proof.verdict = BoxProof::Verdict::kFree;
        if (want_clearance) proof.least_clearance = static_cast<double>(found.least.lane[lane]);
      }
      out.push_back(proof);
    }
  }
}

}  // namespace tandem::collision
