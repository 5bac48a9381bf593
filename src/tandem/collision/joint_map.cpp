#include "tandem/collision/joint_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "tandem/collision/batch_boxes.h"

namespace tandem::collision {

namespace {

constexpr int kSide = JointMap::kSide;
/// More than what single precision may misplace a value by when it looks up its cell [cells].
constexpr double kMisplaced = 1e-3;

const BatchJoint& joint_at(const BatchModel& model, int joint) {
  return model.joints[static_cast<std::size_t>(joint)];
}

/// The joints that decide the relative pose of two groups.
std::vector<int> joints_between(const BatchModel& model, int a, int b) {
  const int common = model.common_joint(a, b);
  std::vector<int> joints;
  for (int from : {a, b}) {
    for (int j = from; j != common; j = joint_at(model, j).parent) joints.push_back(j);
  }
  return joints;
}

/// A square of cells: its lowest corner and side [cells].
struct Square {
  int first, second, side;
};

/// Divides squares until they are proven, touch at the centre, or are single cells.
class MapProver {
 public:
  MapProver(const BatchChecker& checker, const BatchModel& model,
            const world::PairSelection& selection, const JointMap& map)
      : checker_(checker), model_(model), pairs_(checker.compile(selection)), map_(map) {}

  std::vector<std::int8_t> prove() {
    const BatchChecker::ScratchPtr scratch = checker_.make_scratch();
    const bool single = map_.joints[0] == map_.joints[1];
    std::vector<Square> squares{{0, 0, kSide}}, rest;
    for (int side = kSide; !squares.empty(); side /= 2) {
      ask(squares, single);
      prove_boxes(checker_, Q_, D_, *pairs_, false, *scratch, proofs_);
      rest.clear();
      for (std::size_t i = 0; i < squares.size(); ++i) {
        const Square& square = squares[i];
        if (proofs_[i].verdict == BoxProof::Verdict::kFree) {
          mark(square);
        } else if (side > 1) {
          for (const int u : {0, side / 2}) {
            for (const int v : {0, side / 2}) {
              if (single && v > 0) continue;
              rest.push_back({square.first + u, square.second + v, side / 2});
            }
          }
        }
      }
      std::swap(squares, rest);
    }
    return std::move(room_);
  }

 private:
  /// Fills Q_ and D_ with the boxes of joint values that the squares stand for.
  void ask(const std::vector<Square>& squares, bool single) {
    const auto count = static_cast<Eigen::Index>(squares.size());
    Q_.resize(model_.dof, count);
    Q_.colwise() = 0.5 * (checker_.cell().lower() + checker_.cell().upper());
    D_.setZero(model_.dof, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Square& square = squares[static_cast<std::size_t>(i)];
      set(0, square.first, square.side, i);
      if (!single) set(1, square.second, square.side, i);
    }
  }
  void set(std::size_t axis, int first, int side, Eigen::Index column) {
    const BatchJoint& joint = joint_at(model_, map_.joints[axis]);
    const double per_cell = (joint.upper - joint.lower) / kSide;
    const double value = joint.lower + per_cell * (first + 0.5 * side);
    Q_(joint.column, column) = (value - joint.offset) / joint.multiplier;
    D_(joint.column, column) = per_cell * (0.5 * side + kMisplaced) / std::abs(joint.multiplier);
  }
  void mark(const Square& square) {
    for (int u = square.first; u < square.first + square.side; ++u) {
      for (int v = square.second; v < square.second + square.side; ++v)
        room_[JointMap::at(u, v)] = 0;
    }
  }

