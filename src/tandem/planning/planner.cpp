#include "tandem/planning/planner.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include "tandem/core/contract.h"

namespace tandem::planning {

namespace {

Result<void> check_end(const char* end, const Eigen::VectorXd& q, const PathProblem& problem,
                       Validity& validity) {
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    // Written so that NaN fails.
    if (q[j] >= problem.lower[j] && q[j] <= problem.upper[j]) continue;
    std::ostringstream message;
    message << "the " << end << " is outside the limits: joint " << j << " (of " << q.size()
            << ", from 0) is " << q[j] << ", its limits are " << problem.lower[j] << " to "
            << problem.upper[j];
    return fail(ErrorCode::kInfeasible, message.str());
  }
  if (!validity.state(q)) {
    return fail(ErrorCode::kInfeasible, std::string("the ") + end +
                                            " is not valid: something touches there; `tandem "
                                            "check` names the pair");
  }
  return {};
}

}  // namespace

Result<void> check_problem(const PathProblem& problem, Validity& validity) {
  const Eigen::Index n = problem.start.size();
  expects(
      n > 0 && problem.goal.size() == n && problem.lower.size() == n && problem.upper.size() == n,
      "start, goal and limits have the same size, not 0");
  expects((problem.lower.array() <= problem.upper.array()).all(), "lower limits are below upper");
  if (auto start = check_end("start", problem.start, problem, validity); !start) return start;
  return check_end("goal", problem.goal, problem, validity);
}

SearchBox search_box(const PathProblem& problem) {
  SearchBox box{problem.lower, problem.upper};
  for (Eigen::Index j = 0; j < box.lower.size(); ++j) {
    const auto [low, high] = std::minmax(problem.start[j], problem.goal[j]);
    if (!std::isfinite(box.lower[j])) box.lower[j] = low - std::numbers::pi;
    if (!std::isfinite(box.upper[j])) box.upper[j] = high + std::numbers::pi;
  }
  return box;
}

motion::JointPath without_duplicates(const motion::JointPath& path) {
  expects(path.size() >= 2, "a path has at least two waypoints");
  motion::JointPath kept{path.front()};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    if ((path[i] - kept.back()).norm() >= kSameWaypoint) kept.push_back(path[i]);
  }
  while (kept.size() > 1 && (path.back() - kept.back()).norm() < kSameWaypoint) kept.pop_back();
  kept.push_back(path.back());
  return kept;
}

}  // namespace tandem::planning
