#include "shape_promises.h"
#include "tandem/io/workcell_yaml.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  static const fuzz::Folder folder;
  const auto file = folder.write("volumes.yaml", fuzz::text_of(data, size));
  const auto volumes = io::load_volumes(file, fuzz::arm_model());
  const auto* read = fuzz::accepted(volumes);
  if (!read) return 0;
  for (const auto& [link, shapes] : *read) {
    fuzz::require(fuzz::arm_model().find_link(link) >= 0, "volumes belong to links of the robot");
    for (const geometry::Shape& shape : shapes) fuzz::check_shape(shape);
  }
  return 0;
}
