#pragma once
/// Files as text.

#include <cstdint>
#include <filesystem>
#include <string>

#include "tandem/core/result.h"

namespace tandem {

/// The most that is read of a robot description or another file that people write: 16 MiB.
inline constexpr std::uintmax_t kMostTextBytes = std::uintmax_t{16} << 20;

/// The file's whole content; pipes are read too.
/// @param most  bytes; a larger file is refused before it is read.
/// @return kNotFound, kIo for a folder or what cannot be read, kInvalidInput if it is too large;
/// "FILE: what; remedy".
Result<std::string> read_file(const std::filesystem::path& file,
                              std::uintmax_t most = kMostTextBytes);

}  // namespace tandem
