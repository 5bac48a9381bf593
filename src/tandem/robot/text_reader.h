#pragma once
/// Private to the readers of this folder: how they fail, and text to numbers.

#include <optional>
#include <string>
#include <string_view>

#include "tandem/core/result.h"

namespace tandem::robot {

/// Thrown inside a reader, which returns it as its Result.
struct ReadFailure {
  Error error;
};

/// The number that `text` is as a whole, whatever the locale; none if it is not finite.
std::optional<double> parse_number(std::string_view text);

}  // namespace tandem::robot
