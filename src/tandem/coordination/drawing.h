#pragma once
/// A coordination diagram for people: what is blocked, and which lines lead through it.

#include <string>

#include "tandem/coordination/diagram.h"

namespace tandem::coordination {

/// A timing of two arms in their diagram.
struct DiagramLine {
  std::string name;            ///< "uncoordinated", "slowed" or "coordinated".
  Schedule schedule;           ///< Of the two arms.
  bool is_free = false;        ///< Proven.
  double time = 0;             ///< [s] If not free: where it touches, or could not be proven.
  Eigen::VectorXd place = {};  ///< Local times there.
  int pair = -1;               ///< Index into pairs().
  double depth = 0;            ///< [m]
};

/// Everything that a figure of the diagram of two arms shows. Ref: the paper, fig:CoordDiagr.
struct DiagramDrawing {
  struct Rectangle {
    double x0, y0, x1, y1;  ///< [s]
    CellState state;
    int pair;  ///< That touches everywhere, or is not proven apart; -1 if free.
  };
  int arm_x = 0, arm_y = 1;               ///< Of the cell.
  double duration_x = 0, duration_y = 0;  ///< [s]
  double resolution = 0;                  ///< [s] Open cells are no larger.
  long evaluations = 0;
  std::vector<Rectangle> cells = {};  ///< They tile [0, duration_x] x [0, duration_y].
  std::vector<DiagramLine> lines =
      {};  ///< The uncoordinated one, the slowed one, the coordinated ones.
};

/// Examines the whole diagram of two arms down to `resolution` [s], and the lines: both motions at
/// planned speed, the shorter one waiting at its end; both slowed down to the same duration; and
/// those of `schedules`, of all arms of the problem, "coordinated", then "alternative 1" and on.
/// @return the stop's error.
Result<DiagramDrawing> draw_diagram(const CoordinationProblem& problem, int arm_x, int arm_y,
                                    const std::vector<Schedule>& schedules,
                                    double resolution = 0.01, const StopCondition& stop = {});

}  // namespace tandem::coordination
