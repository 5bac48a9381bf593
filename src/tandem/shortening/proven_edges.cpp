#include "tandem/shortening/proven_edges.h"

#include <algorithm>

namespace tandem::shortening {

using motion::JointPath;

std::vector<int> unproven_edges(const collision::BatchChecker& checker,
                                const collision::BatchPairs& pairs, const JointPath& path,
                                collision::BatchChecker::Scratch& scratch,
                                const StopCondition& stop) {
  std::vector<int> open;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (stop() || !checker.is_edge_free(path[i - 1], path[i], pairs, scratch, stop)) {
      open.push_back(static_cast<int>(i) - 1);
    }
  }
  return open;
}

int draw_back(const collision::BatchChecker& checker, const collision::BatchPairs& pairs,
              const JointPath& safe, JointPath& path, collision::BatchChecker::Scratch& scratch,
              const StopCondition& stop) {
  constexpr double kStep = 0.25;  // Of the way to the safe path.
  const JointPath wanted = path;
  std::vector<double> back(path.size(), 0.0);
  while (true) {
    const std::vector<int> open = unproven_edges(checker, pairs, path, scratch, stop);
    bool moved = false;
    for (const int edge : open) {
      for (const std::size_t i :
           {static_cast<std::size_t>(edge), static_cast<std::size_t>(edge) + 1}) {
        if (i == 0 || i + 1 == path.size() || back[i] >= 1) continue;
        back[i] = std::min(1.0, back[i] + kStep);
        path[i] = back[i] == 1 ? safe[i] : (wanted[i] + back[i] * (safe[i] - wanted[i])).eval();
        moved = true;
      }
    }
    if (open.empty()) break;
    if (!moved || stop()) {
      path = safe;
      return static_cast<int>(path.size()) - 2;
    }
  }
  return static_cast<int>(std::ranges::count_if(back, [](double part) { return part > 0; }));
}

}  // namespace tandem::shortening
