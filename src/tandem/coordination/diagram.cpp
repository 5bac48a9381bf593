#include "tandem/coordination/diagram.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::VectorXd;

namespace {

int power_of_two_above(int n) {
  int power = 1;
  while (power < n) power *= 2;
  return power;
}

/// Pairs that arms of both masks can move, and no other arm.
world::PairSelection meeting(const world::Workcell& cell, world::ArmMask x, world::ArmMask y) {
  world::PairSelection selection;
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    const world::ArmMask moved_by = cell.pairs()[i].moved_by;
    if ((moved_by & x) != 0 && (moved_by & y) != 0 && (moved_by & ~(x | y)) == 0) {
      selection.push_back(static_cast<int>(i));
    }
  }
  return selection;
}

}  // namespace

world::PairSelection pairs_between(const world::Workcell& cell, const Track& x, const Track& y) {
  return meeting(cell, x.mask(), y.mask());
}

collision::BatchChecker::Pairs compiled_pairs(const collision::CompiledCell& compiled,
                                              world::ArmMask x, world::ArmMask y) {
  if (std::popcount(x) > std::popcount(y) || (std::popcount(x) == std::popcount(y) && x > y)) {
    std::swap(x, y);
  }
  if (std::popcount(x) == 1) return compiled.pairs({.required = x, .permitted = x | y, .least = 2});
  return compiled.batch().compile(meeting(compiled.cell(), x, y));
}

