#include "tandem/planning/ompl/ompl_planning.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsGNATNoThreadSafety.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <string>
#include <unordered_set>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::planning {

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

using RealState = ob::RealVectorStateSpace::StateType;

std::uint_fast32_t local_seed(Rng& rng) { return static_cast<std::uint32_t>(rng.split()); }

class SeededSampler final : public ob::RealVectorStateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, std::uint_fast32_t seed)
      : RealVectorStateSampler(space) {
    rng_.setLocalSeed(seed);
  }
};

class SeededRrtConnect final : public og::RRTConnect {
 public:
  SeededRrtConnect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed) : RRTConnect(si) {
    rng_.setLocalSeed(seed);
  }
};

class SeededSimplifier final : public og::PathSimplifier {
 public:
  SeededSimplifier(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed)
      : PathSimplifier(si) {
    rng_.setLocalSeed(seed);
  }
};

/// OMPL's default structure for these spaces. Its pivots do not change which neighbour is nearest,
/// but for rounding; a fixed seed leaves nothing to rounding.
template <class T>
class SeededGnat final : public ompl::NearestNeighborsGNATNoThreadSafety<T> {
 public:
  SeededGnat() {
    struct Pivots : ompl::GreedyKCenters<T> {
      static ompl::RNG ompl::GreedyKCenters<T>::* generator() { return &Pivots::rng_; }
    };
    (this->pivotSelector_.*Pivots::generator()).setLocalSeed(1);
  }
};

/// R^n without the random projections that no planner here asks for.
class JointSpace final : public ob::RealVectorStateSpace {
 public:
  JointSpace(const PathProblem& problem, Rng& rng)
      : RealVectorStateSpace(static_cast<unsigned>(problem.start.size())) {
    const SearchBox box = search_box(problem);
    ob::RealVectorBounds bounds(dimension_);
    bounds.low.assign(box.lower.begin(), box.lower.end());
    bounds.high.assign(box.upper.begin(), box.upper.end());
    setBounds(bounds);
    setStateSamplerAllocator([&rng](const ob::StateSpace* space) {
      return std::make_shared<SeededSampler>(space, local_seed(rng));
    });
  }
  void registerProjections() override {}
};

/// Straight edges that `validity` accepted, by their bits.
class AcceptedEdges {
 public:
  void add(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { edges_.insert(key(a, b)); }
  bool contain(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    return edges_.contains(key(a, b));
  }

 private:
  static std::string key(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const auto bytes = [](const Eigen::VectorXd& q) {
      return std::string_view(reinterpret_cast<const char*>(q.data()),
                              static_cast<std::size_t>(q.size()) * sizeof(double));
    };
    // Edges have no direction.
    const auto [first, second] = std::minmax({bytes(a), bytes(b)});
    return std::string(first).append(second);
  }
  std::unordered_set<std::string> edges_;
};

/// One call's questions to `validity`. After a stop every answer is no, so that OMPL's loops, which
/// look at the clock rarely, run out at once.
class Questions {
 public:
  Questions(Validity& validity, const StopCondition& stop, Eigen::Index dof)
      : validity_(validity), stop_(stop), a_(dof), b_(dof) {}

  bool state(const ob::State* s) {
    if (stop_()) return false;
    read(s, a_);
    return validity_.state(a_);
  }
  bool edge(const ob::State* s1, const ob::State* s2) {
    if (stop_()) return false;
    read(s1, a_);
    read(s2, b_);
    return edge(a_, b_);
  }
  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    if (accepted_.contain(a, b)) return true;
    if (stop_() || !validity_.edge(a, b)) return false;
    accepted_.add(a, b);
    return true;
  }
  bool edges(const motion::JointPath& path) {
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!edge(path[i - 1], path[i])) return false;
    }
    return true;
  }
  void accept(const motion::JointPath& path) {
    for (std::size_t i = 1; i < path.size(); ++i) accepted_.add(path[i - 1], path[i]);
  }
  bool stopped() const { return stop_(); }

 private:
  static void read(const ob::State* s, Eigen::VectorXd& q) {
    q = Eigen::Map<const Eigen::VectorXd>(s->as<RealState>()->values, q.size());
  }
  Validity& validity_;
  const StopCondition& stop_;
  AcceptedEdges accepted_;
  Eigen::VectorXd a_, b_;
};

