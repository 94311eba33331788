// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/psf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace psf_set_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_error;
using testing::expect_tokens;
using testing::message;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr PsfOptions small{.samples = 1 << 15, .pixels = 33};

double sum(const PsfKernel& kernel) { return std::accumulate(kernel.light.begin(), kernel.light.end(), 0.0); }

/// Mean of the hits of a kernel, weighted by the light of its rays.
Vec2<double> mean_hit(const PsfKernel& kernel) {
  Vec2<double> mean{0, 0};
  double light = 0;
  for (std::size_t i = 0; i < kernel.hits_x.size(); ++i) {
    if (std::isnan(kernel.hits_x[i])) continue;
    const double own = static_cast<double>(i) / kernel.pixels - static_cast<double>(i % 33) / kernel.pixels + 0.5;
    mean += own * Vec2<double>{kernel.hits_x[i], kernel.hits_y[i]};
    light += own;
  }
  return mean / light;
}

TEST(PsfKernel, LightAndThroughputHaveTheirDefinitions) {
  const Lens open = data_lens("double_gauss_100mm_f2_28deg");
  for (const double f_number : {2.0, 4.0}) {
    const Lens lens = with_focus(with_f_number(open, f_number), 2000);
    for (const double field : {0.0, 10.0, 14.0}) {
      const FieldPoint point{radians(field), -1200};
      const PsfKernel kernel = psf_kernel(lens, open, point, 0, small);
      const Psf image = point_image(lens, point, {.samples = small.samples, .pixels = 33});
      EXPECT_EQ(kernel.throughput, image.mean_throughput);
      EXPECT_EQ(kernel.error, image.error);
      EXPECT_NEAR(sum(kernel), kernel.total, 1e-5 * kernel.total);
      // Photographic lenses obey the sine condition, so that the solid angle on the axis is proportional to 1 / N^2.
      const double stop = 4 / (f_number * f_number);
      EXPECT_NEAR(kernel.total, stop * *relative_illumination(lens, point), 1e-3 * stop) << f_number << ' ' << field;
    }
  }
}

TEST(PsfKernel, IsAnchoredAtTheChiefRayAndStandsUpright) {
  const Lens open = data_lens("double_gauss_100mm_f2_28deg"), lens = with_focus(open, 2000);
  for (const double z : {-1200.0, -infinity}) {
    const FieldPoint point{radians(12), z};
    const PsfKernel kernel = psf_kernel(lens, open, point, 0, small);
    const auto spots = spot_diagram(lens, z, std::array{point.field_rad}, small.samples).values;
    ASSERT_TRUE(kernel.chief_ray);
    EXPECT_EQ(kernel.anchor_mm.y, spots[0].chief_ray_height);
    EXPECT_LT(kernel.anchor_mm.y, -20) << "upside down on the film";
    double x = 0, y = 0;
    for (int row = 0; row < kernel.pixels; ++row) {
      for (int column = 0; column < kernel.pixels; ++column) {
        const double light = kernel.light[static_cast<std::size_t>(row * kernel.pixels + column)];
        x += light * (column - 16) * kernel.pixel_mm / kernel.total;
        y += light * (16 - row) * kernel.pixel_mm / kernel.total;
      }
    }
    const SpotSize& size = spots[0].size;
    ASSERT_GT(std::abs(size.centroid.y - kernel.anchor_mm.y), 0.003);
    EXPECT_NEAR(x, 0, 0.05 * kernel.pixel_mm);
    EXPECT_NEAR(y, kernel.anchor_mm.y - size.centroid.y, 0.1 * kernel.pixel_mm);
    EXPECT_NEAR(mean_hit(kernel).x, 0, 1e-3 * size.rms_radius);
    EXPECT_NEAR(mean_hit(kernel).y, kernel.anchor_mm.y - size.centroid.y, 0.01 * size.rms_radius);
  }
}

