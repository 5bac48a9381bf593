#include "tandem/io/plan_file.h"

#include <nlohmann/json.hpp>

#include "tandem/core/contract.h"
#include "tandem/io/report_keys.h"

namespace tandem::io {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Json vector_json(const Eigen::VectorXd& values) {
  expects(values.allFinite(), "a plan's numbers are finite");
  return std::vector<double>(values.begin(), values.end());
}

/// knots, and coefficients[segment] = [c0, c1, ...] up to the last that is not 0.
Json map_json(const motion::TimeMap& map) {
  Json segments = Json::array();
  for (const motion::TimeMap::Segment& segment : map.segments()) {
    std::size_t count = segment.size();
    while (count > 1 && segment[count - 1] == 0) --count;
    segments.push_back(std::vector<double>(segment.begin(), segment.begin() + count));
  }
  return {{"knots", map.knots()}, {"coefficients", std::move(segments)}};
}

/// knots, and coefficients[segment][joint] = [c0, c1, c2, c3].
Json arm_json(const world::Workcell& cell, std::size_t arm, const motion::ArmMotion& motion) {
  const world::Arm& a = cell.arms()[arm];
  const auto first = cell.joint_names().begin() + a.offset;
  Json segments = Json::array();
  for (const auto& segment : motion.spline().segments()) {
    Json rows = Json::array();
    for (Eigen::Index j = 0; j < segment.rows(); ++j) {
      rows.push_back(vector_json(segment.row(j).transpose()));
    }
    segments.push_back(std::move(rows));
  }
  Json json = {{"name", a.name},
               {"joints", std::vector<std::string>(first, first + a.dof())},
               {"knots", motion.spline().knots()},
               {"coefficients", std::move(segments)}};
  if (motion.map()) json["time_map"] = map_json(*motion.map());
  return json;
}

Json phases_json(const std::vector<pipeline::Phase>& phases) {
  Json list = Json::array();
  for (const pipeline::Phase& phase : phases) {
    Json path = Json::array();
    for (const Eigen::VectorXd& q : phase.path) path.push_back(vector_json(q));
    list.push_back({{"name", phase.name}, {"path", std::move(path)}});
  }
  return list;
}

Json report_json(const pipeline::PlanReport& report, const world::Workcell& cell, double duration) {
  Json times, counts, arms = Json::object();
  for (const auto& [key, member] : kTimeKeys) times[key] = report.times.*member * 1e3;
  for (const auto& [key, member] : kCountKeys) counts[key] = report.counts.*member;
  for (std::size_t i = 0; i < report.arms.size(); ++i) {
    Json& lengths = arms[cell.arms()[i].name];
    for (const auto& [key, member] : kLengthKeys) lengths[key] = report.arms[i].*member;
  }
  return {{"motion_duration_s", duration},
          {"least_clearance_m", report.least_clearance},
          {"times_ms", std::move(times)},
          {"counts", std::move(counts)},
          {"arms", std::move(arms)},
          {"rungs", report.rungs.empty() ? Json::object() : Json(report.rungs)}};
}

Json pose_json(const Eigen::Isometry3d& X) {
  const Eigen::Quaterniond u(X.linear());
  return {{"xyz", vector_json(X.translation())},
          {"quat_wxyz", vector_json(Eigen::Vector4d(u.w(), u.x(), u.y(), u.z()))}};
}

Json scene_json(const world::SceneState& scene) {
  Json objects = Json::array(), allowed = Json::array();
  for (const auto& [name, object] : scene.objects) {
    objects.push_back({{"name", name},
                       {"link", object.link},
                       {"pose", pose_json(object.X_LO)},
                       {"touching", object.touching}});
  }
  for (const world::AllowedPair& pair : scene.allowed) {
    allowed.push_back({{"a", pair.a}, {"b", pair.b}, {"reason", pair.reason}});
  }
  return {{"objects", std::move(objects)}, {"allowed", std::move(allowed)}};
}

/// Relative to the folder of `file`, with links resolved: `..` then means the same to everyone.
std::string workcell_entry(const fs::path& workcell, const fs::path& file) {
  if (workcell.empty()) return "";
  const fs::path target = fs::weakly_canonical(fs::absolute(workcell));
  const fs::path folder = fs::weakly_canonical(fs::absolute(file)).parent_path();
  const fs::path relative = target.lexically_relative(folder);
  return (relative.empty() ? target : relative).generic_string();
}

}  // namespace

Result<std::string> plan_json(const pipeline::Plan& plan, const world::Workcell& cell,
                              const fs::path& file) {
  const std::vector<motion::ArmMotion>& motions = plan.trajectory.arms();
  expects(motions.size() == cell.arms().size() && plan.trajectory.dof() == cell.dof(),
          "the plan belongs to the cell");
  expects(plan.report.arms.empty() || plan.report.arms.size() == motions.size(),
          "the report has lengths for every arm or for none");
  Json arms = Json::array();
  for (std::size_t i = 0; i < motions.size(); ++i) arms.push_back(arm_json(cell, i, motions[i]));
  const Json json = {{"schema_version", 3},
                     {"tandem_version", TANDEM_VERSION},
                     {"workcell", workcell_entry(cell.spec().file, file)},
                     {"query", plan.query},
                     {"seed", plan.seed},
                     {"options",
                      {{"preset", to_string(plan.preset)},
                       {"strategy", to_string(plan.strategy)},
                       {"plpp", plan.plpp}}},
                     {"start", vector_json(plan.ends.start)},
                     {"goal", vector_json(plan.ends.goal)},
                     {"scene", scene_json((plan.ends.cell ? *plan.ends.cell : cell).scene())},
                     {"arms", std::move(arms)},
                     {"phases", phases_json(plan.report.phases)},
                     {"report", report_json(plan.report, cell, plan.trajectory.duration())}};
  // One line per key: small enough to send, and still readable.
  std::string text = "{";
  try {
    for (const auto& [key, value] : json.items()) {
      text += (text.size() > 1 ? ",\n" : "\n") + Json(key).dump() + ": " + value.dump();
    }
  } catch (const Json::type_error& error) {
    return fail(ErrorCode::kInvalidInput, "cannot write the plan of query " + plan.query +
                                              ": a name or path is not UTF-8 (" + error.what() +
                                              "); rename it");
  }
  return text + "\n}\n";
}

Result<void> save_plan(const fs::path& file, const pipeline::Plan& plan,
                       const world::Workcell& cell, bool overwrite) {
  const Result<std::string> text = plan_json(plan, cell, file);
  if (!text) return std::unexpected(text.error());
  return write_file(file, *text, overwrite);
}

}  // namespace tandem::io
