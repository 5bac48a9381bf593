#include <algorithm>

#include "tandem/core/names.h"
#include "tandem/world/obstacles.h"
#include "tandem/world/workcell_builder.h"

namespace tandem::world {

namespace {

template <class List, class Member = std::identity>
bool holds(const List& list, const std::string& name, Member member = {}) {
  return std::ranges::find(list, name, member) != list.end();
}

/// Who else names an obstacle, in words, or "".
std::string user_of(const Workcell& cell, const std::string& name) {
  const auto named = [&](const AllowedPair& pair) { return pair.a == name || pair.b == name; };
  const WorkcellSpec& spec = cell.spec();
  if (std::ranges::any_of(spec.allowed, named)) return "an allowed pair";
  if (std::ranges::any_of(cell.scene().allowed, named)) return "an allowed pair of the scene";
  if (spec.body_padding.contains(name)) return "the padding of a body";
  for (const AttachedSpec& attached : spec.attached) {
    if (holds(attached.touching, name)) return "attached '" + attached.name + "'";
  }
  for (const auto& [object, state] : cell.scene().objects) {
    if (holds(state.touching, name)) return "'" + object + "', which may touch it";
  }
  std::string user;
  const auto look = [&](const std::vector<Query>& queries) {
    for (const Query& query : queries) {
      const SceneChanges& changes = query.changes;
      if (holds(changes.attach, name, &Attach::object) ||
          holds(changes.detach, name, &Detach::object) ||
          std::ranges::any_of(changes.allowed, named) ||
          std::ranges::any_of(changes.attach,
                              [&](const Attach& change) { return holds(change.touching, name); })) {
        user = "query '" + query.name + "'";
      }
    }
  };
  look(cell.queries());
  for (const QueryList& list : cell.lists()) look(list.queries);
  return user;
}

}  // namespace

Result<std::shared_ptr<const Workcell>> WorkcellBuilder::build_with(ObstacleSpec obstacle) {
  Body body{obstacle.name,      0, obstacle.shapes_W, 0.0, 0, Body::Kind::kObstacle,
            obstacle.surfaces_W};
  if (auto done = add_body(std::move(body), obstacle.where); !done) {
    return std::unexpected(done.error());
  }
  cell_->spec_.obstacles.push_back(std::move(obstacle));
  Marked fresh(cell_->bodies_.size(), false);
  fresh.back() = true;
  make_pairs(fresh);
  return cell_;
}

Result<std::shared_ptr<const Workcell>> WorkcellBuilder::build_without(
    const std::string& obstacle) {
  const auto found = body_index_.find(obstacle);
  auto& obstacles = cell_->spec_.obstacles;
  const auto spec = std::ranges::find(obstacles, obstacle, &ObstacleSpec::name);
  if (found == body_index_.end() || spec == obstacles.end()) {
    std::vector<std::string> known;
    for (const ObstacleSpec& one : obstacles) known.push_back(one.name);
    return fail(ErrorCode::kNotFound,
                "there is no obstacle '" + obstacle + "'" + name_hint(obstacle, known));
  }
  const int removed = found->second;
  if (cell_->bodies_[static_cast<std::size_t>(removed)].kind == Body::Kind::kAttached) {
    return fail(
        ErrorCode::kInvalidInput,
        "obstacle '" + obstacle + "' cannot be removed: an arm carries it; detach it first");
  }
  if (const std::string user = user_of(*cell_, obstacle); !user.empty()) {
    return fail(ErrorCode::kInvalidInput,
                "obstacle '" + obstacle + "' cannot be removed: " + user + " names it");
  }
  cell_->scene_.objects.erase(obstacle);
  obstacles.erase(spec);
  cell_->bodies_.erase(cell_->bodies_.begin() + removed);
  const auto drop = [removed](auto& pairs) {
    std::erase_if(pairs, [&](const auto& p) { return p.a == removed || p.b == removed; });
    for (auto& pair : pairs) {
      if (pair.a > removed) --pair.a;
      if (pair.b > removed) --pair.b;
    }
  };
  drop(cell_->pairs_);
  drop(cell_->skipped_pairs_);
  return cell_;
}

Result<std::shared_ptr<const Workcell>> with_obstacle(const Workcell& cell, ObstacleSpec obstacle) {
  return WorkcellBuilder(cell).build_with(std::move(obstacle));
}

Result<std::shared_ptr<const Workcell>> without_obstacle(const Workcell& cell,
                                                         const std::string& name) {
  return WorkcellBuilder(cell).build_without(name);
}

}  // namespace tandem::world
