#pragma once
/// Names of report fields in files: one list for plan files and bench results.

#include <array>
#include <utility>

#include "tandem/pipeline/report.h"

namespace tandem::io {

template <class Owner, class Value>
using Key = std::pair<const char*, Value Owner::*>;

/// Of `times_ms`; values in the report are seconds.
inline constexpr std::array<Key<pipeline::ModuleTimes, double>, 8> kTimeKeys = {{
    {"path_planning", &pipeline::ModuleTimes::path_planning},
    {"simplification", &pipeline::ModuleTimes::simplification},
    {"plpp", &pipeline::ModuleTimes::plpp},
    {"trajectory", &pipeline::ModuleTimes::trajectory},
    {"coordination", &pipeline::ModuleTimes::coordination},
    {"certificate", &pipeline::ModuleTimes::certificate},
    {"distance", &pipeline::ModuleTimes::distance},
    {"total", &pipeline::ModuleTimes::total},
}};

inline constexpr std::array<Key<pipeline::ModuleCounts, long>, 6> kCountKeys = {{
    {"state_checks", &pipeline::ModuleCounts::state_checks},
    {"edge_checks", &pipeline::ModuleCounts::edge_checks},
    {"certificate_evaluations", &pipeline::ModuleCounts::certificate_evaluations},
    {"shortenings", &pipeline::ModuleCounts::shortenings},
    {"timings", &pipeline::ModuleCounts::timings},
    {"repairs", &pipeline::ModuleCounts::repairs},
}};

inline constexpr std::array<Key<pipeline::ArmLengths, double>, 5> kLengthKeys = {{
    {"f_before", &pipeline::ArmLengths::f_before},
    {"f_after", &pipeline::ArmLengths::f_after},
    {"L_before", &pipeline::ArmLengths::L_before},
    {"L_after", &pipeline::ArmLengths::L_after},
    {"joint_length", &pipeline::ArmLengths::joint_length},
}};

}  // namespace tandem::io
