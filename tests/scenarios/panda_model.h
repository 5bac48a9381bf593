#pragma once
/// The Panda of the scenarios, loaded for tests.

#include <map>
#include <string>
#include <vector>

#include "tandem/io/workcell_yaml.h"
#include "tandem/robot/urdf.h"
#include "test_data.h"

namespace tandem::test {

inline const char* const kPanda = "scenarios/robots/panda/";

/// Fails the test and stays empty if the files cannot be read.
struct Panda {
  robot::Model model;
  std::map<std::string, std::vector<geometry::Shape>> volumes;

  Panda() {
    auto read = robot::load_urdf(source_path(std::string(kPanda) + "panda.urdf"));
    if (!read) {
      ADD_FAILURE() << read.error().message;
      return;
    }
    model = *std::move(read);
    auto shapes = io::load_volumes(source_path(std::string(kPanda) + "panda.volumes.yaml"), model);
    if (!shapes) {
      ADD_FAILURE() << shapes.error().message;
      return;
    }
    volumes = *std::move(shapes);
  }

  const robot::Link& link(const std::string& name) const {
    return model.links()[static_cast<std::size_t>(model.find_link(name))];
  }
};

}  // namespace tandem::test
