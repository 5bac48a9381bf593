#include "tandem/geometry/file_bytes.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <fstream>

namespace tandem::geometry::detail {

namespace {

/// The value whose bytes, least first, are in `bits`.
template <class Value, class Bits>
double as(std::uint64_t bits) {
  return static_cast<double>(std::bit_cast<Value>(static_cast<Bits>(bits)));
}

}  // namespace

Result<std::string> read_bytes(const std::filesystem::path& file) {
  const std::string name = "the file '" + file.string() + "'";
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return fail(ErrorCode::kIo, name + " does not exist");
  // A pipe or device may never end.
  if (!std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::kIo, name + " is not a regular file");
  }
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error) return fail(ErrorCode::kIo, name + " cannot be read: " + error.message());
  if (size > kMostBytes) {
    return fail(ErrorCode::kInvalidInput, name + " has " + std::to_string(size) +
                                              " bytes, more than " + std::to_string(kMostBytes) +
                                              "; simplify what is in it");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
    return fail(ErrorCode::kIo, name + " cannot be read");
  }
  return bytes;
}

std::unexpected<Error> malformed(const std::filesystem::path& file, const std::string& where,
                                 const std::string& what) {
  return fail(ErrorCode::kInvalidInput, "the file '" + file.string() + "', " + where + ": " + what);
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kMost = 40;
  std::string text(1, '\'');
  for (const char c : word.substr(0, kMost)) text.push_back(c >= ' ' && c <= '~' ? c : '?');
  text.append(word.size() > kMost ? "...'" : "'");
  return text;
}

std::string extension(const std::filesystem::path& file) {
  std::string name = file.extension().string();
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

double decode(const char* bytes, ScalarType type, bool big_endian) {
  std::uint64_t bits = 0;
  for (int i = 0; i < type.size; ++i) {
    const int place = big_endian ? type.size - 1 - i : i;
    bits |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * place);
  }
  if (type.kind == ScalarType::Kind::kUnsigned) return static_cast<double>(bits);
  if (type.kind == ScalarType::Kind::kFloat) {
    return type.size == 4 ? as<float, std::uint32_t>(bits) : as<double, std::uint64_t>(bits);
  }
  switch (type.size) {
    case 1:
      return as<std::int8_t, std::uint8_t>(bits);
    case 2:
      return as<std::int16_t, std::uint16_t>(bits);
    case 4:
      return as<std::int32_t, std::uint32_t>(bits);
    default:
      return as<std::int64_t, std::uint64_t>(bits);
  }
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is as good as zero; too large is for the caller to leave out.
    return std::strtod(std::string(word).c_str(), nullptr);
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> to_count(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string_view Words::next_in_line() {
  while (at_ < text_.size() && text_[at_] != '\n' && separators_.contains(text_[at_])) ++at_;
  const std::size_t first = at_;
  while (at_ < text_.size() && text_[at_] != '\n' && !separators_.contains(text_[at_])) ++at_;
  return text_.substr(first, at_ - first);
}

std::string_view Words::next() {
  while (true) {
    const std::string_view word = next_in_line();
    if (!word.empty() || !next_line()) return word;
  }
}

bool Words::next_line() {
  const std::size_t end = text_.find('\n', at_);
  if (end == std::string_view::npos || end + 1 >= text_.size()) {
    at_ = text_.size();
    return false;
  }
  at_ = end + 1;
  ++line_;
  return true;
}

}  // namespace tandem::geometry::detail
