#include "tandem/core/names.h"
#include "tandem/io/shapes_yaml.h"
#include "tandem/io/workcell_yaml.h"

namespace tandem::io {

Result<std::map<std::string, std::vector<geometry::Shape>>> load_volumes(
    const std::filesystem::path& file, const robot::Model& model) {
  return read_yaml(file, [&](const YamlNode& root) {
    const NamedPaths paths(file.parent_path(), robot::PackagePath::with_environment());
    root.only({"links"});
    std::vector<std::string> known;
    for (const robot::Link& link : model.links()) known.push_back(link.name);
    std::map<std::string, std::vector<geometry::Shape>> volumes;
    for (const auto& [link, shapes] : root.at("links").entries()) {
      if (model.find_link(link) < 0) {
        root.at("links").refuse_key(
            link,
            "robot '" + model.name() + "' has no link '" + link + "'" + name_hint(link, known),
            ErrorCode::kNotFound);
      }
      volumes[link] = read_shapes(*shapes, paths);
    }
    return volumes;
  });
}

}  // namespace tandem::io
