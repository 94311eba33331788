// SPDX-License-Identifier: Apache-2.0
// The table that petzval/petzval_camera.h reads.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "camera/polynomial_model.hpp"
#include "camera_data.hpp"
#include "core/chebyshev.hpp"
#include "lens/lens_view.hpp"
#include "make_model.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/petzval_camera.h"
#include "pupil_table/scene_grid.hpp"
#include "scene_side.hpp"

namespace petzval {
namespace {

/// The array under construction.
class Numbers {
 public:
  std::vector<float> list = std::vector<float>(PZ_HEAD, 0.0f);

  template <class T>
  void set(std::size_t at, T value) {
    list[at] = static_cast<float>(value);
  }
  /// Starts a list: stores the position of the next number at `at`.
  void begin(std::size_t at) { set(at, list.size()); }
  /// Numbers beyond the range of float become the largest numbers of a table.
  void add(double value) {
    constexpr double largest = 3.2e38;
    list.push_back(static_cast<float>(std::clamp(value, -largest, largest)));
  }
  template <class Values>
  void add_all(const Values& values) {
    for (const auto value : values) add(double{value});
  }
  /// A grid of pupils: pz_cell_at().
  /// @param cells along each axis; 0: there is no such axis
  /// @param stops numbers of the stop at each node; may be empty
  void add_grid(std::size_t at, const std::array<std::size_t, 3>& cells, std::span<const float> nodes,
                std::size_t node_size, std::span<const float> stops = {}, std::size_t stop_size = 0) {
    begin(at), set(at + 1, node_size + stop_size), set(at + 2, node_size);
    for (std::size_t axis = 0; axis < 3; ++axis) set(at + 3 + axis, cells[axis]);
    for (std::size_t node = 0; node < nodes.size() / node_size; ++node) {
      add_all(nodes.subspan(node * node_size, node_size)), add_all(stops.subspan(node * stop_size, stop_size));
    }
  }
};

/// Numbers by wavelength (pz_number()): for compiled wavelengths, and as polynomials for the others.
void put_wavelengths(Numbers& to, const CameraAccess::Data& data) {
  const Lens& lens = data.lens;
  const std::size_t count = lens.surface_count(), wavelengths = lens.wavelengths_nm().size();
  to.set(PZ_WAVELENGTH_COUNT, wavelengths);
  to.set(PZ_PRIMARY, lens.primary_wavelength());
  to.begin(PZ_WAVELENGTHS), to.add_all(lens.wavelengths_nm());
  const auto facts_at = [&](Wavelength wavelength) {
    const auto facts = data.scene().facts_at(wavelength);
    return std::array{data.wavelengths.scale(wavelength), facts.we, facts.density, facts.entrance_area};
  };
  to.begin(PZ_NUMBERS);
  for (std::size_t w = 0; w < wavelengths; ++w) {
    to.add_all(facts_at(w));
    const auto square = [&](std::size_t space) { return lens.index(space, w) * lens.index(space, w); };
    for (std::size_t space = 0; space <= count; ++space) to.add(square(space));
    for (std::size_t i = 0; i < count; ++i) {
      to.add((lens.index(i + 1, w) - lens.index(i, w)) * (lens.index(i + 1, w) + lens.index(i, w)));
    }
  }
  to.begin(PZ_POWERS);
  const auto& sequence = kernel::view<double>(lens).sequence_to_film;
  const auto& coordinate = sequence.coordinate;
  // Empty if indices between the compiled wavelengths are unknown.
  to.set(PZ_SHORTEST, coordinate.shortest), to.set(PZ_LONGEST, coordinate.longest);
  if (!(coordinate.shortest <= coordinate.longest) || wavelengths == 1) return;
  to.set(PZ_T_SCALE, coordinate.scale), to.set(PZ_T_OFFSET, coordinate.offset);
  for (std::size_t k = 0; k < 4; ++k) {
    to.add_all(core_detail::by_powers(core_detail::chebyshev_series<8>([&](double t) {
      const double nm = coordinate.scale / (t + coordinate.offset);
      return facts_at(Wavelength::nm(std::clamp(nm, coordinate.shortest, coordinate.longest)))[k];
    })));
  }
  for (std::size_t space = 0; space <= count; ++space) to.add_all(sequence.media[space].by_power);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t p = 0; p < 8; ++p) to.add(sequence.media[i + 1].by_power[p] - sequence.media[i].by_power[p]);
  }
}

void put_surfaces(Numbers& to, const Lens& lens) {
  const auto& view = kernel::view<float>(lens);
  const std::size_t count = lens.surface_count();
  to.set(PZ_SURFACE_COUNT, count);
  to.set(PZ_MIRRORS, std::ranges::count_if(lens.surfaces(), [](const LensSurface& s) { return s.mirror; }));
  to.begin(PZ_SURFACES);
  const std::size_t first = to.list.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [quadric, gap, rim2, dark2, asphere, mirror, sense] = view.surfaces[i];
    to.add_all(std::array{view.vertex_z[i], gap, quadric.curvature, quadric.e, quadric.ax, quadric.ay, rim2, dark2});
    to.add_all(std::array{mirror ? 1.0 : 0.0, lens.stop() == i ? 1.0 : 0.0, 0.0, 0.0});
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (view.surfaces[i].asphere < 0) continue;
    const auto& asphere = view.aspheres[view.surfaces[i].asphere];
    to.begin(first + PZ_SURFACE_SIZE * i + 10);
    // Terms of rho^k for k = 2, 2 + step, ...
    const bool odd = asphere.odd_count > 0;
    const int terms = odd ? std::max(2 * asphere.even_count - 1, 2 * asphere.odd_count) : asphere.even_count;
    to.add(asphere.height), to.add(asphere.rim2), to.add(terms), to.add(odd ? 1 : 2);
    for (std::size_t k = 0; k < static_cast<std::size_t>(terms); ++k) {
      to.add(!odd ? asphere.even[k] : k % 2 == 1 ? asphere.odd[k / 2] : asphere.even[k / 2]);
    }
  }
  to.begin(PZ_EDGES);
  const auto iris = kernel::view<double>(lens).iris;
  to.set(PZ_BLADES, iris.size());
  for (const auto& [nx, ny, bend, distance] : iris) to.add_all(std::array{nx, ny, bend, distance});
}

