#include "tandem/coordination/diagram.h"

#include <algorithm>
#include <cmath>

#include "tandem/collision/box_check.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::VectorXd;

namespace {

int power_of_two_above(int n) {
  int power = 1;
  while (power < n) power *= 2;
  return power;
}

}  // namespace

world::PairSelection pairs_between(const world::Workcell& cell, const Track& x, const Track& y) {
  world::PairSelection selection;
  const world::ArmMask both = x.mask() | y.mask();
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    const world::ArmMask moved_by = cell.pairs()[i].moved_by;
    if ((moved_by & x.mask()) != 0 && (moved_by & y.mask()) != 0 && (moved_by & ~both) == 0) {
      selection.push_back(static_cast<int>(i));
    }
  }
  return selection;
}

CoordinationDiagram::CoordinationDiagram(const CoordinationProblem& problem, const Track& x,
                                         const Track& y, const DiagramOptions& options)
    : problem_(problem), x_(x), y_(y), scratch_(problem.checker.make_scratch()) {
  check_arms(problem);
  expects(options.finest > 0, "the finest cell is positive");
  expects((x.mask() & y.mask()) == 0, "the tracks of a diagram share no arm");
  // Units are about as long along both axes, so that the cheapest ways in them are cheapest in
  // time.
  const double longest = std::max(x.duration(), y.duration());
  const double unit = std::max(options.finest, longest / kMostUnits);
  const double durations[] = {x.duration(), y.duration()};
  for (const int axis : {0, 1}) {
    units_[axis] = std::max(1, static_cast<int>(std::ceil(durations[axis] / unit - 1e-9)));
    unit_[axis] = durations[axis] / units_[axis];
    boxes_[axis].slot.assign(2 * static_cast<std::size_t>(power_of_two_above(units_[axis])), -1);
  }
  pairs_ = pairs_between(cell(), x, y);
  center_ = D_ = VectorXd::Zero(cell().dof());
  Cell root{
      0, 0, units_[0], units_[1], power_of_two_above(units_[0]), power_of_two_above(units_[1])};
  root.count = static_cast<int>(pairs_.size());
  cells_.push_back(root);
}

int CoordinationDiagram::leaf_at(int x, int y) const {
  if (x < 0 || y < 0 || x >= units_[0] || y >= units_[1]) return -1;
  int index = 0;
  while (!at(index).is_leaf()) {
    const Cell& first = at(at(index).child);
    index = at(index).child + (x < first.x1 && y < first.y1 ? 0 : 1);
  }
  return index;
}

void CoordinationDiagram::leaves_touching(int x0, int y0, int x1, int y1,
                                          std::vector<int>& leaves) const {
  leaves.clear();
  std::vector<int> open{0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const Cell& c = at(index);
    if (c.x0 > x1 || c.x1 < x0 || c.y0 > y1 || c.y1 < y0) continue;
    if (c.is_leaf()) {
      leaves.push_back(index);
      continue;
    }
    open.push_back(c.child + 1);
    open.push_back(c.child);
  }
}

/// No axis separates the line from the open rectangle.
bool CoordinationDiagram::meets(const HalfLine& line, const Cell& c) {
  const int x0 = 2 * c.x0, x1 = 2 * c.x1, y0 = 2 * c.y0, y1 = 2 * c.y1;
  if (std::max(line.ax, line.bx) <= x0 || std::min(line.ax, line.bx) >= x1) return false;
  if (std::max(line.ay, line.by) <= y0 || std::min(line.ay, line.by) >= y1) return false;
  const std::int64_t dx = line.bx - line.ax, dy = line.by - line.ay;
  const auto side = [&](int x, int y) { return dx * (y - line.ay) - dy * (x - line.ax); };
  const auto [least, most] = std::minmax({side(x0, y0), side(x1, y0), side(x0, y1), side(x1, y1)});
  return least < 0 && most > 0;
}

bool CoordinationDiagram::is_line_free(const HalfLine& line, int size) {
  std::vector<int> open{0};
  for (std::size_t k = 0; k < open.size(); ++k) {  // Coarse before fine.
    const int index = open[k];
    if (!meets(line, at(index))) continue;
    if (at(index).state == CellState::kUnknown) examine(index);
    if (at(index).is_leaf() && is_divisible(index, size)) divide(index);
    if (!at(index).is_leaf()) {
      open.push_back(at(index).child);
      open.push_back(at(index).child + 1);
    } else if (at(index).state != CellState::kFree) {
      return false;
    }
  }
  return true;
}

