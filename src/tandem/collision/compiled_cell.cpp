#include "tandem/collision/compiled_cell.h"

namespace tandem::collision {

CompiledCell::CompiledCell(std::shared_ptr<const world::Workcell> cell, const CompiledCell* like)
    : cell_(std::move(cell)), exact_(cell_, like ? &like->exact_ : nullptr) {
  if (!like) return;
  const std::lock_guard lock(like->known_->mutex);
  known_->joint_maps = like->known_->joint_maps;
}

const BatchChecker& CompiledCell::batch() const {
  const std::lock_guard lock(known_->mutex);
  if (!known_->batch) {
    known_->batch = std::make_unique<const BatchChecker>(exact_, known_->joint_maps.get());
    known_->joint_maps = known_->batch->joint_maps();
  }
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
  {
    const std::lock_guard lock(known_->mutex);
    const auto known = known_->alone.find(arm);
    if (known != known_->alone.end()) return *known->second;
  }
  auto made = std::make_unique<const CompiledCell>(cell_->arm_alone(arm), this);
  const std::lock_guard lock(known_->mutex);
  return *known_->alone.try_emplace(arm, std::move(made)).first->second;
}

}  // namespace tandem::collision
