#include <algorithm>
#include <cmath>

#include "tandem/core/names.h"
#include "tandem/world/workcell_builder.h"

namespace tandem::world {

namespace {

std::pair<int, int> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

Result<void> WorkcellBuilder::add_robot_bodies(const RobotSpec& robot) {
  std::vector<std::string> names;
  for (const robot::Link& link : robot.model.links()) names.push_back(link.name);
  for (const auto& [name, shapes] : robot.volumes) {
    if (robot.model.find_link(name) >= 0) continue;
    return refuse(ErrorCode::kNotFound, robot.where,
                  "robot '" + robot.name + "' has volumes for link '" + name +
                      "', which does not exist" + name_hint(name, names));
  }
  for (const robot::Link& link : robot.model.links()) {
    const auto volumes = robot.volumes.find(link.name);
    const std::string who = "link '" + link.name + "' of robot '" + robot.name + "': ";
    Result<LinkGeometry> geometry_L = volumes == robot.volumes.end()
                                          ? link_geometry_.of_urdf(link, robot.meshes)
                                          : LinkGeometry{volumes->second, {}};
    if (!geometry_L) {
      return refuse(geometry_L.error().code, robot.where, who + geometry_L.error().message);
    }
    if (geometry_L->empty() && !link.collision.empty()) {
      return refuse(ErrorCode::kInvalidInput, robot.where,
                    who +
                        "it has collision geometry but its list of volumes is empty; give it "
                        "volumes, or remove the entry if its geometry needs none");
    }
    if (geometry_L->empty()) continue;
    const std::string name = robot.name + "/" + link.name;
    Body body{
        name, cell_->model_.find_link(name), std::move(geometry_L->shapes),  cell_->spec_.padding,
        0,    Body::Kind::kRobotLink,        std::move(geometry_L->surfaces)};
    if (auto done = add_body(std::move(body), robot.where); !done) return done;
  }
  return {};
}

Result<void> WorkcellBuilder::add_obstacles() {
  for (const ObstacleSpec& obstacle : cell_->spec_.obstacles) {
    Body body{obstacle.name,      0, obstacle.shapes_W, 0.0, 0, Body::Kind::kObstacle,
              obstacle.surfaces_W};
    if (auto done = add_body(std::move(body), obstacle.where); !done) return done;
  }
  return {};
}

Result<void> WorkcellBuilder::add_attached() {
  std::vector<std::string> links;
  for (const robot::Link& link : cell_->model_.links()) links.push_back(link.name);
  for (const AttachedSpec& attached : cell_->spec_.attached) {
    const int link = cell_->model_.find_link(attached.link);
    if (link < 0) {
      return refuse(ErrorCode::kNotFound, attached.where,
                    "attached '" + attached.name + "': there is no link '" + attached.link + "'" +
                        name_hint(attached.link, links) + " (links are written ROBOT/LINK)");
    }
    Body body{attached.name,        link, attached.shapes_L,
              cell_->spec_.padding, 0,    Body::Kind::kAttached,
              attached.surfaces_L};
    if (auto done = add_body(std::move(body), attached.where); !done) return done;
  }
  return {};
}

Result<void> WorkcellBuilder::add_body(Body body, const std::string& where) {
  if (body.name.empty()) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "an obstacle or attached object has no name; give it one");
  }
  if (body.shapes_L.empty() && body.surfaces_L.empty()) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "'" + body.name + "' has no shapes and no surfaces; give it one, or remove it");
  }
  for (const geometry::PlacedSurface& placed : body.surfaces_L) {
    if (placed.surface && is_rigid(placed.X_FS)) continue;
    return refuse(ErrorCode::kInvalidInput, where,
                  "'" + body.name + "' has a mesh or cloud without a rigid pose");
  }
  if (!body_index_.emplace(body.name, static_cast<int>(cell_->bodies_.size())).second) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "two bodies are called '" + body.name + "'; rename one");
  }
  body.padding = padding_of(body.name, body.padding);
  if (!(body.padding >= 0) || !std::isfinite(body.padding)) {
    return refuse(ErrorCode::kInvalidInput, cell_->spec_.file.string(),
                  "the padding of '" + body.name + "' is " + std::to_string(body.padding) +
                      "; it must be at least 0");
  }
  body.moved_by = arms_between(body.link, 0);
  cell_->bodies_.push_back(std::move(body));
  return {};
}

