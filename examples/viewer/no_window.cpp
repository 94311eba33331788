// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/error.hpp"
#include "viewer/window.hpp"

namespace viewer {

void show_window(const WindowOptions&) {
  throw petzval::Error(
      "petzval was built without SDL2 and Dear ImGui, which the window needs; install libsdl2-dev and libimgui-dev and "
      "build again, or use --replay");
}

}  // namespace viewer
