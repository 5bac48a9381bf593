#pragma once
/// PCD files.

#include <Eigen/Core>
#include <filesystem>
#include <string_view>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::geometry::detail {

/// The points of a PCD file (ascii, binary, binary_compressed); some may not be finite.
/// @param file  its name, for messages.
/// @return kInvalidInput naming the file with line or byte.
/// Ref: Point Cloud Library, The PCD file format, version 0.7.
Result<std::vector<Eigen::Vector3d>> parse_pcd(std::string_view bytes,
                                               const std::filesystem::path& file);

}  // namespace tandem::geometry::detail
