// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "petzval/core/units.hpp"
#include "petzval/psf/bundle.hpp"
#include "petzval/surface/asphere.hpp"
#include "ray_batch.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Box {
  double x_min = infinity, x_max = -infinity, y_min = infinity, y_max = -infinity;

  void take(double x, double y) noexcept {
    x_min = std::min(x_min, x), x_max = std::max(x_max, x);
    y_min = std::min(y_min, y), y_max = std::max(y_max, y);
  }
  Box grown(double by_x, double by_y) const noexcept {
    return {x_min - by_x, x_max + by_x, y_min - by_y, y_max + by_y};
  }
  double width() const noexcept { return x_max - x_min; }
  double height() const noexcept { return y_max - y_min; }
  double area() const noexcept { return width() * height(); }
};

/// The slab between the lowest and the highest point of the first surface, and its half height.
struct Front {
  double half = 0, z_min = 0, z_max = 0;
};

Front front_of(const Lens& lens, const Pupil& entrance) {
  Front front;
  front.half = lens.surfaces().front().semi_diameter;
  if (!std::isfinite(front.half)) {
    double widest = entrance.diameter / 2;
    for (const LensSurface& s : lens.surfaces()) {
      if (std::isfinite(s.semi_diameter)) widest = std::max(widest, s.semi_diameter);
    }
    front.half = 4 * widest;
  }
  const auto view = lens.view<double>();
  const auto& row = view.surfaces[0];
  kernel::Asphere<double> surface;
  surface.base = row.quadric;
  if (row.asphere >= 0) surface = view.aspheres[row.asphere];
  constexpr int samples = 64;
  for (int i = 0; i <= samples; ++i) {
    const double r = front.half * i / samples;
    const auto [z, slope, defined] = kernel::sag(surface, r * r);
    if (!defined || !std::isfinite(z)) break;
    front.z_min = std::min(front.z_min, z);
    front.z_max = std::max(front.z_max, z);
  }
  const double between_samples = 0.02 * (front.z_max - front.z_min);
  front.z_min -= between_samples;
  front.z_max += between_samples;
  return front;
}

/// A rectangle of the plane that all rays cross which meet the front: the shadow of a box around it.
Box shadow(const Front& front, const ScenePoint& point, double plane_z) {
  const double slope = std::tan(point.field_rad);
  Box box;
  for (const double z : {front.z_min, front.z_max}) {
    // The chief ray passes here at height h; what lies beside it grows or shrinks on the way to the plane.
    const double h = slope * (plane_z - z);
    const double magnification = std::isinf(point.z) ? 1.0 : (plane_z - point.z) / (z - point.z);
    for (const double side : {-front.half, front.half}) box.take(magnification * side, magnification * (side - h));
  }
  return box;
}

void check(const Lens& lens, const ScenePoint& point, const Pupil& entrance, std::size_t wavelength) {
  const std::string where = lens.name() + ": scene point: ";
  if (wavelength >= lens.wavelengths_nm().size()) {
    throw Error(where + "wavelength " + std::to_string(wavelength) + " does not exist, wanted one of " +
                std::to_string(lens.wavelengths_nm().size()));
  }
  if (!(std::abs(point.field_rad) < std::numbers::pi / 2)) {
    throw Error(where + "field is " + number(degrees(point.field_rad), 6) +
                " degrees, wanted less than 90: rays from beyond do not cross the plane of the entrance pupil");
  }
  if (!std::isfinite(entrance.z)) {
    throw Error(where + "the entrance pupil is at infinity, wanted one at a finite place: fields are seen from it");
  }
  if (!(point.z < infinity)) throw Error(where + "z is " + number(point.z) + " mm, wanted a finite one or -inf");
  if (point.z == entrance.z) {
    throw Error(where + "z is " + number(point.z) + " mm, that of the entrance pupil, wanted another");
  }
}

}  // namespace

PupilWindow pupil_window(const Lens& lens, const ScenePoint& point, std::size_t wavelength) {
  const Pupil entrance = pupils(lens, lens.central_wavelength()).entrance;
  check(lens, point, entrance, wavelength);
  const Front front = front_of(lens, entrance);
  if (!(point.z < front.z_min)) {
    throw Error(lens.name() + ": scene point: z is " + number(point.z) +
                " mm, wanted less than where the first surface begins, " + number(front.z_min) + " mm");
  }
  PupilWindow window{.point = point, .plane_z = entrance.z};
  if (entrance.diameter == 0 || front.half == 0) return window;

  constexpr int coarsest = 65, finest = 1025;  // nodes a side
  constexpr std::size_t enough = 16;           // passing nodes from which on the region has a place
  detail::RayBatch row(finest);
  int nodes = coarsest;
  Box box = shadow(front, point, entrance.z);
  for (int pass = 0; pass < 32; ++pass) {
    const double cell_x = box.width() / (nodes - 1), cell_y = box.height() / (nodes - 1);
    Box passing;
    std::size_t count = 0;
    for (int j = 0; j < nodes; ++j) {
      const double y = box.y_min + j * cell_y;
      row.clear();
      for (int i = 0; i < nodes; ++i) row.push(ray_through(point, entrance, box.x_min + i * cell_x, y));
      row.trace(lens, wavelength);
      for (int i = 0; i < nodes; ++i) {
        if (!row.transmitted(static_cast<std::size_t>(i))) continue;
        passing.take(box.x_min + i * cell_x, y);
        ++count;
      }
    }
    if (count < enough && nodes < finest) {
      nodes = 2 * nodes - 1;
      continue;
    }
    if (count == 0) return window;
    // Where the region reaches the edge of the box, a coarser grid has missed some of it: look again, farther out.
    const bool cut = passing.x_min <= box.x_min || passing.x_max >= box.x_max || passing.y_min <= box.y_min ||
                     passing.y_max >= box.y_max;
    const Box next =
        passing.grown(std::max(2 * cell_x, passing.width() / 32), std::max(2 * cell_y, passing.height() / 32));
    const bool fits = !cut && next.area() >= box.area() / 2;
    // A thin region, a crescent or a ring, has tips that run out between the nodes.
    const double fill = static_cast<double>(count) / (nodes * nodes);
    const int wanted = fill > 0.5 ? coarsest : fill > 0.25 ? 257 : finest;
    box = next;
    if (fits && nodes >= wanted) break;
    nodes = fits ? 2 * nodes - 1 : coarsest;
  }
  window.empty = false;
  window.x_min = box.x_min, window.x_max = box.x_max;
  window.y_min = box.y_min, window.y_max = box.y_max;
  return window;
}

}  // namespace petzval