class StateChecker final : public ob::StateValidityChecker {
 public:
  StateChecker(const ob::SpaceInformationPtr& si, Questions& questions)
      : StateValidityChecker(si), questions_(questions) {}
  bool isValid(const ob::State* s) const override { return questions_.state(s); }

 private:
  Questions& questions_;
};

/// Leaves the resolution to `validity`: OMPL's own measures edges in another norm.
class EdgeChecker final : public ob::MotionValidator {
 public:
  EdgeChecker(const ob::SpaceInformationPtr& si, Questions& questions)
      : MotionValidator(si), questions_(questions) {}

  bool checkMotion(const ob::State* s1, const ob::State* s2) const override {
    const bool valid = questions_.edge(s1, s2);
    ++(valid ? valid_ : invalid_);
    return valid;
  }
  bool checkMotion(const ob::State* s1, const ob::State* s2,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(s1, s2)) return true;
    constexpr int kBisections = 10;
    const auto& space = *si_->getStateSpace();
    ob::State* const middle = si_->allocState();
    double low = 0, high = 1;
    for (int i = 0; i < kBisections; ++i) {
      const double t = 0.5 * (low + high);
      space.interpolate(s1, s2, t, middle);
      (questions_.edge(s1, middle) ? low : high) = t;
    }
    space.interpolate(s1, s2, low, middle);
    if (last_valid.first) si_->copyState(last_valid.first, middle);
    last_valid.second = low;
    si_->freeState(middle);
    return false;
  }

 private:
  Questions& questions_;
};

/// The problem in OMPL's terms. Lives as long as one call.
class Setup {
 public:
  Setup(const PathProblem& problem, Validity& validity, std::uint64_t seed,
        const StopCondition& stop)
      : questions(validity, stop, problem.start.size()), rng(seed) {
    static const bool silenced = (ompl::msg::setLogLevel(ompl::msg::LOG_NONE), true);
    static_cast<void>(silenced);
    space = std::make_shared<JointSpace>(problem, rng);
    si = std::make_shared<ob::SpaceInformation>(space);
    si->setStateValidityChecker(std::make_shared<StateChecker>(si, questions));
    si->setMotionValidator(std::make_shared<EdgeChecker>(si, questions));
    si->setup();
  }
  void write(const Eigen::VectorXd& q, ob::State* s) const {
    std::ranges::copy(q, s->as<RealState>()->values);
  }
  motion::JointPath read(const og::PathGeometric& path) const {
    motion::JointPath waypoints;
    for (std::size_t i = 0; i < path.getStateCount(); ++i) {
      const auto* s = path.getState(static_cast<unsigned>(i))->as<RealState>();
      waypoints.push_back(Eigen::Map<const Eigen::VectorXd>(s->values, space->getDimension()));
    }
    return waypoints;
  }

  Questions questions;
  Rng rng;
  std::shared_ptr<JointSpace> space;
  ob::SpaceInformationPtr si;
};

class OmplRrtConnect final : public PathPlanner {
 public:
  explicit OmplRrtConnect(const OmplPlannerOptions& options) : options_(options) {}

