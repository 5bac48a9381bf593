#include "tandem/geometry/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <numeric>
#include <tuple>

#include "tandem/geometry/collada.h"
#include "tandem/geometry/file_bytes.h"
#include "tandem/geometry/obj.h"
#include "tandem/geometry/ply.h"

namespace tandem::geometry {

using Eigen::Vector3d;

namespace {

using Path = std::filesystem::path;

/// Whether a STL is long enough for the triangles that its header announces.
Result<void> check_stl(std::string_view bytes, const Path& file) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;  // [bytes]
  constexpr detail::ScalarType kCount{detail::ScalarType::Kind::kUnsigned, 4};
  const bool text = bytes.starts_with("solid") && bytes.contains("facet");
  if (bytes.size() < kHeader) {
    if (text || (bytes.starts_with("solid") && bytes.contains("endsolid"))) return {};
    return detail::malformed(file, "byte " + std::to_string(bytes.size()),
                             "a binary STL has a header of 84 bytes");
  }
  const auto count = static_cast<std::uint64_t>(detail::decode(&bytes[80], kCount, false));
  const std::uint64_t room = (bytes.size() - kHeader) / kTriangle;
  const bool exact = bytes.size() == kHeader + count * kTriangle;
  if (text && !exact) return {};
  if (count > room) {
    return detail::malformed(file, "byte 80",
                             "the header says " + std::to_string(count) +
                                 " triangles, but the file's " + std::to_string(bytes.size()) +
                                 " bytes hold " + std::to_string(room));
  }
  return {};
}

/// Appends what assimp read of one part. @return what is wrong, or nothing.
std::string append(const aiMesh& part, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  if (part.mNumVertices > 3 * detail::kMostItems || part.mNumFaces > detail::kMostItems ||
      mesh.vertices.size() + part.mNumVertices > 3 * detail::kMostItems ||
      mesh.triangles.size() + part.mNumFaces > detail::kMostItems) {
    return "has more than " + std::to_string(detail::kMostItems) + " triangles";
  }
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& p = part.mVertices[v];
    mesh.vertices.emplace_back(p.x, p.y, p.z);
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;
    std::array<int, 3>& triangle = mesh.triangles.emplace_back();
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) return "has a triangle without its vertices";
      triangle[k] = first + static_cast<int>(face.mIndices[k]);
    }
  }
  return {};
}

Result<TriangleMesh> read_by_assimp(const std::string& bytes, const Path& file) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  // From memory: so nothing else, such as a material file, is opened.
  const aiScene* scene = importer.ReadFileFromMemory(
      bytes.data(), bytes.size(),
      aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType,
      detail::extension(file).c_str() + 1);
  if (!scene) {
    return fail(ErrorCode::kInvalidInput, "the mesh file '" + file.string() +
                                              "' cannot be read: " + importer.GetErrorString());
  }
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    if (const std::string complaint = append(*scene->mMeshes[m], mesh); !complaint.empty()) {
      return fail(ErrorCode::kInvalidInput, "the mesh file '" + file.string() + "' " + complaint);
    }
  }
  return mesh;
}

/// Makes one vertex of all that are equal, and drops those that no triangle has.
void join_vertices(TriangleMesh& mesh) {
  const std::vector<Vector3d> old = std::move(mesh.vertices);
  std::vector<std::size_t> order(old.size()), first(old.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) {
    return std::tuple(old[i].x(), old[i].y(), old[i].z(), i) <
           std::tuple(old[j].x(), old[j].y(), old[j].z(), j);
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && old[order[k]] == old[order[k - 1]];
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  mesh.vertices.clear();
  std::vector<int> number(old.size(), -1);
  for (auto& triangle : mesh.triangles) {
    for (int& i : triangle) {
      const std::size_t one = first[static_cast<std::size_t>(i)];
      if (number[one] < 0) {
        number[one] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(old[one]);
      }
      i = number[one];
    }
  }
}

Result<TriangleMesh> parse(const std::string& bytes, const Path& file) {
  const std::string type = detail::extension(file);
  if (type == ".ply") {
    Result<detail::Ply> ply = detail::parse_ply(bytes, file);
    if (!ply) return std::unexpected(ply.error());
    return TriangleMesh{std::move(ply->vertices), std::move(ply->triangles)};
  }
  if (type == ".obj") return detail::parse_obj(bytes, file);
  if (type == ".dae") return detail::parse_collada(bytes, file);
  if (type == ".stl") {
    if (auto checked = check_stl(bytes, file); !checked) return std::unexpected(checked.error());
  }
  return read_by_assimp(bytes, file);
}

}  // namespace

Result<TriangleMesh> read_mesh(const Path& file, const Vector3d& scale) {
  const std::string name = "the mesh file '" + file.string() + "'", type = detail::extension(file);
  if (type != ".stl" && type != ".obj" && type != ".dae" && type != ".ply") {
    return fail(ErrorCode::kInvalidInput,
                name + " must end in .stl, .obj, .dae or .ply, not '" + type + "'");
  }
  const Result<std::string> bytes = detail::read_bytes(file);
  if (!bytes) return std::unexpected(bytes.error());
  Result<TriangleMesh> mesh = parse(*bytes, file);
  if (!mesh) return mesh;
  if (mesh->triangles.empty()) {
    return fail(ErrorCode::kInvalidInput, name + " holds no triangles");
  }
  for (Vector3d& p : mesh->vertices) {
    p = p.cwiseProduct(scale);
    if (!p.allFinite()) {
      return fail(ErrorCode::kInvalidInput, name + " has a vertex that is not finite; repair it");
    }
  }
  join_vertices(*mesh);
  return mesh;
}

}  // namespace tandem::geometry
