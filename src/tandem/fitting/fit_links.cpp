#include <algorithm>
#include <optional>

#include "tandem/core/names.h"
#include "tandem/fitting/fit.h"

namespace tandem::fitting {

namespace {

bool is_equal(const robot::Geometry& a, const robot::Geometry& b) {
  if (a.shape.index() != b.shape.index() || a.X_LG.matrix() != b.X_LG.matrix()) return false;
  if (const auto* mesh = std::get_if<robot::MeshGeometry>(&a.shape)) {
    const auto& other = std::get<robot::MeshGeometry>(b.shape);
    return !mesh->path.empty() && mesh->path == other.path && mesh->scale == other.scale;
  }
  if (const auto* box = std::get_if<robot::BoxGeometry>(&a.shape)) {
    return box->size == std::get<robot::BoxGeometry>(b.shape).size;
  }
  if (const auto* sphere = std::get_if<robot::SphereGeometry>(&a.shape)) {
    return sphere->radius == std::get<robot::SphereGeometry>(b.shape).radius;
  }
  const auto& one = std::get<robot::CylinderGeometry>(a.shape);
  const auto& two = std::get<robot::CylinderGeometry>(b.shape);
  return one.radius == two.radius && one.length == two.length;
}

bool is_equal(const robot::Link& a, const robot::Link& b) {
  return std::ranges::equal(a.collision, b.collision,
                            [](const auto& x, const auto& y) { return is_equal(x, y); });
}

Result<std::vector<const robot::Link*>> selected(const robot::Model& model,
                                                 const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const robot::Link& link : model.links()) known.push_back(link.name);
  for (const std::string& name : names) {
    if (model.find_link(name) >= 0) continue;
    return fail(ErrorCode::kNotFound,
                "robot '" + model.name() + "' has no link '" + name + "'" + name_hint(name, known));
  }
  std::vector<const robot::Link*> links;
  for (const robot::Link& link : model.links()) {
    const bool named = std::ranges::find(names, link.name) != names.end();
    if (named || (names.empty() && !link.collision.empty())) links.push_back(&link);
  }
  if (!links.empty()) return links;
  return fail(ErrorCode::kInvalidInput, "robot '" + model.name() +
                                            "' has no link with collision geometry to fit volumes "
                                            "to");
}

}  // namespace

Result<std::vector<LinkFit>> fit_links(
    const robot::Model& model, const std::vector<std::string>& links, const FitOptions& options,
    const StopCondition& stop, const std::function<void(const std::string&, int, int)>& progress) {
  const auto chosen = selected(model, links);
  if (!chosen) return std::unexpected(chosen.error());
  const std::size_t count = chosen->size();
  // The link with equal geometry that comes first; meshes that were not found equal nothing.
  std::vector<std::size_t> first(count);
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (first[i] < i && !is_equal(*(*chosen)[first[i]], *(*chosen)[i])) ++first[i];
    left += first[i] == i;
  }
  std::vector<LinkFit> fits;
  for (std::size_t i = 0; i < count; ++i) {
    const robot::Link& link = *(*chosen)[i];
    if (progress) progress(link.name, static_cast<int>(i) + 1, static_cast<int>(count));
    if (first[i] != i) {
      fits.push_back(fits[first[i]]);
      fits.back().link = link.name;
      fits.back().seconds = 0;
      continue;
    }
    const double share = stop.seconds_left() / static_cast<double>(left--);
    auto fit = fit_link(link, options, stop.within(share));
    if (!fit) return std::unexpected(fit.error());
    fits.push_back(*std::move(fit));
  }
  return fits;
}

}  // namespace tandem::fitting
