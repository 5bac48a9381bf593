#include "tandem/math/block_tridiagonal.h"

#include <cmath>

#include "tandem/core/contract.h"

namespace tandem::math {

using Eigen::Index;

namespace {

// Arms have six or seven joints: loops of known length over their blocks run at twice the speed.
// N is the block size, or Eigen::Dynamic.

template <int N>
using Square = Eigen::Map<Eigen::Matrix<double, N, N>>;
template <int N>
using ConstSquare = Eigen::Map<const Eigen::Matrix<double, N, N>>;

/// A = L L^T in place, lower triangle, column by column: every inner loop runs down a column.
template <int N>
bool cholesky(Square<N>& A) {
  const Index n = A.rows();
  for (Index k = 0; k < n; ++k) {
    const double pivot = A(k, k);
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    const double inverse = 1 / std::sqrt(pivot);
    for (Index i = k; i < n; ++i) A(i, k) *= inverse;
    for (Index j = k + 1; j < n; ++j) {
      const double factor = A(j, k);
      for (Index i = j; i < n; ++i) A(i, j) -= factor * A(i, k);
    }
  }
  return true;
}

/// B <- B L^-T: forward substitution over the columns of B.
template <int N>
void divide_by_transpose(Square<N>& B, const Square<N>& L) {
  const Index n = B.rows();
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < k; ++j) B.col(k) -= L(k, j) * B.col(j);
    B.col(k) *= 1 / L(k, k);
  }
}

/// The lower triangle of A <- A - B B^T.
template <int N>
void subtract_square(Square<N>& A, const Square<N>& B) {
  const Index n = A.rows();
  for (Index j = 0; j < n; ++j) {
    for (Index k = 0; k < n; ++k) {
      const double factor = B(j, k);
      for (Index i = j; i < n; ++i) A(i, j) -= factor * B(i, k);
    }
  }
}

template <int N>
bool factorise_blocks(double* blocks, Index size, int count) {
  const Index area = size * size;
  for (int k = 0; k < count; ++k) {
    Square<N> D(blocks + 2 * k * area, size, size);
    if (k > 0) {
      const Square<N> E(blocks + (2 * k - 1) * area, size, size);
      subtract_square<N>(D, E);
    }
    if (!cholesky<N>(D)) return false;
    if (k + 1 < count) {
      Square<N> E(blocks + (2 * k + 1) * area, size, size);
      divide_by_transpose<N>(E, D);
    }
  }
  return true;
}

template <int N>
using Part = Eigen::Map<Eigen::Matrix<double, N, 1>>;

/// x <- L^-1 x, columns of L from the left.
template <int N>
void divide(const ConstSquare<N>& L, Part<N>& x) {
  for (Index k = 0; k < x.size(); ++k) {
    x[k] /= L(k, k);
    for (Index i = k + 1; i < x.size(); ++i) x[i] -= x[k] * L(i, k);
  }
}

template <int N>
void forward_blocks(const double* blocks, Index size, int first, int count, double* b) {
  const Index area = size * size;
  for (int k = first; k < count; ++k) {
    Part<N> x(b + k * size, size);
    if (k > first) {
      const ConstSquare<N> E(blocks + (2 * k - 1) * area, size, size);
      x.noalias() -= E * Part<N>(b + (k - 1) * size, size);
    }
    divide<N>(ConstSquare<N>(blocks + 2 * k * area, size, size), x);
  }
}

template <int N>
void backward_blocks(const double* blocks, Index size, int count, double* b) {
  const Index area = size * size;
  for (int k = count - 1; k >= 0; --k) {
    Part<N> x(b + k * size, size);
    if (k + 1 < count) {
      const ConstSquare<N> E(blocks + (2 * k + 1) * area, size, size);
      x.noalias() -= E.transpose() * Part<N>(b + (k + 1) * size, size);
    }
    ConstSquare<N>(blocks + 2 * k * area, size, size)
        .transpose()
        .template triangularView<Eigen::Upper>()
        .solveInPlace(x);
  }
}

/// Calls `run` with the block size as a constant where it is a usual one.
template <class Run>
auto with_size(int size, Run&& run) {
  switch (size) {
    case 6:
      return run.template operator()<6>();
    case 7:
      return run.template operator()<7>();
    case 12:
      return run.template operator()<12>();
    case 14:
      return run.template operator()<14>();
    default:
      return run.template operator()<Eigen::Dynamic>();
  }
}

}  // namespace

BlockTridiagonal::BlockTridiagonal(int block_size, int block_count)
    : size_(block_size), count_(block_count) {
  expects(block_size >= 1 && block_count >= 1, "a block-tridiagonal matrix has at least one block");
  blocks_.resize(static_cast<std::size_t>((2 * Index{count_} - 1) * area()));
}

void BlockTridiagonal::set_zero() { std::ranges::fill(blocks_, 0.0); }

void BlockTridiagonal::multiply(const Eigen::Ref<const Eigen::VectorXd>& x,
                                Eigen::Ref<Eigen::VectorXd> y) const {
  expects(x.size() == Index{size_} * count_ && y.size() == x.size(), "one entry per row");
  for (int k = 0; k < count_; ++k) {
    auto part = y.segment(k * size_, size_);
    part.noalias() = diagonal(k).selfadjointView<Eigen::Lower>() * x.segment(k * size_, size_);
    if (k > 0) part.noalias() += lower(k - 1) * x.segment((k - 1) * size_, size_);
    if (k + 1 < count_) {
      part.noalias() += lower(k).transpose() * x.segment((k + 1) * size_, size_);
    }
  }
}

bool BlockTridiagonal::factorise() {
  return with_size(size_,
                   [&]<int N>() { return factorise_blocks<N>(blocks_.data(), size_, count_); });
}

void BlockTridiagonal::solve_in_place(Eigen::Ref<Eigen::VectorXd> b) const {
  forward_in_place(b);
  backward_in_place(b);
}

void BlockTridiagonal::forward_in_place(Eigen::Ref<Eigen::VectorXd> b, int first) const {
  expects(b.size() == Index{size_} * count_, "one entry per row");
  expects(0 <= first && first <= count_, "`first` is one of the blocks, or the end");
  with_size(size_,
            [&]<int N>() { forward_blocks<N>(blocks_.data(), size_, first, count_, b.data()); });
}

void BlockTridiagonal::backward_in_place(Eigen::Ref<Eigen::VectorXd> b) const {
  expects(b.size() == Index{size_} * count_, "one entry per row");
  with_size(size_, [&]<int N>() { backward_blocks<N>(blocks_.data(), size_, count_, b.data()); });
}

}  // namespace tandem::math
