#pragma once
/// Private to the readers of this folder: files to text, and text to numbers.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tandem/core/result.h"

namespace tandem::robot {

/// Thrown inside a reader, which returns it as its Result.
struct ReadFailure {
  Error error;
};

/// The file's content; kNotFound or kIo.
Result<std::string> read_text(const std::filesystem::path& file);

/// The number that `text` is as a whole, whatever the locale; none if it is not finite.
std::optional<double> parse_number(std::string_view text);

}  // namespace tandem::robot
