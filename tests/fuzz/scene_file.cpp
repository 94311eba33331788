// SPDX-License-Identifier: Apache-2.0
// Scenes of the example renderer, as JSON and as OBJ meshes.
#include <string_view>

#include "laws.hpp"
#include "renderer/obj_mesh.hpp"
#include "renderer/scene_json.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  static const fuzz::ScratchFile file(".json");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto& path = file.holding(text);
  if (text.starts_with('{')) {
    fuzz::done([&] { renderer::read_scene(path); });
    return 0;
  }
  fuzz::done([&] {
    const renderer::Mesh mesh = renderer::read_obj(path);
    fuzz::require(!mesh.triangles.empty(), "a mesh has triangles");
    for (const auto& corners : mesh.triangles) {
      for (const std::uint32_t corner : corners) {
        fuzz::require(corner < mesh.positions.size(), "corners of triangles exist");
      }
    }
  });
  return 0;
}
