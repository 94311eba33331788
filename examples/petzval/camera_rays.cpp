// SPDX-License-Identifier: Apache-2.0
// Converts film samples of a CSV file to camera rays, by any model of the lens; or writes a camera for POV-Ray.
//
//   printf 'film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm\n0,-10,0.25,0.5,587.5618\n' > samples.csv
//   petzval camera-rays double_gauss_100mm_f2.0 --table samples.csv --out rays.csv --focus 3000 --f-number 4
//   petzval camera-rays double_gauss_100mm_f2.0 --povray --size 160 --spp 64 --focus 3000 --out lens.inc
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/exports/renderer_cameras.hpp"
#include "support/bokeh_flags.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/number_csv.hpp"
#include "support/text.hpp"

namespace {

using examples::CsvColumn;
using examples::LoadedLens;

constexpr examples::Range unit_interval{0, 1, "a number from 0 to 1"};
constexpr std::array<CsvColumn, 5> sample_columns{{{"film_x_mm"},
                                                   {"film_y_mm"},
                                                   {"pupil_u", unit_interval},
                                                   {"pupil_v", unit_interval},
                                                   {"wavelength_nm", examples::positive_number}}};

struct Samples {
  std::vector<double> film_x, film_y, pupil_u, pupil_v;
  std::vector<std::uint16_t> wavelength;  ///< indices of
  std::vector<double> wavelengths_nm;     ///< without repetitions, in the order of the file
  std::vector<std::size_t> first_row;     ///< first row of each wavelength

  std::size_t size() const noexcept { return film_x.size(); }
};

Samples parse_samples(const std::string& csv, const std::string& where) {
  auto all = examples::parse_columns(csv, sample_columns, where);
  Samples samples{all[0], all[1], all[2], all[3], {}, {}, {}};
  for (std::size_t row = 0; row < samples.size(); ++row) {
    auto& known = samples.wavelengths_nm;
    const double nm = all[4][row];
    const auto found = std::find(known.begin(), known.end(), nm);
    samples.wavelength.push_back(static_cast<std::uint16_t>(found - known.begin()));
    if (found != known.end()) continue;
    if (known.size() == 1000) {
      throw petzval::Error(examples::line_of_row(where, row) +
                           ": more than 1000 different wavelengths; must be at most 1000");
    }
    known.push_back(nm);
    samples.first_row.push_back(row);
  }
  return samples;
}

/// The lens compiled for the wavelengths of the samples. @throws petzval::Error that names the line of a wavelength
LoadedLens load_for(const Samples& samples, const petzval::LensSource& lens_file, const std::string& where) {
  LoadedLens loaded = examples::load_lens(lens_file, std::array{petzval::d_line_nm});
  for (std::size_t w = 0; w < samples.wavelengths_nm.size(); ++w) {
    try {
      examples::compiled_for(loaded, std::array{samples.wavelengths_nm[w]});
    } catch (const petzval::Error& error) {
      throw petzval::Error(examples::line_of_row(where, samples.first_row[w]) +
                           ", column wavelength_nm: " + error.what());
    }
  }
  if (samples.size() > 0) loaded.lens = examples::compiled_for(loaded, samples.wavelengths_nm);
  return loaded;
}

std::string rays_csv(const petzval::Camera& camera, const Samples& samples) {
  const std::size_t count = samples.size();
  std::array<std::vector<double>, 9> columns;
  for (auto& column : columns) column.resize(count);
  std::vector<petzval::RayFate> fates(count);
  auto& [x, y, z, dx, dy, dz, weights, pdf_pupil, pdf_direction] = columns;
  camera.sample<double>(count,
                        {samples.film_x.data(),
                         samples.film_y.data(),
                         samples.pupil_u.data(),
                         samples.pupil_v.data(),
                         {.each = samples.wavelength.data()}},
                        {{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()},
                         weights.data(),
                         fates.data(),
                         pdf_pupil.data(),
                         pdf_direction.data()});
  std::string csv = "x_mm,y_mm,z_mm,dx,dy,dz,weight,pdf_pupil_per_mm2,pdf_direction_per_sr,fate\n";
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& column : columns) csv += examples::digits17(column[i]) + ',';
    csv += petzval::name(fates[i]);
    csv += '\n';
  }
  return csv;
}

