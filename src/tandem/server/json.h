#pragma once
/// Pieces that several answers write the same way.

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/result.h"

namespace tandem::server {

using Json = nlohmann::ordered_json;

/// Names out of files may be no UTF-8; that is no reason to show nothing.
inline std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

inline Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

inline Json values_json(const Eigen::VectorXd& q) {
  return std::vector<double>(q.begin(), q.end());
}

inline Json clearance_json(const world::Workcell& cell, const collision::PairClearance& nearest) {
  return {{"pair", cell.describe_pair(nearest.pair)},
          {"distance", nearest.distance},
          {"a", vector_json(nearest.p_WCa)},
          {"b", vector_json(nearest.p_WCb)}};
}

inline Json error_json(const std::string& code, const std::string& message,
                       const Json& touching = Json::array()) {
  return {{"error", {{"code", code}, {"message", message}, {"touching", touching}}}};
}

}  // namespace tandem::server
