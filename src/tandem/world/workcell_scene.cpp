#include <algorithm>

#include "tandem/core/contract.h"
#include "tandem/core/names.h"
#include "tandem/world/workcell_builder.h"

namespace tandem::world {

namespace {

/// Where the file has an object.
ObjectState home_of(const ObstacleSpec& obstacle) {
  return {kWorldLink, obstacle.X_WO, {}, obstacle.where};
}
ObjectState home_of(const AttachedSpec& attached) {
  return {attached.link, attached.X_LO, attached.touching, attached.where};
}

/// Where an object is in `scene`; kNotFound with the nearest name.
Result<ObjectState> object_in(const Workcell& cell, const SceneState& scene,
                              const std::string& name) {
  if (const auto changed = scene.objects.find(name); changed != scene.objects.end()) {
    return changed->second;
  }
  std::vector<std::string> known;
  for (const ObstacleSpec& obstacle : cell.spec().obstacles) {
    if (obstacle.name == name) return home_of(obstacle);
    known.push_back(obstacle.name);
  }
  for (const AttachedSpec& attached : cell.spec().attached) {
    if (attached.name == name) return home_of(attached);
    known.push_back(attached.name);
  }
  return fail(ErrorCode::kNotFound, "there is no object '" + name + "'" + name_hint(name, known) +
                                        " (objects are obstacles and attached objects)");
}

/// Whether an arm moves the link.
bool is_moved(const Workcell& cell, int link) {
  const std::vector<int>& above = cell.model().moving_ancestors(link);
  const auto moves = [&](const Arm& arm) {
    return std::ranges::find_first_of(above, arm.joints) != above.end();
  };
  return std::ranges::any_of(cell.arms(), moves) || std::ranges::any_of(cell.left_out(), moves);
}

Result<int> find_carrier(const Workcell& cell, const std::string& object, const std::string& link,
                         const std::string& where) {
  const int found = cell.model().find_link(link);
  if (found < 0) {
    std::vector<std::string> known;
    for (const robot::Link& l : cell.model().links()) known.push_back(l.name);
    return refuse(ErrorCode::kNotFound, where,
                  "'" + object + "' cannot be attached to link '" + link +
                      "', which does not exist" + name_hint(link, known) +
                      " (links are written ROBOT/LINK)");
  }
  if (!is_moved(cell, found)) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "'" + object + "' cannot be attached to link '" + link +
                      "', which no arm moves; name a link of an arm");
  }
  return found;
}

bool is_same(const ObjectState& a, const ObjectState& b) {
  return a.link == b.link && a.X_LO.matrix() == b.X_LO.matrix() && a.touching == b.touching;
}

Result<void> detach(const Workcell& cell, const Detach& change, const robot::LinkPoses& X_WL,
                    SceneState& scene) {
  const auto object = object_in(cell, scene, change.object);
  if (!object) return refuse(object.error().code, change.where, object.error().message);
  if (!object->carried()) {
    return refuse(ErrorCode::kInvalidInput, change.where,
                  "'" + change.object + "' cannot be detached: nothing carries it");
  }
  const auto link = static_cast<std::size_t>(cell.model().find_link(object->link));
  scene.objects[change.object] = {
      kWorldLink, change.X_WO.value_or(X_WL[link] * object->X_LO), {}, change.where};
  return {};
}

/// The link that takes the object and, where it is given, the object's pose in it.
struct Grip {
  int link;
  std::optional<Eigen::Isometry3d> X_LO;
};

Result<Grip> find_grip(const Workcell& cell, const Attach& change) {
  if (change.arm.empty() == change.link.empty()) {
    return refuse(ErrorCode::kInvalidInput, change.where,
                  "'" + change.object + "' is attached to an arm or to a link: name one of them");
  }
  if (change.arm.empty()) {
    const auto link = find_carrier(cell, change.object, change.link, change.where);
    if (!link) return std::unexpected(link.error());
    return Grip{*link, change.pose};
  }
  const int arm = cell.find_arm(change.arm);
  if (arm < 0) {
    std::vector<std::string> known;
    for (const Arm& a : cell.arms()) known.push_back(a.name);
    return refuse(ErrorCode::kNotFound, change.where,
                  "'" + change.object + "' cannot be attached to arm '" + change.arm +
                      "', which does not exist" + name_hint(change.arm, known));
  }
  const Arm& a = cell.arms()[static_cast<std::size_t>(arm)];
  Grip grip{a.tip_link, {}};
  if (change.pose) grip.X_LO = a.X_LE * *change.pose;
  return grip;
}

Result<void> attach(const Workcell& cell, const Attach& change, const robot::LinkPoses& X_WL,
                    SceneState& scene) {
  const auto object = object_in(cell, scene, change.object);
  if (!object) return refuse(object.error().code, change.where, object.error().message);
  if (object->carried()) {
    return refuse(ErrorCode::kInvalidInput, change.where,
                  "'" + change.object + "' cannot be attached: link '" + object->link +
                      "' carries it; detach it first");
  }
  const auto grip = find_grip(cell, change);
  if (!grip) return std::unexpected(grip.error());
  const auto link = static_cast<std::size_t>(grip->link);
  scene.objects[change.object] = {cell.model().links()[link].name,
                                  grip->X_LO.value_or(X_WL[link].inverse() * object->X_LO),
                                  change.touching, change.where};
  return {};
}

}  // namespace

Result<ObjectState> Workcell::find_object(const std::string& name) const {
  return object_in(*this, scene_, name);
}

