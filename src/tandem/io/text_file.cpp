#include "tandem/io/text_file.h"

#include <algorithm>
#include <fstream>
#include <vector>

namespace tandem::io {

Result<std::string> read_text(const std::filesystem::path& file, std::size_t most_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    return fail(ErrorCode::kNotFound, file.string() + ": does not exist");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file, error)) {
    return fail(ErrorCode::kIo, file.string() + ": cannot be read; is it a file you may read?");
  }
  std::string text;
  std::vector<char> block(std::size_t{1} << 16);
  while (stream && text.size() <= most_bytes) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (text.size() > most_bytes) {
    return fail(ErrorCode::kInvalidInput,
                file.string() + ": is larger than " + std::to_string(most_bytes >> 20) +
                    " MiB, more than tandem reads of such a file; split it");
  }
  return text;
}

std::string place_in(const std::string& file, const std::string& text, std::size_t at) {
  at = std::min(at, text.size());
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(at);
  const auto line = 1 + std::count(text.begin(), end, '\n');
  const std::size_t newline = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t column = newline == std::string::npos ? at + 1 : at - newline;
  return file + ":" + std::to_string(line) + ":" + std::to_string(column);
}

}  // namespace tandem::io