/// Azimuths of the pupil run from +y to +x, and the lens is symmetric about the meridian. The blur is 1.5 mm wide.
TEST(PsfKernel, RaysAreMirrored) {
  const Lens open = data_lens("double_gauss_100mm_f2_28deg");
  const PsfKernel kernel = psf_kernel(open, open, {radians(12), -1200}, 0, small);
  float worst = 0;
  for (std::size_t row = 0; row < 33; ++row) {
    for (std::size_t column = 0; column < 33; ++column) {
      const std::size_t i = 33 * row + column, mirrored = 33 * row + 32 - column;
      ASSERT_EQ(std::isnan(kernel.hits_x[i]), std::isnan(kernel.hits_x[mirrored]));
      if (std::isnan(kernel.hits_x[i])) continue;
      worst = std::max({worst, std::abs(kernel.hits_x[i] + kernel.hits_x[mirrored]),
                        std::abs(kernel.hits_y[i] - kernel.hits_y[mirrored])});
    }
  }
  EXPECT_LT(worst, 0.05);
}

TEST(PsfKernel, DarkPointIsDark) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  const PsfKernel kernel = psf_kernel(lens, lens, {radians(80), -infinity}, 0, small);
  EXPECT_EQ(kernel.total, 0);
  EXPECT_EQ(sum(kernel), 0);
  EXPECT_TRUE(std::all_of(kernel.hits_x.begin(), kernel.hits_x.end(), [](float x) { return std::isnan(x); }));
  const PsfKernel lit = psf_kernel(lens, lens, {0, -infinity}, 0, small);
  const PsfSet set({{0, 80}, {infinity}, {d_line_nm}, {5}}, {lit, kernel});
  EXPECT_NEAR(sum(set.at({20, infinity, d_line_nm, 5})), 0.75 * 0.75 * lit.total, 1e-5);
  const PsfSet dark({{70, 80}, {infinity}, {d_line_nm}, {5}}, {kernel, kernel});
  EXPECT_EQ(sum(dark.at({75, infinity, d_line_nm, 5})), 0);
}

TEST(PsfKernel, RefusesEvenPixels) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  for (const int pixels : {0, 1, 32, -3}) {
    const PsfOptions options{.pixels = pixels};
    expect_error([&] { psf_kernel(lens, lens, {0, -1000}, 0, options); }, {"pixels", pixels});
  }
  expect_error([&] { psf_kernel(lens, lens, {0, -1000}, 7, small); }, {"wavelength", 7});
}

/// PSF sets of a lens over some axes, compared with traced points between the nodes.
struct Study {
  Lens open;
  double focus_mm;
  PsfOptions options{.samples = 1 << 17, .pixels = 65, .threads = 2};

  PsfKernel kernel(const PsfSetPoint& point, double half_width = 0, std::uint32_t seed = 0) const {
    PsfOptions own = options;
    own.half_width_mm = half_width;
    own.seed = seed;
    const Lens lens = with_focus(with_f_number(open, point.f_number), focus_mm);
    return psf_kernel(lens, open, {radians(point.field_deg), -point.distance_mm},
                      open.wavelength_index(Wavelength::nm(point.wavelength_nm)), own);
  }
  PsfSet set(const PsfSet::Axes& axes) const {
    std::vector<PsfKernel> kernels;
    for (std::size_t i = 0; i < axes.size(); ++i) kernels.push_back(kernel(axes.point(i)));
    return {axes, kernels};
  }
  /// Per cent of light that differs from the traced kernel, minus the median noise between two traced kernels.
  double error(const PsfSet& set, const PsfSetPoint& point) const {
    const PsfKernel between = set.at(point);
    const double half = between.pixels * between.pixel_mm / 2;
    const PsfKernel traced = kernel(point, half, 1), again = kernel(point, half, 2);
    EXPECT_NEAR(between.total, traced.total, 0.02 * traced.total);
    EXPECT_NEAR(between.anchor_mm.y, traced.anchor_mm.y, 0.005);
    return 100 * (total_variation(between, traced) - total_variation(traced, again));
  }
};

