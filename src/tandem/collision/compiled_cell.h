#pragma once
/// A workcell compiled for collision checks, once.

#include <map>
#include <mutex>

#include "tandem/collision/batch_checker.h"
#include "tandem/collision/ssv_checker.h"

namespace tandem::collision {

/// The exact checker and the batch checker of one workcell, and its pairs by scope. Immutable and
/// thread-safe: share it between plans and threads. What not everybody asks for is compiled when
/// it is first asked for.
class CompiledCell {
 public:
  /// @param like  of the same cell in another state, or of one with the same robots: what is known
  ///   of their links is taken from it.
  explicit CompiledCell(std::shared_ptr<const world::Workcell> cell,
                        const CompiledCell* like = nullptr);

  const world::Workcell& cell() const { return *cell_; }
  const std::shared_ptr<const world::Workcell>& shared_cell() const { return cell_; }
  const SsvChecker& exact() const { return exact_; }
  const BatchChecker& batch() const;

  /// References stay valid as long as this does.
  const world::PairSelection& selection(const world::PairScope& scope) const;
  /// For batch().
  BatchChecker::Pairs pairs(const world::PairScope& scope) const;
  /// cell().arm_alone(arm), compiled.
  const CompiledCell& alone(int arm) const;

 private:
  /// What was asked for so far. Nodes of maps stay where they are.
  struct Known {
    std::mutex mutex;
    std::shared_ptr<const JointMaps> joint_maps;
    std::unique_ptr<const BatchChecker> batch;
    std::map<world::PairScope, world::PairSelection> selections;
    std::map<world::PairScope, BatchChecker::Pairs> pairs;
    std::map<int, std::unique_ptr<const CompiledCell>> alone;
  };

  std::shared_ptr<const world::Workcell> cell_;
  SsvChecker exact_;
  std::unique_ptr<Known> known_ = std::make_unique<Known>();
};

}  // namespace tandem::collision
