# SPDX-License-Identifier: Apache-2.0
# Headers that nearly every file includes are compiled once for the library, once for the tests and once for the examples.
# Sources still include all headers that they use, and CMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without precompiled headers. A
# compiler cache needs this setting: precompiled headers differ between build trees, so that cached objects would not be found.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()
set(PETZVAL_PRECOMPILED <algorithm> <array> <cmath> <cstddef> <cstdint> <cstdlib> <filesystem> <fstream> <functional> <iostream>
  <limits> <map> <memory> <numbers> <numeric> <optional> <random> <set> <span> <sstream> <string> <string_view> <thread>
  <tuple> <utility> <variant> <vector> <glm/geometric.hpp> <glm/vec2.hpp> <glm/vec3.hpp>)
