// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "petzval/core/parallel.hpp"
#include "single_image_blur.hpp"

namespace {

using Complex = std::complex<float>;
using Rgba = std::array<float, 4>;
using Lines = std::array<Complex, 4>;

/// exp(-a x^2) (A cos(b x^2) + B sin(b x^2)), summed over two components: a disc of radius 1.
struct Component {
  float a, b, real, imaginary;
};
constexpr std::array<Component, 2> components{
    {{0.886528f, 5.268909f, 0.411259f, -0.548794f}, {1.960518f, 1.558213f, 0.513282f, 4.561110f}}};
constexpr int half_taps = 16;
constexpr float support = 1.4f;  // in radii of the disc

using Kernel = std::array<Complex, 2 * half_taps + 1>;

/// The components along one axis; the sum over both axes is 1.
std::array<Kernel, 2> kernels() {
  std::array<Kernel, 2> result;
  float total = 0;
  for (std::size_t j = 0; j < 2; ++j) {
    Complex sum = 0;
    for (std::size_t i = 0; i < result[j].size(); ++i) {
      const float x = support * (static_cast<float>(i) / half_taps - 1);
      sum += result[j][i] = std::exp(Complex(-components[j].a, components[j].b) * (x * x));
    }
    total += components[j].real * (sum * sum).real() + components[j].imaginary * (sum * sum).imag();
  }
  for (Kernel& kernel : result) {
    for (Complex& value : kernel) value /= std::sqrt(total);
  }
  return result;
}

struct Size {
  int columns, rows, threads;

  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, rows - 1) * columns + std::clamp(x, 0, columns - 1));
  }
};

/// Filters rows (down = 0) or columns (down = 1), at pixels whose disc has a radius (px) above 0.
template <class From>
std::vector<Lines> filtered(const Size& size, const std::vector<From>& from, const std::vector<float>& radius,
                            const Kernel& kernel, int down) {
  std::vector<Lines> to(from.size());
  petzval::parallel_for(static_cast<std::size_t>(size.rows), 4, size.threads, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < size.columns; ++x) {
        const std::size_t i = size.pixel(x, y);
        const float step = support * radius[i] / half_taps;
        for (int tap = -half_taps; radius[i] > 0 && tap <= half_taps; ++tap) {
          const int off = static_cast<int>(std::lround(step * static_cast<float>(tap)));
          const From& source = from[size.pixel(x + (1 - down) * off, y + down * off)];
          const Complex value = kernel[static_cast<std::size_t>(tap + half_taps)];
          for (std::size_t c = 0; c < 4; ++c) to[i][c] += value * source[c];
        }
      }
    }
  });
  return to;
}

std::vector<Rgba> blurred(const Size& size, const std::vector<Rgba>& picture, const std::vector<float>& radius) {
  const std::array<Kernel, 2> both = kernels();
  std::vector<Rgba> result(picture.size());
  for (std::size_t j = 0; j < 2; ++j) {
    const auto lines = filtered(size, filtered(size, picture, radius, both[j], 0), radius, both[j], 1);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        result[i][c] += components[j].real * lines[i][c].real() + components[j].imaginary * lines[i][c].imag();
      }
    }
  }
  return result;
}

/// The radius of the largest disc that reaches a pixel, first along rows, then along columns.
std::vector<float> widest(const Size& size, std::vector<float> radius) {
  const int reach = static_cast<int>(std::ceil(*std::max_element(radius.begin(), radius.end())));
  for (const int down : {0, 1}) {
    const std::vector<float> from = radius;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const int x = static_cast<int>(i) % size.columns, y = static_cast<int>(i) / size.columns;
      for (int off = -reach; off <= reach; ++off) {
        const float other = from[size.pixel(x + (1 - down) * off, y + down * off)];
        if (static_cast<float>(std::abs(off)) <= other) radius[i] = std::max(radius[i], other);
      }
    }
  }
  return radius;
}

}  // namespace

petzval::RgbImage separable_blur(const petzval::LayerSet& layers, const petzval::LayerCamera& camera,
                                 const CircleOfConfusion& circle, int threads) {
  const Size size{layers.columns(), layers.rows(), threads};
  const auto w = layers.inverse_depth(0);
  std::array<std::vector<Rgba>, 2> field;  // behind and before the plane of focus
  std::array<std::vector<float>, 2> radius;
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t i = 0; i < w.size(); ++i) {
      const double off = circle.px_mm * (std::max(static_cast<double>(w[i]), 0.0) - circle.inverse_focus);
      radius[side].push_back(static_cast<float>(std::max(side == 0 ? -off : off, 0.0)));
      // Blurs below a pixel fade into the picture.
      const float part = std::min(radius[side][i], 1.0f);
      const auto rgba = layers.rgba(0, i);
      field[side].push_back({part * rgba[0], part * rgba[1], part * rgba[2], part});
    }
    field[side] = blurred(size, field[side], side == 0 ? radius[0] : widest(size, radius[1]));
  }
  petzval::RgbImage picture(camera.columns, camera.rows);
  const int overscan = (layers.columns() - camera.columns) / 2;
  for (int y = 0; y < camera.rows; ++y) {
    for (int x = 0; x < camera.columns; ++x) {
      const std::size_t i = size.pixel(x + overscan, y + overscan);
      for (std::size_t c = 0; c < 3; ++c) {
        float colour = layers.rgba(0, i)[c];
        for (std::size_t side = 0; side < 2; ++side) {
          const float of = field[side][i][3];
          const float part = of < 0.01f ? 0 : side == 0 ? std::min(radius[0][i], 1.0f) : std::min(of, 1.0f);
          if (part > 0) colour += part * (field[side][i][c] / of - colour);
        }
        picture.pixel(x, y)[c] = colour;
      }
    }
  }
  return picture;
}
