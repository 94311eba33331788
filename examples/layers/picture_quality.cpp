// SPDX-License-Identifier: Apache-2.0
#include "layers/picture_quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace lens_blur {
namespace {

using std::numbers::pi;

/// One value for each pixel.
struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
};

using Kernel = std::vector<double>;  // odd size, centred at 0

/// The convolution with across(x) down(y); pixels at the edges are repeated.
Plane convolved(const Plane& plane, const Kernel& across, const Kernel& down) {
  const auto along = [](const Plane& from, const Kernel& kernel, bool rows) {
    Plane to(from.width, from.height);
    const int reach = static_cast<int>(kernel.size() / 2);
    for (int y = 0; y < from.height; ++y) {
      for (int x = 0; x < from.width; ++x) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k) {
          const int column = rows ? std::clamp(x + k, 0, from.width - 1) : x,
                    row = rows ? y : std::clamp(y + k, 0, from.height - 1);
          sum += kernel[static_cast<std::size_t>(k + reach)] *
                 from.values[static_cast<std::size_t>(row * from.width + column)];
        }
        to.values[static_cast<std::size_t>(y * from.width + x)] = sum;
      }
    }
    return to;
  };
  return along(along(plane, across, true), down, false);
}

/// f(x) at whole numbers from -reach to reach.
template <class F>
Kernel kernel(int reach, const F& f) {
  Kernel result;
  for (int x = -reach; x <= reach; ++x) result.push_back(f(static_cast<double>(x)));
  return result;
}
Kernel normalised(Kernel k) {
  double sum = 0;
  for (const double v : k) sum += v;
  for (double& v : k) v /= sum;
  return k;
}

void check(const petzval::RgbImage& a, const petzval::RgbImage& b) {
  if (a.width == b.width && a.height == b.height) return;
  throw petzval::Error("compare: sizes = " + std::to_string(a.width) + " x " + std::to_string(a.height) + " and " +
                       std::to_string(b.width) + " x " + std::to_string(b.height) + "; must be equal");
}

glm::dvec3 clipped(const petzval::RgbImage& image, std::size_t pixel) {
  const float* const p = &image.pixels[3 * pixel];
  return glm::clamp(glm::dvec3(p[0], p[1], p[2]), 0.0, 1.0);
}

Plane luma(const petzval::RgbImage& image) {
  Plane plane(image.width, image.height);
  for (std::size_t i = 0; i < plane.values.size(); ++i) {
    plane.values[i] = glm::dot(clipped(image, i), glm::dvec3(0.2126, 0.7152, 0.0722));
  }
  return plane;
}

Plane ssim_map(const petzval::RgbImage& picture, const petzval::RgbImage& reference) {
  const Kernel window = normalised(kernel(5, [](double x) { return std::exp(-x * x / (2 * 1.5 * 1.5)); }));
  const Plane a = luma(picture), b = luma(reference);
  const auto product = [](const Plane& p, const Plane& q) {
    Plane result = p;
    for (std::size_t i = 0; i < p.values.size(); ++i) result.values[i] *= q.values[i];
    return result;
  };
  const auto mean = [&](const Plane& p) { return convolved(p, window, window); };
  const Plane ma = mean(a), mb = mean(b), aa = mean(product(a, a)), bb = mean(product(b, b)), ab = mean(product(a, b));
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  Plane map(a.width, a.height);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double x = ma.values[i], y = mb.values[i];
    map.values[i] = (2 * x * y + c1) * (2 * (ab.values[i] - x * y) + c2) /
                    ((x * x + y * y + c1) * (aa.values[i] - x * x + bb.values[i] - y * y + c2));
  }
  return map;
}

// Colour spaces of FLIP: linear RGB to XYZ of D65, relative to white. Listed by rows; GLM takes columns.
const glm::dmat3 to_xyz =
    glm::transpose(glm::dmat3(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,    // X
                              2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,      // Y
                              1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382));  // Z
const glm::dmat3 to_rgb = glm::inverse(to_xyz);
const glm::dvec3 white = to_xyz * glm::dvec3(1);

glm::dvec3 opponent(const glm::dvec3& rgb) {
  const glm::dvec3 n = to_xyz * rgb / white;
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}
glm::dvec3 from_opponent(const glm::dvec3& yc) {
  const double y = (yc.x + 16) / 116;
  return to_rgb * (glm::dvec3(y + yc.y / 500, y, y - yc.z / 200) * white);
}
/// L*a*b* with colours weakened in the dark (Hunt effect).
glm::dvec3 hunt_lab(const glm::dvec3& rgb) {
  const auto f = [](double t) {
    constexpr double limit = 6.0 / 29;
    return t > limit * limit * limit ? std::cbrt(t) : t / (3 * limit * limit) + 4.0 / 29;
  };
  const glm::dvec3 n = to_xyz * rgb / white;
  const double l = 116 * f(n.y) - 16;
  return {l, 0.01 * l * 500 * (f(n.x) - f(n.y)), 0.01 * l * 200 * (f(n.y) - f(n.z))};
}
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = a - b;
  return std::abs(d.x) + std::hypot(d.y, d.z);
}

