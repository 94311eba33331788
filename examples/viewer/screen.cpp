// SPDX-License-Identifier: Apache-2.0
#include "viewer/screen.hpp"

#include <SDL.h>
#include <SDL_opengl.h>
#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>

#include <cstddef>

#include "petzval/core/error.hpp"

namespace viewer {

Screen::Screen(const char* title, int width, int height) {
  if (SDL_Init(SDL_INIT_VIDEO) != 0) fail(SDL_GetError());
  // If no display exists, SDL chooses a driver that draws to memory.
  for (const char* const unseen : {"offscreen", "dummy", "evdev"}) {
    if (SDL_GetCurrentVideoDriver() == std::string(unseen)) fail("there is no display");
  }
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
  window_ = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height,
                             SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE);
  if (!window_) fail(SDL_GetError());
  context_ = SDL_GL_CreateContext(window_);
  if (!context_) fail(SDL_GetError());
  SDL_GL_SetSwapInterval(1);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui::StyleColorsDark();
  ImGui_ImplSDL2_InitForOpenGL(window_, context_);
  ImGui_ImplOpenGL3_Init("#version 130");
  drawn_ = true;
}

Screen::~Screen() {
  if (drawn_) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplSDL2_Shutdown();
    ImGui::DestroyContext();
  }
  close();
}

void Screen::fail(const std::string& reason) {
  const std::string message = "window: " + reason;  // before close(), which changes the reason of SDL
  close();
  throw petzval::Error(message +
                       "; must have a display (DISPLAY) with OpenGL 3. petzval view --replay works without a display");
}

void Screen::close() {
  if (context_) SDL_GL_DeleteContext(context_);
  if (window_) SDL_DestroyWindow(window_);
  SDL_Quit();
}

void Screen::process(const SDL_Event& event) { ImGui_ImplSDL2_ProcessEvent(&event); }

void Screen::begin() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  ImGui::NewFrame();
}

void Screen::end() {
  ImGui::Render();
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  glViewport(0, 0, static_cast<int>(size.x), static_cast<int>(size.y));
  glClearColor(0.1f, 0.1f, 0.1f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Screen::swap() { SDL_GL_SwapWindow(window_); }

petzval::Rgb8Image Screen::picture() const {
  int width = 0, height = 0;
  SDL_GL_GetDrawableSize(window_, &width, &height);
  petzval::Rgb8Image image{width, height, {}};
  const auto row = static_cast<std::ptrdiff_t>(3 * width);
  std::vector<unsigned char> below(static_cast<std::size_t>(row * height));  // rows from the bottom
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, below.data());
  for (int y = height - 1; y >= 0; --y) {
    image.pixels.insert(image.pixels.end(), below.begin() + y * row, below.begin() + (y + 1) * row);
  }
  return image;
}

Texture::~Texture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void Texture::set(const petzval::Rgb8Image& image) { set(image.width, image.height, GL_RGB, image.pixels.data()); }

void Texture::set(int width, int height, const std::vector<std::uint8_t>& rgba) {
  set(width, height, GL_RGBA, rgba.data());
}

void Texture::show_pixels(bool squares) const {
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, squares ? GL_NEAREST : GL_LINEAR);
}

void Texture::set(int width, int height, unsigned format, const void* pixels) {
  if (id_ == 0) glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, width, height, 0, format, GL_UNSIGNED_BYTE, pixels);
}

}  // namespace viewer
