#pragma once
/// Bodies that were compiled before. Private to this folder.

#include "tandem/collision/ssv_model.h"

namespace tandem::collision {

/// Finds the bodies of a cell that another cell has too, the same in every number and in the same
/// order but for single ones, and takes over how they were compiled: of a mesh that is most of the
/// work.
class SsvKnown {
 public:
  /// @param like  of the other cell; nullptr: nothing is known. Must outlive this.
  explicit SsvKnown(const SsvChecker* like) : like_(like) {}

  /// Adds the cell's next body to the model, if it is known.
  /// @param frame  of the body's link.   @return whether it is.
  bool add(const world::Body& body, const LinkFrame& frame, SsvModel& model);

 private:
  int find(const world::Body& body);

  const SsvChecker* like_;
  std::size_t next_ = 0;  // Of the other cell's bodies: most likely the next one here.
};

}  // namespace tandem::collision
