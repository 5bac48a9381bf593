#pragma once
/// What the page may ask, read strictly: a refusal names the key, the value and what was expected.

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "tandem/pipeline/plan.h"

namespace tandem::server {

/// Longest planning time that a request gets [s].
inline constexpr double kLongestDeadline = 30;

/// Exactly one of `query` and `ends` is given.
struct PlanRequest {
  std::optional<std::string> query;
  std::optional<pipeline::ResolvedQuery> ends;
  pipeline::PlanOptions options;
};

struct IkRequest {
  std::string arm;
  Eigen::VectorXd q;  ///< Where all arms are.
  Eigen::Isometry3d X_WE;
};

/// @param dof  of the cell.   @return kInvalidInput.
Result<PlanRequest> read_plan_request(const std::string& body, int dof);
Result<IkRequest> read_ik_request(const std::string& body, int dof);

}  // namespace tandem::server
