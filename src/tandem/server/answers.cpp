#include "tandem/server/answers.h"

#include <limits>

#include "tandem/core/names.h"
#include "tandem/robot/inverse_kinematics.h"
#include "tandem/server/json.h"
#include "tandem/server/requests.h"
#include "tandem/server/scene.h"

namespace tandem::server {

namespace {

/// A person drags: an answer that comes later than this is of no use [s].
constexpr double kIkDeadline = 0.3;
constexpr int kIkRestarts = 20;

Answer failure(const Error& error, const Json& touching = Json::array()) {
  return {200, text_of(error_json(to_string(error.code), error.message, touching))};
}

/// The pairs that touch at q.
Json touching_json(const collision::CompiledCell& compiled, const Eigen::VectorXd& q) {
  const collision::SsvChecker& checker = compiled.exact();
  const world::PairSelection& pairs = compiled.selection(world::PairScope::all());
  const auto scratch = checker.make_scratch();
  std::vector<collision::PairClearance> touching;
  checker.clearances(q, pairs, std::numeric_limits<double>::min(), *scratch, touching);
  Json list = Json::array();
  for (const collision::PairClearance& pair : touching) {
    list.push_back(clearance_json(checker.cell(), pair));
  }
  return list;
}

/// The pairs that touch at the start and at the goal, each with the end that it is about.
Json touching_ends(const collision::CompiledCell& compiled, const pipeline::ResolvedQuery& ends) {
  Json list = Json::array();
  for (const auto& [end, q] : {std::pair{"start", &ends.start}, std::pair{"goal", &ends.goal}}) {
    for (Json& pair : touching_json(compiled, *q)) {
      pair["end"] = end;
      list.push_back(std::move(pair));
    }
  }
  return list;
}

}  // namespace

Answer refusal(int status, const std::string& code, const std::string& message) {
  return {status, text_of(error_json(code, message))};
}

Answers::Answers(std::shared_ptr<const world::Workcell> cell, PlanWriter plan_json)
    : cell_(std::move(cell)), planner_(cell_), plan_json_(std::move(plan_json)) {}

Answer Answers::query(const std::string& name) {
  const auto query = cell_->find_query(name);
  if (!query) return refusal(404, to_string(query.error().code), query.error().message);
  const std::lock_guard lock(resolving_);
  auto known = resolved_.find(name);
  if (known == resolved_.end()) {
    known = resolved_.emplace(name, planner_.resolve(**query)).first;
  }
  const Result<pipeline::ResolvedQuery>& ends = known->second;
  if (!ends) return failure(ends.error());
  return {200, "{\"start\":" + text_of(values_json(ends->start)) +
                   ",\"goal\":" + text_of(values_json(ends->goal)) +
                   ",\"objects\":" + describe_moved(*cell_, *ends->cell) + "}"};
}

Answer Answers::plan(const std::string& body, std::stop_token token) {
  const auto request = read_plan_request(body, cell_->dof());
  if (!request) {
    return refusal(400, to_string(request.error().code), request.error().message);
  }
  const world::Query* query = nullptr;
  if (request->query) {
    const auto found = cell_->find_query(*request->query);
    if (!found) return refusal(404, to_string(found.error().code), found.error().message);
    query = *found;
  }
  if (planning_.test_and_set()) {
    return refusal(429, "busy", "another plan is being made; ask again when it is done");
  }
  const struct Done {
    std::atomic_flag& planning;
    ~Done() { planning.clear(); }
  } done{planning_};
  pipeline::PlanOptions options = request->options;
  options.token = std::move(token);
  const auto stop = StopCondition::after(options.deadline, options.token);
  const auto ends = query ? planner_.resolve(*query, options.seed, stop) : *request->ends;
  if (!ends) return failure(ends.error());
  const auto plan = planner_.plan(*ends, options);
  if (!plan) {
    return failure(plan.error(), touching_ends(*planner_.compiled(ends->cell), *ends));
  }
  const auto text = plan_json_(*plan);
  if (!text) return failure(text.error());
  return {200, "{\"plan\":" + *text + ",\"clearance\":" +
                   describe_clearance(*planner_.compiled(plan->ends.cell), plan->trajectory,
                                      kClearanceRate) +
                   ",\"objects\":" + describe_moved(*cell_, *plan->ends.cell) + "}"};
}

Answer Answers::ik(const std::string& body, std::stop_token token) const {
  const auto request = read_ik_request(body, cell_->dof());
  if (!request) {
    return refusal(400, to_string(request.error().code), request.error().message);
  }
  const int index = cell_->find_arm(request->arm);
  if (index < 0) {
    std::vector<std::string> names;
    for (const world::Arm& arm : cell_->arms()) names.push_back(arm.name);
    return refusal(404, to_string(ErrorCode::kNotFound),
                   "there is no arm '" + request->arm + "'" + name_hint(request->arm, names));
  }
  const world::Arm& arm = cell_->arms()[static_cast<std::size_t>(index)];
  robot::IkProblem problem;
  problem.model = &cell_->model();
  problem.link = arm.tip_link;
  problem.X_LE = arm.X_LE;
  problem.columns = arm.columns;
  cell_->positions(request->q, problem.positions);
  problem.X_WE = request->X_WE;
  const auto positions = robot::solve_ik(problem, {.restarts = kIkRestarts}, {},
                                         StopCondition::after(kIkDeadline, std::move(token)));
  if (!positions) return failure(positions.error());
  Eigen::VectorXd q = request->q;
  for (int j = 0; j < arm.dof(); ++j) {
    q[arm.offset + j] = (*positions)[arm.columns[static_cast<std::size_t>(j)]];
  }
  return {200,
          text_of({{"q", values_json(q)}, {"touching", touching_json(*planner_.compiled(), q)}})};
}

}  // namespace tandem::server
