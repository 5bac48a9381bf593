#include "model_promises.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tandem;
  const auto model = robot::parse_urdf(fuzz::text_of(data, size), "input.urdf", "/nowhere");
  if (const robot::Model* read = fuzz::accepted(model)) fuzz::check_model(*read);
  return 0;
}
