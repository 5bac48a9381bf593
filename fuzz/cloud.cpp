// The first byte says which format the others have: p(ly), c (PCD) or x(yz).
#include "support.h"
#include "tandem/geometry/mesh_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::Folder folder;
  const std::string_view kinds = "pcx";
  const char* const names[] = {"input.ply", "input.pcd", "input.xyz"};
  const std::size_t kind = size == 0 ? kinds.npos : kinds.find(static_cast<char>(data[0]));
  if (kind == kinds.npos) return -1;
  const auto file = folder.write(names[kind], fuzz::text_of(data + 1, size - 1));
  const auto cloud = geometry::read_cloud(file);
  const auto* points = fuzz::accepted(cloud);
  if (!points) return 0;
  fuzz::require(!points->empty(), "clouds have points");
  for (const Eigen::Vector3d& p : *points) fuzz::require(p.allFinite(), "points are finite");
  return 0;
}
