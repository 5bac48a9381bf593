#include "model_promises.h"
#include "shape_promises.h"
#include "tandem/io/workcell_yaml.h"

namespace tandem::fuzz {
namespace {

/// A folder with the files that the corpus names.
struct CellFolder {
  CellFolder() {
    folder.write("arm.urdf", kArmUrdf);
    folder.write("arm.srdf", kArmSrdf);
    folder.write("limits.yaml", kArmLimits);
    folder.write("volumes.yaml", "volumes: {hand: [{sphere: {radius: 0.05}}]}\n");
    folder.write("block.obj",
                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    folder.write("block.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  }
  Folder folder;
};

void check(const world::Workcell& cell) {
  check_model(cell.model());
  int dof = 0;
  for (const world::Arm& arm : cell.arms()) {
    check_pose(arm.X_LE);
    require(arm.offset == dof, "arms follow each other in q");
    dof += arm.dof();
  }
  require(dof == cell.dof(), "q holds the joints of all arms");
  require(cell.lower().allFinite() && cell.upper().allFinite(), "joints of arms have limits");
  for (const robot::JointLimits& limits : cell.limits()) {
    check_limits(limits);
    require(std::isfinite(limits.velocity) && std::isfinite(limits.acceleration),
            "joints of arms have velocity and acceleration limits");
  }
  for (const world::Body& body : cell.bodies()) {
    for (const geometry::Shape& shape : body.shapes_L) check_shape(shape);
    require(std::isfinite(body.padding), "padding is finite");
  }
  const int bodies = static_cast<int>(cell.bodies().size());
  for (const world::BodyPair& pair : cell.pairs()) {
    require(0 <= pair.a && pair.a < pair.b && pair.b < bodies && pair.moved_by != 0,
            "pairs are of two bodies that move");
  }
  for (const world::Query& query : cell.queries()) {
    require(query.start.size() == cell.arms().size() && query.goal.size() == cell.arms().size(),
            "queries have one entry per arm");
  }
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::CellFolder cell;
  const auto file = cell.folder.write("cell.yaml", fuzz::text_of(data, size));
  const auto loaded = io::load_workcell(file);
  if (const auto* read = fuzz::accepted(loaded)) fuzz::check(**read);
  return 0;
}
