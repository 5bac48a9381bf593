#pragma once
/// Nearest neighbours by looking at all of them, several at once.

#include <Eigen/Core>
#include <vector>

namespace tandem::planning {

/// Configurations in the order they were added. At the sizes that planners' trees reach, looking at
/// all in vectors is faster than any tree. One thread at a time may add.
class NearestConfigurations {
 public:
  /// @param dof  entries of a configuration, >= 1.
  explicit NearestConfigurations(int dof);

  int size() const { return size_; }
  /// Takes memory for so many configurations.
  void reserve(std::size_t count) {
    rows_.reserve((count + kBlock - 1) / kBlock * static_cast<std::size_t>(dof_));
  }
  /// Keeps the memory.
  void clear() { size_ = 0; }
  /// @param q  dof, finite.
  void add(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Index of the configuration with the least Euclidean distance to q, of those that single
  /// precision cannot tell apart any; -1 if there is none. Allocates nothing.
  int nearest(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// Configurations per block; a block holds one row of so many floats per entry.
  static constexpr int kBlock = 16;
  struct alignas(sizeof(float) * kBlock) Row {
    float value[kBlock];
  };

 private:
  int dof_;
  int size_ = 0;
  std::vector<Row> rows_;  // dof per block.
};

}  // namespace tandem::planning
