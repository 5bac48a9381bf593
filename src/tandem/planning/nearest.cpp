#include "tandem/planning/nearest.h"

#include <algorithm>
#include <array>
#include <limits>

#include "tandem/core/contract.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tandem/planning/nearest.cpp"
#include <hwy/foreach_target.h>  // Includes this file again for each instruction set.
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace tandem::planning::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The nearest of `blocks` blocks to the point q of `dof` floats.
int Nearest(const NearestConfigurations::Row* rows, int blocks, int dof, const float* q) {
  const hn::CappedTag<float, NearestConfigurations::kBlock> floats;
  const hn::Rebind<std::int32_t, decltype(floats)> ints;
  constexpr auto kLanes = static_cast<int>(hn::MaxLanes(floats));
  auto least = hn::Set(floats, std::numeric_limits<float>::infinity());
  auto where = hn::Set(ints, -1);
  auto index = hn::Iota(ints, 0);
  for (int block = 0; block < blocks; ++block, rows += dof) {
    for (int first = 0; first < NearestConfigurations::kBlock; first += kLanes) {
      auto sum = hn::Zero(floats);
      for (int j = 0; j < dof; ++j) {
        const auto d = hn::Sub(hn::Load(floats, rows[j].value + first), hn::Set(floats, q[j]));
        sum = hn::MulAdd(d, d, sum);
      }
      const auto nearer = hn::Lt(sum, least);
      least = hn::IfThenElse(nearer, sum, least);
      where = hn::IfThenElse(hn::RebindMask(ints, nearer), index, where);
      index = hn::Add(index, hn::Set(ints, kLanes));
    }
  }
  const auto lane = hn::FindFirstTrue(floats, hn::Eq(least, hn::MinOfLanes(floats, least)));
  HWY_ALIGN std::int32_t index_of_lane[NearestConfigurations::kBlock];
  hn::Store(where, ints, index_of_lane);
  return index_of_lane[lane];
}

}  // namespace tandem::planning::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tandem::planning {

HWY_EXPORT(Nearest);

namespace {

constexpr int kMostJoints = 64;

}  // namespace

NearestConfigurations::NearestConfigurations(int dof) : dof_(dof) {
  expects(1 <= dof && dof <= kMostJoints, "a configuration has 1 to 64 entries");
}

void NearestConfigurations::add(const Eigen::Ref<const Eigen::VectorXd>& q) {
  expects(q.size() == dof_ && q.allFinite(), "q is finite and has one entry per joint");
  const auto block = static_cast<std::size_t>(size_ / kBlock);
  const auto dof = static_cast<std::size_t>(dof_);
  if (size_ % kBlock == 0) {
    rows_.resize((block + 1) * dof);
    // Further than any configuration, so that what is not there is never the nearest.
    for (std::size_t j = 0; j < dof; ++j) std::ranges::fill(rows_[block * dof + j].value, 1e18F);
  }
  for (std::size_t j = 0; j < dof; ++j) {
    rows_[block * dof + j].value[size_ % kBlock] =
        static_cast<float>(q[static_cast<Eigen::Index>(j)]);
  }
  ++size_;
}

int NearestConfigurations::nearest(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  expects(q.size() == dof_, "q has one entry per joint");
  std::array<float, kMostJoints> single;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    single[static_cast<std::size_t>(j)] = static_cast<float>(q[j]);
  }
  const int blocks = (size_ + kBlock - 1) / kBlock;
  return HWY_DYNAMIC_DISPATCH(Nearest)(rows_.data(), blocks, dof_, single.data());
}

}  // namespace tandem::planning
#endif  // HWY_ONCE