Result<SceneState> Workcell::scene_after(const SceneChanges& changes,
                                         const Eigen::Ref<const Eigen::VectorXd>& q) const {
  expects(left_out_.empty(), "objects change hands in the whole cell, where all arms are known");
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  forward_kinematics(q, positions, X_WL);
  SceneState next{scene_.objects, changes.allowed};
  Result<void> done;
  for (const Detach& change : changes.detach) {
    if (done) done = detach(*this, change, X_WL, next);
  }
  for (const Attach& change : changes.attach) {
    if (done) done = attach(*this, change, X_WL, next);
  }
  if (!done) return std::unexpected(done.error());
  return next;
}

Result<std::shared_ptr<const Workcell>> Workcell::in_scene(SceneState scene) const {
  return WorkcellBuilder(*this).build_in(std::move(scene));
}

Result<std::shared_ptr<const Workcell>> after_changes(const std::shared_ptr<const Workcell>& cell,
                                                      const SceneChanges& changes,
                                                      const Eigen::Ref<const Eigen::VectorXd>& q) {
  expects(cell != nullptr, "changes need a workcell");
  if (changes.empty() && cell->scene().allowed.empty()) return cell;
  auto scene = cell->scene_after(changes, q);
  if (!scene) return std::unexpected(scene.error());
  return cell->in_scene(std::move(*scene));
}

WorkcellBuilder::WorkcellBuilder(const Workcell& cell) : cell_(new Workcell(cell)) {
  own_joints();
  for (std::size_t i = 0; i < cell.bodies_.size(); ++i) {
    body_index_.emplace(cell.bodies_[i].name, static_cast<int>(i));
  }
}

Result<std::shared_ptr<const Workcell>> WorkcellBuilder::build_in(SceneState scene) {
  const SceneState before = std::exchange(cell_->scene_, std::move(scene));
  Result<void> done = check_scene();
  Marked changed(cell_->bodies_.size(), false);
  if (done) place_objects(before, changed);
  if (done) done = skip_pairs();
  if (!done) return std::unexpected(done.error());
  for (const auto* allowed : {&before.allowed, &std::as_const(cell_->scene_.allowed)}) {
    for (const AllowedPair& pair : *allowed) {
      for (const std::string& name : {pair.a, pair.b}) {
        changed[static_cast<std::size_t>(body_index_.at(name))] = true;
      }
    }
  }
  make_pairs(changed);
  return cell_;
}

Result<void> WorkcellBuilder::check_scene() const {
  for (const auto& [name, object] : cell_->scene_.objects) {
    if (const auto known = object_in(*cell_, {}, name); !known) {
      return refuse(known.error().code, object.where, known.error().message);
    }
    if (!is_rigid(object.X_LO)) {
      return refuse(ErrorCode::kInvalidInput, object.where,
                    "the pose of '" + name + "' is not a rigid pose within 1e8 m");
    }
    if (!object.carried()) continue;
    const auto link = find_carrier(*cell_, name, object.link, object.where);
    if (!link) return std::unexpected(link.error());
  }
  return {};
}

/// Places what is not where it was before, and marks it.
void WorkcellBuilder::place_objects(const SceneState& before, Marked& changed) {
  const auto place = [&](const std::string& name) {
    if (!place_object(name)) return;
    changed[static_cast<std::size_t>(body_index_.at(name))] = true;
  };
  const SceneState& scene = cell_->scene_;
  for (const auto& [name, object] : scene.objects) {
    const auto was = before.objects.find(name);
    if (was == before.objects.end() || !is_same(was->second, object)) place(name);
  }
  for (const auto& [name, object] : before.objects) {
    if (!scene.objects.contains(name)) place(name);
  }
}

/// @return false if there is no such object.
bool WorkcellBuilder::place_object(const std::string& name) {
  const auto& obstacles = cell_->spec_.obstacles;
  const auto& attached = cell_->spec_.attached;
  if (const auto o = std::ranges::find(obstacles, name, &ObstacleSpec::name);
      o != obstacles.end()) {
    place_object(name, home_of(*o), o->shapes_W, o->surfaces_W);
    return true;
  }
  const auto a = std::ranges::find(attached, name, &AttachedSpec::name);
  if (a == attached.end()) return false;
  place_object(name, home_of(*a), a->shapes_L, a->surfaces_L);
  return true;
}

/// Gives a body its link and the geometry that the file has at `home`.
void WorkcellBuilder::place_object(const std::string& name, const ObjectState& home,
                                   const std::vector<geometry::Shape>& shapes,
                                   const std::vector<geometry::PlacedSurface>& surfaces) {
  const auto changed = cell_->scene_.objects.find(name);
  const bool at_home = changed == cell_->scene_.objects.end();
  const ObjectState& object = at_home ? home : changed->second;
  Body& body = cell_->bodies_[static_cast<std::size_t>(body_index_.at(name))];
  body.link = cell_->model_.find_link(object.link);
  body.moved_by = arms_between(body.link, 0);
  body.kind = object.carried() ? Body::Kind::kAttached : Body::Kind::kObstacle;
  body.padding = padding_of(name, object.carried() ? cell_->spec_.padding : 0.0);
  body.shapes_L = shapes;
  body.surfaces_L = surfaces;
  if (at_home) return;
  const Eigen::Isometry3d X_LH = object.X_LO * home.X_LO.inverse();
  for (geometry::Shape& shape : body.shapes_L) shape = shape.in(X_LH);
  for (geometry::PlacedSurface& surface : body.surfaces_L) surface.X_FS = X_LH * surface.X_FS;
}

}  // namespace tandem::world
