#include "tandem/collision/fcl/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

namespace tandem::collision {

Result<TriangleMesh> read_mesh(const std::string& file, const Eigen::Vector3d& scale) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                  aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (!scene) {
    return fail(ErrorCode::kIo,
                "the mesh file '" + file + "' cannot be read: " + importer.GetErrorString());
  }
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const std::size_t first = mesh.vertices.size();
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      mesh.vertices.push_back(Eigen::Vector3d(p.x, p.y, p.z).cwiseProduct(scale));
      if (!mesh.vertices.back().allFinite()) {
        return fail(ErrorCode::kIo,
                    "the mesh file '" + file + "' has a vertex that is not finite; repair it");
      }
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  if (mesh.triangles.empty()) {
    return fail(ErrorCode::kIo, "the mesh file '" + file + "' holds no triangles");
  }
  return mesh;
}

}  // namespace tandem::collision
