// SPDX-License-Identifier: Apache-2.0
// Images of point lights through any lens.
#include "petzval/analysis/psf.hpp"

#include <array>
#include <numeric>

#include "laws.hpp"
#include "wild_lens.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const int work = bytes.byte();
    const Lens lens = fuzz::wild_lens(bytes);
    const double z = bytes.one_in(2) ? -HUGE_VAL : bytes.number(-1e4, -1);
    const FieldPoint point{bytes.number(0, 1), z, bytes.one_in(4) ? bytes.number(-3, 3) : 0};
    if (work < 32) {
      for (const Spot& spot : spot_diagram(lens, z, std::array{point.field_rad}, 32).values) {
        fuzz::require(std::isfinite(spot.size.rms_radius) && spot.size.rms_radius <= spot.size.max_radius * 1.000001,
                      "a spot is at most as large as its farthest ray");
      }
      return;
    }
    if (work < 48) {
      const PsfKernel kernel = psf_kernel(lens, lens, point, 0, {.samples = 64, .pixels = 3, .seed = bytes.byte()});
      for (const float light : kernel.light) fuzz::require(std::isfinite(light) && light >= 0, "a kernel is finite");
      return;
    }
    PsfOptions options{.samples = 64, .pixels = bytes.count(1, 5), .seed = bytes.byte()};
    if (bytes.one_in(4)) options.half_width_mm = bytes.number(0, 1);
    const Psf image = point_image(lens, point, options);
    const Psf& psf = image;
    const std::size_t plane = psf.counts.size() / psf.wavelengths_nm.size();
    for (std::size_t w = 0; w < psf.wavelengths_nm.size(); ++w) {
      const auto begin = psf.counts.begin() + static_cast<std::ptrdiff_t>(w * plane);
      const std::uint64_t sum = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(plane), std::uint64_t{0});
      fuzz::require(sum <= psf.transmitted[w], "an image has at most the light that passes the lens");
      fuzz::require(psf.transmitted[w] <= psf.sent[w] * psf.units_per_ray, "at most the emitted light passes");
      fuzz::require(std::isfinite(psf.throughput(w)) && psf.throughput(w) >= 0, "throughput is 0 or more");
    }
    for (const double ring : image.radial_profile)
      fuzz::require(!std::isnan(ring) && ring >= 0, "a ring has light or is empty");
  });
  return 0;
}