void put_polynomial(Numbers& to, const RayPolynomial& polynomial) {
  const RayPolynomial::Domain& domain = polynomial.domain();
  to.set(PZ_RAYS, 1);
  to.set(PZ_REFERENCE_Z, domain.reference_z);
  to.set(PZ_DEGREE, polynomial.degree());
  to.set(PZ_DOMAIN, domain.film_radius);
  const auto along_x = domain.along_x.value_or(RayPolynomial::Domain::Section{domain.pupil_shift, domain.pupil_radius});
  to.set(PZ_DOMAIN + 1, along_x.pupil_shift), to.set(PZ_DOMAIN + 2, along_x.pupil_radius);
  to.set(PZ_DOMAIN + 3, domain.pupil_shift), to.set(PZ_DOMAIN + 4, domain.pupil_radius);
  to.begin(PZ_TERMS);
  for (const RayPolynomial::Fit& fit : polynomial.fits()) {
    to.add_all(fit.direction_by_film), to.add_all(fit.direction_by_pupil);
    to.add_all(fit.offset_by_film), to.add_all(fit.offset_by_pupil);
  }
}

void put_film(Numbers& to, const CameraAccess::Data& data) {
  const TwoPlanes& space = data.model.pupils().space();
  to.set(PZ_FILM_Z, space.film_z), to.set(PZ_PUPIL_Z, space.pupil_z);
  to.set(PZ_FILM_X, data.film.shift_x_mm), to.set(PZ_FILM_Y, data.film.shift_y_mm);
  to.set(PZ_FILM_WIDTH, data.film.width_mm), to.set(PZ_FILM_HEIGHT, data.film.height_mm);
  to.set(PZ_MARGIN, data.film.margin_mm);
  to.set(PZ_COLUMNS, data.film.columns), to.set(PZ_ROWS, data.film.rows);
  to.set(PZ_FRONT_Z, data.front.vertex_z), to.set(PZ_FRONT_CURVATURE, data.front.curvature);
  to.set(PZ_FRONT_FIRST, data.front.first_surface ? 1 : 0);
}

void put_pupils(Numbers& to, const FilmPupilArrays& pupils) {
  to.set(PZ_REACH, pupils.reach), to.set(PZ_ROWS_PER_MM, pupils.rows_per_mm), to.set(PZ_IRIS_AREA, pupils.iris_area);
  to.begin(PZ_HALF_WIDTHS), to.add_all(pupils.half_widths);
  to.begin(PZ_IRIS), to.add_all(pupils.iris);
  const bool of_revolution = pupils.dimensions == 1;
  to.add_grid(PZ_FILM_GRID, {of_revolution ? pupils.rows : pupils.columns, of_revolution ? 0 : pupils.rows, 0},
              pupils.nodes, pupils.node_size, pupils.stops, pupils.stop_size);
}

void put_entrance(Numbers& to, const EntrancePupilArrays& entrance) {
  to.set(PZ_CENTRE_Z, entrance.centre_z), to.set(PZ_STEEPEST, entrance.steepest);
  to.set(PZ_FRONT_HALF, entrance.front_half);
  to.begin(PZ_BALLS), to.add_all(entrance.balls);
  to.begin(PZ_WIDEST), to.add_all(entrance.widest);
  const bool of_revolution = entrance.dimensions == 2;
  constexpr std::size_t distances = pupil_table_detail::SceneChart<1>::distances;
  const std::size_t fields =
      of_revolution ? pupil_table_detail::SceneChart<1>::fields : pupil_table_detail::SceneChart<2>::fields;
  to.add_grid(PZ_SCENE_GRID, {fields, of_revolution ? 0 : fields, distances}, entrance.nodes, entrance.node_size);
}

}  // namespace

std::vector<float> camera_table(const Camera& camera) {
  const CameraAccess::Data& data = CameraAccess::data(camera);
  const std::string where = data.lens.name() + ": table of the camera: ";
  if (data.tilted) throw Error(where + "the film is tilted or travels; must be upright and fixed");
  if (data.transmission)
    throw Error(where + "the camera has transmission; must be without, as a table has no coatings");
  if (data.weights)
    throw Error(where + "the pupil has weights; must have no weights, as a host weights its own samples");
  if (data.focus) throw Error(where + "the camera has a focal surface or an expressive lens; must have neither");
  const RayPolynomial* const polynomial = data.model.polynomial();
  const ModelKind kind = data.model.kind();
  if (!kind.is_exact() && !polynomial) {
    throw Error(where + "the model is " + std::string(name(kind)) +
                "; must be exact_float, exact_double or a polynomial");
  }
  Numbers to;
  to.set(0, PZ_FORMAT);
  put_wavelengths(to, data);
  put_surfaces(to, data.lens);
  put_film(to, data);
  put_pupils(to, data.model.pupils().arrays());
  if (polynomial) put_polynomial(to, *polynomial);
  put_entrance(to, data.scene().entrance().arrays());
  to.set(1, to.list.size());
  return std::move(to.list);
}

}  // namespace petzval