TEST(PsfSet, NodesEqualTheirKernelsToTheBit) {
  const Study study{data_lens("double_gauss_100mm_f2_28deg"), 2000, small};
  const PsfSet::Axes axes{{0, 7.1}, {1000, infinity}, {d_line_nm}, {2, 2.8}};
  const PsfSet set = study.set(axes);
  for (std::size_t node = 0; node < axes.size(); ++node) {
    const PsfKernel kernel = set.at(axes.point(node));
    EXPECT_EQ(kernel.light, set.kernels()[node].light) << node;
    EXPECT_EQ(kernel.pixel_mm, set.kernels()[node].pixel_mm);
    EXPECT_EQ(kernel.total, set.kernels()[node].total);
  }
  EXPECT_EQ(axes.point(1).field_deg, 7.1);
  EXPECT_EQ(axes.point(2).distance_mm, infinity);
  EXPECT_EQ(axes.point(4).f_number, 2.8);
}

/// The mean of images on a grid, as blended by a compositor.
PsfKernel plain_mean(const std::vector<PsfKernel>& kernels, const PsfKernel& grid) {
  constexpr int samples = 8;  // along each side of a pixel
  PsfKernel mean = grid;
  mean.light.assign(mean.light.size(), 0.0f);
  for (const PsfKernel& kernel : kernels) {
    const auto place = [&](int i) {
      return static_cast<int>(std::floor(((i + 0.5) / samples - kernel.pixels / 2.0) * kernel.pixel_mm / grid.pixel_mm +
                                         grid.pixels / 2.0));
    };
    for (int i = 0; i < kernel.pixels * samples; ++i) {
      for (int k = 0; k < kernel.pixels * samples; ++k) {
        const int row = place(i), column = place(k);
        if (row < 0 || row >= grid.pixels || column < 0 || column >= grid.pixels) continue;
        mean.light[static_cast<std::size_t>(row * grid.pixels + column)] +=
            kernel.light[static_cast<std::size_t>(i / samples * kernel.pixels + k / samples)];
      }
    }
  }
  mean.total = sum(mean);
  return mean;
}

/// Blurs shrink towards the focus; behind the focus they are inverted and grow.
TEST(PsfSet, IsNearTracedKernelsBetweenItsNodes) {
  const Study study{data_lens("double_gauss_100mm_f2_28deg"), 2000};
  const PsfSet::Axes axes{{0, 5, 10, 14}, {1000, 1400, 2000, 4000, infinity}, {d_line_nm}, {2.8}};
  const PsfSet set = study.set(axes);
  std::vector<double> errors, plain;
  for (std::size_t d = 0; d + 1 < axes.distances_mm.size(); ++d) {
    for (std::size_t f = 0; f + 1 < axes.fields_deg.size(); ++f) {
      const PsfSetPoint point{(axes.fields_deg[f] + axes.fields_deg[f + 1]) / 2,
                              2 / (1 / axes.distances_mm[d] + 1 / axes.distances_mm[d + 1]), d_line_nm, 2.8};
      errors.push_back(study.error(set, point));
      const PsfKernel between = set.at(point);
      const std::size_t node = 4 * d + f;
      const auto& nodes = set.kernels();
      const PsfKernel mean = plain_mean({nodes[node], nodes[node + 1], nodes[node + 4], nodes[node + 5]}, between);
      plain.push_back(100 * total_variation(mean, study.kernel(point, between.pixels * between.pixel_mm / 2)));
    }
  }
  std::sort(errors.begin(), errors.end()), std::sort(plain.begin(), plain.end());
  EXPECT_LT(errors[errors.size() / 2], 0.3);
  EXPECT_LT(errors.back(), 1.5);
  EXPECT_GT(plain[plain.size() / 2], 50);
}

