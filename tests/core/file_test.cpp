#include "tandem/core/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "temporary_folder.h"

namespace tandem {
namespace {

namespace fs = std::filesystem;

class ReadFile : public testing::Test {
 protected:
  void expect_refused(const fs::path& file, std::uintmax_t most, ErrorCode code,
                      const std::string& says) {
    const auto read = read_file(file, most);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, code);
    EXPECT_EQ(read.error().message.find(file.string() + ": "), 0u) << read.error().message;
    EXPECT_NE(read.error().message.find(says), std::string::npos) << read.error().message;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ReadFile, GivesEveryByte) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += static_cast<char>(i * i % 251);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{65'536}, text.size()}) {
    std::ofstream(folder_ / "a", std::ios::binary) << text.substr(0, size);
    const auto read = read_file(folder_ / "a");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, text.substr(0, size));
  }
}

TEST_F(ReadFile, RefusesWhatIsTooLarge) {
  std::ofstream(folder_ / "a") << "12345";
  EXPECT_TRUE(read_file(folder_ / "a", 5));
  expect_refused(folder_ / "a", 4, ErrorCode::kInvalidInput, "larger than 4 bytes");
  // A sparse file of 1 TiB: who reads it first never ends.
  std::ofstream(folder_ / "b") << "1";
  fs::resize_file(folder_ / "b", std::uintmax_t{1} << 40);
  expect_refused(folder_ / "b", kMostTextBytes, ErrorCode::kInvalidInput, "16777216");
}

TEST_F(ReadFile, BoundsPipesToo) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::uintmax_t most : {3u, 2u}) {
    std::thread writer([&] { std::ofstream(pipe) << "abc"; });
    const auto read = read_file(pipe, most);
    writer.join();
    EXPECT_EQ(read.has_value(), most == 3);
  }
}

TEST_F(ReadFile, NamesWhatIsWrong) {
  expect_refused(folder_ / "none", 9, ErrorCode::kNotFound, "no such file");
  expect_refused(folder_.path(), 9, ErrorCode::kIo, "folder");
}

}  // namespace
}  // namespace tandem