  const BatchChecker& checker_;
  const BatchModel& model_;
  BatchChecker::Pairs pairs_;
  const JointMap& map_;
  std::vector<std::int8_t> room_ = std::vector<std::int8_t>(kSide * kSide, -1);
  Eigen::MatrixXd Q_, D_;
  std::vector<BoxProof> proofs_;
};

/// Raises the room of proven cells to the rings of proven cells around them. What is beyond the
/// limits takes no room away: no box that anybody asks about is there.
void measure_room(std::vector<std::int8_t>& rooms) {
  const auto sweep = [&](int u, int v, int step) {
    std::int8_t& room = rooms[JointMap::at(u, v)];
    if (room < 0) return;
    std::int8_t least = kSide;
    const auto look = [&](int i, int k) {
      if (0 <= i && i < kSide && 0 <= k && k < kSide) {
        least = std::min(least, rooms[JointMap::at(i, k)]);
      }
    };
    for (const int shift : {-1, 0, 1}) look(u - step, v + shift);
    look(u, v - step);
    room = std::min<std::int8_t>(room, static_cast<std::int8_t>(least + 1));
  };
  for (std::int8_t& room : rooms) room = room < 0 ? -1 : kSide;
  for (int u = 0; u < kSide; ++u) {
    for (int v = 0; v < kSide; ++v) sweep(u, v, 1);
  }
  for (int u = kSide - 1; u >= 0; --u) {
    for (int v = kSide - 1; v >= 0; --v) sweep(u, v, -1);
  }
}

/// A map without rooms; nothing where more than two joints decide, or two that are not independent.
std::optional<JointMap> empty_map(const BatchModel& model, int a, int b) {
  const std::vector<int> joints = joints_between(model, a, b);
  if (joints.empty() || joints.size() > 2) return std::nullopt;
  JointMap map{a, b, {joints.front(), joints.back()}, {}, {}, nullptr, nullptr};
  const bool single = joints.size() == 1;
  if (!single && joint_at(model, joints[0]).column == joint_at(model, joints[1]).column) {
    return std::nullopt;
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const BatchJoint& joint = joint_at(model, map.joints[axis]);
    const double range = joint.upper - joint.lower;
    if (!(range > 0) || !std::isfinite(range)) return std::nullopt;
    map.low[axis] = static_cast<float>(joint.lower);
    map.cells_per_unit[axis] = static_cast<float>(kSide / range);
  }
  if (single) map.cells_per_unit[1] = 0;
  return map;
}

std::vector<JointRooms::Step> steps_down(const BatchModel& model, int common, int group) {
  std::vector<JointRooms::Step> steps;
  for (int j = group; j != common; j = joint_at(model, j).parent) {
    const BatchJoint& joint = joint_at(model, j);
    steps.push_back({joint.prismatic, joint.multiplier, joint.offset, joint.lower, joint.upper,
                     joint.X_PJ.matrix()});
  }
  return steps;
}

/// All that the rooms of a map follow from, without them.
JointRooms rooms_to_prove(const BatchModel& model, const world::Workcell& cell, const JointMap& map,
                          const world::PairSelection& selection) {
  const int common = model.common_joint(map.group_a, map.group_b);
  JointRooms rooms;
  rooms.down_a = steps_down(model, common, map.group_a);
  rooms.down_b = steps_down(model, common, map.group_b);
  std::map<int, int> place;  // By body.
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BatchBody& body = model.bodies[b];
    if (body.joint != map.group_a && body.joint != map.group_b) continue;
    place[static_cast<int>(b)] = static_cast<int>(rooms.bodies.size());
    const auto first = model.shapes.begin() + body.first_shape;
    rooms.bodies.emplace_back(first, first + body.shape_count);
    for (BatchShape& shape : rooms.bodies.back()) {
      const auto vertex = model.vertices.begin() + shape.first_vertex;
      rooms.vertices.insert(rooms.vertices.end(), vertex, vertex + shape.vertex_count);
      shape.joint = body.joint == map.group_a ? 0 : 1;  // Which group, whatever its number.
      shape.slot = shape.first_vertex = 0;
    }
  }
  for (const int i : selection) {
    const world::BodyPair& pair = cell.pairs()[static_cast<std::size_t>(i)];
    rooms.pairs.push_back({place.at(pair.a), place.at(pair.b)});
  }
  return rooms;
}

using Groups = std::pair<int, int>;

std::map<Groups, world::PairSelection> pairs_by_groups(const BatchModel& model,
                                                       const world::Workcell& cell) {
  std::map<Groups, world::PairSelection> by_groups;
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    const world::BodyPair& pair = cell.pairs()[i];
    const auto group = [&](int body) { return model.bodies[static_cast<std::size_t>(body)].joint; };
    const auto [a, b] = std::minmax({group(pair.a), group(pair.b)});
    if (a >= 0 && a != b) by_groups[{a, b}].push_back(static_cast<int>(i));
  }
  return by_groups;
}

}  // namespace

JointMaps prove_joint_maps(const BatchChecker& checker, const BatchModel& model, JointMaps known) {
  JointMaps maps;
  for (const auto& [groups, selection] : pairs_by_groups(model, checker.cell())) {
    std::optional<JointMap> map = empty_map(model, groups.first, groups.second);
    if (!map) continue;
    JointRooms rooms = rooms_to_prove(model, checker.cell(), *map, selection);
    const auto same = std::ranges::find_if(known.all, [&](const JointMap& other) {
      return other.rooms->follows_from_the_same(rooms);
    });
    if (same != known.all.end()) {
      map->rooms = same->rooms;
    } else {
      rooms.room = MapProver(checker, model, selection, *map).prove();
      measure_room(rooms.room);
      map->rooms = std::make_shared<const JointRooms>(std::move(rooms));
      known.all.push_back(*map);  // Another arm may be alike.
    }
    map->room = map->rooms->room.data();
    maps.all.push_back(*std::move(map));
  }
  return maps;
}

}  // namespace tandem::collision
