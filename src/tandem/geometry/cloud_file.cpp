#include "tandem/geometry/file_bytes.h"
#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/pcd.h"
#include "tandem/geometry/ply.h"

namespace tandem::geometry {

using Eigen::Vector3d;

namespace {

/// Lines of three numbers or more; what follows the third (colours, normals) is not looked at.
Result<std::vector<Vector3d>> parse_xyz(std::string_view bytes, const std::filesystem::path& file) {
  detail::Words words(bytes, " \t\r,;");
  std::vector<Vector3d> points;
  do {
    std::string_view word = words.next_in_line();
    if (word.empty() || word.starts_with('#') || word.starts_with("//")) continue;
    Vector3d& point = points.emplace_back();
    for (int axis = 0; axis < 3; ++axis, word = words.next_in_line()) {
      const auto value = detail::to_number(word);
      if (!value) {
        return detail::malformed(
            file, "line " + std::to_string(words.line()),
            detail::in_quotes(word) + " is not a number; a line holds x y z in metres");
      }
      point[axis] = *value;
    }
    if (points.size() > detail::kMostItems) {
      return detail::malformed(file, "line " + std::to_string(words.line()),
                               "more than " + std::to_string(detail::kMostItems) + " points");
    }
  } while (words.next_line());
  return points;
}

Result<std::vector<Vector3d>> parse(std::string_view bytes, const std::filesystem::path& file) {
  const std::string type = detail::extension(file);
  if (type == ".pcd") return detail::parse_pcd(bytes, file);
  if (type == ".xyz") return parse_xyz(bytes, file);
  Result<detail::Ply> ply = detail::parse_ply(bytes, file);
  if (!ply) return std::unexpected(ply.error());
  return std::move(ply->vertices);
}

}  // namespace

Result<std::vector<Vector3d>> read_cloud(const std::filesystem::path& file) {
  const std::string type = detail::extension(file);
  if (type != ".ply" && type != ".pcd" && type != ".xyz") {
    return fail(ErrorCode::kInvalidInput, "the cloud file '" + file.string() +
                                              "' must end in .ply, .pcd or .xyz, not '" + type +
                                              "'");
  }
  const Result<std::string> bytes = detail::read_bytes(file);
  if (!bytes) return std::unexpected(bytes.error());
  Result<std::vector<Vector3d>> points = parse(*bytes, file);
  if (!points) return points;
  std::erase_if(*points, [](const Vector3d& p) { return !p.allFinite(); });
  if (points->empty()) {
    return fail(ErrorCode::kInvalidInput,
                "the cloud file '" + file.string() + "' has no finite point");
  }
  return points;
}

}  // namespace tandem::geometry
