#pragma once
/// Tool paths of plans, as a picture.

#include <string_view>

#include "tandem/tandem.h"

namespace tandem {

/// Prints an SVG with the tools' paths of a query through the phases of planning.
/// @return a program's exit code.
int print_traces(const std::shared_ptr<const world::Workcell>& cell, std::string_view query);

}  // namespace tandem