constexpr double pixels_per_degree = 67;

/// The picture filtered by the contrast sensitivity of the eye, in perceptual colours.
std::vector<glm::dvec3> seen(const petzval::RgbImage& image) {
  struct Gauss {
    double a, b;
  };
  const std::array<std::array<Gauss, 2>, 3> channels{
      {{{{1, 0.0047}, {0, 1e-5}}}, {{{1, 0.0053}, {0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};
  const std::size_t pixels = image.pixels.size() / 3;
  std::vector<glm::dvec3> result(pixels, glm::dvec3(0));
  for (int c = 0; c < 3; ++c) {
    Plane plane(image.width, image.height);
    for (std::size_t i = 0; i < pixels; ++i) plane.values[i] = opponent(clipped(image, i))[c];
    const int reach = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    // Sums of separable Gaussians, each weighted by its part of the total. The height sqrt(pi / b) is the paper's, also
    // in two dimensions.
    double whole = 0;
    std::array<double, 2> parts{};
    std::array<Kernel, 2> kernels;
    for (std::size_t g = 0; g < 2; ++g) {
      const auto [a, b] = channels[static_cast<std::size_t>(c)][g];
      kernels[g] = kernel(reach, [b = b](double x) {
        return std::exp(-pi * pi * x * x / (pixels_per_degree * pixels_per_degree) / b);
      });
      double line = 0;
      for (const double v : kernels[g]) line += v;
      parts[g] = a * std::sqrt(pi / b) * line * line, whole += parts[g];
    }
    for (std::size_t g = 0; g < 2; ++g) {
      if (parts[g] == 0) continue;
      const Kernel k = normalised(kernels[g]);
      const Plane filtered = convolved(plane, k, k);
      for (std::size_t i = 0; i < pixels; ++i) result[i][c] += parts[g] / whole * filtered.values[i];
    }
  }
  for (glm::dvec3& p : result) p = hunt_lab(glm::clamp(from_opponent(p), 0.0, 1.0));
  return result;
}

/// Strength of edges and points.
struct Features {
  Plane edges, points;
};
Features features(const petzval::RgbImage& image) {
  Plane y(image.width, image.height);
  for (std::size_t i = 0; i < y.values.size(); ++i) y.values[i] = (opponent(clipped(image, i)).x + 16) / 116;
  const double deviation = 0.5 * 0.082 * pixels_per_degree;
  const int reach = static_cast<int>(std::ceil(3 * deviation));
  const auto gauss = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
  const Kernel smooth = normalised(kernel(reach, gauss));
  const auto balanced = [](Kernel k) {  // positive values sum to 1, negative values to -1
    double up = 0, down = 0;
    for (const double v : k) (v > 0 ? up : down) += v;
    for (double& v : k) v /= v > 0 ? up : -down;
    return k;
  };
  const Kernel slope = balanced(kernel(reach, [&](double x) { return -x * gauss(x); })),
               bend =
                   balanced(kernel(reach, [&](double x) { return (x * x / (deviation * deviation) - 1) * gauss(x); }));
  const auto strength = [&](const Kernel& k) {
    Plane result = convolved(y, k, smooth);
    const Plane other = convolved(y, smooth, k);
    for (std::size_t i = 0; i < y.values.size(); ++i) result.values[i] = std::hypot(result.values[i], other.values[i]);
    return result;
  };
  return {strength(slope), strength(bend)};
}

}  // namespace

Likeness likeness(const petzval::RgbImage& picture, const petzval::RgbImage& reference,
                  const std::vector<unsigned char>& mask) {
  check(picture, reference);
  const Plane map = ssim_map(picture, reference);
  double squares = 0, similar = 0, count = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    const glm::dvec3 off = clipped(picture, i) - clipped(reference, i);
    squares += glm::dot(off, off), similar += map.values[i], ++count;
  }
  return {squares > 0 ? 10 * std::log10(3 * count / squares) : std::numeric_limits<double>::infinity(),
          count > 0 ? similar / count : 1};
}

std::vector<float> flip(const petzval::RgbImage& picture, const petzval::RgbImage& reference) {
  check(picture, reference);
  const std::vector<glm::dvec3> a = seen(picture), b = seen(reference);
  const Features fa = features(picture), fb = features(reference);
  constexpr double power = 0.7, knee = 0.4, knee_value = 0.95;
  const double most = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), power);
  std::vector<float> result;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double colour = std::pow(hyab(a[i], b[i]), power);
    const double error = colour < knee * most
                             ? knee_value / (knee * most) * colour
                             : knee_value + (colour - knee * most) / ((1 - knee) * most) * (1 - knee_value);
    const double feature = std::max(std::abs(fa.edges.values[i] - fb.edges.values[i]),
                                    std::abs(fa.points.values[i] - fb.points.values[i]));
    result.push_back(static_cast<float>(std::pow(error, 1 - std::sqrt(feature / std::numbers::sqrt2))));
  }
  return result;
}

