// SPDX-License-Identifier: Apache-2.0
#include "layers/lens_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "petzval/analysis/colour.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "support/bokeh.hpp"

namespace lens_blur {

petzval::ModelKind LensView::model() const noexcept {
  const bool first_order = surface || !setup.camera.expressive.empty() || first_order_only;
  return thin() ? petzval::ModelKind::thin : first_order ? petzval::ModelKind::thick : petzval::ModelKind::exact_float;
}

petzval::Camera LensView::camera() const {
  if (made) return made();
  petzval::CameraOptions options = setup.camera;
  options.model = model(), options.normalisation = petzval::Normalisation::unity_on_axis;
  options.focal_surface = surface, options.paraxial_focus = thin() || options.paraxial_focus;
  return petzval::Camera(lens, setup.film, options);
}

std::function<double(const petzval::Vec2<double>&)> LensView::thin_focus(const petzval::LayerCamera& layers) const {
  const double power = 1 / petzval::first_order(lens).effective_focal_length, image = power - 1 / focus_depth_mm;
  return [=, normal = setup.film.normal()](const petzval::Vec2<double>& raster) {
    const petzval::Vec2<double> run = (raster - layers.axis) / layers.focal_px;
    return power - image * (1 - (normal.x * run.x - normal.y * run.y) / normal.z);
  };
}

/// The picture of a tilted film keeps the frame of the upright film, on which a focal surface states the focus.
petzval::Camera LensView::sharp_at_focus(const petzval::LayerCamera& layers) const {
  const petzval::Film& film = setup.film;
  if (!thin() || !film.tilted() || (surface && surface->fixes_distance())) return camera();
  petzval::Film upright = film;
  upright.tilt_rad = upright.swing_rad = 0, upright.columns = layers.columns, upright.rows = layers.rows;
  const auto inverse_distance = thin_focus(layers);
  std::vector<petzval::FocalPoint> points;
  for (const petzval::Vec2<double>& part : {petzval::Vec2<double>{0, 0}, {1, 0}, {0.5, 1}}) {
    const petzval::Vec2<double> raster{part.x * layers.columns, part.y * layers.rows};
    points.push_back(
        {.film_point = upright.point(raster.x, raster.y), .inverse_distance = std::max(0.0, inverse_distance(raster))});
  }
  LensView sharp = *this;
  sharp.setup.film = upright;
  sharp.setup.film.columns = film.columns, sharp.setup.film.rows = film.rows;
  sharp.surface.emplace(petzval::thick_lens(lens), upright, points);
  sharp.made = {};
  return sharp.camera();
}

petzval::LayerCamera LensView::layers(std::uint32_t supersample) const {
  const auto side = static_cast<int>(supersample);
  if (thin()) return petzval::layer_camera(setup.film.columns * side, setup.film.rows * side, vertical_angle_rad);
  petzval::LayerCamera layers = petzval::layer_camera(camera());
  layers.columns *= side, layers.rows *= side, layers.focal_px *= side, layers.axis *= side;
  return layers;
}

petzval::LensRays LensView::rays(const petzval::LayerCamera& layers, const RayPattern& pattern, double nearest_mm,
                                 int threads, const std::stop_token& stop) const {
  // Each subpixel has its own rays; all subpixels together have the number of rays of a pixel.
  const auto parts = static_cast<int>(pattern.supersample * pattern.supersample);
  const int sets = pattern.jitter ? 16 : parts;
  const std::vector<petzval::PupilPoint> points =
      petzval::vogel_sets((static_cast<int>(pattern.rays) + parts - 1) / parts, sets);
  const petzval::LensRaysOptions options{.nearest_mm = nearest_mm,
                                         .set_count = sets,
                                         .over_pixels = pattern.over_pixels,
                                         .threads = threads,
                                         .stop = stop};
  const petzval::BokehControls& controls = setup.camera.bokeh;
  if (!thin() || controls.vignettes() || !setup.camera.expressive.empty()) {
    std::vector<petzval::Wavelength> wavelengths;
    for (std::size_t i = 1; coloured && i <= petzval::rgb_triple_nm.size(); ++i) wavelengths.emplace_back(i);
    return petzval::LensRays::of(sharp_at_focus(layers), layers, points, wavelengths, options);
  }

  petzval::ThinLens thin_lens{.radius_mm = thin_radius_mm(),
                              .inverse_focus = 1 / focus_depth_mm,
                              .iris = lens.iris(),
                              .edge = controls.edge(),
                              .map = controls.weight_map};
  const double power = 1 / petzval::first_order(lens).effective_focal_length;
  for (int c = 0; coloured && c < 3; ++c) {
    thin_lens.colour_shift[c] =
        1 / petzval::first_order(lens, static_cast<std::size_t>(c + 1)).effective_focal_length - power;
  }
  if (surface) {
    petzval::Film fine = setup.film;
    fine.columns = layers.columns, fine.rows = layers.rows;
    thin_lens.focus = [surface = *surface, fine](const petzval::Vec2<double>& raster) {
      const petzval::FocalSurface::Values at = surface.at(fine.point(raster.x, raster.y));
      return petzval::FocusAt{at.inverse_distance, std::exp2(-at.extent_stops / 2)};
    };
  } else if (setup.film.tilted()) {
    thin_lens.focus = [inverse_distance = thin_focus(layers)](const petzval::Vec2<double>& raster) {
      return petzval::FocusAt{inverse_distance(raster), 1};
    };
  }
  return petzval::LensRays::thin(layers, thin_lens, points, options);
}

petzval::RgbImage LensView::ghosts(std::span<const BrightPart> parts, const petzval::LayerCamera& layers,
                                   const petzval::GhostOptions& options) const {
  // The picture is 1 on the axis after the losses at the surfaces.
  petzval::CameraSetup radiometric = setup;
  radiometric.camera.transmission = true;
  radiometric.camera.model = petzval::ModelKind::exact_float;
  radiometric.camera.normalisation = petzval::Normalisation::irradiance;
  radiometric.camera.expressive = {}, radiometric.focal_points.clear();
  radiometric.film.shift_x_mm = radiometric.film.shift_y_mm = 0;
  const double scale = 1 / examples::irradiance_on_axis(petzval::camera(radiometric, lens));
  const double origin_z = petzval::layer_origin_z(camera());
  petzval::RgbImage sum(setup.film.columns, setup.film.rows);
  for (const BrightPart& part : parts) {
    const petzval::Vec2<double> slope = (part.raster - layers.axis) / layers.focal_px;
    petzval::ScenePoint point{.position = {slope.x, -slope.y, -1}, .at_infinity = !(part.inverse_depth > 0)};
    if (!point.at_infinity)
      point.position = point.position / part.inverse_depth + petzval::Vec3<double>(0, 0, origin_z);
    // The solid angle of a pixel.
    const double pixel = std::pow(1 + glm::dot(slope, slope), -1.5) / (layers.focal_px * layers.focal_px);
    std::vector<std::array<double, 3>> weights(coloured ? 4 : 1);
    for (std::size_t c = 0; c < 3; ++c) weights[coloured ? c + 1 : 0][c] = part.light[c] * pixel * scale;
    const auto image = examples::ghost_picture(lens, point, setup.film, weights, options);
    std::ranges::transform(sum.pixels, image.pixels, sum.pixels.begin(), std::plus());
  }
  return sum;
}

}  // namespace lens_blur
