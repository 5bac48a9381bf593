#include "tandem/server/page.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

#include "tandem/server/base64.h"

namespace tandem::server {

namespace {

constexpr std::string_view kPlace =
    R"(<script id="tandem-data" type="application/json">null</script>)";

/// Inside a script element `<` could end or nest it; in JSON it stands in texts only, where it may
/// be written by number.
std::string without_angles(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

Result<std::string> viewer_page() {
  if (!embedded_page().empty()) return std::string(embedded_page());
  return fail(ErrorCode::kUnsupported,
              "this tandem was built without the viewer's page; run tools/setup, which builds it, "
              "and build tandem again");
}

Result<std::string> read_mesh(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return fail(ErrorCode::kIo, file.string() + ": cannot be read");
  return bytes;
}

const char* mesh_type(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".stl") return "model/stl";
  if (extension == ".dae") return "model/vnd.collada+xml";
  if (extension == ".obj") return "model/obj";
  return "application/octet-stream";
}

Result<std::string> fill_page(std::string_view page, const PageData& data) {
  const std::size_t place = page.find(kPlace);
  if (place == std::string_view::npos) {
    return fail(ErrorCode::kInvalidInput,
                "the viewer's page has no place for data; it is not of this version of tandem");
  }
  std::string meshes;
  for (std::size_t i = 0; i < data.scene.meshes.size(); ++i) {
    const auto bytes = read_mesh(data.scene.meshes[i]);
    if (!bytes) return std::unexpected(bytes.error());
    meshes += (i > 0 ? ",\"" : "\"") + std::to_string(i) +
              "\":\"data:" + mesh_type(data.scene.meshes[i]) + ";base64," + base64(*bytes) + "\"";
  }
  const std::string json = "{\"scene\":" + data.scene.json + ",\"plan\":" + data.plan +
                           ",\"clearance\":" + data.clearance + ",\"meshes\":{" + meshes + "}}";
  const std::size_t null = place + kPlace.find("null");
  std::string filled(page.substr(0, null));
  filled += without_angles(json);
  filled += page.substr(null + 4);
  return filled;
}

}  // namespace tandem::server
