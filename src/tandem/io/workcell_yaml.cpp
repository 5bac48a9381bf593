#include "tandem/io/workcell_yaml.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/names.h"
#include "tandem/io/moveit_scene.h"
#include "tandem/io/named_path.h"
#include "tandem/io/shapes_yaml.h"
#include "tandem/robot/joint_limits.h"
#include "tandem/robot/urdf.h"

namespace tandem::io {

namespace {

namespace fs = std::filesystem;
using world::WorkcellSpec;

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

std::string text_or_empty(const YamlNode& map, const char* key) {
  const YamlNode* node = map.find(key);
  return node ? node->text() : "";
}

/// Items of an optional list.
std::vector<const YamlNode*> items_of(const YamlNode& map, const char* key) {
  std::vector<const YamlNode*> items;
  const YamlNode* list = map.find(key);
  if (!list) return items;
  for (const YamlNode& item : list->items()) items.push_back(&item);
  return items;
}

/// Reads one workcell file.
class Reader {
 public:
  Reader(const fs::path& file, const std::vector<fs::path>& packages)
      : folder_(file.parent_path()), packages_(packages) {
    spec_.file = file;
  }

  WorkcellSpec read(const YamlNode& root);

 private:
  NamedPaths paths() const { return {folder_, robot::PackagePath::with_environment(packages_)}; }
  world::RobotSpec read_robot(const YamlNode& map) const;
  world::ArmSpec read_arm(const YamlNode& map) const;
  world::AttachedSpec read_attached(const YamlNode& map) const;
  Eigen::Isometry3d place_in_tool(const YamlNode& name, world::AttachedSpec& attached) const;
  world::ObstacleSpec read_obstacle(const YamlNode& map) const;
  void read_scene(const YamlNode& node);
  void read_padding(const YamlNode& node);

