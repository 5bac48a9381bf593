#pragma once
/// Result<T>: a value, or the reason there is none.

#include <expected>
#include <string>
#include <utility>

namespace tandem {

/// Kind of an expected failure. The message says the rest.
enum class ErrorCode {
  kInvalidInput,  ///< A file, option or value that cannot be used as given.
  kNotFound,      ///< A name or file that does not exist.
  kIo,            ///< The operating system refused to read or write.
  kUnsupported,   ///< Well-formed input that tandem does not handle.
  kInfeasible,    ///< Start or goal outside limits, in collision or out of reach.
  kNoPath,        ///< The path planner found no path.
  kCollision,     ///< The executed curve touches something, or cannot be certified.
  kLimits,        ///< The executed curve breaks a joint limit.
  kCoordination,  ///< The arms' motions cannot be coordinated.
  kTimeout,       ///< The deadline passed.
  kCancelled,     ///< A stop was requested.
};

/// Short stable name for files and logs: "invalid_input", "no_path", ...
const char* to_string(ErrorCode code);

struct Error {
  ErrorCode code;
  std::string message;  ///< For a person: what, where, which value, what to do.
};

template <class T>
using Result = std::expected<T, Error>;

/// Shorthand for `std::unexpected(Error{code, message})`.
inline std::unexpected<Error> fail(ErrorCode code, std::string message) {
  return std::unexpected(Error{code, std::move(message)});
}

}  // namespace tandem
