#include "tandem/core/file.h"

#include <fstream>

namespace tandem {

namespace {

std::unexpected<Error> too_large(const std::filesystem::path& file, std::uintmax_t most) {
  return fail(ErrorCode::kInvalidInput, file.string() + ": is larger than " + std::to_string(most) +
                                            " bytes, the most that is read of such a file; is it "
                                            "the right one?");
}

}  // namespace

Result<std::string> read_file(const std::filesystem::path& file, std::uintmax_t most) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    return fail(ErrorCode::kNotFound, file.string() + ": no such file");
  }
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::kIo, file.string() + ": is a folder; name the file in it");
  }
  if (std::filesystem::is_regular_file(status)) {
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error && size > most) return too_large(file, most);
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  char block[1 << 16];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(stream.gcount()));
    // What has no size beforehand, a pipe, must not fill the memory either.
    if (text.size() > most) return too_large(file, most);
  }
  if (!stream.is_open() || stream.bad()) {
    return fail(ErrorCode::kIo, file.string() + ": cannot be read; check its permissions");
  }
  return text;
}

}  // namespace tandem