/// The largest number of rays for POV-Ray. A ray takes 100 bytes of text.
constexpr double most_povray_rays = 1e7;
constexpr std::uint32_t usual_columns = 160;

}  // namespace

int commands::camera_rays(int argc, char** argv) {
  std::string samples_file, out_file;
  examples::CameraFlags setup;
  setup.camera.model = petzval::ModelKind::exact_double;
  bool povray = false;
  std::uint32_t columns = 0, rows = 0, samples_per_pixel = 32;
  examples::App app(
      "Samples camera rays from film points through the lens into the scene. Lengths in mm, in the lens frame: origin "
      "at the first vertex, light travels towards +z, camera rays towards -z. The image on the film is upside down. "
      "With --povray, writes a camera for POV-Ray 3.7 instead.",
      "petzval camera-rays");
  examples::add_lens(app, setup.lens);
  app.add_option("--table", samples_file,
                 "CSV with the columns film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm; pupil_u and pupil_v from 0 "
                 "to 1, uniform by area over the model's pupil for the film point")
      ->type_name("CSV");
  auto* const povray_flag = app.add_flag(
      "--povray", povray,
      "write an include file of POV-Ray 3.7: a mesh_camera with one mesh per sample, one triangle per pixel. Frame of "
      "POV-Ray: left-handed, mm, origin at the first vertex, +y up, view along +z; declare petzval_pose, a transform "
      "without scale, to move the camera. Light at the d line. Rays are dropped in proportion to their weights, "
      "because POV-Ray has none: the picture times the number in the file is the linear picture of petzval render. "
      "Render in the same size without antialiasing: povray scene.pov +W160 +H107 -A. The first row of pixels repeats "
      "the second one");
  povray_flag->excludes("--table");
  examples::add_picture_size(app, columns, rows, usual_columns);
  app.get_option("--size")->needs(povray_flag);
  examples::add_count(app, "--spp", samples_per_pixel, {1, most_povray_rays, "a whole number from 1 to 10000000"},
                      "rays per pixel for --povray; the file has 100 bytes per ray: 54 MB for 160x107 pixels with 32 "
                      "rays")
      ->needs(povray_flag);
  examples::add_out_file(app, out_file,
                         "file to write; CSV, or the include file of --povray. CSV: one line per sample in the same "
                         "order: x_mm,y_mm,z_mm,dx,dy,dz,weight,"
                         "pdf_pupil_per_mm2,pdf_direction_per_sr,fate, with 17 digits. The mean of weight x radiance "
                         "is the irradiance of the film point; the weight is 0 unless the fate is transmitted",
                         "FILE")
      ->required();
  examples::add_model(app, setup.camera.model);
  examples::add_camera(app, setup);
  examples::add_bokeh(app, setup);
  examples::add_tilt(app, setup, {-89.9, 89.9, "an angle from -89.9 to 89.9"});
  app.get_option("--focus")->required()->default_str("");

  return examples::run(app, argc, argv, [&] {
    if (!povray && samples_file.empty()) throw petzval::Error("--table or --povray is required");
    const auto camera_of = [&](const LoadedLens& loaded, const petzval::Film& film,
                               petzval::Normalisation normalisation) {
      const petzval::Lens lens = examples::focused(loaded, setup);
      examples::say_what_does_not_fit(lens, film, povray ? "--size" : "");
      return petzval::Camera(
          lens, film,
          {.model = setup.camera.model, .normalisation = normalisation, .bokeh = examples::controls_of(setup)});
    };
    if (povray) {
      const petzval::Film film = setup.sized_film(columns, rows, usual_columns);
      const double rays = 1.0 * film.columns * film.rows * samples_per_pixel;
      if (rays > most_povray_rays) {
        throw petzval::Error("--size and --spp: " + examples::number(rays) + " rays; must be at most 10000000");
      }
      const auto loaded = examples::load_lens(setup.lens, std::array{petzval::d_line_nm});
      const petzval::Camera camera = camera_of(loaded, film, petzval::Normalisation::unity_on_axis);
      return examples::write_text(out_file, petzval::format_povray_camera(camera, static_cast<int>(samples_per_pixel)));
    }
    const Samples samples = parse_samples(examples::read_text(samples_file), samples_file);
    const petzval::Camera camera =
        camera_of(load_for(samples, setup.lens, samples_file), setup.film, petzval::Normalisation::irradiance);
    examples::write_text(out_file, rays_csv(camera, samples));
  });
}