double WorkcellBuilder::padding_of(const std::string& body, double otherwise) const {
  const auto own = cell_->spec_.body_padding.find(body);
  return own == cell_->spec_.body_padding.end() ? otherwise : own->second;
}

Result<void> WorkcellBuilder::check_body_padding() const {
  for (const auto& [name, padding] : cell_->spec_.body_padding) {
    const Result<int> body = body_named(name, cell_->spec_.file.string());
    if (!body) return fail(body.error().code, body.error().message + " (in padding)");
  }
  return {};
}

Result<int> WorkcellBuilder::body_named(const std::string& name, const std::string& where) const {
  if (const auto found = body_index_.find(name); found != body_index_.end()) return found->second;
  if (cell_->model_.find_link(name) >= 0) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "link '" + name + "' has no shapes and touches nothing; remove it");
  }
  std::vector<std::string> known;
  for (const Body& body : cell_->bodies_) known.push_back(body.name);
  return refuse(ErrorCode::kNotFound, where,
                "there is no body '" + name + "'" + name_hint(name, known) +
                    " (robot links are written ROBOT/LINK)");
}

Result<void> WorkcellBuilder::skip_pairs() {
  const WorkcellSpec& spec = cell_->spec_;
  Result<void> done;
  for (const RobotSpec& robot : spec.robots) {
    if (done) done = skip_disabled(robot);
  }
  const auto touch = [&](const std::string& name, const auto& object) {
    for (const std::string& other : object.touching) {
      if (done) done = skip_allowed(name, other, "attached, may touch", object.where);
    }
  };
  for (const AttachedSpec& attached : spec.attached) {
    if (!cell_->scene_.objects.contains(attached.name)) touch(attached.name, attached);
  }
  for (const auto& [name, object] : cell_->scene_.objects) touch(name, object);
  for (const auto* allowed : {&spec.allowed, &std::as_const(cell_->scene_.allowed)}) {
    for (const AllowedPair& pair : *allowed) {
      if (done) done = skip_allowed(pair.a, pair.b, "allowed: " + pair.reason, pair.where);
    }
  }
  return done;
}

/// Links without shapes are no bodies, and an SRDF may well name them.
Result<void> WorkcellBuilder::skip_disabled(const RobotSpec& robot) {
  std::vector<std::string> names;
  for (const robot::Link& link : robot.model.links()) names.push_back(link.name);
  for (const robot::DisabledPair& pair : robot.semantics.disabled_pairs) {
    for (const std::string& link : {pair.link_a, pair.link_b}) {
      if (robot.model.find_link(link) >= 0) continue;
      return refuse(ErrorCode::kNotFound, robot.where,
                    "the SRDF of robot '" + robot.name + "' disables link '" + link +
                        "', which does not exist" + name_hint(link, names));
    }
    const auto a = body_index_.find(robot.name + "/" + pair.link_a);
    const auto b = body_index_.find(robot.name + "/" + pair.link_b);
    if (a == body_index_.end() || b == body_index_.end()) continue;
    skipped_.emplace(ordered(a->second, b->second),
                     "disabled by SRDF" + (pair.reason.empty() ? "" : ": " + pair.reason));
  }
  return {};
}

Result<void> WorkcellBuilder::skip_allowed(const std::string& a, const std::string& b,
                                           const std::string& reason, const std::string& where) {
  const Result<int> index_a = body_named(a, where);
  if (!index_a) return std::unexpected(index_a.error());
  const Result<int> index_b = body_named(b, where);
  if (!index_b) return std::unexpected(index_b.error());
  if (*index_a == *index_b) {
    return refuse(ErrorCode::kInvalidInput, where,
                  "'" + a + "' is allowed to touch itself; name two bodies");
  }
  skipped_.emplace(ordered(*index_a, *index_b), reason);
  return {};
}

