// SPDX-License-Identifier: Apache-2.0
#include <pbrt/cameras.h>
#include <pbrt/filters.h>
#include <pbrt/paramdict.h>
#include <pbrt/util/error.h>
#include <pbrt/util/file.h>

#include <algorithm>
#include <cmath>
#include <petzval/petzval17.hpp>

namespace pbrt {

PetzvalCamera* PetzvalCamera::Create(const ParameterDictionary& parameters, const CameraTransform& transform, Film film,
                                     Medium medium, const FileLoc* loc, Allocator alloc) {
  CameraBaseParameters base(transform, film, medium, parameters, loc);

  bool dispersion = parameters.GetOneBool("dispersion", false);
  std::string file = ResolveFilename(parameters.GetOneString("lensfile", ""));
  // The spectrum from which pbrt draws wavelengths. Glasses with shorter tables are clamped.
  const double nm[8] = {360, 420, 480, 540, 600, 660, 740, 830};
  petzval_lens_options how = petzval_lens_options_init();
  how.clamp_wavelengths = 1;
  if (dispersion) {
    how.wavelengths_nm = nm;
    how.wavelength_count = 8;
    how.primary_nm = 540;
  }
  petzval17::Lens lens = petzval17::Lens::read(file, how);
  if (Float fNumber = parameters.GetOneFloat("fnumber", 0); fNumber != 0) lens.f_number(fNumber);
  if (int blades = parameters.GetOneInt("blades", 0); blades != 0) lens.iris(blades);
  // From the film, in metres, as for the realistic camera.
  lens.focus(1000 * double(parameters.GetOneFloat("focusdistance", 10)), PETZVAL_FROM_FILM);

  Point2i resolution = film.FullResolution();
  double aspect = double(resolution.y) / resolution.x, diagonal = 1000 * double(film.Diagonal());
  petzval_film area = petzval_film_init();
  area.columns = resolution.x;
  area.rows = resolution.y;
  area.width_mm = diagonal / std::sqrt(1 + aspect * aspect);
  area.height_mm = aspect * area.width_mm;
  Vector2f radius = film.GetFilter().Radius();
  area.margin_mm = std::max(radius.x, radius.y) * area.width_mm / resolution.x;
  area.tilt_rad = parameters.GetOneFloat("tilt", 0) * 3.14159265358979 / 180;

  std::string model = parameters.GetOneString("model", "exact_float");
  petzval_camera_options options = petzval_camera_options_init();
  options.model = model.c_str();
  options.frame = PETZVAL_FRAME_PBRT;
  options.origin = PETZVAL_FROM_FILM;
  options.clamp_wavelengths = 1;
  options.importance_tables = parameters.GetOneBool("lighttables", false);
  petzval_camera* camera = nullptr;
  if (!lens) ErrorExit(loc, "%s", lens.message());
  if (petzval_camera_create(lens.get(), &area, &options, &camera) != PETZVAL_OK)
    ErrorExit(loc, "%s", petzval_message());
  return alloc.new_object<PetzvalCamera>(base, camera, dispersion);
}

}  // namespace pbrt
