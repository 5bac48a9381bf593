#include "tandem/math/tridiagonal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/core/contract.h"

namespace tandem::math {

TridiagonalLu::TridiagonalLu(const Eigen::VectorXd& lower, const Eigen::VectorXd& diagonal,
                             const Eigen::VectorXd& upper)
    : l_(lower), d_(diagonal), u_(upper) {
  const Eigen::Index n = d_.size();
  expects(n >= 1 && l_.size() == n - 1 && u_.size() == n - 1,
          "a tridiagonal matrix needs n diagonal and n - 1 off-diagonal entries");
  u2_ = Eigen::VectorXd::Zero(std::max<Eigen::Index>(n - 2, 0));
  swapped_.assign(static_cast<std::size_t>(n), false);
  for (Eigen::Index k = 0; k < n; ++k) {
    const bool last = k + 1 == n;
    // A pivot counts as zero against the entries that went into it.
    double scale = std::abs(diagonal[k]) + (k > 0 ? std::abs(upper[k - 1]) : 0.0);
    if (!last) {
      scale += std::abs(lower[k]);
      if (std::abs(l_[k]) > std::abs(d_[k])) {
        swapped_[static_cast<std::size_t>(k)] = true;
        std::swap(d_[k], l_[k]);
        std::swap(u_[k], d_[k + 1]);
        if (k + 2 < n) {
          u2_[k] = u_[k + 1];
          u_[k + 1] = 0;
        }
      }
    }
    if (!(std::abs(d_[k]) > std::numeric_limits<double>::epsilon() * scale)) {
      ok_ = false;
      return;
    }
    if (last) return;
    l_[k] /= d_[k];
    d_[k + 1] -= l_[k] * u_[k];
    if (k + 2 < n && swapped_[static_cast<std::size_t>(k)]) u_[k + 1] -= l_[k] * u2_[k];
  }
}

void TridiagonalLu::solve_in_place(Eigen::Ref<RowMatrix> B) const {
  const Eigen::Index n = d_.size();
  expects(ok_ && B.rows() == n, "solve needs a regular matrix and n rows");
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    if (swapped_[static_cast<std::size_t>(k)]) B.row(k).swap(B.row(k + 1));
    B.row(k + 1) -= l_[k] * B.row(k);
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    if (k + 1 < n) B.row(k) -= u_[k] * B.row(k + 1);
    if (k + 2 < n && u2_[k] != 0) B.row(k) -= u2_[k] * B.row(k + 2);
    B.row(k) /= d_[k];
  }
}

void TridiagonalLu::solve_transposed_in_place(Eigen::Ref<RowMatrix> B) const {
  const Eigen::Index n = d_.size();
  expects(ok_ && B.rows() == n, "solve needs a regular matrix and n rows");
  for (Eigen::Index k = 0; k < n; ++k) {
    if (k >= 1) B.row(k) -= u_[k - 1] * B.row(k - 1);
    if (k >= 2 && u2_[k - 2] != 0) B.row(k) -= u2_[k - 2] * B.row(k - 2);
    B.row(k) /= d_[k];
  }
  for (Eigen::Index k = n - 2; k >= 0; --k) {
    B.row(k) -= l_[k] * B.row(k + 1);
    if (swapped_[static_cast<std::size_t>(k)]) B.row(k).swap(B.row(k + 1));
  }
}

}  // namespace tandem::math
