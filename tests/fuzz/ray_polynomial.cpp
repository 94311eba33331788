// SPDX-License-Identifier: Apache-2.0
// Files of ray polynomials: they round-trip to the byte, and their rays are finite.
#include "polynomial/ray_polynomial.hpp"

#include <array>

#include "io/ray_polynomial_json.hpp"
#include "laws.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  fuzz::done([&] {
    const RayPolynomial read = parse_ray_polynomial({reinterpret_cast<const char*>(data), size}, "x");
    const std::string json = format_ray_polynomial(read);
    fuzz::require(format_ray_polynomial(parse_ray_polynomial(json, "x")) == json,
                  "a polynomial round-trips to the same bytes");
    const auto& domain = read.domain();
    for (const double part : {0.0, 0.3, -0.9, 2.0}) {
      const TwoPlaneRay line{part * domain.film_radius, 0.1, part * domain.pupil_radius, 0.2};
      Ray<double> ray;
      read.to_scene(line, {}, ray);
      fuzz::require(fuzz::finite(ray), "a ray of a polynomial is finite");
    }
  });
  return 0;
}
