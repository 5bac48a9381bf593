#pragma once
/// The viewer's page: one HTML file that shows what it carries or what it is served.

#include <string>
#include <string_view>

#include "tandem/core/result.h"
#include "tandem/server/scene.h"

namespace tandem::server {

/// The page that this build carries; empty if viewer/ was not built before it.
std::string_view embedded_page();

/// embedded_page(), or kUnsupported saying how to build it.
Result<std::string> viewer_page();

/// What a page shows: scene, plan file and clearance samples, as JSON; "null" where there is none.
struct PageData {
  Scene scene;
  std::string plan = "null";
  std::string clearance = "null";
};

/// The page with its data and meshes inside: it needs no server and no network.
/// @return kIo for a mesh that cannot be read, kInvalidInput for a page without a place for data.
Result<std::string> fill_page(std::string_view page, const PageData& data);

/// The bytes of a mesh file.   @return kIo naming the file.
Result<std::string> read_mesh(const std::filesystem::path& file);
/// Its type by its name: "model/stl", "model/vnd.collada+xml", ...
const char* mesh_type(const std::filesystem::path& file);

}  // namespace tandem::server
