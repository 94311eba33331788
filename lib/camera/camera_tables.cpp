// SPDX-License-Identifier: Apache-2.0
#include "camera/camera_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "camera/polynomial_model.hpp"
#include "camera_data.hpp"
#include "lens/lens_view.hpp"
#include "make_model.hpp"
#include "paraxial_model.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using Table = CameraTables;
constexpr float unlimited = 3e38f;

/// The array under construction.
class Numbers {
 public:
  std::vector<float> list = std::vector<float>(Table::head_size, 0.0f);

  template <class T>
  void set(Table::Position at, T value) {
    list[at] = static_cast<float>(value);
  }
  /// Starts the list of `at`: stores the position of the next number.
  void begin(Table::Position at) { set(at, list.size()); }
  void add(double value) { list.push_back(static_cast<float>(value)); }
  void add(std::span<const double> values) {
    for (const double value : values) add(value);
  }
};

void put_maps(Numbers& to, const camera_detail::ParaxialModel& model) {
  to.set(Table::rays_kind, 0);
  to.set(Table::reference_z, model.z());
  for (const camera_detail::SectionMaps& maps : model.maps()) to.add(maps.numbers());
}

void put_polynomial(Numbers& to, const RayPolynomial& polynomial) {
  const RayPolynomial::Domain& domain = polynomial.domain();
  to.set(Table::rays_kind, 1);
  to.set(Table::reference_z, domain.reference_z);
  to.set(Table::degree, polynomial.degree());
  to.set(Table::domain_film_radius, domain.film_radius);
  to.set(Table::domain_pupil_shift, domain.pupil_shift);
  to.set(Table::domain_pupil_radius, domain.pupil_radius);
  if (domain.along_x) {
    to.set(Table::domain_pupil_shift_x, domain.along_x->pupil_shift);
    to.set(Table::domain_pupil_radius_x, domain.along_x->pupil_radius);
  }
  for (const RayPolynomial::Fit& fit : polynomial.fits()) {
    to.add(fit.direction_by_film), to.add(fit.direction_by_pupil);
    to.add(fit.offset_by_film), to.add(fit.offset_by_pupil);
  }
}

void put_surfaces(Numbers& to, const Lens& lens) {
  to.set(Table::rays_kind, 2);
  to.set(Table::surface_count, lens.surface_count());
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const LensSurface& s = lens.surfaces()[i];
    const bool limited = std::isfinite(s.semi_diameter) && s.semi_diameter > 0;
    const double height = limited ? s.semi_diameter : 1;
    to.add(std::array{s.vertex_z, s.curvature, s.conic});
    to.add(std::isfinite(s.semi_diameter) ? s.semi_diameter : double{unlimited});
    to.add(std::array{s.obscuration_semi_diameter, s.mirror ? 1.0 : 0.0, lens.stop() == i ? 1.0 : 0.0});
    to.add(std::array{s.curved_in == Section::x ? 1.0 : s.curved_in == Section::y ? 2.0 : 0.0, height});
    std::array<double, Table::surface_size - 9> terms{};
    for (const auto& [order, coefficient] : s.aspheric) {
      terms[static_cast<std::size_t>(order) - 2] += coefficient * std::pow(height, order);
    }
    to.add(terms);
  }
  to.begin(Table::indices);
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    for (std::size_t space = 0; space <= lens.surface_count(); ++space) to.add(lens.index(space, w));
  }
  to.begin(Table::edges);
  const auto iris = kernel::view<double>(lens).iris;
  to.set(Table::edge_count, iris.size());
  for (const auto& [nx, ny, bend, distance] : iris) to.add(std::array{nx, ny, bend, distance});
}

}  // namespace

