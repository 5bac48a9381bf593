#include "tandem/io/moveit_scene.h"

#include "shape_promises.h"

namespace tandem::fuzz {
namespace {

void check(const io::MoveitScene& scene) {
  for (const world::ObstacleSpec& obstacle : scene.obstacles) {
    require(!obstacle.shapes_W.empty() || !obstacle.surfaces_W.empty(), "obstacles have shapes");
    for (const geometry::Shape& shape : obstacle.shapes_W) check_shape(shape);
    for (const geometry::PlacedSurface& placed : obstacle.surfaces_W) {
      require(placed.X_FS.matrix().allFinite(), "surfaces have a place");
      require(placed.surface && placed.surface->piece_count() > 0, "surfaces have pieces");
    }
  }
  const auto written = io::moveit_scene_text(scene.name, scene.obstacles);
  const auto* text = accepted(written);
  if (!text) return;
  const auto again = io::parse_moveit_scene(text->text, "written.scene");
  require(again && again->obstacles.size() == scene.obstacles.size(),
          "what is written can be read again");
}

}  // namespace
}  // namespace tandem::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  const auto scene = io::parse_moveit_scene(fuzz::text_of(data, size), "input.scene");
  if (const auto* read = fuzz::accepted(scene)) fuzz::check(*read);
  return 0;
}
