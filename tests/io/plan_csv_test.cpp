#include <gtest/gtest.h>

#include <charconv>
#include <sstream>

#include "plan_samples.h"
#include "tandem/core/contract.h"
#include "tandem/io/plan_file.h"

namespace tandem::io {
namespace {

using test::TemporaryFolder;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::istringstream text(test::read_text(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) {
    double value = 0;
    const auto end = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    EXPECT_EQ(end.ptr, cell.data() + cell.size()) << cell;
    numbers.push_back(value);
  }
  return numbers;
}

/// Two joints, 1 s.
motion::PiecewiseCubic one_second(double duration = 1.0) {
  motion::PiecewiseCubic::Coefficients c(2, 4);
  c << 0.1, 0.2, 0.3, 0.4, -1, -0.1, 1.0 / 3, 2;
  return *motion::PiecewiseCubic::make({0, duration}, {c});
}

TEST(SaveCsv, RowsHoldTheMotionExactly) {
  const TemporaryFolder folder;
  const auto motion = one_second();
  ASSERT_TRUE(save_csv(folder / "m.csv", motion, {"a", "b"}, 30));
  const auto lines = lines_of(folder / "m.csv");
  EXPECT_EQ(lines[0], "t,a.q,a.qd,a.qdd,b.q,b.qd,b.qdd");
  ASSERT_EQ(lines.size(), 32u);  // Header, 30 samples from 0 on, and the end.
  for (std::size_t k = 0; k < 31; ++k) {
    const auto row = numbers_of(lines[k + 1]);
    ASSERT_EQ(row.size(), 7u);
    EXPECT_EQ(row[0], static_cast<double>(k) / 30);
    const auto state = motion.at(row[0]);
    EXPECT_EQ(row, (std::vector{row[0], state.q[0], state.qd[0], state.qdd[0], state.q[1],
                                state.qd[1], state.qdd[1]}));
  }
}

TEST(SaveCsv, LastRowIsTheEndAndTimesIncrease) {
  const TemporaryFolder folder;
  for (const double duration : {0.0004, 0.1, 0.25, 1.0 / 3, 0.7, 1.0000001, 2.0 + 1e-13}) {
    for (const double rate : {0.5, 3.0, 10.0, 1000.0}) {
      ASSERT_TRUE(save_csv(folder / "m.csv", one_second(duration), {"a", "b"}, rate, true));
      const auto lines = lines_of(folder / "m.csv");
      double before = -1;
      for (std::size_t k = 1; k < lines.size(); ++k) {
        const double t = numbers_of(lines[k])[0];
        EXPECT_GT(t, before + 1e-9) << duration << " s at " << rate << " Hz";
        EXPECT_LE(t - std::max(before, 0.0), 1 / rate + 1e-9);
        before = t;
      }
      EXPECT_EQ(before, duration);
    }
  }
}

TEST(SaveCsv, QuotesNames) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_csv(folder / "m.csv", one_second(), {"a,b", "c\"d"}, 1));
  EXPECT_EQ(lines_of(folder / "m.csv")[0],
            "t,\"a,b.q\",\"a,b.qd\",\"a,b.qdd\",\"c\"\"d.q\",\"c\"\"d.qd\",\"c\"\"d.qdd\"");
}

TEST(SaveCsv, RefusesRatesAndFiles) {
  const TemporaryFolder folder;
  for (const double rate : {0.0, -1.0, 1e7, std::nan(""), HUGE_VAL}) {
    const auto saved = save_csv(folder / "m.csv", one_second(), {"a", "b"}, rate);
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(saved.error().message.find("rate"), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "m.csv"));
  ASSERT_TRUE(save_csv(folder / "m.csv", one_second(), {"a", "b"}, 1));
  EXPECT_FALSE(save_csv(folder / "m.csv", one_second(), {"a", "b"}, 1));
  EXPECT_THROW((void)save_csv(folder / "n.csv", one_second(), {"a"}, 1), ContractViolation);
}

}  // namespace
}  // namespace tandem::io
