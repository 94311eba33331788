// SPDX-License-Identifier: Apache-2.0
// Loops over pupils that gain less than 15 % from wider registers, because gathering or searching dominates.
#include "polygon_blocks.hpp"
#include "polygon_loops.hpp"

namespace petzval::pupil_table_detail {
namespace {

template <int dimensions, class R>
void stop_points(const PolygonGrid<dimensions, R>& grid, std::size_t count, const R* film_x, const R* film_y,
                 const R* x, const R* y, const RayWavelengths& wavelengths, R* stop_x, R* stop_y) noexcept {
  const R* const in[4] = {film_x, film_y, x, y};
  R* const out[2] = {stop_x, stop_y};
  by_blocks(grid, count, in, wavelengths, out,
            [&grid](auto block, const R* const* of, const std::int32_t* w, R* const* to) {
              stop_points_block<decltype(block)::value>(grid, of[0], of[1], of[2], of[3], w, to[0], to[1]);
            });
}

template <int dimensions>
double area_of_one(const PolygonGrid<dimensions, double>& grid, double film_x, double film_y, double x, double y,
                   std::int32_t wavelength) noexcept {
  double area = 0;
  with_kind(grid, [&](auto obscured, auto stopped) {
    areas_block<1, decltype(obscured)::value, decltype(stopped)::value>(grid, &film_x, &film_y, &x, &y, &wavelength,
                                                                        &area);
  });
  return area;
}

template <int dimensions>
constexpr PlainLoops<dimensions> loops{
    {stop_points<dimensions, float>}, {stop_points<dimensions, double>}, area_of_one<dimensions>};

}  // namespace

const SampleLoops<2> quadrant_samples{
    {sample<2, float>, areas<2, float>}, {sample<2, double>, areas<2, double>}, sample_one<2, double>};
const PlainLoops<1> plain_polar_loops = loops<1>;
const PlainLoops<2> plain_quadrant_loops = loops<2>;

}  // namespace petzval::pupil_table_detail
