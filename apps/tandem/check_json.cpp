#include <cmath>
#include <nlohmann/json.hpp>

#include "check_report.h"

namespace tandem::app {

using Json = nlohmann::ordered_json;
using world::Body;
using world::Workcell;

namespace {

/// JSON has no infinity: a limit that does not exist is null by itself.
Json joint_json(const Workcell& cell, int j) {
  const robot::JointLimits& l = cell.limits()[static_cast<std::size_t>(j)];
  return {{"name", cell.joint_names()[static_cast<std::size_t>(j)]},
          {"lower", l.lower},
          {"upper", l.upper},
          {"velocity", l.velocity},
          {"acceleration", l.acceleration},
          {"jerk", l.jerk}};
}

Json arms_json(const Workcell& cell) {
  Json arms = Json::array();
  for (const world::Arm& arm : cell.arms()) {
    Json joints = Json::array();
    for (int j = arm.offset; j < arm.offset + arm.dof(); ++j) {
      joints.push_back(joint_json(cell, j));
    }
    arms.push_back({{"name", arm.name},
                    {"robot", cell.spec().robots[static_cast<std::size_t>(arm.robot)].name},
                    {"tip", cell.model().links()[static_cast<std::size_t>(arm.tip_link)].name},
                    {"joints", std::move(joints)}});
  }
  return arms;
}

Json robots_json(const Workcell& cell) {
  Json robots = Json::array();
  for (const world::RobotSpec& robot : cell.spec().robots) {
    const Eigen::Vector3d p = robot.X_WB.translation();
    const Eigen::Quaterniond u(robot.X_WB.linear());
    robots.push_back({{"name", robot.name},
                      {"model", robot.model.name()},
                      {"urdf", robot.urdf.string()},
                      {"srdf", robot.srdf.string()},
                      {"links", robot.model.links().size()},
                      {"joints", robot.model.position_count()},
                      {"position", {p.x(), p.y(), p.z()}},
                      {"orientation_wxyz", {u.w(), u.x(), u.y(), u.z()}}});
  }
  return robots;
}

Json bodies_json(const Workcell& cell) {
  Json bodies = Json::array();
  for (const Body& body : cell.bodies()) {
    int triangles = 0, points = 0;
    for (const geometry::PlacedSurface& placed : body.surfaces_L) {
      (placed.surface->is_mesh() ? triangles : points) += placed.surface->piece_count();
    }
    bodies.push_back({{"name", body.name},
                      {"kind", to_string(body.kind)},
                      {"shapes", body.shapes_L.size()},
                      {"pieces", piece_counts(body)},
                      {"triangles", triangles},
                      {"points", points},
                      {"padding_m", body.padding}});
  }
  return bodies;
}

Json pairs_json(const Workcell& cell, bool list) {
  Json reasons = Json::object();
  for (const auto& [reason, count] : skipped_by_reason(cell)) reasons[reason] = count;
  Json json = {{"checked", cell.pairs().size()},
               {"skipped", cell.skipped_pairs().size()},
               {"skipped_by_reason", std::move(reasons)}};
  if (!list) return json;
  json["list"] = Json::array();
  for (const world::BodyPair& pair : cell.pairs()) {
    json["list"].push_back({{"a", body_name(cell, pair.a)}, {"b", body_name(cell, pair.b)}});
  }
  for (const world::SkippedPair& pair : cell.skipped_pairs()) {
    json["list"].push_back(
        {{"a", body_name(cell, pair.a)}, {"b", body_name(cell, pair.b)}, {"skipped", pair.reason}});
  }
  return json;
}

Json standing_json(const Workcell& cell, const Eigen::VectorXd& q,
                   const pipeline::Standing& standing) {
  Json outside = Json::array(), touching = Json::array();
  for (const pipeline::LimitExcess& excess : standing.outside) {
    outside.push_back({{"joint", cell.joint_names()[static_cast<std::size_t>(excess.entry)]},
                       {"value", excess.value},
                       {"limit", excess.limit},
                       {"excess", std::abs(excess.value - excess.limit)}});
  }
  for (const collision::PairClearance& clearance : standing.touching) {
    const world::BodyPair& pair = cell.pairs()[static_cast<std::size_t>(clearance.pair)];
    touching.push_back({{"a", body_name(cell, pair.a)},
                        {"b", body_name(cell, pair.b)},
                        {"depth_m", -clearance.distance}});
  }
  return {{"q", std::vector<double>(q.begin(), q.end())},
          {"outside_limits", std::move(outside)},
          {"touching", std::move(touching)}};
}

Json queries_json(const Workcell& cell, const std::vector<QueryCheck>& queries) {
  Json list = Json::array();
  for (const QueryCheck& query : queries) {
    Json entry = {{"name", query.name}, {"feasible", query.feasible()}};
    if (query.ends) {
      const Workcell& own = query.cell_or(cell);
      entry["start"] = standing_json(own, query.ends->start, query.start);
      entry["goal"] = standing_json(own, query.ends->goal, query.goal);
    }
    if (!query.feasible()) entry["reasons"] = problems(cell, query);
    list.push_back(std::move(entry));
  }
  return list;
}

std::string printed(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string check_json(const Workcell& cell, const std::vector<QueryCheck>& queries, bool pairs) {
  return printed({{"workcell", cell.name()},
                  {"robots", robots_json(cell)},
                  {"arms", arms_json(cell)},
                  {"bodies", bodies_json(cell)},
                  {"notes", advice(cell)},
                  {"pairs", pairs_json(cell, pairs)},
                  {"queries", queries_json(cell, queries)}});
}

std::string suggestions_json(const std::vector<RobotSuggestion>& robots, int samples,
                             std::uint64_t seed) {
  Json list = Json::array();
  for (const RobotSuggestion& suggestion : robots) {
    Json pairs = Json::array();
    for (const collision::PairSuggestion& pair : suggestion.pairs) {
      pairs.push_back({{"link1", pair.link_a},
                       {"link2", pair.link_b},
                       {"reason", collision::to_string(pair.reason)}});
    }
    list.push_back({{"robot", suggestion.robot->name},
                    {"model", suggestion.robot->model.name()},
                    {"pairs", std::move(pairs)}});
  }
  return printed({{"samples", samples}, {"seed", seed}, {"robots", std::move(list)}});
}

}  // namespace tandem::app
