#pragma once
/// What the fuzz targets share. A target is one function that reads any bytes and says if a promise
/// of its parser is broken.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tandem/core/result.h"
#include "tandem/robot/urdf.h"

/// The entry that libFuzzer and replay_main.cpp call.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tandem::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return size == 0 ? std::string() : std::string(reinterpret_cast<const char*>(data), size);
}

/// Ends the program as a crash does, which is how a finding is told.
inline void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "the parser broke a promise: %s\n", promise);
  std::abort();
}

/// The value of an accepted input; nullptr if it was refused, with words.
template <class T>
const T* accepted(const Result<T>& result) {
  if (result) return &*result;
  require(!result.error().message.empty(), "a refusal says why");
  return nullptr;
}

/// A temporary folder, removed at the end of the program.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "tandem_fuzz_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream stream(path_ / name, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    require(stream.good(), "the temporary folder can be written to");
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Three joints that turn, one that slides and one that follows it.
inline constexpr const char* kArmUrdf = R"(<robot name="arm">
<link name="base"/>
<link name="upper"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="fore"><collision><geometry><box size="0.3 0.05 0.05"/></geometry></collision></link>
<link name="hand"/><link name="left_finger"/><link name="right_finger"/>
<joint name="yaw" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="2"/></joint>
<joint name="lift" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
<origin xyz="0.3 0 0"/><limit lower="-2" upper="2" effort="1" velocity="2"/></joint>
<joint name="roll" type="continuous"><parent link="fore"/><child link="hand"/><axis xyz="1 0 0"/>
<origin xyz="0.3 0 0"/><limit effort="1" velocity="2"/></joint>
<joint name="grip" type="prismatic"><parent link="hand"/><child link="left_finger"/>
<axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>
<joint name="mate" type="prismatic"><parent link="hand"/><child link="right_finger"/>
<axis xyz="0 -1 0"/><limit lower="0" upper="0.04" effort="1" velocity="1"/><mimic joint="grip"/>
</joint></robot>)";

inline constexpr const char* kArmSrdf = R"(<robot name="arm">
<group name="arm"><chain base_link="base" tip_link="hand"/></group>
<group_state name="up" group="arm"><joint name="yaw" value="0"/><joint name="lift" value="-1"/>
<joint name="roll" value="0"/></group_state>
<disable_collisions link1="upper" link2="fore" reason="Adjacent"/></robot>)";

inline constexpr const char* kArmLimits =
    "joint_limits:\n"
    "  yaw: {has_acceleration_limits: true, max_acceleration: 5}\n"
    "  lift: {has_acceleration_limits: true, max_acceleration: 5}\n"
    "  roll: {has_acceleration_limits: true, max_acceleration: 5}\n";

inline const robot::Model& arm_model() {
  static const robot::Model model = *robot::parse_urdf(kArmUrdf, "arm.urdf", "/");
  return model;
}

}  // namespace tandem::fuzz
