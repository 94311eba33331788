// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "core/low_discrepancy.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/exports/calibration.hpp"
#include "petzval/lens/lens.hpp"
#include "radial_picture.hpp"

namespace petzval {
namespace {

/// An odd increasing function, by polynomials of degree 3 through the 4 nearest nodes. The first node is (0, 0).
double at_nodes(const std::vector<double>& from, const std::vector<double>& to, double x) {
  const auto above = std::upper_bound(from.begin(), from.end(), x);
  const auto last = static_cast<std::ptrdiff_t>(from.size()) - 4;
  const std::ptrdiff_t first = std::clamp(above - from.begin() - 2, std::ptrdiff_t{-1}, last);
  const auto node = [](const std::vector<double>& values, std::ptrdiff_t i) {
    return i < 0 ? -values[static_cast<std::size_t>(-i)] : values[static_cast<std::size_t>(i)];
  };
  double sum = 0;
  for (std::ptrdiff_t i = first; i < first + 4; ++i) {
    double term = node(to, i);
    for (std::ptrdiff_t k = first; k < first + 4; ++k) {
      if (k != i) term *= (x - node(from, k)) / (node(from, i) - node(from, k));
    }
    sum += term;
  }
  return sum;
}

/// Octahedral coordinates of a direction, -1 to 1, with -z in the centre, and back.
Vec2<double> octahedral(const Vec3<double>& d) {
  const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  const Vec2<double> p{d.x / sum, d.y / sum};
  if (d.z <= 0) return p;
  return {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y)};
}
Vec3<double> from_octahedral(const Vec2<double>& p) {
  const double forward = 1 - std::abs(p.x) - std::abs(p.y);
  Vec2<double> across = p;
  if (forward < 0) across = {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y)};
  return glm::normalize(Vec3<double>{across.x, across.y, -forward});
}

/// Bilinear interpolation between centres of texels, as textures are read; nullopt at an invalid texel.
template <int N, class Valid>
std::optional<std::array<double, N>> texture(const std::vector<float>& texels, int width, int height, double x,
                                             double y, const Valid& valid) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  std::array<double, N> sum{};
  for (const int j : {0, 1}) {
    for (const int i : {0, 1}) {
      const int column = std::clamp(static_cast<int>(left) + i, 0, width - 1);
      const int row = std::clamp(static_cast<int>(top) + j, 0, height - 1);
      const float* const texel =
          &texels[(static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)) *
                  N];
      if (!valid(texel)) return {};
      const double weight = std::abs(1 - i - (x - 0.5 - left)) * std::abs(1 - j - (y - 0.5 - top));
      for (std::size_t k = 0; k < N; ++k) sum[k] += weight * texel[k];
    }
  }
  return sum;
}

}  // namespace

