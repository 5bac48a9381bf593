// Private to the server, but what it reads comes from anyone who can reach its port.
#include "tandem/server/requests.h"

#include <cmath>

#include "support.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  constexpr int kDof = 4;
  const std::string body = fuzz::text_of(data, size);
  const auto plan_request = server::read_plan_request(body, kDof);
  if (const auto* plan = fuzz::accepted(plan_request)) {
    fuzz::require(plan->query.has_value() != plan->ends.has_value(), "a query or two ends");
    if (plan->ends) {
      fuzz::require(plan->ends->start.size() == kDof && plan->ends->goal.size() == kDof &&
                        plan->ends->start.allFinite() && plan->ends->goal.allFinite(),
                    "ends are finite and fit the cell");
    }
  }
  const auto ik_request = server::read_ik_request(body, kDof);
  if (const auto* ik = fuzz::accepted(ik_request)) {
    fuzz::require(ik->q.size() == kDof && ik->q.allFinite(), "q is finite and fits the cell");
    fuzz::require(ik->X_WE.matrix().allFinite() &&
                      (ik->X_WE.linear() * ik->X_WE.linear().transpose()).isIdentity(1e-9),
                  "poses are rigid");
  }
  return 0;
}
