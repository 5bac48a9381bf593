#pragma once
/// Answers to the page's questions about planning. No network in here.

#include <atomic>
#include <map>
#include <mutex>
#include <stop_token>

#include "tandem/pipeline/planner.h"
#include "tandem/server/server.h"

namespace tandem::server {

struct Answer {
  int status = 200;  ///< HTTP's: an infeasible query is an answer (200), a malformed one is not.
  std::string json;
};

Answer refusal(int status, const std::string& code, const std::string& message);

/// Thread-safe.
class Answers {
 public:
  Answers(std::shared_ptr<const world::Workcell> cell, PlanWriter plan_json);

  /// Joint values of a query's ends.
  Answer query(const std::string& name);
  /// Plans; while one call does, others are refused (429). A failure names the pairs that touch at
  /// the start and at the goal.
  Answer plan(const std::string& body, std::stop_token token);
  /// The solution nearest to where the arm is, free or not.
  Answer ik(const std::string& body, std::stop_token token) const;

 private:
  std::shared_ptr<const world::Workcell> cell_;
  pipeline::Planner planner_;
  PlanWriter plan_json_;
  std::atomic_flag planning_;
  std::mutex resolving_;  // Guards what follows, and keeps resolving to one thread.
  std::map<std::string, Result<pipeline::ResolvedQuery>> resolved_;
};

}  // namespace tandem::server