OmniverseTables omniverse_tables(const Camera& camera, std::optional<double> subject_z_mm, int exit_size, int threads) {
  if (exit_size < 3) {
    throw Error("omniverse_tables: exit_size = " + std::to_string(exit_size) + "; must be 3 or more");
  }
  const exports_detail::RadialPicture picture(camera, subject_z_mm);
  const Film& film = camera.film();

  // The farthest lit point towards the corner.
  double lit = picture.corner;
  for (double dark = lit, inside = 0; dark - inside > 1e-3;) {
    (exports_detail::irradiance(camera, lit * film.pixel_mm()) > 0 ? inside : dark) = lit;
    if (inside == picture.corner) break;
    lit = (inside + dark) / 2;
  }
  // Fields and distances, up to a few texels beyond the corner, so that bilinear interpolation reaches the corner.
  std::vector<double> fields{0}, radii{0};
  double end = HUGE_VAL;
  for (double field = picture.widest / 1024; field < end; field += picture.widest / 1024) {
    const auto radius = picture.primary.radius(field);
    if (!radius || !(*radius > radii.back())) break;
    fields.push_back(field), radii.push_back(*radius);
    if (end == HUGE_VAL && *radius > picture.corner) end = field + 10.0 / exit_size;
  }
  if (fields.size() < 20) throw Error(camera.lens().name() + ": calibration: the picture is dark; must be lit");
  lit = std::min(lit, radii.back());

  OmniverseTables tables{.columns = film.columns, .rows = film.rows, .exit_size = exit_size};
  const Vec2<double> centre{film.columns / 2.0, film.rows / 2.0};
  const auto columns = static_cast<std::size_t>(film.columns), size = static_cast<std::size_t>(exit_size);
  tables.directions.resize(3 * columns * static_cast<std::size_t>(film.rows));
  tables.positions.assign(2 * size * size, -1);
  parallel_for(static_cast<std::size_t>(film.rows), 8, threads, [&](std::size_t begin, std::size_t stop) {
    for (std::size_t row = begin; row < stop; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        const double x = static_cast<double>(column) + 0.5 - centre.x, y = centre.y - (static_cast<double>(row) + 0.5);
        const double radius = std::hypot(x, y);
        float* const to = &tables.directions[3 * (row * columns + column)];
        to[0] = to[1] = 0, to[2] = 1;
        if (radius > lit) continue;
        const double field = at_nodes(radii, fields, radius);
        const double across = radius > 0 ? std::sin(field) / radius : 0;
        to[0] = static_cast<float>(across * x), to[1] = static_cast<float>(across * y);
        to[2] = static_cast<float>(-std::cos(field));
      }
    }
  });
  parallel_for(size, 8, threads, [&](std::size_t begin, std::size_t stop) {
    const auto coordinate = [&](std::size_t i) { return (2 * static_cast<double>(i) + 1) / exit_size - 1; };
    for (std::size_t row = begin; row < stop; ++row) {
      for (std::size_t column = 0; column < size; ++column) {
        const Vec3<double> d = from_octahedral({coordinate(column), coordinate(row)});
        const double across = std::hypot(d.x, d.y), field = std::atan2(across, -d.z);
        if (field > fields.back()) continue;
        const double scale = across > 0 ? at_nodes(fields, radii, field) / across : 0;
        float* const to = &tables.positions[2 * (row * size + column)];
        to[0] = static_cast<float>((centre.x + scale * d.x) / film.columns);
        to[1] = static_cast<float>((centre.y - scale * d.y) / film.rows);
      }
    }
  });

  // From a position through both tables, and back to a position.
  constexpr std::size_t count = 1 << 15;
  const core_detail::Kronecker<2> places(1);
  double squares = 0, largest = 0;
  std::size_t used = 0, left_out = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [s, t] = places(i);
    const double x = 0.5 + s * (film.columns - 1), y = 0.5 + t * (film.rows - 1);
    if (std::hypot(x - centre.x, y - centre.y) > lit) continue;
    const auto d =
        texture<3>(tables.directions, film.columns, film.rows, x, y, [](const float* v) { return v[2] != 1; });
    const Vec2<double> p = d ? octahedral({(*d)[0], (*d)[1], (*d)[2]}) : Vec2<double>{0, 0};
    const auto back = d ? texture<2>(tables.positions, exit_size, exit_size, (p.x + 1) / 2 * exit_size,
                                     (p.y + 1) / 2 * exit_size, [](const float* v) { return v[0] != -1; })
                        : std::nullopt;
    if (!back) {
      ++left_out;
      continue;
    }
    const double error = std::hypot((*back)[0] * film.columns - x, (*back)[1] * film.rows - y);
    squares += error * error, largest = std::max(largest, error), ++used;
  }
  if (used == 0) throw Error(camera.lens().name() + ": calibration: no texel is lit; must be more pixels");
  tables.fit = {.name = "omniverse_lut",
                .values = {{"exit_size", exit_size},
                           {"left_out", static_cast<double>(left_out) / static_cast<double>(used + left_out)}},
                .rms = std::sqrt(squares / static_cast<double>(used)),
                .largest = largest,
                .widest_field_rad = at_nodes(radii, fields, lit)};
  return tables;
}

std::string OmniverseTables::usd(std::string_view enter_file, std::string_view exit_file) const {
  const std::string prefix = "omni:lensdistortion:lut:";
  const auto asset = [&](const char* name, std::string_view file) {
    return "asset " + prefix + name + " = @./" + std::string(file) + "@\n";
  };
  return "prepend apiSchemas = [\"OmniLensDistortionLutAPI\"]\nuniform token omni:lensdistortion:model = \"lut\"\n"
         "float " +
         prefix + "nominalWidth = " + std::to_string(columns) + "\nfloat " + prefix +
         "nominalHeight = " + std::to_string(rows) + "\nfloat2 " + prefix + "opticalCenter = (" +
         to_text(columns / 2.0) + ", " + to_text(rows / 2.0) + ")\n" + asset("rayEnterDirectionTexture", enter_file) +
         asset("rayExitPositionTexture", exit_file);
}

}  // namespace petzval