CoordinationDiagram::CoordinationDiagram(const CoordinationProblem& problem, const Track& x,
                                         const Track& y, const DiagramOptions& options)
    : problem_(problem),
      x_(x),
      y_(y),
      checker_(problem.compiled.batch()),
      pairs_(compiled_pairs(problem.compiled, x.mask(), y.mask())),
      scratch_(checker_.make_scratch()) {
  check_arms(problem);
  expects(options.finest > 0 && options.largest > 0, "the finest and largest cell are positive");
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
  centers_ = D_ = Eigen::MatrixXd(cell().dof(), collision::boxes_at_once());
  cells_.push_back(
      {0, 0, units_[0], units_[1], power_of_two_above(units_[0]), power_of_two_above(units_[1])});
  // Boxes that arms move far in are hardly ever decided.
  const int most = std::max(1, static_cast<int>(options.largest / unit));
  for (int index = 0; index < static_cast<int>(cells_.size()); ++index) {
    const Cell& c = at(index);
    if (c.size() > most) halve(index, c.x1 - c.x0 >= c.y1 - c.y0);
  }
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
  std::vector<int> level{0}, unknown, next;
  const auto is_refuted = [&](int index) {
    const Cell& c = at(index);
    return c.is_leaf() && c.state != CellState::kUnknown && c.state != CellState::kFree &&
           !is_divisible(index, size);
  };
  const auto most = static_cast<std::size_t>(collision::boxes_at_once());
  while (!level.empty()) {  // Coarse before fine.
    if (std::ranges::any_of(level, is_refuted)) return false;
    unknown.clear();
    for (const int index : level) {
      if (at(index).is_leaf() && at(index).state == CellState::kUnknown) unknown.push_back(index);
    }
    for (std::size_t k = 0; k < unknown.size(); k += most) {
      const auto block = std::span(unknown).subspan(k, std::min(most, unknown.size() - k));
      examine_block(block);
      if (std::ranges::any_of(block, is_refuted)) return false;
    }
    next.clear();
    for (const int index : level) {
      if (at(index).is_leaf() && is_divisible(index, size)) divide(index);
      if (at(index).is_leaf()) continue;
      for (const int half : {at(index).child, at(index).child + 1}) {
        if (meets(line, at(half))) next.push_back(half);
      }
    }
    std::swap(level, next);
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

/// What the halves of these leaves' parents were left to be asked about, together.
std::span<const int> CoordinationDiagram::items_of(std::span<const int> leaves) {
  const auto items = [&](int leaf) {
    const Cell& c = at(leaf);
    return std::span<const int>(items_).subspan(static_cast<std::size_t>(c.first),
                                                static_cast<std::size_t>(c.count));
  };
  // Where nothing was asked yet everything is.
  if (std::ranges::any_of(leaves, [&](int leaf) { return at(leaf).count == 0; })) return {};
  const int first = at(leaves.front()).first;
  if (std::ranges::all_of(leaves, [&](int leaf) { return at(leaf).first == first; })) {
    return items(leaves.front());
  }
  asked_.clear();
  int last = -1;
  for (const int leaf : leaves) {
    if (at(leaf).first == last) continue;
    last = at(leaf).first;
    const auto more = items(leaf);
    asked_.insert(asked_.end(), more.begin(), more.end());
  }
  std::ranges::sort(asked_);
  asked_.erase(std::unique(asked_.begin(), asked_.end()), asked_.end());
  return asked_;
}

/// @param leaves  at most boxes_at_once(); all of them have a parent, or one is the root.
void CoordinationDiagram::examine_block(std::span<const int> leaves) {
  Eigen::Index column = 0;
  for (const int leaf : leaves) {
    const Cell& c = at(leaf);
    expects(c.state == CellState::kUnknown, "a cell is examined once");
    const std::size_t i = box(0, c.x0, c.x1, c.width), j = box(1, c.y0, c.y1, c.height);
    centers_.col(column) = boxes_[0].center[i] + boxes_[1].center[j];
    D_.col(column++) = boxes_[0].D[i] + boxes_[1].D[j];
  }
  collision::examine_boxes(checker_, centers_.leftCols(column), D_.leftCols(column), *pairs_,
                           items_of(leaves), *scratch_, findings_, open_);
  const auto first = static_cast<int>(items_.size()), count = static_cast<int>(open_.size());
  items_.insert(items_.end(), open_.begin(), open_.end());
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    Cell& c = cells_[static_cast<std::size_t>(leaves[k])];
    const collision::BoxFinding& found = findings_[k];
    examined_.push_back(leaves[k]);
    c.pair = found.pair;
    c.touches = found.touches_at_center;
    c.state = found.verdict == collision::BoxVerdict::kFree       ? CellState::kFree
              : found.verdict == collision::BoxVerdict::kTouching ? CellState::kBlocked
                                                                  : CellState::kOpen;
    if (c.state != CellState::kOpen) continue;
    const auto& mover = cell().bodies()[static_cast<std::size_t>(found.mover)];
    c.divides_x = (mover.moved_by & x_.mask()) != 0;
    c.first = first;
    c.count = count;
  }
}

bool CoordinationDiagram::examine(std::span<const int> leaves, const StopCondition& stop) {
  constexpr std::size_t kBlocksPerLook = 64;
  const auto most = static_cast<std::size_t>(collision::boxes_at_once());
  for (std::size_t k = 0; k < leaves.size(); k += most) {
    if (k / most % kBlocksPerLook == 0 && stop()) return false;
    examine_block(leaves.subspan(k, std::min(most, leaves.size() - k)));
  }
  return true;
}

void CoordinationDiagram::divide(int leaf) {
  const Cell& c = at(leaf);
  expects(c.is_leaf() && c.state == CellState::kOpen && c.size() > 1,
          "an open leaf of more than one unit is divided");
  halve(leaf, c.y1 - c.y0 == 1 || (c.x1 - c.x0 > 1 && c.divides_x));
}

void CoordinationDiagram::halve(int leaf, bool along_x) {
  const Cell c = at(leaf);
  Cell first{c.x0, c.y0, c.x1, c.y1, c.width, c.height};
  first.first = c.first;
  first.count = c.count;
  Cell second = first;
  const auto split = [](int x0, int x1, int& width) {
    do width /= 2;
    while (x0 + width >= x1);
    return x0 + width;
  };
  if (along_x) {
    first.x1 = second.x0 = split(c.x0, c.x1, first.width);
    second.width = first.width;
  } else {
    first.y1 = second.y0 = split(c.y0, c.y1, first.height);
    second.height = first.height;
  }
  cells_[static_cast<std::size_t>(leaf)].child = static_cast<int>(cells_.size());
  cells_.push_back(first);
  cells_.push_back(second);
}

bool CoordinationDiagram::resolve(int size, const StopCondition& stop, std::vector<int> from) {
  std::vector<int> unknown, next;
  while (!from.empty()) {
    unknown.clear();
    for (const int index : from) {
      if (at(index).is_leaf() && at(index).state == CellState::kUnknown) unknown.push_back(index);
    }
    if (!examine(unknown, stop)) return false;
    next.clear();
    for (const int index : from) {
      if (at(index).is_leaf() && is_divisible(index, size)) divide(index);
      if (at(index).is_leaf()) continue;
      next.push_back(at(index).child);
      next.push_back(at(index).child + 1);
    }
    std::swap(from, next);
  }
  return true;
}

}  // namespace tandem::coordination