  Result<motion::JointPath> plan(const PathProblem& problem, Validity& validity, std::uint64_t seed,
                                 const StopCondition& stop) const override {
    if (auto ends = check_problem(problem, validity); !ends) return std::unexpected(ends.error());
    if (stop()) return std::unexpected(stop.error(kWhat));
    if ((problem.goal - problem.start).norm() < kSameWaypoint) {
      return near_ends(problem, validity);
    }
    Setup setup(problem, validity, seed, stop);
    const auto definition = std::make_shared<ob::ProblemDefinition>(setup.si);
    ob::ScopedState<> start(setup.space), goal(setup.space);
    setup.write(problem.start, start.get());
    setup.write(problem.goal, goal.get());
    definition->setStartAndGoalStates(start, goal);

    SeededRrtConnect planner(setup.si, local_seed(setup.rng));
    planner.setProblemDefinition(definition);
    planner.setRange(options_.range);
    planner.setNearestNeighbors<SeededGnat>();
    const ob::PlannerStatus status =
        planner.solve(ob::PlannerTerminationCondition([&stop] { return stop(); }));
    if (status != ob::PlannerStatus::EXACT_SOLUTION) {
      if (stop()) return std::unexpected(stop.error(kWhat));
      return fail(ErrorCode::kNoPath,
                  std::string("OMPL's RRTConnect gave up: ") + status.asString());
    }
    const auto* found = definition->getSolutionPath()->as<og::PathGeometric>();
    const motion::JointPath path = setup.read(*found);
    motion::JointPath result = without_duplicates(path);
    if (result.size() < path.size() && !setup.questions.edges(result)) {
      if (stop()) return std::unexpected(stop.error(kWhat));
      return fail(ErrorCode::kNoPath,
                  "the path found touches something once its duplicate waypoints are dropped; "
                  "another seed finds another path");
    }
    return result;
  }

 private:
  static constexpr const char* kWhat = "path planning (RRT-Connect)";

  static Result<motion::JointPath> near_ends(const PathProblem& problem, Validity& validity) {
    if (validity.edge(problem.start, problem.goal)) {
      return motion::JointPath{problem.start, problem.goal};
    }
    return fail(ErrorCode::kNoPath,
                "start and goal are the same, but the edge between them is not "
                "valid: they touch something nearly");
  }

  OmplPlannerOptions options_;
};

class OmplSimplifier final : public PathSimplifier {
 public:
  motion::JointPath simplify(const PathProblem& problem, motion::JointPath path, Validity& validity,
                             std::uint64_t seed, const StopCondition& stop) const override {
    expects(path.size() >= 2, "a path has at least two waypoints");
    if (path.size() == 2 || stop()) return path;
    Setup setup(problem, validity, seed, stop);
    setup.questions.accept(path);
    const auto keep = [&](motion::JointPath candidate) {
      candidate = without_duplicates(candidate);
      // OMPL mends rejected edges by random detours.
      constexpr double kRounding = 1e-12;
      const double longest = motion::joint_length(path) * (1 + kRounding);
      if (motion::joint_length(candidate) > longest) return;
      if (setup.questions.edges(candidate)) path = std::move(candidate);
    };
    keep(path);
    og::PathGeometric working(setup.si);
    for (const Eigen::VectorXd& q : path) {
      ob::ScopedState<> state(setup.space);
      setup.write(q, state.get());
      working.append(state.get());
    }
    SeededSimplifier simplifier(setup.si, local_seed(setup.rng));
    // OMPL asks this between its steps, when the path is whole.
    const ob::PlannerTerminationCondition between([&] {
      if (stop()) return true;
      keep(setup.read(working));
      return false;
    });
    simplifier.simplify(working, between, false);
    keep(setup.read(working));
    return path;
  }
};

}  // namespace

std::unique_ptr<PathPlanner> make_ompl_rrt_connect(const OmplPlannerOptions& options) {
  expects(options.range >= 0, "the range of RRT-Connect is positive, or 0 for OMPL's own");
  return std::make_unique<OmplRrtConnect>(options);
}

std::unique_ptr<PathSimplifier> make_ompl_simplifier() {
  return std::make_unique<OmplSimplifier>();
}

}  // namespace tandem::planning
