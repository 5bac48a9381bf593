#include "tandem/server/scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "tandem/core/contract.h"
#include "tandem/server/base64.h"
#include "tandem/server/json.h"

namespace tandem::server {

namespace {

Json pose_json(const Eigen::Isometry3d& X_FG) {
  const Eigen::Quaterniond u(X_FG.linear());
  return {{"xyz", vector_json(X_FG.translation())}, {"quat_wxyz", {u.w(), u.x(), u.y(), u.z()}}};
}

/// JSON has no infinity: null stands for "none".
Json limit_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json shape_json(const geometry::Shape& shape) {
  Json extents = Json::array();
  for (int i = 0; i < 3; ++i) extents.push_back(vector_json(shape.extents().col(i)));
  Json json{{"core", geometry::to_string(shape.type())},
            {"origin", vector_json(shape.origin())},
            {"extents", extents},
            {"core_radius", shape.core_radius()},
            {"radius", shape.radius()}};
  if (shape.type() == geometry::CoreType::kConvex) {
    // In the frame of origin and extents, as the faces are.
    json["vertices"] = Json::array();
    for (const Eigen::Vector3d& v : shape.hull().vertices)
      json["vertices"].push_back(vector_json(v));
    json["faces"] = shape.hull().triangles;
  }
  return json;
}

/// Numbers as the bytes of a little-endian typed array, in base64: 100,000 points as JSON lists
/// would take a page seconds to read.
template <class Number>
std::string array_text(const std::vector<Number>& values) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(values.size() * sizeof(Number), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

Json surface_json(const geometry::PlacedSurface& placed) {
  const geometry::Surface& surface = *placed.surface;
  std::vector<float> vertices;
  vertices.reserve(3 * surface.vertices().size());
  for (const Eigen::Vector3d& vertex : surface.vertices()) {
    for (const double value : vertex) vertices.push_back(static_cast<float>(value));
  }
  std::vector<std::uint32_t> triangles;
  triangles.reserve(3 * surface.triangles().size());
  for (const auto& triangle : surface.triangles()) {
    for (const int index : triangle) triangles.push_back(static_cast<std::uint32_t>(index));
  }
  Json json = {{"pose", pose_json(placed.X_FS)},
               {"radius", surface.radius()},
               {"vertices", array_text(vertices)}};
  if (surface.is_mesh()) json["triangles"] = array_text(triangles);
  return json;
}

const char* to_string(world::Body::Kind kind) {
  switch (kind) {
    case world::Body::Kind::kRobotLink:
      return "robot";
    case world::Body::Kind::kObstacle:
      return "obstacle";
    case world::Body::Kind::kAttached:
      return "attached";
  }
  return "unknown";
}

/// The value of a joint is multiplier * q[entry] + offset, or the offset where entry is -1.
struct JointDrive {
  int entry = -1;
  double multiplier = 1;
  double offset = 0;
};

JointDrive drive_of(const world::Workcell& cell, const robot::Joint& joint,
                    const Eigen::VectorXd& resting, const std::map<int, int>& entries) {
  if (joint.type == robot::JointType::kFixed) return {};
  JointDrive drive;
  int position = joint.position_index;
  if (joint.mimic) {
    position = cell.model().joints()[static_cast<std::size_t>(joint.mimic->joint)].position_index;
    drive.multiplier = joint.mimic->multiplier;
    drive.offset = joint.mimic->offset;
  }
  if (const auto entry = entries.find(position); entry != entries.end()) {
    drive.entry = entry->second;
  } else {
    drive.offset += drive.multiplier * resting[position];
  }
  return drive;
}

Json links_json(const world::Workcell& cell) {
  std::map<int, int> entries;  // Position entry to entry of q.
  for (const world::Arm& arm : cell.arms()) {
    for (int j = 0; j < arm.dof(); ++j) {
      entries[arm.columns[static_cast<std::size_t>(j)]] = arm.offset + j;
    }
  }
  Eigen::VectorXd resting;
  cell.positions(Eigen::VectorXd::Zero(cell.dof()), resting);
  Json links = Json::array();
  for (const robot::Link& link : cell.model().links()) {
    Json entry = {{"name", link.name}};
    if (link.parent_joint >= 0) {
      const robot::Joint& joint =
          cell.model().joints()[static_cast<std::size_t>(link.parent_joint)];
      const JointDrive drive = drive_of(cell, joint, resting, entries);
      entry["parent"] = joint.parent_link;
      entry["joint"] = {{"name", joint.name},
                        {"type", robot::to_string(joint.type)},
                        {"pose", pose_json(joint.X_PJ)},
                        {"axis", vector_json(joint.axis_J)},
                        {"entry", drive.entry},
                        {"multiplier", drive.multiplier},
                        {"offset", drive.offset}};
    }
    links.push_back(entry);
  }
  return links;
}

/// Visual geometry by link; meshes by index, each file once.
Json visuals_json(const world::Workcell& cell, std::vector<std::filesystem::path>& meshes) {
  std::map<std::string, std::size_t> index;
  Json visuals = Json::array();
  for (std::size_t i = 0; i < cell.model().links().size(); ++i) {
    for (const robot::Geometry& geometry : cell.model().links()[i].visual) {
      Json visual = {{"link", i}, {"pose", pose_json(geometry.X_LG)}};
      if (const auto* box = std::get_if<robot::BoxGeometry>(&geometry.shape)) {
        visual["box"] = vector_json(box->size);
      } else if (const auto* sphere = std::get_if<robot::SphereGeometry>(&geometry.shape)) {
        visual["sphere"] = sphere->radius;
      } else if (const auto* cylinder = std::get_if<robot::CylinderGeometry>(&geometry.shape)) {
        visual["cylinder"] = {{"radius", cylinder->radius}, {"length", cylinder->length}};
      } else if (const auto* mesh = std::get_if<robot::MeshGeometry>(&geometry.shape)) {
        if (mesh->path.empty()) continue;  // Its package was not found: the volumes show the link.
        const auto [entry, is_new] = index.try_emplace(mesh->path, meshes.size());
        if (is_new) meshes.emplace_back(mesh->path);
        visual["mesh"] = {{"index", entry->second},
                          {"type", std::filesystem::path(mesh->path).extension().string()},
                          {"scale", vector_json(mesh->scale)}};
      }
      visuals.push_back(visual);
    }
  }
  return visuals;
}

Json body_json(const world::Body& body) {
  Json shapes = Json::array();
  for (const geometry::Shape& shape : body.shapes_L) shapes.push_back(shape_json(shape));
  Json surfaces = Json::array();
  for (const auto& surface : body.surfaces_L) surfaces.push_back(surface_json(surface));
  return {{"name", body.name}, {"kind", to_string(body.kind)},
          {"link", body.link}, {"padding", body.padding},
          {"shapes", shapes},  {"surfaces", surfaces}};
}

Json bodies_json(const world::Workcell& cell) {
  Json bodies = Json::array();
  for (const world::Body& body : cell.bodies()) bodies.push_back(body_json(body));
  return bodies;
}

/// Queries by the names that planning knows them by.
Json queries_json(const world::Workcell& cell) {
  Json names = Json::array();
  for (const world::Query& query : cell.queries()) names.push_back(query.name);
  for (const world::QueryList& list : cell.lists()) {
    for (const world::Query& query : list.queries) names.push_back(query.name);
  }
  return names;
}

Json arms_json(const world::Workcell& cell) {
  Json arms = Json::array();
  for (const world::Arm& arm : cell.arms()) {
    arms.push_back({{"name", arm.name},
                    {"first", arm.offset},
                    {"dof", arm.dof()},
                    {"tip_link", arm.tip_link},
                    {"tool", pose_json(arm.X_LE)}});
  }
  return arms;
}

Json joints_json(const world::Workcell& cell) {
  Json joints = Json::array();
  for (std::size_t j = 0; j < cell.joint_names().size(); ++j) {
    const robot::JointLimits& limits = cell.limits()[j];
    joints.push_back({{"name", cell.joint_names()[j]},
                      {"lower", limit_json(limits.lower)},
                      {"upper", limit_json(limits.upper)},
                      {"velocity", limit_json(limits.velocity)},
                      {"acceleration", limit_json(limits.acceleration)},
                      {"jerk", limit_json(limits.jerk)}});
  }
  return joints;
}

/// Where an arm first is or goes in the queries, as far as that needs no inverse kinematics; 0,
/// moved into the limits, if nothing says.
Eigen::VectorXd home_of(const world::Workcell& cell, int arm) {
  const auto i = static_cast<std::size_t>(arm);
  for (const world::Query& query : cell.queries()) {
    for (const auto& goal : {query.start[i], query.goal[i]}) {
      if (!goal) continue;
      if (const auto* joints = std::get_if<world::JointGoal>(&*goal)) return joints->q;
      const auto* state = std::get_if<world::StateGoal>(&*goal);
      if (!state) continue;
      if (const auto values = cell.named_state(arm, state->name)) return *values;
    }
  }
  const world::Arm& a = cell.arms()[i];
  const auto part = [&](const Eigen::VectorXd& q) { return q.segment(a.offset, a.dof()).array(); };
  return Eigen::ArrayXd::Zero(a.dof()).max(part(cell.lower())).min(part(cell.upper()));
}

Json home_json(const world::Workcell& cell) {
  Eigen::VectorXd q(cell.dof());
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    const world::Arm& arm = cell.arms()[i];
    q.segment(arm.offset, arm.dof()) = home_of(cell, static_cast<int>(i));
  }
  return values_json(q);
}

}  // namespace

Scene describe_scene(const world::Workcell& cell) {
  Scene scene;
  const Json json = {{"name", cell.name()},           {"links", links_json(cell)},
                     {"bodies", bodies_json(cell)},   {"visuals", visuals_json(cell, scene.meshes)},
                     {"arms", arms_json(cell)},       {"joints", joints_json(cell)},
                     {"queries", queries_json(cell)}, {"home", home_json(cell)}};
  scene.json = text_of(json);
  return scene;
}

std::string describe_moved(const world::Workcell& shown, const world::Workcell& cell) {
  const auto& here = shown.scene().objects;
  const auto& there = cell.scene().objects;
  Json bodies = Json::array();
  for (const world::Body& body : cell.bodies()) {
    if (here.contains(body.name) || there.contains(body.name)) bodies.push_back(body_json(body));
  }
  return text_of(bodies);
}

std::string describe_clearance(const collision::CompiledCell& compiled,
                               const motion::Motion& motion, double rate) {
  expects(rate > 0, "the rate of clearance samples must be positive");
  constexpr double kMostSteps = 2000;
  const world::Workcell& cell = compiled.cell();
  const collision::SsvChecker& checker = compiled.exact();
  const auto scratch = checker.make_scratch();
  const world::PairSelection& all = compiled.selection(world::PairScope::all());
  Json samples = Json::array();
  Eigen::VectorXd q(cell.dof());
  const double steps = std::ceil(std::min(motion.duration() * rate, kMostSteps));
  const double step = std::max(1 / rate, motion.duration() / kMostSteps);
  for (double i = 0; i <= steps; ++i) {
    const double t = std::min(i * step, motion.duration());
    motion.position(t, q);
    const collision::PairClearance nearest = checker.least_clearance(q, all, *scratch);
    if (nearest.pair < 0) break;
    Json sample = {{"t", t}};
    sample.update(clearance_json(cell, nearest));
    samples.push_back(std::move(sample));
  }
  return text_of(samples);
}

}  // namespace tandem::server
