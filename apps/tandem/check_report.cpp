#include "check_report.h"

#include <cmath>
#include <set>

#include "tandem/core/names.h"
#include "tandem/io/table.h"

namespace tandem::app {

using io::Table;
using world::Body;
using world::Workcell;

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

std::map<std::string, int> skipped_by_reason(const Workcell& cell) {
  std::map<std::string, int> reasons;
  for (const world::SkippedPair& pair : cell.skipped_pairs()) ++reasons[pair.reason];
  return reasons;
}

namespace {

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

std::string pieces_text(const Body& body) {
  std::string text;
  for (const auto& [kind, count] : piece_counts(body)) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  int triangles = 0, points = 0;
  for (const geometry::PlacedSurface& placed : body.surfaces_L) {
    (placed.surface->is_mesh() ? triangles : points) += placed.surface->piece_count();
  }
  if (triangles > 0) text += " (" + std::to_string(triangles) + " triangles)";
  if (points > 0) text += " (" + std::to_string(points) + " points)";
  return text.empty() ? "none" : text;
}

std::string or_dash(double value) { return std::isfinite(value) ? Table::number(value, 3) : "-"; }

std::string robots_text(const Workcell& cell) {
  Table table;
  table.row({"robot", "links", "joints", "x", "y", "z [m]", "urdf"});
  for (const world::RobotSpec& robot : cell.spec().robots) {
    const Eigen::Vector3d p = robot.X_WB.translation();
    table.row({robot.name, std::to_string(robot.model.links().size()),
               std::to_string(robot.model.position_count()), Table::number(p.x(), 3),
               Table::number(p.y(), 3), Table::number(p.z(), 3),
               robot.urdf.empty() ? "-" : robot.urdf.string()});
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
    table.row(
        {body.name, Table::number(body.padding * 1e3, 1), to_string(body.kind), pieces_text(body)});
  }
  std::string text = table.text();
  for (const std::string& sentence : advice(cell)) text += "note: " + sentence + "\n";
  return text;
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

std::string queries_text(const Workcell& cell, const std::vector<QueryCheck>& queries) {
  if (queries.empty()) return "queries: none\n";
  std::string text;
  for (const QueryCheck& query : queries) {
    text += "query " + query.name + (query.feasible() ? ": feasible\n" : ": NOT feasible\n");
    for (const std::string& problem : problems(cell, query)) text += "  " + problem + "\n";
  }
  return text;
}

/// Enough digits to tell a value from the limit that it exceeds.
std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

/// Which links of the SRDF's pairs the robot lacks: misspelt, or of another variant.
std::string ignored_pairs(const world::RobotSpec& robot) {
  std::vector<std::string> known;
  for (const robot::Link& link : robot.model.links()) known.push_back(link.name);
  std::set<std::string> unknown;
  for (const robot::DisabledPair& pair : robot.semantics.ignored_pairs) {
    for (const std::string& link : {pair.link_a, pair.link_b}) {
      if (robot.model.find_link(link) < 0) unknown.insert(link);
    }
  }
  constexpr int kMost = 5;
  std::string names;
  int count = 0;
  for (const std::string& name : unknown) {
    if (++count > kMost) break;
    const std::string nearest = nearest_name(name, known);
    names += (count > 1 ? ", '" : "'") + name + "'" +
             (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)");
  }
  return std::to_string(robot.semantics.ignored_pairs.size()) + " pairs of the SRDF of robot '" +
         robot.name + "' have no effect: it has no link " + names + (count > kMost ? ", ..." : "");
}

}  // namespace

std::map<std::string, int> piece_counts(const Body& body) {
  std::map<std::string, int> counts;
  for (const geometry::Shape& shape : body.shapes_L) ++counts[shape_name(shape)];
  for (const geometry::PlacedSurface& placed : body.surfaces_L) {
    ++counts[placed.surface->is_mesh() ? "triangle mesh" : "point cloud"];
  }
  return counts;
}

std::vector<std::string> advice(const Workcell& cell) {
  std::map<std::string, int> meshes;  // Links by robot.
  for (const Body& body : cell.bodies()) {
    if (body.kind != Body::Kind::kRobotLink || body.surfaces_L.empty()) continue;
    ++meshes[body.name.substr(0, body.name.find('/'))];
  }
  std::vector<std::string> sentences;
  for (const auto& [robot, links] : meshes) {
    sentences.push_back(std::to_string(links) + " links of robot '" + robot +
                        "' are checked as triangle meshes; `tandem fit` makes volumes that are "
                        "faster, and `meshes: convex` takes their hulls");
  }
  for (const world::RobotSpec& robot : cell.spec().robots) {
    if (robot.semantics.disabled_pairs.empty()) {
      sentences.push_back("robot '" + robot.name +
                          "' has no disabled pairs, so neighbouring links are checked against each "
                          "other; `tandem check --suggest-pairs` proposes some");
    }
    if (!robot.semantics.ignored_pairs.empty()) sentences.push_back(ignored_pairs(robot));
  }
  return sentences;
}

std::vector<std::string> problems(const Workcell& file_cell, const QueryCheck& query) {
  const Workcell& cell = query.cell_or(file_cell);
  std::vector<std::string> sentences;
  if (!query.reason.empty()) sentences.push_back(query.reason);
  for (const auto& [what, standing] :
       {std::pair("start: ", &query.start), std::pair("goal: ", &query.goal)}) {
    for (const pipeline::LimitExcess& excess : standing->outside) {
      const bool above = excess.value > excess.limit;
      sentences.push_back(
          what + ("joint '" + cell.joint_names()[static_cast<std::size_t>(excess.entry)]) +
          "' is at " + digits(excess.value) + ", " + digits(std::abs(excess.value - excess.limit)) +
          (above ? " above" : " below") + " its " + (above ? "upper" : "lower") + " limit " +
          digits(excess.limit));
    }
    for (const collision::PairClearance& touching : standing->touching) {
      sentences.push_back(what + collision::describe(cell, touching));
    }
  }
  return sentences;
}

std::string check_text(const Workcell& cell, const std::vector<QueryCheck>& queries, bool pairs) {
  return "workcell " + cell.name() + "\n\n" + robots_text(cell) + "\n" + arms_text(cell) + "\n" +
         bodies_text(cell) + "\n" + pairs_text(cell, pairs) + "\n" + queries_text(cell, queries);
}

std::string suggestions_text(const std::vector<RobotSuggestion>& robots, int samples,
                             std::uint64_t seed) {
  std::string text =
      "<!-- Proposed by tandem check, " + std::to_string(samples) + " samples, seed " +
      std::to_string(seed) +
      ". Review each line before it goes into the robot's SRDF.\n"
      "     Adjacent: neighbours in the tree. Default: touching at the zero position, which an arm "
      "may never take: look twice.\n"
      "     Always, Never: touching in every, in no sample; that is no proof. -->\n";
  for (const RobotSuggestion& suggestion : robots) {
    // A comment must not hold two dashes.
    std::string name = escaped(suggestion.robot->model.name());
    for (std::size_t at = 0; (at = name.find("--", at)) != std::string::npos;) name.erase(at, 1);
    text += "<!-- " + name + ": " + std::to_string(suggestion.pairs.size()) + " pairs -->\n";
    for (const collision::PairSuggestion& pair : suggestion.pairs) {
      text += "<disable_collisions link1=\"" + escaped(pair.link_a) + "\" link2=\"" +
              escaped(pair.link_b) + "\" reason=\"" + to_string(pair.reason) + "\"/>\n";
    }
  }
  return text;
}

}  // namespace tandem::app