/// Where the box of a track over an interval of units is kept.
std::size_t CoordinationDiagram::box(int axis, int from, int to, int width) {
  Boxes& boxes = boxes_[axis];
  const auto place = boxes.slot.size() / 2 + static_cast<std::size_t>(from);
  int& slot = boxes.slot[place / static_cast<std::size_t>(width)];
  if (slot < 0) {
    slot = static_cast<int>(boxes.D.size());
    VectorXd center = VectorXd::Zero(cell().dof()), D = center;
    const Track& track = axis == 0 ? x_ : y_;
    const auto time = [&](int units) { return axis == 0 ? at_x(units) : at_y(units); };
    track.box(time(from), time(to), center, D);
    boxes.center.push_back(std::move(center));
    boxes.D.push_back(std::move(D));
  }
  return static_cast<std::size_t>(slot);
}

void CoordinationDiagram::examine(int leaf) {
  Cell& c = cells_[static_cast<std::size_t>(leaf)];
  expects(c.state == CellState::kUnknown, "a cell is examined once");
  const std::size_t i = box(0, c.x0, c.x1, c.width), j = box(1, c.y0, c.y1, c.height);
  center_ = boxes_[0].center[i] + boxes_[1].center[j];
  D_ = boxes_[0].D[i] + boxes_[1].D[j];
  unproven_.clear();
  const std::span<const int> pairs(pairs_.data() + c.first, static_cast<std::size_t>(c.count));
  const auto found =
      collision::examine_box(problem_.checker, center_, D_, pairs, *scratch_, unproven_);
  examined_.push_back(leaf);
  c.pair = found.pair;
  c.touches = found.touches_at_center;
  if (found.verdict == collision::BoxVerdict::kFree) {
    c.state = CellState::kFree;
    return;
  }
  if (found.verdict == collision::BoxVerdict::kTouching) {
    c.state = CellState::kBlocked;
    return;
  }
  c.state = CellState::kOpen;
  const auto& pair = cell().pairs()[static_cast<std::size_t>(found.pair)];
  const auto& bodies = cell().bodies();
  const bool a_is_x = (bodies[static_cast<std::size_t>(pair.a)].moved_by & x_.mask()) != 0;
  c.divides_x = (found.travel_a >= found.travel_b) == a_is_x;
  c.first = static_cast<int>(pairs_.size());
  c.count = static_cast<int>(unproven_.size());
  pairs_.insert(pairs_.end(), unproven_.begin(), unproven_.end());
}

void CoordinationDiagram::divide(int leaf) {
  const Cell c = at(leaf);
  expects(c.is_leaf() && c.state == CellState::kOpen && c.size() > 1,
          "an open leaf of more than one unit is divided");
  Cell first{c.x0, c.y0, c.x1, c.y1, c.width, c.height};
  first.first = c.first;
  first.count = c.count;
  Cell second = first;
  const auto halve = [](int x0, int x1, int& width) {
    do width /= 2;
    while (x0 + width >= x1);
    return x0 + width;
  };
  if (c.y1 - c.y0 == 1 || (c.x1 - c.x0 > 1 && c.divides_x)) {
    first.x1 = second.x0 = halve(c.x0, c.x1, first.width);
    second.width = first.width;
  } else {
    first.y1 = second.y0 = halve(c.y0, c.y1, first.height);
    second.height = first.height;
  }
  cells_[static_cast<std::size_t>(leaf)].child = static_cast<int>(cells_.size());
  cells_.push_back(first);
  cells_.push_back(second);
}

bool CoordinationDiagram::resolve(int size, const StopCondition& stop, int from) {
  std::vector<int> open{from};
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (k % 64 == 0 && stop()) return false;
    const int index = open[k];
    if (at(index).state == CellState::kUnknown) examine(index);
    if (at(index).is_leaf() && is_divisible(index, size)) divide(index);
    if (at(index).is_leaf()) continue;
    open.push_back(at(index).child);
    open.push_back(at(index).child + 1);
  }
  return true;
}

}  // namespace tandem::coordination