ArmMask WorkcellBuilder::arms_between(int link_a, int link_b) const {
  const robot::Model& model = cell_->model_;
  ArmMask mask = 0;
  // Parents come before their children, so the later of two links is never above the other.
  while (link_a != link_b) {
    int& later = link_a > link_b ? link_a : link_b;
    const int joint = model.links()[static_cast<std::size_t>(later)].parent_joint;
    if (const int arm = owner(joint); arm >= 0) mask |= ArmMask{1} << arm;
    later = model.joints()[static_cast<std::size_t>(joint)].parent_link;
  }
  return mask;
}

/// Appends one pair of bodies to those that are checked or to those that are not.
void WorkcellBuilder::sort_pair(int a, int b, bool list_standing, std::vector<BodyPair>& pairs,
                                std::vector<SkippedPair>& skipped) const {
  const Body& body_a = cell_->bodies_[static_cast<std::size_t>(a)];
  const Body& body_b = cell_->bodies_[static_cast<std::size_t>(b)];
  if (body_a.moved_by == 0 && body_b.moved_by == 0) {
    if (list_standing) skipped.push_back({a, b, "no arm moves them"});
    return;
  }
  const ArmMask moved_by = arms_between(body_a.link, body_b.link);
  if (moved_by == 0) {
    skipped.push_back(
        {a, b, body_a.link == body_b.link ? "on the same link" : "rigidly connected"});
  } else if (const auto why = skipped_.find({a, b}); why != skipped_.end()) {
    skipped.push_back({a, b, why->second});
  } else if (moved_by >= ArmMask{1} << cell_->arms_.size()) {
    skipped.push_back({a, b, "an arm that is left out moves them"});
  } else {
    pairs.push_back({a, b, moved_by});
  }
}

namespace {

/// Replaces what is said of pairs with a fresh body; both lists ascend.
template <class Pair>
void renew(std::vector<Pair>& pairs, const std::vector<bool>& fresh, std::vector<Pair>&& news) {
  const auto place = [](const Pair& pair) { return std::pair(pair.a, pair.b); };
  std::erase_if(pairs, [&](const Pair& pair) {
    return fresh[static_cast<std::size_t>(pair.a)] || fresh[static_cast<std::size_t>(pair.b)];
  });
  std::vector<Pair> all;
  all.reserve(pairs.size() + news.size());
  std::ranges::merge(pairs, news, std::back_inserter(all), {}, place, place);
  pairs = std::move(all);
}

}  // namespace

/// Makes the pairs of the fresh bodies; the others have theirs. Only bodies that move are paired
/// with all others, so that cells with many obstacles take no more than they have pairs.
void WorkcellBuilder::make_pairs(const Marked& fresh) {
  constexpr std::size_t kMostListed = 500;  // Standing bodies whose pairs are worth a list.
  const int count = static_cast<int>(cell_->bodies_.size());
  std::vector<int> moving, standing;
  for (int b = 0; b < count; ++b) {
    (cell_->bodies_[static_cast<std::size_t>(b)].moved_by == 0 ? standing : moving).push_back(b);
  }
  const bool list_standing = standing.size() <= kMostListed;
  std::vector<BodyPair> pairs;
  std::vector<SkippedPair> skipped;
  for (int a = 0; a < count; ++a) {
    const bool stands = cell_->bodies_[static_cast<std::size_t>(a)].moved_by == 0;
    const auto with = [&](int b) {
      if (b <= a) return;
      if (!fresh[static_cast<std::size_t>(a)] && !fresh[static_cast<std::size_t>(b)]) return;
      sort_pair(a, b, list_standing, pairs, skipped);
    };
    if (stands && !list_standing) {
      for (const int b : moving) with(b);
    } else {
      for (int b = a + 1; b < count; ++b) with(b);
    }
  }
  renew(cell_->pairs_, fresh, std::move(pairs));
  renew(cell_->skipped_pairs_, fresh, std::move(skipped));
}

}  // namespace tandem::world
