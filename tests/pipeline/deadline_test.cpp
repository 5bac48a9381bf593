#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

#include "tandem/core/stop.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/plan.h"
#include "test_data.h"

namespace tandem::pipeline {
namespace {

/// The promise is 10 ms on a quiet machine; a loaded one may take the processor away for longer.
constexpr double kPatience = 0.1;  // [s]

class Deadlines : public ::testing::TestWithParam<Preset> {
 protected:
  std::shared_ptr<const world::Workcell> cell_ =
      *io::load_workcell(test::source_path("scenarios/gearbox/workcell.yaml"));
  ResolvedQuery query_ = *resolve(cell_, cell_->query("pick_shafts"));
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Deadlines that fall into every stage: planning, simplifying, timing, proving.
TEST_P(Deadlines, AreHonouredInEveryStage) {
  double worst = 0;
  int timed_out = 0;
  for (int k = 0; k < 40; ++k) {
    PlanOptions options;
    options.preset = GetParam();
    options.seed = static_cast<std::uint64_t>(k);
    options.deadline = 0.001 * std::pow(1.16, k);  // 1 ms to 0.33 s
    const auto begin = Clock::now();
    const auto planned = plan(cell_, query_, options);
    worst = std::max(worst, seconds_since(begin) - options.deadline);
    timed_out += !planned && planned.error().code == ErrorCode::kTimeout;
  }
  std::printf("%s: %d of 40 timed out, at most %.1f ms late\n", to_string(GetParam()), timed_out,
              1e3 * worst);
  EXPECT_GT(timed_out, 5);  // Else the deadlines were no test.
  EXPECT_LT(worst, kPatience);
}

// Stops early in a query that takes long.
TEST_P(Deadlines, StopsFromAnotherThreadAreHonoured) {
  const ResolvedQuery slow = *resolve(cell_, cell_->query("pick_gears"));
  double worst = 0;
  int cancelled = 0;
  for (int k = 0; k < 20; ++k) {
    std::stop_source source;
    PlanOptions options;
    options.preset = GetParam();
    options.seed = static_cast<std::uint64_t>(k);
    options.token = source.get_token();
    Clock::time_point stopped_at = Clock::time_point::max();
    std::jthread stopper([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(1 + k / 2));
      stopped_at = Clock::now();
      source.request_stop();
    });
    const auto planned = plan(cell_, slow, options);
    const auto end = Clock::now();
    stopper.join();
    if (planned || planned.error().code != ErrorCode::kCancelled) continue;
    ++cancelled;
    worst = std::max(worst, std::chrono::duration<double>(end - stopped_at).count());
  }
  std::printf("%s: %d of 20 cancelled, at most %.1f ms late\n", to_string(GetParam()), cancelled,
              1e3 * worst);
  EXPECT_GT(cancelled, 5);
  EXPECT_LT(worst, kPatience);
}

INSTANTIATE_TEST_SUITE_P(Presets, Deadlines, ::testing::Values(Preset::kDefault, Preset::kPaper),
                         [](const auto& each) { return std::string(to_string(each.param)); });

}  // namespace
}  // namespace tandem::pipeline
