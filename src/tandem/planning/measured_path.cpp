#include "tandem/planning/measured_path.h"

#include <algorithm>
#include <numeric>

#include "tandem/core/contract.h"

namespace tandem::planning {

MeasuredPath::MeasuredPath(motion::JointPath path) : path_(std::move(path)), at_(path_.size()) {
  expects(!path_.empty(), "a path has a waypoint");
  for (std::size_t i = 1; i < path_.size(); ++i) {
    at_[i] = at_[i - 1] + (path_[i] - path_[i - 1]).norm();
  }
  length_ = at_.back();
  for (double& s : at_) s = length_ > 0 ? s / length_ : 0;
}

Eigen::VectorXd MeasuredPath::position(double s) const {
  if (s <= 0) return path_.front();
  if (s >= 1) return path_.back();
  const auto next = std::ranges::upper_bound(at_, s);
  if (next == at_.end()) return path_.back();
  const auto i = static_cast<std::size_t>(next - at_.begin());
  const double u = (s - at_[i - 1]) / (at_[i] - at_[i - 1]);
  return path_[i - 1] + u * (path_[i] - path_[i - 1]);
}

void MeasuredPath::append_waypoints(double from, double to, std::vector<double>& parts) const {
  if (from == to) return;
  for (const double s : at_) {
    const double part = (s - from) / (to - from);
    if (part > 0 && part < 1) parts.push_back(part);
  }
}

std::vector<std::vector<int>> orders(int count) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<int>> all;
  if (count <= 3) {
    do all.push_back(order);
    while (std::ranges::next_permutation(order).found);
    return all;
  }
  for (int k = 0; k < count; ++k) {
    all.push_back(order);
    std::ranges::rotate(order, order.begin() + 1);
  }
  return all;
}

}  // namespace tandem::planning
