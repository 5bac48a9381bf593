#pragma once
/// Help with misspelt names.

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// The entry of `known` with the least edit distance to `name`, or "" if none is near (more than a
/// third of the letters differ, at least two).
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "; did you mean 'x'?" or, without a near name, "; known: a, b, c" (at most eight).
std::string name_hint(std::string_view name, const std::vector<std::string>& known);

}  // namespace tandem
