#include "tandem/coordination/sequential.h"

#include <algorithm>
#include <numeric>

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

namespace {

class SequentialCoordinator final : public Coordinator {
 public:
  Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t /*seed*/,
                              const StopCondition& stop) const override {
    const auto scratch = problem.exact().make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) {
      return std::unexpected(ends.error());
    }
    const world::Workcell& cell = problem.cell();
    const world::PairSelection pairs = pairs_between_arms(cell);
    const VectorXd T = durations(problem);
    std::vector<Index> order(problem.arms.size());
    std::iota(order.begin(), order.end(), 0);
    std::string blocked;  // By which pair the first order is.
    do {
      std::vector<VectorXd> places{VectorXd::Zero(T.size())};
      for (std::size_t k = 0; k < order.size(); ++k) {
        VectorXd next = places.back();
        next[order[k]] = T[order[k]];
        const auto proof = certify_edge(problem, places.back(), next, pairs, *scratch, stop);
        if (proof.stopped) return std::unexpected(stop.error("coordinating one after the other"));
        if (!proof.is_free()) {
          if (blocked.empty()) {
            const VectorXd place = places.back() + proof.time * (next - places.back());
            blocked = describe_blocking(cell, proof.pair, place);
          }
          // No other order of those after the k-th can help.
          std::sort(order.begin() + static_cast<Index>(k) + 1, order.end(), std::greater<>());
          break;
        }
        places.push_back(std::move(next));
      }
      if (places.size() == order.size() + 1) return make_schedule(places);
    } while (std::ranges::next_permutation(order).found);
    return fail(ErrorCode::kCoordination,
                "the arms cannot move one after the other, in no order; in the first, blocked by " +
                    blocked);
  }
};

}  // namespace

std::unique_ptr<Coordinator> make_sequential_coordinator() {
  return std::make_unique<SequentialCoordinator>();
}

}  // namespace tandem::coordination
