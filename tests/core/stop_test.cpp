#include "tandem/core/stop.h"

#include <gtest/gtest.h>

#include <thread>

namespace tandem {
namespace {

using std::chrono::milliseconds;

TEST(StopCondition, NeverStopsByDefault) {
  const StopCondition stop;
  EXPECT_FALSE(stop());
  EXPECT_EQ(stop.seconds_left(), std::numeric_limits<double>::infinity());
}

TEST(StopCondition, StopsAtItsDeadline) {
  EXPECT_TRUE(StopCondition(Clock::now() - milliseconds(1)).timed_out());
  EXPECT_TRUE(StopCondition::after(0)());
  EXPECT_EQ(StopCondition::after(0).seconds_left(), 0);
  EXPECT_EQ(StopCondition::after(-5).seconds_left(), 0);

  const StopCondition later = StopCondition::after(3600);
  EXPECT_FALSE(later());
  EXPECT_GT(later.seconds_left(), 3590);
  EXPECT_LE(later.seconds_left(), 3600);

  const StopCondition soon = StopCondition::after(0.005);
  while (!soon()) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(soon.error("planning").code, ErrorCode::kTimeout);
}

TEST(StopCondition, TakesEndlessTimes) {
  for (double seconds : {1e10, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(StopCondition::after(seconds)());
  }
}

TEST(StopCondition, StopsOnRequestAndSaysSo) {
  std::stop_source source;
  const StopCondition stop = StopCondition::after(3600, source.get_token());
  const StopCondition copy = stop.within(10);
  EXPECT_FALSE(stop());
  source.request_stop();
  EXPECT_TRUE(stop() && copy());
  EXPECT_FALSE(stop.timed_out());
  const Error error = copy.error("planning");
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_NE(error.message.find("planning"), std::string::npos);
}

TEST(StopCondition, WithinKeepsTheEarlierDeadline) {
  EXPECT_LE(StopCondition::after(10).within(1000).seconds_left(), 10);
  EXPECT_LE(StopCondition::after(1000).within(10).seconds_left(), 10);
  EXPECT_GT(StopCondition::after(1000).within(500).seconds_left(), 490);
  EXPECT_LE(StopCondition().within(10).seconds_left(), 10);
}

}  // namespace
}  // namespace tandem
