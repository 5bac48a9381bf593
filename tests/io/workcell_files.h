#pragma once
/// A temporary folder with the robot files that workcell tests name.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "temporary_folder.h"
#include "test_data.h"

namespace tandem::test {

inline std::string read_text(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Seven joints, a hand and a finger; links 0 and 5 and the hand have meshes.
inline std::string panda_urdf() {
  std::string text = "<robot name='panda'>\n";
  const auto link = [&](const std::string& name, bool mesh) {
    text += "<link name='" + name + "'><collision><geometry>" +
            (mesh ? "<mesh filename='package://panda/" + name + ".stl'/>"
                  : std::string("<sphere radius='0.05'/>")) +
            "</geometry></collision></link>\n";
  };
  const auto joint = [&](const std::string& name, const std::string& type,
                         const std::string& parent, const std::string& child) {
    text += "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
            "'/><child link='" + child +
            "'/><origin xyz='0.1 0 0.2'/><axis xyz='0 0 1'/>"
            "<limit lower='-3' upper='3' velocity='2' effort='1'/></joint>\n";
  };
  for (int i = 0; i <= 7; ++i) link("panda_link" + std::to_string(i), i == 0 || i == 5);
  for (int i = 1; i <= 7; ++i) {
    joint("panda_joint" + std::to_string(i), "revolute", "panda_link" + std::to_string(i - 1),
          "panda_link" + std::to_string(i));
  }
  link("panda_hand", true);
  link("panda_finger", false);
  joint("panda_hand_joint", "fixed", "panda_link7", "panda_hand");
  joint("panda_finger_joint1", "prismatic", "panda_hand", "panda_finger");
  return text + "</robot>\n";
}

inline std::string panda_srdf() {
  std::string text =
      "<robot name='panda'><group name='panda_arm'>"
      "<chain base_link='panda_link0' tip_link='panda_link7'/></group>\n"
      "<group_state name='ready' group='panda_arm'>";
  for (int i = 1; i <= 7; ++i) {
    text += "<joint name='panda_joint" + std::to_string(i) + "' value='0.1'/>";
  }
  text += "</group_state>\n";
  text += "<disable_collisions link1='panda_link0' link2='panda_link1' reason='Adjacent'/>\n";
  return text + "</robot>\n";
}

inline std::string joint_limits_yaml() {
  std::string text = "joint_limits:\n";
  for (int i = 1; i <= 7; ++i) {
    text += "  panda_joint" + std::to_string(i) +
            ": {has_acceleration_limits: true, max_acceleration: 10}\n";
  }
  return text;
}

/// The YAML blocks of the schema page, in its order.
inline std::vector<std::string> documented_yaml() {
  const std::string page = read_text(source_path("docs/workcell.md"));
  std::vector<std::string> blocks;
  const std::string open = "```yaml\n", close = "```\n";
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
    at += open.size();
    blocks.push_back(page.substr(at, page.find(close, at) - at));
  }
  return blocks;
}

/// A folder with robots/panda.{urdf,srdf,volumes.yaml}, robots/joint_limits.yaml and packages/.
inline void write_robots(const TemporaryFolder& folder) {
  folder.write("robots/panda.urdf", panda_urdf());
  folder.write("robots/panda.srdf", panda_srdf());
  folder.write("robots/panda.volumes.yaml", documented_yaml().at(3));
  folder.write("robots/joint_limits.yaml", joint_limits_yaml());
  std::filesystem::create_directories(folder / "packages");
}

}  // namespace tandem::test