double energy_drift(const petzval::RgbImage& picture, const petzval::RgbImage& reference) {
  double a = 0, b = 0;
  for (const float v : picture.pixels) a += static_cast<double>(v);
  for (const float v : reference.pixels) b += static_cast<double>(v);
  return a / b - 1;
}

std::vector<unsigned char> near_depth_edges(const petzval::LayerSet& layers, const petzval::LensRays& rays) {
  const petzval::LayerCamera& camera = rays.camera();
  const int overscan = (layers.columns() - camera.columns) / 2;
  const float jump = static_cast<float>(1 / rays.largest_slope());
  std::vector<unsigned char> mask(static_cast<std::size_t>(camera.columns) * static_cast<std::size_t>(camera.rows));
  std::vector<petzval::LayerRay> found(rays.count());
  const auto depth = layers.inverse_depth(0);
  for (int row = 0; row + 1 < camera.rows; ++row) {
    for (int column = 0; column + 1 < camera.columns; ++column) {
      const auto at = [&](int x, int y) {
        return depth[static_cast<std::size_t>((row + y + overscan) * layers.columns() + column + x + overscan)];
      };
      const float least = std::min({at(0, 0), at(1, 0), at(0, 1)}), most = std::max({at(0, 0), at(1, 0), at(0, 1)});
      if (!(most - least > jump)) continue;
      rays.at(0, column, row, found);
      double reach = 1;
      for (const petzval::LayerRay& ray : found) {
        for (const float w : {least, most}) {
          const petzval::Vec2<double> off =
              ray.position + ray.slope * static_cast<double>(w) - petzval::Vec2<double>{column + 0.5, row + 0.5};
          reach = std::max(reach, std::hypot(off.x, off.y));
        }
      }
      const int r = static_cast<int>(std::ceil(reach));
      for (int y = std::max(0, row - r); y <= std::min(camera.rows - 1, row + r); ++y) {
        const auto begin = mask.begin() + static_cast<std::ptrdiff_t>(y) * camera.columns;
        const int half = static_cast<int>(std::sqrt(std::max(0, r * r - (y - row) * (y - row))));
        std::fill(begin + std::max(0, column - half), begin + std::min(camera.columns - 1, column + half) + 1,
                  static_cast<unsigned char>(1));
      }
    }
  }
  return mask;
}

std::string quality_plot(std::vector<RayQuality> qualities, const std::string& remark) {
  std::erase_if(qualities, [](const RayQuality& q) { return !std::isfinite(q.psnr_db); });
  std::ranges::sort(qualities, {}, &RayQuality::rays);
  constexpr double left = 70, right = 610, top = 70, foot = 350;
  double least = 0, most = 0, low = 0, high = 10;
  if (!qualities.empty()) {
    least = std::log10(qualities.front().rays) - 0.2, most = std::log10(qualities.back().rays) + 0.4;
    const auto [worst, best] = std::ranges::minmax(qualities, {}, &RayQuality::psnr_db);
    low = 10 * std::floor(worst.psnr_db / 10 - 0.3), high = 10 * std::floor(best.psnr_db / 10) + 10;
  }
  const auto y_of = [&](double psnr) { return foot - (psnr - low) / (high - low) * (foot - top); };
  examples::SvgPage page;
  page.text(16, 26, 17, "Quality and number of rays", "#000");
  page.text(16, 46, 13, "PSNR (dB) over rays per pixel, " + remark, "#000");
  for (double psnr = low; psnr <= high; psnr += 10) {
    page.rect(left, y_of(psnr), right - left, 1, "#ccc");
    page.text(left - 8, y_of(psnr) + 4, 13, examples::number(psnr), "#000", "end");
  }
  std::string line;
  for (const RayQuality& q : qualities) {
    const double x = left + (std::log10(q.rays) - least) / (most - least) * (right - left), y = y_of(q.psnr_db);
    line += (line.empty() ? "M" : "L") + examples::number(x, 4) + " " + examples::number(y, 4);
    page.disc(x, y, 4, "#1f5fc4");
    page.text(x + 8, y + 14, 13, examples::number(q.psnr_db, 3) + " dB", "#000");
    page.text(x, foot + 20, 13, examples::number(q.rays), "#000", "middle");
  }
  page.path(line, "stroke=\"#1f5fc4\" stroke-width=\"1.5\"");
  return page.finish(640, 400, "#fff");
}

}  // namespace lens_blur
