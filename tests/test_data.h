#pragma once
/// Where tests find data, inside the repository and outside of it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace tandem::test {

/// A file or folder of the repository.
inline std::filesystem::path source_path(const std::string& relative) {
  return std::filesystem::path(TANDEM_SOURCE_DIR) / relative;
}

/// A file or folder of the test data: TANDEM_DATA_DIR, else ../shared beside the repository.
inline std::filesystem::path data_path(const std::string& relative) {
  const char* folder = std::getenv("TANDEM_DATA_DIR");
  return (folder ? std::filesystem::path(folder) : source_path("../shared")) / relative;
}

}  // namespace tandem::test

/// Reports the test as skipped where the test data is absent.
#define TANDEM_SKIP_WITHOUT_DATA(relative)                         \
  if (!std::filesystem::exists(tandem::test::data_path(relative))) \
  GTEST_SKIP() << "no test data at " << tandem::test::data_path(relative) << "; set TANDEM_DATA_DIR"