  fs::path folder_;
  std::vector<fs::path> packages_;
  WorkcellSpec spec_;
};

/// Limits that the workcell states for joints of a robot.
void read_limits(const YamlNode& map, robot::Model& model) {
  for (const auto& [name, values] : map.entries()) {
    const int index = model.find_joint(name);
    if (index < 0) {
      map.refuse_key(name,
                     "there is no joint '" + name + "'" + name_hint(name, names_of(model.joints())),
                     ErrorCode::kNotFound);
    }
    const robot::Joint& joint = model.joints()[static_cast<std::size_t>(index)];
    if (joint.type == robot::JointType::kFixed) {
      map.refuse_key(name, "joint '" + name + "' is fixed; remove its limits");
    }
    values->only({"lower", "upper", "velocity", "acceleration", "jerk"});
    robot::JointLimits limits = joint.limits;
    if (const YamlNode* lower = values->find("lower")) limits.lower = lower->number();
    if (const YamlNode* upper = values->find("upper")) limits.upper = upper->number();
    if (limits.lower > limits.upper) {
      values->refuse("joint '" + name + "': the lower limit " + std::to_string(limits.lower) +
                     " is above the upper limit " + std::to_string(limits.upper));
    }
    if (const YamlNode* v = values->find("velocity")) limits.velocity = v->positive();
    if (const YamlNode* a = values->find("acceleration")) limits.acceleration = a->positive();
    if (const YamlNode* j = values->find("jerk")) limits.jerk = j->positive();
    model.set_limits(index, limits);
  }
}

world::RobotSpec::Meshes read_meshes(const YamlNode& node) {
  const std::string kind = node.text();
  if (kind == "triangles") return world::RobotSpec::Meshes::kTriangles;
  if (kind == "convex") return world::RobotSpec::Meshes::kConvex;
  node.refuse("meshes is '" + kind + "'" + name_hint(kind, {"triangles", "convex"}));
}

world::RobotSpec Reader::read_robot(const YamlNode& map) const {
  map.only(
      {"name", "urdf", "srdf", "volumes", "meshes", "joint_limits", "limits", "base", "joints"});
  world::RobotSpec robot;
  robot.where = map.where();
  robot.name = map.at("name").text();
  const NamedPaths paths = this->paths();
  robot.urdf = paths.file(map.at("urdf"));
  robot.model = take(robot::load_urdf(robot.urdf, paths.packages()));
  if (const YamlNode* srdf = map.find("srdf")) {
    robot.srdf = paths.file(*srdf);
    robot.semantics = take(robot::load_srdf(robot.srdf, robot.model));
  }
  for (const YamlNode* overlay : items_of(map, "joint_limits")) {
    take(robot::overlay_joint_limits(paths.file(*overlay), robot.model));
  }
  if (const YamlNode* limits = map.find("limits")) read_limits(*limits, robot.model);
  if (const YamlNode* volumes = map.find("volumes")) {
    robot.volumes = take(load_volumes(paths.file(*volumes), robot.model));
  }
  if (const YamlNode* meshes = map.find("meshes")) robot.meshes = read_meshes(*meshes);
  if (const YamlNode* base = map.find("base")) robot.X_WB = read_pose(*base);
  if (const YamlNode* joints = map.find("joints")) {
    for (const auto& [name, value] : joints->entries()) {
      robot.fixed_positions[name] = value->number();
    }
  }
  return robot;
}

world::ArmSpec Reader::read_arm(const YamlNode& map) const {
  map.only({"name", "robot", "group", "base", "tip", "tool"});
  world::ArmSpec arm;
  arm.where = map.where();
  arm.name = map.at("name").text();
  arm.robot = map.at("robot").text();
  map.one_of({"group", "base"});
  arm.group = text_or_empty(map, "group");
  arm.base = text_or_empty(map, "base");
  arm.tip = arm.base.empty() ? text_or_empty(map, "tip") : map.at("tip").text();
  if (const YamlNode* tool = map.find("tool")) arm.X_LE = read_pose(*tool);
  return arm;
}

world::ObstacleSpec Reader::read_obstacle(const YamlNode& map) const {
  std::vector<std::string> keys = geometry_keys();
  keys.push_back("name");
  map.only(keys);
  const std::string name = map.at("name").text();
  Pieces pieces = read_geometry(map, paths());
  world::ObstacleSpec obstacle{name, std::move(pieces.shapes), map.where(),
                               std::move(pieces.surfaces)};
  if (const YamlNode* pose = map.find("pose")) obstacle.X_WO = read_pose(*pose);
  return obstacle;
}

world::AttachedSpec Reader::read_attached(const YamlNode& map) const {
  std::vector<std::string> keys = geometry_keys();
  keys.insert(keys.end(), {"name", "arm", "link", "touching"});
  map.only(keys);
  world::AttachedSpec attached;
  attached.where = map.where();
  attached.name = map.at("name").text();
  Pieces pieces = read_geometry(map, paths());
  if (const YamlNode* pose = map.find("pose")) attached.X_LO = read_pose(*pose);
  for (const YamlNode* name : items_of(map, "touching")) attached.touching.push_back(name->text());
  if (map.one_of({"arm", "link"}) == "link") {
    attached.link = map.at("link").text();
  } else {
    pieces.move(place_in_tool(map.at("arm"), attached));
  }
  attached.shapes_L = std::move(pieces.shapes);
  attached.surfaces_L = std::move(pieces.surfaces);
  return attached;
}

/// What an arm carries is given in its tool frame.   @return the tool frame in the link.
Eigen::Isometry3d Reader::place_in_tool(const YamlNode& name, world::AttachedSpec& attached) const {
  const auto arm = std::ranges::find(spec_.arms, name.text(), &world::ArmSpec::name);
  if (arm == spec_.arms.end()) {
    name.refuse(
        "there is no arm '" + name.text() + "'" + name_hint(name.text(), names_of(spec_.arms)),
        ErrorCode::kNotFound);
  }
  std::string tip = arm->tip;
  const auto robot = std::ranges::find(spec_.robots, arm->robot, &world::RobotSpec::name);
  const robot::Group* group =
      robot == spec_.robots.end() ? nullptr : robot->semantics.find_group(arm->group);
  if (tip.empty() && group && group->tip_link >= 0) {
    tip = robot->model.links()[static_cast<std::size_t>(group->tip_link)].name;
  }
  if (tip.empty()) name.refuse("arm '" + arm->name + "' has no tip; give it a 'tip' link");
  attached.link = arm->robot + "/" + tip;
  attached.X_LO = arm->X_LE * attached.X_LO;
  return arm->X_LE;
}

/// One of MoveIt's scenes, or a list of them.
void Reader::read_scene(const YamlNode& node) {
  if (node.kind() == YamlNode::Kind::kList) {
    for (const YamlNode& item : node.items()) read_scene(item);
    return;
  }
  MoveitScene scene = take(load_moveit_scene(paths().file(node)));
  std::ranges::move(scene.obstacles, std::back_inserter(spec_.obstacles));
}

world::AllowedPair read_allowed(const YamlNode& map) {
  map.only({"a", "b", "reason"});
  return {map.at("a").text(), map.at("b").text(), map.at("reason").text(), map.where()};
}

void Reader::read_padding(const YamlNode& node) {
  if (node.kind() != YamlNode::Kind::kMap) {
    spec_.padding = node.not_negative();
    return;
  }
  node.only({"default", "bodies"});
  if (const YamlNode* padding = node.find("default")) spec_.padding = padding->not_negative();
  if (const YamlNode* bodies = node.find("bodies")) {
    for (const auto& [name, padding] : bodies->entries()) {
      spec_.body_padding[name] = padding->not_negative();
    }
  }
}

world::ArmGoal read_goal(const YamlNode& map) {
  const std::vector<std::string> kinds{"joints", "state", "pose"};
  map.only(kinds);
  const std::string& kind = map.one_of(kinds);
  if (kind == "joints") return world::JointGoal{map.at(kind).numbers()};
  if (kind == "state") return world::StateGoal{map.at(kind).text()};
  return world::PoseGoal{read_pose(map.at(kind))};
}

/// Which arm or link takes what, and where.
world::Attach read_attach(const YamlNode& map) {
  map.only({"object", "arm", "link", "at", "touching"});
  world::Attach attach;
  attach.where = map.where();
  attach.object = map.at("object").text();
  map.one_of({"arm", "link"});
  attach.arm = text_or_empty(map, "arm");
  attach.link = text_or_empty(map, "link");
  if (const YamlNode* pose = map.find("at")) attach.pose = read_pose(*pose);
  for (const YamlNode* name : items_of(map, "touching")) attach.touching.push_back(name->text());
  return attach;
}

/// A name, or `object` and `place`.
world::Detach read_detach(const YamlNode& item) {
  if (item.kind() != YamlNode::Kind::kMap) return {item.text(), {}, item.where()};
  item.only({"object", "place"});
  world::Detach detach{item.at("object").text(), {}, item.where()};
  if (const YamlNode* place = item.find("place")) detach.X_WO = read_pose(*place);
  return detach;
}

world::SceneChanges read_changes(const YamlNode& map) {
  world::SceneChanges changes;
  for (const YamlNode* item : items_of(map, "detach")) {
    changes.detach.push_back(read_detach(*item));
  }
  for (const YamlNode* item : items_of(map, "attach")) {
    changes.attach.push_back(read_attach(*item));
  }
  for (const YamlNode* item : items_of(map, "allowed")) {
    changes.allowed.push_back(read_allowed(*item));
  }
  return changes;
}

world::QuerySpec read_query(const YamlNode& map) {
  map.only({"name", "start", "goal", "detach", "attach", "allowed"});
  world::QuerySpec query;
  query.where = map.where();
  query.name = map.at("name").text();
  if (const YamlNode* start = map.find("start")) {
    for (const auto& [arm, goal] : start->entries()) query.start.emplace(arm, read_goal(*goal));
  }
  for (const auto& [arm, goal] : map.at("goal").entries())
    query.goal.emplace(arm, read_goal(*goal));
  query.changes = read_changes(map);
  return query;
}

WorkcellSpec Reader::read(const YamlNode& root) {
  root.only({"name", "packages", "robots", "arms", "obstacles", "scene", "attached", "allowed",
             "padding", "queries", "lists"});
  spec_.name = root.at("name").text();
  for (const YamlNode* item : items_of(root, "packages"))
    packages_.push_back(paths().folder(*item));
  for (const YamlNode& item : root.at("robots").items()) spec_.robots.push_back(read_robot(item));
  for (const YamlNode& item : root.at("arms").items()) spec_.arms.push_back(read_arm(item));
  for (const YamlNode* item : items_of(root, "obstacles")) {
    spec_.obstacles.push_back(read_obstacle(*item));
  }
  if (const YamlNode* scene = root.find("scene")) read_scene(*scene);
  for (const YamlNode* item : items_of(root, "attached")) {
    spec_.attached.push_back(read_attached(*item));
  }
  for (const YamlNode* item : items_of(root, "allowed")) {
    spec_.allowed.push_back(read_allowed(*item));
  }
  if (const YamlNode* padding = root.find("padding")) read_padding(*padding);
  for (const YamlNode* item : items_of(root, "queries")) spec_.queries.push_back(read_query(*item));
  if (const YamlNode* lists = root.find("lists")) {
    for (const auto& [name, queries] : lists->entries()) {
      world::QueryListSpec& list = spec_.lists.emplace_back(name);
      list.where = queries->where();
      for (const YamlNode& item : queries->items()) list.queries.push_back(read_query(item));
    }
  }
  return std::move(spec_);
}

}  // namespace

Result<WorkcellSpec> load_workcell_spec(const fs::path& file,
                                        const std::vector<fs::path>& packages) {
  return read_yaml(file, [&](const YamlNode& root) { return Reader(file, packages).read(root); });
}

Result<std::shared_ptr<const world::Workcell>> load_workcell(
    const fs::path& file, const std::vector<fs::path>& packages) {
  Result<WorkcellSpec> spec = load_workcell_spec(file, packages);
  if (!spec) return std::unexpected(spec.error());
  return world::Workcell::make(std::move(*spec));
}

}  // namespace tandem::io
