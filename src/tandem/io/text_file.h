#pragma once
/// Text files of any length that somebody may hand us. Not part of the public interface.

#include <filesystem>
#include <string>

#include "tandem/core/result.h"

namespace tandem::io {

/// The bytes of a file, at most so many; devices and pipes are read no further than that.
/// @return kNotFound; kIo; kInvalidInput if there are more.
Result<std::string> read_text(const std::filesystem::path& file, std::size_t most_bytes);

/// "FILE:LINE:COLUMN" of a byte of `text`, lines and columns from 1.
std::string place_in(const std::string& file, const std::string& text, std::size_t at);

}  // namespace tandem::io
