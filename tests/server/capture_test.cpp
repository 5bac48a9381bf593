#include "tandem/server/capture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "small_cell.h"
#include "tandem/io/plan_file.h"
#include "tandem/server/browser.h"

namespace tandem::server {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// TANDEM_CHROMIUM and the folder for temporary files, as they were when the test ends.
class CaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_);
    ::setenv("TMPDIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    EXPECT_TRUE(leftovers().empty()) << leftovers();
    restore("TANDEM_CHROMIUM", chromium_);
    restore("TMPDIR", temporary_);
    fs::remove_all(folder_);
  }

  static std::optional<std::string> value_of(const char* name) {
    const char* value = std::getenv(name);
    return value ? std::optional<std::string>(value) : std::nullopt;
  }
  static void restore(const char* name, const std::optional<std::string>& value) {
    value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
  }

  /// Names of folders that a browser left behind.
  std::string leftovers() const {
    std::string names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename().string().starts_with("tandem-browser")) {
        names += entry.path().string() + " ";
      }
    }
    return names;
  }

  /// A program that stands in for Chromium; its last argument is the address.
  void stand_in(const std::string& script) {
    const fs::path file = folder_ / "stand-in";
    std::ofstream(file) << "#!/bin/bash\n" + script + "\n";
    fs::permissions(file, fs::perms::owner_all);
    ::setenv("TANDEM_CHROMIUM", file.c_str(), 1);
  }

  Result<std::string> picture(const CaptureOptions& options, double seconds) const {
    return capture(cell_, {.scene = describe_scene(*cell_)}, "<html>", options,
                   StopCondition::after(seconds));
  }

  /// Whether a process with `word` in its command line runs.
  static bool runs(const std::string& word) {
    for (const auto& entry : fs::directory_iterator("/proc")) {
      std::ifstream stream(entry.path() / "cmdline");
      std::string line{std::istreambuf_iterator<char>(stream), {}};
      if (line.find(word) != std::string::npos) return true;
    }
    return false;
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  std::optional<std::string> chromium_ = value_of("TANDEM_CHROMIUM");
  std::optional<std::string> temporary_ = value_of("TMPDIR");
  fs::path folder_ = fs::temp_directory_path() / ("tandem-capture" + std::to_string(::getpid()));
};

TEST_F(CaptureTest, TakesWhatThePageSends) {
  stand_in(R"(
base=${!#%%#*}
echo "${!#}" > "$TMPDIR/address"
curl -s -H 'Content-Type: image/png' --data-binary 'the picture' "${base}api/capture"
sleep 60)");
  if (std::system("command -v curl >/dev/null") != 0) GTEST_SKIP() << "no curl";
  const auto png = picture({.time = 0.125, .width = 320, .height = 200}, 30);
  ASSERT_TRUE(png) << png.error().message;
  EXPECT_EQ(*png, "the picture");
  std::ifstream stream(folder_ / "address");
  std::string address;
  stream >> address;
  EXPECT_TRUE(address.ends_with("/#paused&capture=png&t=0.125&width=320&height=200")) << address;
  EXPECT_FALSE(runs((folder_ / "stand-in").string()));
}

TEST_F(CaptureTest, APageThatCannotSaysWhy) {
  if (std::system("command -v curl >/dev/null") != 0) GTEST_SKIP() << "no curl";
  stand_in(R"(
base=${!#%%#*}
curl -s -H 'Content-Type: text/plain' --data-binary 'no WebGL here' "${base}api/capture"
sleep 60)");
  const auto png = picture({}, 30);
  ASSERT_FALSE(png);
  EXPECT_NE(png.error().message.find("no WebGL here"), std::string::npos) << png.error().message;
}

TEST_F(CaptureTest, ABrowserThatHangsIsEndedWithAllItStarted) {
  const std::string mark = "31415" + std::to_string(::getpid());
  stand_in("echo waiting for nothing; sleep " + mark + " & sleep " + mark);
  const auto begin = Clock::now();
  const auto png = picture({}, 0.7);
  ASSERT_FALSE(png);
  EXPECT_EQ(png.error().code, ErrorCode::kTimeout);
  EXPECT_NE(png.error().message.find("package chromium"), std::string::npos);
  EXPECT_NE(png.error().message.find("waiting for nothing"), std::string::npos);
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 10);
  for (int i = 0; i < 100 && runs(mark); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_FALSE(runs(mark));
}

TEST_F(CaptureTest, ABrowserThatEndsIsAnErrorWithItsWords) {
  stand_in("echo cannot open display >&2; exit 3");
  const auto png = picture({}, 30);
  ASSERT_FALSE(png);
  EXPECT_EQ(png.error().code, ErrorCode::kIo);
  EXPECT_NE(png.error().message.find("cannot open display"), std::string::npos);
}

TEST_F(CaptureTest, AStopIsObeyed) {
  stand_in("sleep 60");
  std::stop_source stop;
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.request_stop();
  });
  const auto png = capture(cell_, {.scene = describe_scene(*cell_)}, "<html>", {},
                           StopCondition::after(30, stop.get_token()));
  ASSERT_FALSE(png);
  EXPECT_EQ(png.error().code, ErrorCode::kCancelled);
}

TEST_F(CaptureTest, AMissingBrowserNamesThePackage) {
  ::setenv("TANDEM_CHROMIUM", (folder_ / "none").c_str(), 1);
  auto program = find_chromium();
  ASSERT_FALSE(program);
  EXPECT_EQ(program.error().code, ErrorCode::kNotFound);
  EXPECT_NE(program.error().message.find((folder_ / "none").string()), std::string::npos);
  EXPECT_NE(program.error().message.find("package chromium"), std::string::npos);
  ::unsetenv("TANDEM_CHROMIUM");
  const auto path = value_of("PATH");
  ::setenv("PATH", folder_.c_str(), 1);
  program = find_chromium();
  restore("PATH", path);
  ASSERT_FALSE(program);
  EXPECT_NE(program.error().message.find("package chromium"), std::string::npos);
}

/// Width and height that a PNG states.
std::pair<int, int> png_size(const std::string& bytes) {
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  return {number(16), number(20)};
}

TEST_F(CaptureTest, TheRealPageMakesPictureAndVideo) {
  const auto program = find_chromium();
  if (!program) GTEST_SKIP() << program.error().message;
  const auto page = viewer_page();
  if (!page) GTEST_SKIP() << page.error().message;
  const auto plan = pipeline::plan(cell_, cell_->query("cross"), {.deadline = 20});
  ASSERT_TRUE(plan) << plan.error().message;
  const PageData data{.scene = describe_scene(*cell_),
                      .plan = *io::plan_json(*plan, *cell_, "plan.json"),
                      .clearance = describe_clearance(collision::CompiledCell(cell_),
                                                      plan->trajectory, kClearanceRate)};
  const auto take = [&](const CaptureOptions& options) {
    auto bytes = capture(cell_, data, *page, options, StopCondition::after(180));
    EXPECT_TRUE(bytes) << bytes.error().message;
    return bytes.value_or("");
  };
  const std::string png = take({.time = 0.5, .width = 320, .height = 200});
  ASSERT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
  EXPECT_EQ(png_size(png), std::pair(320, 200));
  const std::string webm =
      take({.kind = CaptureOptions::Kind::kWebm, .width = 160, .height = 96, .fps = 5});
  EXPECT_TRUE(webm.starts_with("\x1a\x45\xdf\xa3"));  // EBML.
  EXPECT_NE(webm.find("webm"), std::string::npos);
  EXPECT_GT(webm.size(), 1000U);
}

}  // namespace
}  // namespace tandem::server