void CameraTables::check(std::span<const float> tables, const std::string& where) {
  const auto refuse = [&](const std::string& found) { throw Error(where + ": found " + found); };
  if (tables.size() < head_size || tables[format] != 4) refuse("something else; must be camera tables of format 4");
  const auto number = [&](Position at) {
    const float value = tables[at];
    if (!(value >= 0 && value <= 1 << 24 && value == std::floor(value))) {
      refuse(std::to_string(value) + " at position " + std::to_string(at) + "; must be a whole number");
    }
    return static_cast<std::size_t>(value);
  };
  const auto check_list = [&](Position at, std::size_t size) {
    const std::size_t begin = number(at);
    if (begin >= head_size && begin + size <= tables.size()) return;
    refuse("a list of " + std::to_string(size) + " numbers that begins at " + std::to_string(begin) + " (position " +
           std::to_string(at) + "); must lie between " + std::to_string(std::size_t{head_size}) + " and " +
           std::to_string(tables.size()));
  };
  const auto check_number = [&](Position at, std::size_t least, std::size_t most) {
    if (const std::size_t value = number(at); value < least || value > most) {
      refuse(std::to_string(value) + " at position " + std::to_string(at) + "; must be " + std::to_string(least) +
             " to " + std::to_string(most));
    }
  };
  check_number(model, 0, models().size());
  check_number(wavelength_count, 1, 1 << 16);
  check_number(primary_wavelength, 0, number(wavelength_count) - 1);
  const std::size_t w = number(wavelength_count), spaces = number(surface_count) + 1;
  check_list(wavelengths, w), check_list(scales, w);
  switch (number(pupils_kind)) {
    case 1: check_list(pupil_list, w * FilmPupilArrays::image_size); break;
    case 0:
    case 2: {
      const bool polar = number(pupils_kind) == 0;
      check_number(rows, 1, 1 << 16), check_number(columns, 1, 1 << 16);
      const std::size_t cells = number(rows) * number(columns);
      if (!polar) check_list(half_widths, number(rows) + 1);
      check_list(pupil_list, cells);
      check_list(pupil_list, w * cells * (polar ? FilmPupilArrays::polar_size : FilmPupilArrays::quadrant_size));
      if (number(stop_size) == 0) break;
      check_list(stop_list,
                 w * cells * (polar ? FilmPupilArrays::polar_stop_size : FilmPupilArrays::quadrant_stop_size));
      break;
    }
    default: refuse("pupils of kind " + std::to_string(number(pupils_kind)) + "; must be 0 to 2");
  }
  if (number(iris_blades) > 0) check_list(iris, 2 * (FilmPupilArrays::edge_terms + number(iris_blades)));
  switch (number(rays_kind)) {
    case 0: check_list(rays, 8 * w); break;
    case 1: {
      check_number(degree, 3, 11);
      const int n = static_cast<int>(number(degree));
      if (n % 2 == 0) refuse("polynomials of degree " + std::to_string(n) + "; must be odd");
      const bool mirrors = tables[domain_pupil_radius_x] != 0;
      const std::size_t each = mirrors ? 2 * RayPolynomial::mirror_terms(n).size() : RayPolynomial::terms(n).size();
      check_list(rays, 4 * w * each);
      break;
    }
    case 2:
      check_list(rays, number(surface_count) * surface_size), check_list(indices, w * spaces);
      check_list(edges, 4 * number(edge_count));
      break;
    default: refuse("rays of kind " + std::to_string(number(rays_kind)) + "; must be 0, 1 or 2");
  }
}

std::vector<float> camera_tables(const Camera& camera) {
  const CameraAccess::Data& data = CameraAccess::data(camera);
  const std::string where = data.lens.name() + ": tables: ";
  if (data.tilted) throw Error(where + "the film is tilted or travels; must be upright and fixed");
  if (data.weights)
    throw Error(where + "the pupil has weights; must have no weights, as a host weights its own samples");
  if (data.focus) throw Error(where + "the camera has a focal surface or an expressive lens; must have neither");
  Numbers to;
  to.set(Table::format, 4);
  to.set(Table::model, std::ranges::find(models(), data.model.kind()) - models().begin());
  to.set(Table::wavelength_count, data.lens.wavelengths_nm().size());
  to.set(Table::primary_wavelength, data.lens.primary_wavelength());
  const TwoPlanes& space = data.model.pupils().space();
  to.set(Table::film_z, space.film_z), to.set(Table::pupil_z, space.pupil_z);
  to.set(Table::film_x, data.film.shift_x_mm), to.set(Table::film_y, data.film.shift_y_mm);
  to.set(Table::half_width, data.film.width_mm / 2 + data.film.margin_mm);
  to.set(Table::half_height, data.film.height_mm / 2 + data.film.margin_mm);
  to.set(Table::front_z, data.front.vertex_z), to.set(Table::front_curvature, data.front.curvature);
  to.begin(Table::wavelengths), to.add(data.lens.wavelengths_nm());
  to.begin(Table::scales), to.add(data.wavelengths.scales());

  const FilmPupilArrays pupils = data.model.pupils().arrays();
  const auto put = [&to](Table::Position at, const std::vector<float>& list) {
    to.begin(at);
    to.list.insert(to.list.end(), list.begin(), list.end());
  };
  put(Table::pupil_list, pupils.pupils);
  to.set(Table::pupils_kind, static_cast<int>(pupils.kind));
  to.set(Table::pupil_radius, pupils.film_radius);
  to.set(Table::rows, pupils.rows), to.set(Table::columns, pupils.columns);
  to.set(Table::height, pupils.height);
  put(Table::half_widths, pupils.half_widths);
  put(Table::stop_list, pupils.stop);
  to.set(Table::stop_size, pupils.stop.size());
  put(Table::iris, pupils.iris);
  to.set(Table::iris_blades, pupils.iris.empty() ? 0 : pupils.iris.size() / 2 - FilmPupilArrays::edge_terms);

  to.begin(Table::rays);
  if (const auto* paraxial = data.model.as<camera_detail::ParaxialModel>()) {
    put_maps(to, *paraxial);
  } else if (const auto* polynomial = data.model.as<PolynomialModel>()) {
    put_polynomial(to, polynomial->polynomial());
  } else if (data.model.kind() != ModelKind::custom) {
    put_surfaces(to, data.lens);
  } else {
    throw Error(where + "the model is custom; must be one of models()");
  }
  return std::move(to.list);
}

}  // namespace petzval
