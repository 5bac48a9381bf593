#include <algorithm>
#include <cmath>
#include <limits>

#include "tandem/io/json_reader.h"
#include "tandem/io/plan_file.h"
#include "tandem/io/report_keys.h"

namespace tandem::io {

namespace {

constexpr std::uint64_t kSchemaVersion = 3;
constexpr std::uint64_t kOldestVersion = 2;  ///< Without time maps, else the same.

template <class Keys>
std::vector<std::string> names_of(const Keys& keys) {
  std::vector<std::string> names;
  for (const auto& [name, member] : keys) names.emplace_back(name);
  return names;
}

template <class Integer>
Integer whole(const JsonReader& number) {
  return static_cast<Integer>(number.count(std::numeric_limits<Integer>::max()));
}

std::vector<std::string> unique_names(const JsonReader& list, const std::string& what) {
  std::vector<std::string> names;
  for (const JsonReader& item : list.items()) {
    names.push_back(item.name());
    if (std::count(names.begin(), names.end(), names.back()) > 1) {
      item.refuse("a name that no other " + what + " has");
    }
  }
  if (names.empty()) list.refuse("at least one " + what);
  return names;
}

motion::PiecewiseCubic::Coefficients read_segment(const JsonReader& list, Eigen::Index dof) {
  const std::vector<JsonReader> rows = list.items();
  if (static_cast<Eigen::Index>(rows.size()) != dof) {
    list.refuse("one row per joint: " + std::to_string(dof));
  }
  motion::PiecewiseCubic::Coefficients segment(dof, 4);
  for (Eigen::Index j = 0; j < dof; ++j) {
    segment.row(j) = rows[static_cast<std::size_t>(j)].vector(4, "c0, c1, c2, c3").transpose();
  }
  return segment;
}

motion::PiecewiseCubic read_spline(const JsonReader& arm, Eigen::Index dof) {
  std::vector<double> knots = arm["knots"].numbers();
  std::vector<motion::PiecewiseCubic::Coefficients> segments;
  for (const JsonReader& segment : arm["coefficients"].items()) {
    segments.push_back(read_segment(segment, dof));
  }
  if (segments.size() + 1 != knots.size()) {
    arm["coefficients"].refuse("one segment less than the " + std::to_string(knots.size()) +
                               " knots");
  }
  auto spline = motion::PiecewiseCubic::make(std::move(knots), std::move(segments));
  if (!spline) arm.complain(spline.error().message);
  return std::move(*spline);
}

motion::TimeMap read_map(const JsonReader& json) {
  json.expect_keys({"knots", "coefficients"});
  std::vector<motion::TimeMap::Segment> segments;
  for (const JsonReader& item : json["coefficients"].items()) {
    const std::vector<double> numbers = item.numbers();
    motion::TimeMap::Segment& segment = segments.emplace_back();
    if (numbers.empty() || numbers.size() > segment.size()) {
      item.refuse("1 to " + std::to_string(segment.size()) + " numbers: c0, c1, ...");
    }
    std::ranges::copy(numbers, segment.begin());
  }
  auto map = motion::TimeMap::make(json["knots"].numbers(), std::move(segments));
  if (!map) json.complain(map.error().message);
  return std::move(*map);
}

motion::ArmMotion read_motion(const JsonReader& arm, Eigen::Index dof) {
  motion::ArmMotion motion = read_spline(arm, dof);
  if (!arm.has("time_map")) return motion;
  auto along = motion.along(read_map(arm["time_map"]));
  if (!along) arm["time_map"].complain(along.error().message);
  return std::move(*along);
}

pipeline::PlanReport read_report(const JsonReader& json, const std::vector<std::string>& arms,
                                 double duration) {
  pipeline::PlanReport report;
  json.expect_keys(
      {"motion_duration_s", "least_clearance_m", "times_ms", "counts", "arms", "rungs"});
  if (json["motion_duration_s"].number() != duration) {
    json["motion_duration_s"].refuse("the last knot of the arms, or of their time maps");
  }
  // A cell without pairs keeps them apart by any distance, which JSON cannot say as a number.
  const JsonReader clearance = json["least_clearance_m"];
  report.least_clearance =
      clearance.is_null() ? std::numeric_limits<double>::infinity() : clearance.non_negative();
  json["times_ms"].expect_keys(names_of(kTimeKeys));
  for (const auto& [key, member] : kTimeKeys) {
    report.times.*member = json["times_ms"][key].non_negative() * 1e-3;
  }
  json["counts"].expect_keys(names_of(kCountKeys));
  for (const auto& [key, member] : kCountKeys) {
    report.counts.*member = whole<long>(json["counts"][key]);
  }
  if (!json["arms"].keys().empty()) {
    json["arms"].expect_keys(arms);
    for (const std::string& arm : arms) {
      json["arms"][arm].expect_keys(names_of(kLengthKeys));
      pipeline::ArmLengths& lengths = report.arms.emplace_back();
      for (const auto& [key, member] : kLengthKeys) {
        lengths.*member = json["arms"][arm][key].non_negative();
      }
    }
  }
  for (const std::string& rung : json["rungs"].keys()) {
    report.rungs[rung] = whole<int>(json["rungs"][rung]);
  }
  return report;
}

std::vector<pipeline::Phase> read_phases(const JsonReader& json, Eigen::Index dof) {
  std::vector<pipeline::Phase> phases;
  for (const JsonReader& item : json.items()) {
    item.expect_keys({"name", "path"});
    pipeline::Phase& phase = phases.emplace_back();
    phase.name = item["name"].name();
    for (const JsonReader& q : item["path"].items()) {
      phase.path.push_back(q.vector(dof, "one per joint of the cell"));
    }
  }
  return phases;
}

Eigen::Isometry3d read_pose(const JsonReader& json) {
  json.expect_keys({"xyz", "quat_wxyz"});
  const Eigen::VectorXd u = json["quat_wxyz"].vector(4, "w, x, y, z");
  constexpr double kRounding = 1e-9;  // Of the length; a file holds every digit.
  if (!(std::abs(u.norm() - 1) <= kRounding)) json["quat_wxyz"].refuse("a quaternion of length 1");
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = json["xyz"].vector(3, "x, y, z");
  X.linear() = Eigen::Quaterniond(u[0], u[1], u[2], u[3]).normalized().toRotationMatrix();
  return X;
}

world::SceneState read_scene(const JsonReader& json) {
  world::SceneState scene;
  json.expect_keys({"objects", "allowed"});
  for (const JsonReader& item : json["objects"].items()) {
    item.expect_keys({"name", "link", "pose", "touching"});
    world::ObjectState object{item["link"].name(), read_pose(item["pose"]), {}, {}};
    for (const JsonReader& name : item["touching"].items()) object.touching.push_back(name.name());
    if (!scene.objects.emplace(item["name"].name(), std::move(object)).second) {
      item["name"].refuse("a name that no other object has");
    }
  }
  for (const JsonReader& item : json["allowed"].items()) {
    item.expect_keys({"a", "b", "reason"});
    scene.allowed.push_back({item["a"].name(), item["b"].name(), item["reason"].text(), {}});
  }
  return scene;
}

void check_schema(const JsonReader& json) {
  const JsonReader version = json["schema_version"];
  if (version.count() < kOldestVersion || version.count() > kSchemaVersion) {
    version.refuse(std::to_string(kOldestVersion) + " to " + std::to_string(kSchemaVersion) +
                   ", the versions that this tandem (" + TANDEM_VERSION +
                   ") reads; the file was written by another");
  }
  json.expect_keys({"schema_version", "tandem_version", "workcell", "query", "seed", "options",
                    "start", "goal", "scene", "arms", "phases", "report"});
  json["options"].expect_keys({"preset", "strategy", "plpp"});
}

PlanFile read_plan(const JsonReader& json, const std::filesystem::path& folder) {
  check_schema(json);
  std::vector<std::string> arms;
  std::vector<std::vector<std::string>> joints;
  std::vector<motion::ArmMotion> motions;
  Eigen::Index dof = 0;
  std::vector<std::string> optional;
  if (json["schema_version"].count() > kOldestVersion) optional.emplace_back("time_map");
  for (const JsonReader& arm : json["arms"].items()) {
    arm.expect_keys({"name", "joints", "knots", "coefficients"}, optional);
    arms.push_back(arm["name"].name());
    if (std::count(arms.begin(), arms.end(), arms.back()) > 1) {
      arm["name"].refuse("a name that no other arm has");
    }
    joints.push_back(unique_names(arm["joints"], "joint"));
    const auto count = static_cast<Eigen::Index>(joints.back().size());
    motions.push_back(read_motion(arm, count));
    dof += count;
  }
  if (arms.empty()) json["arms"].refuse("at least one arm");
  motion::CellMotion trajectory(std::move(motions));
  pipeline::PlanReport report = read_report(json["report"], arms, trajectory.duration());
  report.phases = read_phases(json["phases"], dof);
  const std::filesystem::path workcell = json["workcell"].text();
  return {.version = json["tandem_version"].name(),
          .workcell = workcell.empty() ? workcell : (folder / workcell).lexically_normal(),
          .query = json["query"].text(),
          .strategy = json["options"]["strategy"].name(),
          .preset = json["options"]["preset"].name(),
          .plpp = json["options"]["plpp"].boolean(),
          .seed = json["seed"].count(),
          .arms = std::move(arms),
          .joints = std::move(joints),
          .start = json["start"].vector(dof, "one per joint of the cell"),
          .goal = json["goal"].vector(dof, "one per joint of the cell"),
          .trajectory = std::move(trajectory),
          .report = std::move(report),
          .scene = read_scene(json["scene"])};
}

}  // namespace

Result<PlanFile> load_plan(const std::filesystem::path& file) {
  return read_json(file, [&](const JsonReader& json) {
    const auto folder = std::filesystem::weakly_canonical(std::filesystem::absolute(file));
    return read_plan(json, folder.parent_path());
  });
}

Result<std::shared_ptr<const world::Workcell>> in_scene_of(
    const PlanFile& plan, const std::shared_ptr<const world::Workcell>& cell) {
  if (plan.scene.objects.empty() && plan.scene.allowed.empty()) return cell;
  auto changed = cell->in_scene(plan.scene);
  if (!changed) {
    return fail(changed.error().code, "the scene of the plan does not fit workcell '" +
                                          cell->name() + "': " + changed.error().message);
  }
  return changed;
}

}  // namespace tandem::io
