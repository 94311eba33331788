// SPDX-License-Identifier: Apache-2.0
// Traces rays of a CSV file through a lens and writes the end point and the fate of each ray.
//
//   printf 'x_mm,y_mm,z_mm,dx,dy,dz\n0,10,-50,0,0,1\n' > rays.csv
//   petzval trace data/lenses/double_gauss_100mm_f1.35.json --table rays.csv --out traced.csv
#include "commands.hpp"

#include "petzval/trace/trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/number_csv.hpp"
#include "support/text.hpp"

namespace {

constexpr std::array<examples::CsvColumn, 6> columns{{{"x_mm"}, {"y_mm"}, {"z_mm"}, {"dx"}, {"dy"}, {"dz"}}};
/// Rays by column.
using Rays = std::vector<std::vector<double>>;

/// Normalizes directions of any length to unit vectors in double.
void normalise(Rays& rays, const std::string& where) {
  for (std::size_t i = 0; i < rays[3].size(); ++i) {
    double &dx = rays[3][i], &dy = rays[4][i], &dz = rays[5][i];
    // Scaled by a power of two first, so that very small and large components lose no digits.
    const double largest = std::max({std::abs(dx), std::abs(dy), std::abs(dz)});
    if (largest == 0) {
      throw petzval::Error(examples::line_of_row(where, i) + ": direction = 0,0,0; must have a nonzero length");
    }
    for (double* const component : {&dx, &dy, &dz}) *component = std::scalbn(*component, -std::ilogb(largest));
    const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
    dx /= length, dy /= length, dz /= length;
  }
}

template <class T>
std::vector<T> rounded(const std::vector<double>& values, const std::string& where, const char* column) {
  std::vector<T> result;
  result.reserve(values.size());
  for (const double value : values) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<T>::max())) {
      throw petzval::Error(where + ": line " + std::to_string(result.size() + 2) + ", column " + column + " = " +
                           examples::number(value) + "; must be within the range of float");
    }
    result.push_back(static_cast<T>(value));
  }
  return result;
}

template <class T>
std::string traced_csv(const petzval::Lens& lens, const Rays& rays, const petzval::TraceOptions& options,
                       const std::string& where) {
  std::array<std::vector<T>, columns.size()> in;
  for (std::size_t k = 0; k < in.size(); ++k) in[k] = rounded<T>(rays[k], where, columns[k].name);
  const auto& [x, y, z, dx, dy, dz] = in;
  std::string csv = "x_mm,y_mm,z_mm,dx,dy,dz,fate,surface\n";
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto end = petzval::trace(lens, petzval::Ray<T>{{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}}, options);
    const auto& [origin, direction] = end.ray;
    for (const T value : {origin.x, origin.y, origin.z, direction.x, direction.y, direction.z}) {
      csv += examples::digits17(value) + ',';
    }
    csv += petzval::name(end.fate);
    csv += ',' + std::to_string(end.surface) + '\n';
  }
  return csv;
}

}  // namespace

int commands::trace(int argc, char** argv) {
  petzval::LensSource lens_file;
  std::string rays_file, out_file, precision = "double", travel = "to_film";
  double wavelength_nm = petzval::d_line_nm;
  bool ignore_apertures = false;

  examples::App app(
      "Traces rays through a lens, surface by surface. Lengths in mm, in the lens frame: origin at the first vertex, "
      "light travels towards +z.",
      "petzval trace");
  examples::add_lens(app, lens_file);
  app.add_option("--table", rays_file, "CSV with the columns x_mm,y_mm,z_mm,dx,dy,dz; directions of any length")
      ->required()
      ->type_name("CSV");
  examples::add_out_file(
      app, out_file,
      "CSV to write, one line per ray in the same order: x_mm,y_mm,z_mm,dx,dy,dz,fate,surface, with 17 digits. The "
      "point is on the last surface that the ray reached; surfaces count from 0. For missed_surface and "
      "no_convergence it is on the previous surface, or the ray's origin if there is no previous surface",
      "CSV")
      ->required();
  app.add_option("--precision", precision, "arithmetic of the trace")
      ->one_of({"float", "double"})
      ->capture_default_str();
  app.add_option("--travel", travel, "direction of travel through the lens")
      ->one_of({"to_film", "to_scene"})
      ->capture_default_str();
  examples::add_wavelength(app, "--wavelengths", wavelength_nm, "wavelength");
  app.add_flag("--ignore-apertures", ignore_apertures, "let rays pass outside the clear diameters");

  return examples::run(app, argc, argv, [&] {
    const auto loaded = examples::load_lens(lens_file, std::array{wavelength_nm});
    Rays rays = examples::parse_columns(examples::read_text(rays_file), columns, rays_file);
    normalise(rays, rays_file);
    const petzval::TraceOptions options{
        .travel = travel == "to_film" ? petzval::Travel::to_film : petzval::Travel::to_scene,
        .apertures = !ignore_apertures};
    examples::write_text(out_file, precision == "float" ? traced_csv<float>(loaded.lens, rays, options, rays_file)
                                                        : traced_csv<double>(loaded.lens, rays, options, rays_file));
  });
}
