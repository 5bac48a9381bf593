#include <gtest/gtest.h>

#include <cmath>

#include "small_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"
#include "tandem/pipeline/problem_bench.h"

namespace tandem::pipeline {
namespace {

class PathOnSmallCell : public ::testing::Test {
 protected:
  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  ResolvedQuery query_ = *resolve(cell_, cell_->query("cross"));

  /// Whether no sample of the path touches anything: independent of the certificate.
  bool samples_are_free(const motion::JointPath& path) const {
    const collision::SsvChecker checker(cell_);
    const auto scratch = checker.make_scratch();
    const auto all = cell_->select(world::PairScope::all());
    for (std::size_t i = 1; i < path.size(); ++i) {
      for (int k = 0; k <= 500; ++k) {
        const double t = k / 500.0;
        const Eigen::VectorXd q = (1 - t) * path[i - 1] + t * path[i];
        if (!checker.is_free(q, all, *scratch)) return false;
      }
    }
    return true;
  }
};

TEST_F(PathOnSmallCell, JoinsTheEndsFreelyAndTheSimplifiedOneIsNoLonger) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PlanReport report;
    const auto found = plan_path(cell_, query_, {.seed = seed}, &report);
    ASSERT_TRUE(found) << found.error().message;
    for (const motion::JointPath* path : {&found->planned, &found->path}) {
      ASSERT_GE(path->size(), 2u);
      EXPECT_EQ(path->front(), query_.start);
      EXPECT_EQ(path->back(), query_.goal);
      EXPECT_TRUE(samples_are_free(*path));
    }
    EXPECT_LE(motion::joint_length(found->path), motion::joint_length(found->planned) * (1 + 1e-9));
    const auto clearance = certify_path(cell_, found->path);
    ASSERT_TRUE(clearance) << clearance.error().message;
    EXPECT_GT(*clearance, 0);
    EXPECT_GT(report.times.path_planning, 0);
    EXPECT_GT(report.times.simplification, 0);
    EXPECT_EQ(report.times.trajectory, 0);
    EXPECT_GT(report.counts.edge_checks, 0);
    EXPECT_TRUE(report.phases.empty());
  }
}

// The path is the one that plan() times: the same modules, the same seeds.
TEST_F(PathOnSmallCell, IsThePathOfTheCentralizedPlan) {
  for (const Preset preset : {Preset::kDefault, Preset::kPaper}) {
    const PlanOptions options{.preset = preset, .seed = 4, .plpp = false};
    const auto found = plan_path(cell_, query_, options);
    ASSERT_TRUE(found) << found.error().message;
    PlanReport report;
    static_cast<void>(plan(cell_, query_, options, &report));
    ASSERT_EQ(report.phases.size(), 2u);
    EXPECT_EQ(report.phases[0].path, found->planned);
    EXPECT_EQ(report.phases[1].path, found->path);
  }
}

TEST_F(PathOnSmallCell, AnInfeasibleEndIsExplained) {
  ResolvedQuery low = query_;
  low.goal[1] = 1.0;
  const auto touching = plan_path(cell_, low);
  ASSERT_FALSE(touching);
  EXPECT_EQ(touching.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(touching.error().message.find("goal of query 'cross' is in collision"),
            std::string::npos)
      << touching.error().message;
  ResolvedQuery outside = query_;
  outside.start[5] = 2.6;
  const auto beyond = plan_path(cell_, outside);
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().message.find("right/joint2"), std::string::npos)
      << beyond.error().message;
}

