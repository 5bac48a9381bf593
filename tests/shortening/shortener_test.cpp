#include "conformance/shortener_conformance.h"
#include "tandem/shortening/nlopt/slsqp_shortener.h"

namespace tandem::shortening {
namespace {

ShorteningOptions by_differences() {
  ShorteningOptions options;
  options.difference_step = 1e-6;
  return options;
}

ShorteningOptions with_few_edges() {
  ShorteningOptions options;
  options.edges = 5;
  return options;
}

INSTANTIATE_TEST_SUITE_P(
    All, ShortenerConformance,
    testing::Values(ShortenerCase{"structured", {}, &make_structured_shortener},
                    ShortenerCase{"structured_with_few_edges", with_few_edges(),
                                  &make_structured_shortener},
                    ShortenerCase{"slsqp", {}, &make_slsqp_shortener},
                    ShortenerCase{"slsqp_by_differences", by_differences(), &make_slsqp_shortener}),
    case_name<ShortenerCase>);

}  // namespace
}  // namespace tandem::shortening
