#include "tandem/pipeline/bench.h"

#include <gtest/gtest.h>

#include "small_cell.h"

namespace tandem::pipeline {
namespace {

TEST(Statistics, MatchesHandComputedValues) {
  const Statistics s = Statistics::of({4, 1, 3, 2, 5});
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(2.5));
  EXPECT_DOUBLE_EQ(s.p50, 3);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);
  EXPECT_DOUBLE_EQ(s.max, 5);
  EXPECT_DOUBLE_EQ(Statistics::of({}).mean, 0);
  EXPECT_DOUBLE_EQ(Statistics::of({7}).std, 0);
  EXPECT_DOUBLE_EQ(Statistics::of({7}).p99, 7);
}

TEST(Bench, RunsEveryQueryOfEveryCycleWithItsOwnSeed) {
  int calls = 0;
  const auto result = bench(test::small_cell(), 2, {}, [&](const BenchRun&, int done, int total) {
    EXPECT_EQ(done, ++calls);
    EXPECT_EQ(total, 4);
  });
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->cycles, 2);
  ASSERT_EQ(result->runs.size(), 4u);
  EXPECT_EQ(result->runs[2].query, "cross");
  EXPECT_EQ(result->runs[2].cycle, 1);
  for (const BenchRun& run : result->runs) EXPECT_TRUE(run.success) << run.message;
  EXPECT_NE(result->runs[0].duration, result->runs[2].duration);
}

TEST(Bench, KeepsWhatItHasWhenStopped) {
  std::stop_source source;
  PlanOptions options;
  options.token = source.get_token();
  const auto result = bench(test::small_cell(), 100, options, [&](const BenchRun&, int done, int) {
    if (done == 3) source.request_stop();
  });
  ASSERT_TRUE(result);
  EXPECT_EQ(result->runs.size(), 3u);
  EXPECT_EQ(result->cycles, 1);
}

TEST(Bench, NeedsQueries) {
  auto spec = test::small_cell_spec();
  spec.queries.clear();
  const auto result = bench(*world::Workcell::make(spec), 1, {}, {});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("no queries"), std::string::npos);
}

}  // namespace
}  // namespace tandem::pipeline
