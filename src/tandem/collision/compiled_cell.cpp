#include "tandem/collision/compiled_cell.h"

namespace tandem::collision {

CompiledCell::CompiledCell(std::shared_ptr<const world::Workcell> cell)
    : cell_(std::move(cell)), exact_(cell_) {}

const BatchChecker& CompiledCell::batch() const {
  const std::lock_guard lock(known_->mutex);
  if (!known_->batch) known_->batch = std::make_unique<const BatchChecker>(exact_);
  return *known_->batch;
}

const world::PairSelection& CompiledCell::selection(const world::PairScope& scope) const {
  const std::lock_guard lock(known_->mutex);
  const auto [found, is_new] = known_->selections.try_emplace(scope);
  if (is_new) found->second = cell_->select(scope);
  return found->second;
}

BatchChecker::Pairs CompiledCell::pairs(const world::PairScope& scope) const {
  const BatchChecker& checker = batch();
  const std::lock_guard lock(known_->mutex);
  BatchChecker::Pairs& pairs = known_->pairs[scope];
  if (!pairs) pairs = checker.compile(scope);
  return pairs;
}

const CompiledCell& CompiledCell::alone(int arm) const {
  const std::lock_guard lock(known_->mutex);
  auto& alone = known_->alone[arm];
  if (!alone) alone = std::make_unique<const CompiledCell>(cell_->arm_alone(arm));
  return *alone;
}

}  // namespace tandem::collision