TEST(PsfSet, InterpolatesStopsAndColours) {
  const Study study{data_lens("double_gauss_100mm_f2_28deg"), 2000};
  const PsfSet stops = study.set({{8}, {1400}, {d_line_nm}, {2.8, 4, 8}});
  for (const double f_number : {2 / (1 / 2.8 + 1 / 4.), 2 / (1 / 4. + 1 / 8.)}) {
    EXPECT_LT(study.error(stops, {8, 1400, d_line_nm, f_number}), 1) << f_number;
  }
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens colours = compile(data_prescription("double_gauss_100mm_f2_28deg"), std::array{486.1327, 520.0, 550.0},
                               {.glasses = &glasses});
  const Study coloured{colours, 2000};
  // The focal position is a curved function of the wavelength. Near the focus the interpolation error is visible
  // between nodes 64 nm apart, and 40 % between F and C.
  for (const auto& [distance, most] : {std::pair{1400, 1}, {1900, 18}}) {
    const double mm = distance;
    const PsfSet set = coloured.set({{8}, {mm}, {486.1327, 550}, {2.8}});
    EXPECT_LT(coloured.error(set, {8, mm, 520, 2.8}), most) << mm;
  }
}

TEST(PsfSet, RefusesInvalidAxesAndPointsOutside) {
  const Study study{data_lens("double_gauss_100mm_f2_28deg"), 2000, small};
  const PsfSet::Axes good{{0, 7}, {1000, infinity}, {d_line_nm}, {2.8}};
  const PsfSet set = study.set(good);
  const auto refused = [&](auto&& change) {
    PsfSet::Axes axes = good;
    change(axes);
    return message([&] { PsfSet(axes, set.kernels()); });
  };
  using Axes = PsfSet::Axes;
  expect_tokens(refused([](Axes& a) { a.fields_deg.clear(); }), {"field_deg"});
  expect_tokens(refused([](Axes& a) { a.fields_deg = {7, 0}; }), {"field_deg", 0, 7});
  expect_tokens(refused([](Axes& a) { a.fields_deg = {0, 181}; }), {"field_deg", 181});
  expect_tokens(refused([](Axes& a) { a.distances_mm = {0, 5}; }), {"distance_mm", 0});
  expect_tokens(refused([](Axes& a) { a.distances_mm = {infinity, infinity}; }), {"distance_mm", "inf"});
  expect_tokens(refused([](Axes& a) { a.wavelengths_nm = {infinity}; }), {"wavelength_nm", "inf"});
  expect_tokens(refused([](Axes& a) { a.f_numbers = {std::nan("")}; }), {"f_number", "nan"});
  expect_tokens(refused([](Axes& a) { a.f_numbers = {2.8, 4}; }), {"kernels", 4, 8});
  auto torn = set.kernels();
  torn[2].hits_y.pop_back();
  EXPECT_EQ(message([&] { PsfSet(good, set.kernels()); }), "no error");
  expect_error([&] { PsfSet(good, torn); }, {33});

  const auto outside = [&](const PsfSetPoint& point) { return message([&] { set.at(point); }); };
  expect_tokens(outside({7.1, 2000, d_line_nm, 2.8}), {"PSF set", "field_deg", 7.1});
  expect_tokens(outside({-1, 2000, d_line_nm, 2.8}), {"field_deg", -1});
  expect_tokens(outside({7, 999, d_line_nm, 2.8}), {"distance_mm", 999});
  expect_tokens(outside({7, std::nan(""), d_line_nm, 2.8}), {"distance_mm", "nan"});
  expect_tokens(outside({7, 2000, 500, 2.8}), {"wavelength_nm", 500});
  expect_tokens(outside({7, 2000, d_line_nm, 4}), {"f_number", 4});
}

}  // namespace psf_set_test
}  // namespace petzval
