#include "shortening_traces.h"

#include <algorithm>
#include <cstdio>

#include "tandem/world/tool_poses.h"

namespace tandem {

namespace {

constexpr double kScale = 260;             // [px/m]
constexpr double kWidth = 190, kTop = 60;  // [px] of a column, and above the panels.

/// One phase seen along one axis, y to the left: curves, and a dot per waypoint.
struct Panel {
  int across, up;     ///< Entries of p_WE drawn to the left and upwards.
  double left, base;  ///< [px] where the low corner of the box is drawn.
  Eigen::Vector3d low, high;

  double x(const Eigen::Vector3d& p) const { return left + kScale * (high[across] - p[across]); }
  double y(const Eigen::Vector3d& p) const { return base - kScale * (p[up] - low[up]); }
};

void draw(const Panel& panel, const world::Workcell& cell, const motion::JointPath& path) {
  constexpr const char* kColors[] = {"#1f6fb4", "#c0392b", "#2e8b57", "#8e44ad"};
  const auto curves = tool_poses(cell, motion::interpolated(path, 400));
  const auto dots = tool_poses(cell, path);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const char* color = kColors[i % 4];
    std::printf("<polyline fill='none' stroke='%s' stroke-width='1.5' points='", color);
    for (const auto& X_WE : curves[i]) {
      std::printf("%.1f,%.1f ", panel.x(X_WE.translation()), panel.y(X_WE.translation()));
    }
    std::printf("'/>\n");
    for (const auto& X_WE : dots[i]) {
      std::printf("<circle cx='%.1f' cy='%.1f' r='2' fill='%s'/>\n", panel.x(X_WE.translation()),
                  panel.y(X_WE.translation()), color);
    }
  }
}

}  // namespace

int print_traces(const std::shared_ptr<const world::Workcell>& cell, std::string_view name) {
  const pipeline::Planner planner(cell);
  const auto queries = planner.resolve_all(cell->queries());
  const auto query = queries ? std::ranges::find(*queries, name, &pipeline::ResolvedQuery::name)
                             : decltype(queries->begin()){};
  if (!queries || query == queries->end()) {
    std::fprintf(stderr, "there is no query '%s' that can be resolved\n",
                 std::string(name).c_str());
    return 2;
  }
  const auto planned = planner.plan(*query);
  if (!planned) {
    std::fprintf(stderr, "%s\n", planned.error().message.c_str());
    return 1;
  }
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const pipeline::Phase& phase : planned->report.phases) {
    for (const auto& X_WE : tool_poses(*cell, motion::interpolated(phase.path, 400))) {
      for (const auto& X : X_WE) {
        low = low.cwiseMin(X.translation());
        high = high.cwiseMax(X.translation());
      }
    }
  }
  const Eigen::Vector3d size = kScale * (high - low);
  const double column = std::max(kWidth, size.y() + 40);
  const double above = kTop + size.x(), side = above + 50 + size.z();
  std::printf(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' "
      "font-family='sans-serif' font-size='13'>\n<rect width='100%%' height='100%%' "
      "fill='white'/>\n",
      column * static_cast<double>(planned->report.phases.size()) + 20, side + 20);
  double left = 20;
  for (const pipeline::Phase& phase : planned->report.phases) {
    std::string title = phase.name;
    std::ranges::replace(title, '_', ' ');
    std::printf(
        "<text x='%.0f' y='24'>%s</text>\n<text x='%.0f' y='42' fill='#666'>%zu waypoints</text>\n",
        left, title.c_str(), left, phase.path.size());
    draw({1, 0, left, above, low, high}, *cell, phase.path);
    draw({1, 2, left, side, low, high}, *cell, phase.path);
    left += column;
  }
  std::printf("</svg>\n");
  return 0;
}

}  // namespace tandem
