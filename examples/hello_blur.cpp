// SPDX-License-Identifier: Apache-2.0
// Blurs a picture with depths: a board 1 m away in front of a striped wall 3 m away, through a lens focused at the
// wall. Prints a row across the edge of the board, which hides the wall gradually.
#include <cstdio>
#include <exception>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/geometry.hpp"

int main() try {
  const petzval::LayerCamera camera = petzval::layer_camera(320, 240, petzval::radians(30));
  const petzval::LensRays rays =
      petzval::LensRays::thin(camera, {.radius_mm = 25, .inverse_focus = 1 / 3000.0}, petzval::vogel_points(100));

  // A renderer's colours and depths, with a margin around the picture that the lens can see.
  const petzval::PeelPlan plan = petzval::plan_peel(rays, 1000, 3000);
  const int columns = plan.camera.layer_columns(), rows = plan.camera.layer_rows();
  std::vector<float> rgba, depth_mm;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const bool board = column < columns / 2;
      const float light = board ? 1.0f : column % 80 < 40 ? 0.1f : 0.5f;
      rgba.insert(rgba.end(), {light, light, light, 1});
      depth_mm.push_back(board ? 1000 : 3000);
    }
  }
  const petzval::LayerImage image{columns, rows, rgba, depth_mm};
  petzval::LayerSet layers;
  layers.set({&image, 1});

  const petzval::BlurredImage picture = petzval::gather(layers, rays);
  for (int column = 144; column <= 176; column += 2) {
    std::printf("%.2f ",
                static_cast<double>(picture.rgba[static_cast<std::size_t>(4 * (120 * picture.columns + column))]));
  }
  std::printf("\n%.1f %% of the rays hit surfaces that are not in the picture\n",
              100 * static_cast<double>(picture.missed_count) / static_cast<double>(picture.ray_count));
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
