# Everything tandem links to, all from Debian 12. The traps that shaped these lines are real: see
# the comments before changing one.
find_package(Eigen3 3.4 REQUIRED)
find_package(Threads REQUIRED)
find_package(hwy REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(assimp REQUIRED)
find_package(Qhull CONFIG REQUIRED)
# fcl's pkg-config file forces C++11; its CMake target does not.
find_package(fcl CONFIG REQUIRED)
find_package(ompl CONFIG REQUIRED)
# Two packages ship an NLopt config under one name; this one has the C++ library.
find_package(NLopt CONFIG REQUIRED PATHS /usr/lib/x86_64-linux-gnu/cmake/nlopt_cxx NO_DEFAULT_PATH)
find_path(TINYXML2_INCLUDE_DIR tinyxml2.h REQUIRED)
find_library(TINYXML2_LIBRARY tinyxml2 REQUIRED)
if(TANDEM_BUILD_SERVER)
  find_package(PkgConfig REQUIRED)
  # The compiled library: its flags decide how its classes are laid out.
  pkg_check_modules(HTTPLIB REQUIRED cpp-httplib)
endif()
