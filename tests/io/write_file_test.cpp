#include <gtest/gtest.h>

#include "plan_samples.h"
#include "tandem/io/plan_file.h"

namespace tandem::io {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TemporaryFolder;

std::size_t entries(const TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path()), {}));
}

TEST(WriteFile, WritesAllBytesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string text = std::string(3'000'000, 'x') + std::string("\0\n", 2);
  ASSERT_TRUE(write_file(folder / "a", text, false));
  EXPECT_EQ(read_text(folder / "a"), text);
  EXPECT_EQ(entries(folder), 1u);
}

TEST(WriteFile, KeepsTheOldFileUnlessAsked) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old", false));
  const auto refused = write_file(folder / "a", "new", false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(read_text(folder / "a"), "old");
  ASSERT_TRUE(write_file(folder / "a", "new", true));
  EXPECT_EQ(read_text(folder / "a"), "new");
  EXPECT_EQ(entries(folder), 1u);
}

TEST(WriteFile, WritesThroughALink) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "real", "old", false));
  fs::create_symlink("real", folder / "link");
  ASSERT_TRUE(write_file(folder / "link", "new", true));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_text(folder / "real"), "new");
}

TEST(WriteFile, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto nowhere = write_file(folder / "no/such/a", "x", false);
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kIo);
  EXPECT_NE(nowhere.error().message.find("create it first"), std::string::npos);
  for (const fs::path& target : {folder.path(), fs::path("/dev/null")}) {
    const auto refused = write_file(target, "x", true);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(refused.error().message.find("not a regular file"), std::string::npos);
  }
  EXPECT_TRUE(fs::exists("/dev/null"));
}

TEST(WriteFile, UnwritableFolderIsAnIoError) {
  if (::geteuid() == 0) {
    const auto refused = write_file("/proc/tandem_test", "x", false);  // Root may write elsewhere.
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kIo);
    return;
  }
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  const auto refused = write_file(folder / "a", "x", false);
  fs::permissions(folder.path(), fs::perms::owner_all);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace tandem::io
