#pragma once
/// What the readers of geometry files share: bounded bytes, numbers in them, and limits.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tandem/core/result.h"

namespace tandem::geometry::detail {

inline constexpr std::uint64_t kMostBytes = 1'000'000'000;  ///< Of a file.
inline constexpr std::uint64_t kMostItems = 10'000'000;     ///< Points or triangles in it.

/// The content of a file.
/// @return kIo if it is no file or cannot be read, kInvalidInput if it is too large.
Result<std::string> read_bytes(const std::filesystem::path& file);

/// kInvalidInput "the file 'file', where: what".
std::unexpected<Error> malformed(const std::filesystem::path& file, const std::string& where,
                                 const std::string& what);

/// A word from a file for a message: short, printable, in quotes.
std::string in_quotes(std::string_view word);

/// Extension of a file in lower case, with its dot.
std::string extension(const std::filesystem::path& file);

/// A number's type in a binary file.
struct ScalarType {
  enum class Kind { kSigned, kUnsigned, kFloat } kind = Kind::kFloat;
  int size = 4;  ///< [bytes] 1, 2, 4 or 8; of a float 4 or 8.
};

/// The value at `bytes`, which holds at least `type.size` of them.
double decode(const char* bytes, ScalarType type, bool big_endian);

/// A whole word as number ("nan" and "inf" are some), or none.
std::optional<double> to_number(std::string_view word);

/// A whole word as unsigned number, or none.
std::optional<std::uint64_t> to_count(std::string_view word);

/// Words of a text, with the line they stand on.
class Words {
 public:
  /// @param separators  what is between words besides the end of a line.
  explicit Words(std::string_view text, std::string_view separators = " \t\r", int line = 1)
      : text_(text), separators_(separators), line_(line) {}

  /// The next word of the current line; empty at its end.
  std::string_view next_in_line();
  /// The next word of the text; empty at its end.
  std::string_view next();
  /// Goes to the next line. @return false if there is none.
  bool next_line();

  int line() const { return line_; }
  std::size_t offset() const { return at_; }  ///< [bytes] from the beginning of the text.

 private:
  std::string_view text_, separators_;
  std::size_t at_ = 0;
  int line_;
};

}  // namespace tandem::geometry::detail
