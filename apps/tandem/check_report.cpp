#include "check_report.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "tandem/io/table.h"

namespace tandem::app {

using io::Table;
using Json = nlohmann::ordered_json;
using world::Body;
using world::Workcell;

namespace {

const char* to_string(Body::Kind kind) {
  switch (kind) {
    case Body::Kind::kRobotLink:
      return "robot link";
    case Body::Kind::kObstacle:
      return "obstacle";
    case Body::Kind::kAttached:
      return "attached";
  }
  return "unknown";
}

const std::string& body_name(const Workcell& cell, int body) {
  return cell.bodies()[static_cast<std::size_t>(body)].name;
}

/// Skipped pairs by reason.
std::map<std::string, int> skipped_by_reason(const Workcell& cell) {
  std::map<std::string, int> reasons;
  for (const world::SkippedPair& pair : cell.skipped_pairs()) ++reasons[pair.reason];
  return reasons;
}

/// What people call a swept core of this type.
const char* shape_name(const geometry::Shape& shape) {
  switch (shape.type()) {
    case geometry::CoreType::kPoint:
      return "sphere";
    case geometry::CoreType::kSegment:
      return "capsule";
    case geometry::CoreType::kTriangle:
      return "rounded triangle";
    case geometry::CoreType::kRectangle:
      return "rounded rectangle";
    case geometry::CoreType::kBox:
      return "box";
    case geometry::CoreType::kCylinder:
      return "cylinder";
    case geometry::CoreType::kConvex:
      return "convex polytope";
  }
  return "unknown";
}

std::string shape_counts(const Body& body) {
  std::map<std::string, int> counts;
  for (const geometry::Shape& shape : body.shapes_L) ++counts[shape_name(shape)];
  std::string text;
  for (const auto& [type, count] : counts) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + type;
  }
  return text.empty() ? "none" : text;
}

std::string or_dash(double value) { return std::isfinite(value) ? Table::number(value, 3) : "-"; }

std::string robots_text(const Workcell& cell) {
  Table table;
  table.row({"robot", "links", "joints", "x", "y", "z [m]"});
  for (const world::RobotSpec& robot : cell.spec().robots) {
    const Eigen::Vector3d p = robot.X_WB.translation();
    table.row({robot.name, std::to_string(robot.model.links().size()),
               std::to_string(robot.model.position_count()), Table::number(p.x(), 3),
               Table::number(p.y(), 3), Table::number(p.z(), 3)});
  }
  return table.text();
}

std::string arms_text(const Workcell& cell) {
  Table table;
  table.row({"joint", "lower", "upper", "velocity", "acceleration", "jerk"});
  for (const world::Arm& arm : cell.arms()) {
    const auto& tip = cell.model().links()[static_cast<std::size_t>(arm.tip_link)].name;
    table.row({"arm " + arm.name + ", tool on " + tip});
    for (int j = arm.offset; j < arm.offset + arm.dof(); ++j) {
      const robot::JointLimits& l = cell.limits()[static_cast<std::size_t>(j)];
      table.row({"  " + cell.joint_names()[static_cast<std::size_t>(j)], or_dash(l.lower),
                 or_dash(l.upper), or_dash(l.velocity), or_dash(l.acceleration), or_dash(l.jerk)});
    }
  }
  return table.text();
}

std::string bodies_text(const Workcell& cell) {
  Table table;
  table.row({"body", "padding [mm]", "kind", "shapes"});
  for (const Body& body : cell.bodies()) {
    table.row({body.name, Table::number(body.padding * 1e3, 1), to_string(body.kind),
               shape_counts(body)});
  }
  return table.text();
}

std::string pairs_text(const Workcell& cell, bool list) {
  std::string text = "pairs: " + std::to_string(cell.pairs().size()) + " checked, " +
                     std::to_string(cell.skipped_pairs().size()) + " skipped\n";
  for (const auto& [reason, count] : skipped_by_reason(cell)) {
    text += "  " + std::to_string(count) + " skipped: " + reason + "\n";
  }
  if (!list) return text;
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    text += "checked: " + cell.describe_pair(static_cast<int>(i)) + "\n";
  }
  for (const world::SkippedPair& pair : cell.skipped_pairs()) {
    text += "skipped: " + body_name(cell, pair.a) + " and " + body_name(cell, pair.b) + " (" +
            pair.reason + ")\n";
  }
  return text;
}

std::string queries_text(const std::vector<QueryCheck>& queries) {
  if (queries.empty()) return "queries: none\n";
  std::string text;
  for (const QueryCheck& query : queries) {
    text += "query " + query.name + ": " +
            (query.feasible ? "feasible" : "NOT feasible: " + query.reason) + "\n";
  }
  return text;
}

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
                      {"position", {p.x(), p.y(), p.z()}},
                      {"orientation_wxyz", {u.w(), u.x(), u.y(), u.z()}}});
  }
  return robots;
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

}  // namespace

std::string check_text(const Workcell& cell, const std::vector<QueryCheck>& queries, bool pairs) {
  return "workcell " + cell.name() + "\n\n" + robots_text(cell) + "\n" + arms_text(cell) + "\n" +
         bodies_text(cell) + "\n" + pairs_text(cell, pairs) + "\n" + queries_text(queries);
}

std::string check_json(const Workcell& cell, const std::vector<QueryCheck>& queries, bool pairs) {
  Json bodies = Json::array();
  for (const Body& body : cell.bodies()) {
    bodies.push_back({{"name", body.name},
                      {"kind", to_string(body.kind)},
                      {"shapes", body.shapes_L.size()},
                      {"padding_m", body.padding}});
  }
  Json list = Json::array();
  for (const QueryCheck& query : queries) {
    list.push_back({{"name", query.name}, {"feasible", query.feasible}});
    if (!query.feasible) list.back()["reason"] = query.reason;
  }
  const Json json = {{"workcell", cell.name()},          {"robots", robots_json(cell)},
                     {"arms", arms_json(cell)},          {"bodies", std::move(bodies)},
                     {"pairs", pairs_json(cell, pairs)}, {"queries", std::move(list)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tandem::app
