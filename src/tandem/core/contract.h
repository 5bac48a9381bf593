#pragma once
/// Contract checks: a caller's bug throws, an expected failure is a Result.

#include <source_location>
#include <stdexcept>
#include <string>

namespace tandem {

/// Thrown where a caller broke a documented precondition.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws ContractViolation with file and line unless `condition` holds. Cheap enough for release
/// builds; inner loops check once outside.
inline void expects(bool condition, const char* what,
                    std::source_location where = std::source_location::current()) {
  if (condition) return;
  throw ContractViolation(std::string(where.file_name()) + ":" + std::to_string(where.line()) +
                          ": " + what);
}

}  // namespace tandem
