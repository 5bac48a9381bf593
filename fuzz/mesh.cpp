// The first byte says which format the others have: s(tl), o(bj), p(ly) or d(ae).
#include <algorithm>

#include "support.h"
#include "tandem/geometry/mesh_file.h"

namespace tandem::fuzz {
namespace {

void check(const geometry::TriangleMesh& mesh) {
  require(!mesh.triangles.empty(), "meshes have triangles");
  std::vector<bool> used(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const int i : triangle) {
      require(i >= 0 && static_cast<std::size_t>(i) < mesh.vertices.size(), "vertices exist");
      used[static_cast<std::size_t>(i)] = true;
    }
  }
  require(std::ranges::all_of(used, [](bool one) { return one; }), "vertices have triangles");
  for (const Eigen::Vector3d& p : mesh.vertices) require(p.allFinite(), "vertices are finite");
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::Folder folder;
  const std::string_view kinds = "sopd";
  const char* const names[] = {"input.stl", "input.obj", "input.ply", "input.dae"};
  const std::size_t kind = size == 0 ? kinds.npos : kinds.find(static_cast<char>(data[0]));
  if (kind == kinds.npos) return -1;
  const auto file = folder.write(names[kind], fuzz::text_of(data + 1, size - 1));
  const auto mesh = geometry::read_mesh(file);
  if (const auto* read = fuzz::accepted(mesh)) fuzz::check(*read);
  return 0;
}
