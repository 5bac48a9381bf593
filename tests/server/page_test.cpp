#include "tandem/server/page.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "small_cell.h"
#include "tandem/core/rng.h"

namespace tandem::server {
namespace {

using nlohmann::json;

constexpr const char* kPage =
    "<!doctype html><body><script id=\"tandem-data\" "
    "type=\"application/json\">null</script><p>null</p></body>";

/// What a browser takes for the content of the page's data element: the HTML standard's "script
/// data" and "script data double escaped" states.
std::string data_of(const std::string& page) {
  const std::string open = "<script id=\"tandem-data\" type=\"application/json\">";
  const std::size_t begin = page.find(open) + open.size();
  const std::size_t end = page.find("</script", begin);
  const std::string content = page.substr(begin, end - begin);
  EXPECT_EQ(content.find("<!--"), std::string::npos);
  return content;
}

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  EXPECT_EQ(text.size() % 4, 0U);
  return bytes;
}

class PageTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem-page-test" + std::to_string(::getpid()));
};

TEST_F(PageTest, CarriesSceneAndPlan) {
  PageData data{.scene = describe_scene(*test::small_cell())};
  data.plan = R"({"query":"a"})";
  const auto page = fill_page(kPage, data);
  ASSERT_TRUE(page) << page.error().message;
  const json carried = json::parse(data_of(*page));
  EXPECT_EQ(carried["scene"], json::parse(data.scene.json));
  EXPECT_EQ(carried["plan"], json({{"query", "a"}}));
  EXPECT_TRUE(carried["clearance"].is_null());
  EXPECT_TRUE(carried["meshes"].empty());
  EXPECT_TRUE(page->ends_with("</script><p>null</p></body>"));
}

TEST_F(PageTest, NamesCannotEndTheElementTheyStandIn) {
  for (const char* name : {"</script><script>alert(1)</script>", "</SCRIPT >", "<!--<script>",
                           "<!-- <script> --> </script>", "a < b", "\\u003c/script>"}) {
    world::WorkcellSpec spec = test::small_cell_spec();
    spec.name = name;
    const auto cell = world::Workcell::make(std::move(spec));
    ASSERT_TRUE(cell);
    const auto page = fill_page(kPage, {.scene = describe_scene(**cell)});
    ASSERT_TRUE(page);
    EXPECT_EQ(data_of(*page).find('<'), std::string::npos);
    EXPECT_EQ(json::parse(data_of(*page))["scene"]["name"], name);
  }
}

TEST_F(PageTest, MeshesComeBackByteForByte) {
  Rng rng(3);
  PageData data{.scene = describe_scene(*test::small_cell())};
  std::vector<std::string> contents;
  for (std::size_t size = 0; size < 40; ++size) {
    std::string bytes;
    while (bytes.size() < size) bytes += static_cast<char>(rng.index(256));
    contents.push_back(bytes);
    data.scene.meshes.push_back(file(std::to_string(size) + ".stl", bytes));
  }
  const auto page = fill_page(kPage, data);
  ASSERT_TRUE(page) << page.error().message;
  const json meshes = json::parse(data_of(*page))["meshes"];
  ASSERT_EQ(meshes.size(), contents.size());
  const std::string prefix = "data:model/stl;base64,";
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const std::string url = meshes[std::to_string(i)];
    ASSERT_TRUE(url.starts_with(prefix));
    EXPECT_EQ(from_base64(url.substr(prefix.size())), contents[i]) << i;
  }
}

TEST_F(PageTest, WhatCannotBeDoneIsSaid) {
  PageData data{.scene = describe_scene(*test::small_cell())};
  const auto strange = fill_page("<html></html>", data);
  ASSERT_FALSE(strange);
  EXPECT_EQ(strange.error().code, ErrorCode::kInvalidInput);
  data.scene.meshes = {folder_ / "gone.dae"};
  const auto gone = fill_page(kPage, data);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::kIo);
  EXPECT_NE(gone.error().message.find("gone.dae"), std::string::npos);
}

TEST_F(PageTest, TypesOfMeshesAreByName) {
  EXPECT_STREQ(mesh_type("a/b.DAE"), "model/vnd.collada+xml");
  EXPECT_STREQ(mesh_type("b.stl"), "model/stl");
  EXPECT_STREQ(mesh_type("b.Obj"), "model/obj");
  EXPECT_STREQ(mesh_type("b"), "application/octet-stream");
}

TEST(EmbeddedPage, NeedsNoNetworkAndHasAPlaceForData) {
  const auto page = viewer_page();
  if (!page) {
    EXPECT_NE(page.error().message.find("tools/setup"), std::string::npos);
    GTEST_SKIP() << page.error().message;
  }
  const auto filled = fill_page(*page, {.scene = describe_scene(*test::small_cell())});
  ASSERT_TRUE(filled) << filled.error().message;
  EXPECT_EQ(json::parse(data_of(*filled))["scene"]["name"], "small");
  // Addresses in comments and names of XML spaces are no requests; elements and styles that load
  // something are.
  const std::regex loads(R"((src|href|action)\s*=\s*["']?(https?:)?//|url\(\s*["']?(https?:)?//)");
  EXPECT_FALSE(std::regex_search(page->begin(), page->end(), loads));
  EXPECT_EQ(page->find("<script src"), std::string::npos);
  EXPECT_EQ(page->find("<link rel=\"stylesheet\""), std::string::npos);
}

}  // namespace
}  // namespace tandem::server
