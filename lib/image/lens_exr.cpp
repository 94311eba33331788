// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <algorithm>
#include <string>

namespace petzval {
namespace {

ExrPart part_of(const StMap& map, const char* name) {
  return {.name = name,
          .width = map.width,
          .height = map.height,
          .channels = {{"G", map.t}, {"R", map.s}},
          .margin_x = map.margin_x,
          .margin_y = map.margin_y};
}

}  // namespace

void add_lens_attributes(ExrPart& part, const LensDistortion& distortion, const LensIdentity& identity) {
  const auto add_text = [&](const char* name, const std::string& text) {
    if (!text.empty()) part.texts[name] = text;
  };
  add_text("lensMake", identity.make);
  add_text("lensModel", identity.model);
  add_text("lensSerialNumber", identity.serial_number);

  const LensState state = lens_state(distortion);
  if (identity.nominal_focal_length_mm) part.numbers["nominalFocalLength"] = *identity.nominal_focal_length_mm;
  part.numbers["effectiveFocalLength"] = state.effective_focal_length_mm;
  part.numbers["pinholeFocalLength"] = state.pinhole_focal_length_mm;
  part.numbers["entrancePupilOffset"] = state.entrance_pupil_offset_mm;
  part.numbers["aperture"] = state.f_number;
  if (state.t_number) part.numbers["tStop"] = *state.t_number;
  part.numbers["focus"] = state.focus_distance_mm / 1000;  // in metres by the OpenEXR standard
  const Film& film = distortion.camera().film();
  part.pairs["sensorOverallDimensions"] = Vec2<float>(Vec2<double>(film.width_mm, film.height_mm));
}

std::array<ExrPart, 2> to_exr_parts(const StMaps& maps, const LensDistortion& distortion,
                                    const LensIdentity& identity) {
  std::array<ExrPart, 2> parts{part_of(maps.undistort, "undistort"), part_of(maps.redistort, "redistort")};
  for (ExrPart& part : parts) {
    add_lens_attributes(part, distortion, identity);
    part.numbers["overscan"] = std::max(static_cast<double>(maps.undistort.width) / maps.redistort.width,
                                        static_cast<double>(maps.undistort.height) / maps.redistort.height);
  }
  return parts;
}

void write_st_map(const Lens& lens, const Film& film, const LensIdentity& identity, const std::filesystem::path& file,
                  std::optional<double> overscan, int threads) {
  const LensDistortion distortion(Camera(lens, film, {.model = ModelKind::exact_double}));
  write_exr(to_exr_parts(st_maps(distortion, overscan, threads), distortion, identity), file);
}

}  // namespace petzval
