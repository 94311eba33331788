// SPDX-License-Identifier: Apache-2.0
#include "export_maps.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/image/image.hpp"
#include "petzval/lens/lens.hpp"

namespace commands {
namespace {

/// A part with the channels R, G, B; missing channels are 0.
petzval::ExrPart texture(int width, int height, std::span<const float> texels, std::size_t channels) {
  petzval::ExrPart part{.width = width, .height = height};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float> values(texels.size() / channels, 0.0f);
    for (std::size_t i = 0; k < channels && i < values.size(); ++i) values[i] = texels[i * channels + k];
    part.channels[std::string(1, "RGB"[k])] = std::move(values);
  }
  return part;
}

}  // namespace

void write_omniverse(const petzval::OmniverseTables& tables, const std::filesystem::path& enter,
                     const std::filesystem::path& exit) {
  petzval::write_exr(std::array{texture(tables.columns, tables.rows, tables.directions, 3)}, enter);
  petzval::write_exr(std::array{texture(tables.exit_size, tables.exit_size, tables.positions, 2)}, exit);
}

examples::Json head_of(const petzval::RayMap& map, const petzval::Camera& camera) {
  const bool planes = map.layout == petzval::RayMapLayout::planes;
  const petzval::Film& film = camera.film();
  const petzval::Lens& lens = camera.lens();
  examples::Json samples = examples::Json::array();
  for (const petzval::RayMap::LensSample& one : map.lens_samples) {
    samples.push_back({{"u", one.u}, {"v", one.v}, {"pupil_mm", {one.pupil_mm.x, one.pupil_mm.y}}});
  }
  return {{"format", "petzval ray map"},
          {"version", 1},
          {"lens", lens.name()},
          {"layout", planes ? "planes" : "directions"},
          {"channels", map.channels()},
          {"ray", planes ? "origin (x, y, plane_z_mm), direction (slope_x, slope_y, -1), where slope = channel + "
                           "slope_per_pixel * (raster - picture centre)"
                         : "origin (x, y, z), direction (dx, dy, dz), to be normalised after interpolation"},
          {"half", map.half},
          {"units", "mm"},
          {"frame", "x right, y up, view along -z, origin at the first vertex"},
          {"raster", "pixel (column, row) from the upper left is the raster position (column + 0.5, row + 0.5)"},
          {"weight", "the mean of weight * radiance over the lens samples is the irradiance of the film; 0: no ray"},
          {"plane_z_mm", map.plane_z_mm},
          {"front_z_mm", map.front_z_mm},
          {"slope_per_pixel", {map.slope_per_pixel.x, map.slope_per_pixel.y}},
          {"film",
           {{"width_mm", film.width_mm},
            {"height_mm", film.height_mm},
            {"columns", film.columns},
            {"rows", film.rows},
            {"z_mm", film.z()}}},
          {"wavelength_nm", lens.wavelengths_nm()[lens.primary_wavelength()]},
          {"focus_mm", examples::finite_or_null(map.focus_mm)},
          {"field_deg", petzval::degrees(map.widest_field_rad)},
          {"chief_rays", map.chief_rays},
          {"pupil_z_mm", map.pupil_z_mm},
          {"lens_samples", std::move(samples)},
          {"rms_px", map.rms_px},
          {"largest_px", map.largest_px},
          {"left_out", map.left_out}};
}

void write_ray_map(const petzval::RayMap& map, const petzval::Camera& camera, const std::filesystem::path& file) {
  const std::vector<std::string_view> names = map.channels();
  const std::size_t pixels = static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows);
  std::vector<petzval::ExrPart> parts;
  for (std::size_t s = 0; s < map.lens_samples.size(); ++s) {
    const petzval::RayMap::LensSample& own = map.lens_samples[s];
    petzval::ExrPart part{.name = "sample_" + std::to_string(s), .width = map.columns, .height = map.rows};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const float* const values = map.channel(s, k);
      part.channels[std::string(names[k])].assign(values, values + pixels);
    }
    part.pairs["lens_sample"] = {static_cast<float>(own.u), static_cast<float>(own.v)};
    if (s == 0) part.texts["ray_map"] = head_of(map, camera).dump();
    part.half = map.half;
    parts.push_back(std::move(part));
  }
  petzval::write_exr(parts, file);
}

}  // namespace commands
