// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <cstdint>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"

struct SDL_Window;
union SDL_Event;

namespace viewer {

/// A window of SDL with OpenGL, drawn by Dear ImGui.
class Screen {
 public:
  /// @throws petzval::Error if there is no display with OpenGL
  Screen(const char* title, int width, int height);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Passes an event of SDL to Dear ImGui.
  static void process(const SDL_Event& event);
  /// Calls of Dear ImGui draw between begin() and end().
  void begin();
  void end();
  /// Shows what was drawn.
  void swap();
  /// What was drawn.
  petzval::Rgb8Image picture() const;

 private:
  [[noreturn]] void fail(const std::string& reason);
  void close();

  SDL_Window* window_ = nullptr;
  void* context_ = nullptr;
  bool drawn_ = false;
};

/// A picture on the graphics processor. It must not outlive the screen.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  void set(const petzval::Rgb8Image& image);
  /// rgba: width x height x 4 values.
  void set(int width, int height, const std::vector<std::uint8_t>& rgba);
  /// Shows enlarged pixels as squares, or else smoothed.
  void show_pixels(bool squares) const;
  explicit operator bool() const noexcept { return id_ != 0; }
  ImTextureID id() const noexcept { return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(id_)); }

 private:
  void set(int width, int height, unsigned format, const void* pixels);

  unsigned id_ = 0;
};

}  // namespace viewer
