#include "tandem/robot/text_reader.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

namespace tandem::robot {

Result<std::string> read_text(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    return fail(ErrorCode::kNotFound, file.string() + ": no such file");
  }
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::kIo, file.string() + ": is a folder, expected a file");
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  // An empty file sets the fail bit of `text`; only the stream says whether reading worked.
  if (!stream.is_open() || stream.bad()) {
    return fail(ErrorCode::kIo, file.string() + ": cannot be read; check its permissions");
  }
  return std::move(text).str();
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace tandem::robot
