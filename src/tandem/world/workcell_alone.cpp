#include "tandem/core/contract.h"
#include "tandem/world/workcell_builder.h"

namespace tandem::world {

std::shared_ptr<const Workcell> Workcell::arm_alone(int i) const {
  expects(0 <= i && i < static_cast<int>(arms_.size()), "arm is an index into arms()");
  return WorkcellBuilder(*this).build_alone(i);
}

/// Arms that are left out own their joints as well, with indices after those that are not.
void WorkcellBuilder::own_joints() {
  owner_.assign(cell_->model_.joints().size(), -1);
  int index = 0;
  for (const auto* arms : {&cell_->arms_, &cell_->left_out_}) {
    for (const Arm& arm : *arms) {
      for (const int joint : arm.joints) owner_[static_cast<std::size_t>(joint)] = index;
      ++index;
    }
  }
}

std::shared_ptr<const Workcell> WorkcellBuilder::build_alone(int arm) {
  const auto index = static_cast<std::size_t>(arm);
  Arm kept = cell_->arms_[index];
  for (std::size_t i = 0; i < cell_->arms_.size(); ++i) {
    if (i != index) cell_->left_out_.push_back(std::move(cell_->arms_[i]));
  }
  keep_joints(kept.offset, kept.dof());
  kept.offset = 0;
  cell_->arms_ = {std::move(kept)};
  cell_->spec_.arms = {cell_->spec_.arms[index]};
  cell_->spec_.queries.clear();
  cell_->spec_.lists.clear();
  cell_->queries_.clear();
  cell_->lists_.clear();
  own_joints();
  for (Body& body : cell_->bodies_) body.moved_by = arms_between(body.link, 0);
  // The same allowances were good for the whole cell.
  expects(skip_pairs().has_value(), "a cell's bodies have the names that its pairs are allowed by");
  make_pairs(Marked(cell_->bodies_.size(), true));
  return cell_;
}

/// The cell's q with these entries only.
void WorkcellBuilder::keep_joints(int offset, int dof) {
  cell_->dof_ = dof;
  cell_->lower_ = Eigen::VectorXd(cell_->lower_.segment(offset, dof));
  cell_->upper_ = Eigen::VectorXd(cell_->upper_.segment(offset, dof));
  const auto first = cell_->limits_.begin() + offset;
  cell_->limits_ = std::vector(first, first + dof);
  const auto name = cell_->joint_names_.begin() + offset;
  cell_->joint_names_ = std::vector(name, name + dof);
}

}  // namespace tandem::world
