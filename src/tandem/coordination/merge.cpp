#include "tandem/coordination/merge.h"

#include <algorithm>

#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

namespace {

/// Parts of the edge from a to b, in (0, 1], at which a track changes its direction; ends with 1.
void append_parts(const Track& track, double a, double b, std::vector<double>& parts) {
  for (const double t : track.kinks(std::min(a, b), std::max(a, b))) {
    parts.push_back((t - a) / (b - a));
  }
}

}  // namespace

Track merge(const CoordinationDiagram& diagram, const std::vector<GridPoint>& points) {
  const Track &x = diagram.x(), &y = diagram.y();
  std::vector<int> arms = x.arms();
  arms.insert(arms.end(), y.arms().begin(), y.arms().end());
  const auto place = [&](double at_x, double at_y) {
    VectorXd both(static_cast<Index>(arms.size()));
    both << x.place(at_x), y.place(at_y);
    return both;
  };
  std::vector<VectorXd> places{place(0, 0)};
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double ax = diagram.at_x(points[k - 1].x), bx = diagram.at_x(points[k].x);
    const double ay = diagram.at_y(points[k - 1].y), by = diagram.at_y(points[k].y);
    std::vector<double> parts;
    append_parts(x, ax, bx, parts);
    append_parts(y, ay, by, parts);
    std::ranges::sort(parts);
    for (const double part : parts) {
      places.push_back(place(ax + part * (bx - ax), ay + part * (by - ay)));
    }
    places.push_back(place(bx, by));
  }
  return {diagram.problem(), std::move(arms), make_schedule(places)};
}

Schedule schedule_of(const Track& track) {
  Schedule schedule = track.schedule();
  for (VectorXd& place : schedule.places) {
    const VectorXd of_track = place;
    for (std::size_t i = 0; i < track.arms().size(); ++i) {
      place[track.arms()[i]] = of_track[static_cast<Index>(i)];
    }
  }
  return schedule;
}

}  // namespace tandem::coordination