TEST_F(PathOnSmallCell, CertificateNamesTheEdgeThatTouches) {
  const motion::JointPath straight{query_.start, query_.start, query_.goal};
  ASSERT_FALSE(samples_are_free(straight));
  const auto refused = certify_path(cell_, straight);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCollision);
  EXPECT_NE(refused.error().message.find("edge 2 of 2: "), std::string::npos);
  std::stop_source source;
  source.request_stop();
  const auto stopped = certify_path(cell_, straight, source.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST_F(PathOnSmallCell, MisuseIsAContractViolation) {
  EXPECT_THROW(static_cast<void>(plan_path(nullptr, query_)), ContractViolation);
  EXPECT_THROW(static_cast<void>(plan_path(cell_, {"", query_.start.head(3), query_.goal})),
               ContractViolation);
  EXPECT_THROW(static_cast<void>(certify_path(cell_, {query_.start})), ContractViolation);
}

class BenchOnSmallCell : public PathOnSmallCell {
 protected:
  BenchProblem problem(const std::string& set, const std::string& name, bool valid = true) {
    BenchProblem problem{set, valid, query_, [this] {
                           ++made_;
                           return Result<std::shared_ptr<const world::Workcell>>(cell_);
                         }};
    problem.ends.name = name;
    return problem;
  }
  int made_ = 0;
};

TEST_F(BenchOnSmallCell, RunsValidProblemsAndCountsTheOthers) {
  std::vector<BenchProblem> problems{problem("a", "1"), problem("b", "1"), problem("a", "2", false),
                                     problem("a", "3")};
  problems.back().ends.goal[1] = 1.0;  // In the table.
  std::size_t calls = 0;
  const auto result =
      bench_problems(problems, 2, {.seed = 9}, [&](const ProblemRun&, std::size_t done, auto all) {
        EXPECT_EQ(done, ++calls);
        EXPECT_EQ(all, 6u);
      });
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(made_, 3);
  ASSERT_EQ(result->sets.size(), 2u);
  EXPECT_EQ(result->sets[0].name, "a");
  EXPECT_EQ(result->sets[0].problems, 3);
  EXPECT_EQ(result->sets[0].valid, 2);
  ASSERT_EQ(result->runs.size(), 6u);
  const auto again = plan_path(cell_, query_, {.seed = 10});
  const ProblemRun& second = result->runs[1];
  EXPECT_TRUE(second.solved && second.certified);
  EXPECT_EQ(second.cycle, 1);
  EXPECT_EQ(second.length_before, motion::joint_length(again->planned));
  EXPECT_EQ(second.length_after, motion::joint_length(again->path));
  EXPECT_GT(second.planning, 0);
  const ProblemRun& last = result->runs.back();
  EXPECT_FALSE(last.solved || last.certified);
  EXPECT_EQ(last.failure, ErrorCode::kInfeasible);
  EXPECT_NE(last.message.find("in collision"), std::string::npos);
}

TEST_F(BenchOnSmallCell, SampledEdgesAreSolvedButNotAlwaysCertified) {
  // The paper's samples miss the thin wall now and then; the certificate never does.
  const auto result = bench_problems({problem("a", "1")}, 30, {.preset = Preset::kPaper}, {});
  ASSERT_TRUE(result);
  for (const ProblemRun& run : result->runs) {
    EXPECT_TRUE(run.solved) << run.message;
    if (run.certified) continue;
    EXPECT_EQ(run.failure, ErrorCode::kCollision);
  }
}

TEST_F(BenchOnSmallCell, AStopKeepsWhatIsDone) {
  std::stop_source source;
  const auto result =
      bench_problems({problem("a", "1"), problem("a", "2")}, 5, {.token = source.get_token()},
                     [&](const ProblemRun&, std::size_t done, std::size_t) {
                       if (done == 3) source.request_stop();
                     });
  ASSERT_TRUE(result);
  EXPECT_EQ(result->runs.size(), 3u);
  EXPECT_EQ(result->planned_runs, 10u);
}

TEST_F(BenchOnSmallCell, ACellThatCannotBeMadeNamesItsProblem) {
  std::vector<BenchProblem> problems{problem("a", "7")};
  problems[0].cell = []() -> Result<std::shared_ptr<const world::Workcell>> {
    return fail(ErrorCode::kInvalidInput, "no such thing");
  };
  const auto result = bench_problems(problems, 1, {}, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "problem '7' of set 'a': no such thing");
}

}  // namespace
}  // namespace tandem::pipeline
