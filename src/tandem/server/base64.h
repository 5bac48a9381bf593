#pragma once
/// Bytes as text. Ref: RFC 4648, section 4.

#include <string>
#include <string_view>

namespace tandem::server {

std::string base64(std::string_view bytes);

}  // namespace tandem::server
