#include "tandem/coordination/drawing.h"

#include <algorithm>

#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::VectorXd;

namespace {

/// Two arms of a problem, with the proof of lines in their diagram.
class Lines {
 public:
  Lines(const CoordinationProblem& problem, const CoordinationDiagram& diagram)
      : problem_(problem),
        x_(diagram.x().arms()[0]),
        y_(diagram.y().arms()[0]),
        pairs_(pairs_between(diagram.cell(), diagram.x(), diagram.y())),
        scratch_(problem.exact().make_scratch()) {}

  DiagramLine examine(std::string name, Schedule schedule, const StopCondition& stop) const {
    DiagramLine line{std::move(name), std::move(schedule), true};
    const auto& [places, times] = line.schedule;
    for (std::size_t k = 1; k < places.size() && line.is_free; ++k) {
      const auto proof = certify_edge(problem_, everywhere(places[k - 1]), everywhere(places[k]),
                                      pairs_, *scratch_, stop);
      line.is_free = proof.is_free();
      if (line.is_free) continue;
      line.time = times[k - 1] + proof.time * (times[k] - times[k - 1]);
      line.place = places[k - 1] + proof.time * (places[k] - places[k - 1]);
      line.pair = proof.pair;
      line.depth = proof.depth;
    }
    return line;
  }
  /// The two arms' part of a schedule of all.
  Schedule part(const Schedule& all) const {
    Schedule two;
    two.times = all.times;
    for (const VectorXd& place : all.places) {
      two.places.push_back(Eigen::Vector2d(place[x_], place[y_]));
    }
    return two;
  }

 private:
  /// The other arms stand at their starts: the pairs are not about them.
  VectorXd everywhere(const VectorXd& place) const {
    VectorXd all = VectorXd::Zero(static_cast<Eigen::Index>(problem_.arms.size()));
    all[x_] = place[0];
    all[y_] = place[1];
    return all;
  }

  const CoordinationProblem& problem_;
  int x_, y_;
  world::PairSelection pairs_;
  std::unique_ptr<collision::CollisionChecker::Scratch> scratch_;
};

}  // namespace

Result<DiagramDrawing> draw_diagram(const CoordinationProblem& problem, int arm_x, int arm_y,
                                    const std::vector<Schedule>& schedules, double resolution,
                                    const StopCondition& stop) {
  check_arms(problem);
  const int arms = static_cast<int>(problem.arms.size());
  expects(0 <= arm_x && arm_x < arms && 0 <= arm_y && arm_y < arms && arm_x != arm_y,
          "a diagram is of two arms of the cell");
  const Track x(problem, arm_x), y(problem, arm_y);
  CoordinationDiagram diagram(problem, x, y, {.finest = resolution});
  const auto stopped = [&] { return std::unexpected(stop.error("drawing a diagram")); };
  if (!diagram.resolve(1, stop)) return stopped();
  DiagramDrawing drawing{arm_x, arm_y, x.duration(), y.duration(), resolution};
  drawing.evaluations = diagram.evaluations();
  for (const auto& c : diagram.cells()) {
    if (!c.is_leaf()) continue;
    drawing.cells.push_back({diagram.at_x(c.x0), diagram.at_y(c.y0), diagram.at_x(c.x1),
                             diagram.at_y(c.y1), c.state,
                             c.state == CellState::kFree ? -1 : c.pair});
  }
  const Eigen::Vector2d start(0, 0), goal(x.duration(), y.duration());
  const double first = goal.minCoeff();
  const Lines lines(problem, diagram);
  drawing.lines.push_back(lines.examine(
      "uncoordinated", make_schedule({start, Eigen::Vector2d(first, first), goal}), stop));
  drawing.lines.push_back(lines.examine("slowed", make_schedule({start, goal}), stop));
  for (std::size_t k = 0; k < schedules.size(); ++k) {
    const std::string name = k == 0 ? "coordinated" : "alternative " + std::to_string(k);
    drawing.lines.push_back(lines.examine(name, lines.part(schedules[k]), stop));
  }
  if (stop()) return stopped();
  return drawing;
}

}  // namespace tandem::coordination
