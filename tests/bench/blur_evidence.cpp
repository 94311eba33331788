// SPDX-License-Identifier: Apache-2.0
// Pictures of five scenes through four lenses, by filters of one picture and by rays through layers, compared with many
// rays through the scene. Prints a table in Markdown.
//
//   build/tests/bench/blur_evidence [--truth RAYS] [--scene NAME]
//
// --truth: rays per pixel of the truth (default 4096)
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "layers/blur_scenes.hpp"
#include "layers/layer_picture.hpp"
#include "layers/lens_setup.hpp"
#include "layers/lit_scene.hpp"
#include "layers/picture_quality.hpp"
#include "petzval/core/parallel.hpp"
#include "single_image_blur.hpp"
#include "support/cli.hpp"
#include "table.hpp"

namespace {

using petzval::RgbImage;

constexpr double focus_mm = 2500;
constexpr int columns = 240, rows = 180, side = 2, truth_side = 4;
const int threads = petzval::processor_threads();

struct TestLens {
  const char* name;
  double thin_mm, f_number;
  const char *file, *singlet;
};
constexpr std::array lenses{TestLens{"thin 50 mm f/0.5", 50, 0.5, "", ""},
                            TestLens{"singlet 100 mm f/2", 0, 2, "", "102,-102,12,N-BK7"},
                            TestLens{"double Gauss 100 mm f/1.1", 0, 1.1, "double_gauss_100mm_f1.1", ""},
                            TestLens{"Planar 50 mm f/1.4", 0, 1.4, "planar_50mm_f1.4", ""}};

/// The rays of a lens with samples x samples subpixels per pixel.
petzval::LensRays rays_of(const lens_blur::LitScene& scene, const renderer::Pose& pose, const TestLens& lens,
                          int ray_count, int samples) {
  lens_blur::LensFlags flags;
  flags.setup.lens.thin_mm = lens.thin_mm, flags.setup.lens.file = lens.file, flags.singlet = lens.singlet;
  flags.setup.f_number = lens.f_number, flags.setup.focus_mm = focus_mm, flags.fov_deg = 30;
  flags.pattern.rays = static_cast<unsigned>(ray_count), flags.pattern.supersample = static_cast<unsigned>(samples);
  lens_blur::BlurLens blur(flags, columns, rows, pose, false);
  return blur.rays(0.8 * scene.nearest_mm(blur.layers(), threads), threads);
}

/// Lines of a pixel at an inverse depth: middle and radius of the disc, and light.
struct Disc {
  Disc(const std::vector<petzval::LayerRay>& lines, double w) {
    const auto count = static_cast<double>(lines.size());
    for (const auto& line : lines) light += line.weight / count, middle += (line.position + w * line.slope) / count;
    for (const auto& line : lines) {
      const petzval::Vec2<double> off = line.position + w * line.slope - middle;
      radius += 2 * (off.x * off.x + off.y * off.y) / count;
    }
    radius = std::sqrt(radius);
  }
  double light = 0, radius = 0;
  petzval::Vec2<double> middle{0, 0};
};

/// The discs of a thin lens that are nearest to the discs on the axis: a parabola through their squared radii.
CircleOfConfusion circle_of(const petzval::LensRays& rays) {
  std::vector<petzval::LayerRay> lines(rays.count());
  rays.at(0, rays.camera().columns / 2, rays.camera().rows / 2, lines);
  const auto squared = [&](double w) { return std::pow(Disc(lines, w).radius, 2); };
  constexpr double step = 1 / focus_mm;
  const double bend = squared(2 * step) - 2 * squared(step) + squared(0), rise = squared(2 * step) - squared(0);
  return {std::sqrt(bend / 2) / step, step * (1 - rise / (2 * bend))};
}

/// Gives the picture of a pinhole the distortion and the light of a lens.
RgbImage through(const petzval::LensRays& rays, double w, const RgbImage& picture) {
  RgbImage result(picture.width, picture.height);
  std::vector<petzval::LayerRay> lines(rays.count());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      rays.at(0, x, y, lines);
      const Disc disc(lines, w);
      const auto u = static_cast<float>(std::clamp(disc.middle.x - 0.5, 0.0, picture.width - 1.001)),
                 v = static_cast<float>(std::clamp(disc.middle.y - 0.5, 0.0, picture.height - 1.001));
      const int i = static_cast<int>(u), j = static_cast<int>(v);
      for (int c = 0; c < 3; ++c) {
        const auto line = [&](int k) {
          return std::lerp(picture.pixel(i, k)[c], picture.pixel(i + 1, k)[c], u - std::floor(u));
        };
        result.pixel(x, y)[c] = static_cast<float>(disc.light) * std::lerp(line(j), line(j + 1), v - std::floor(v));
      }
    }
  }
  return result;
}

/// Time of the fastest of three runs in milliseconds.
template <class Work>
double time_of(const Work& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 3; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    least = std::min(least, examples::ms_since(begin));
  }
  return least;
}

void report(const std::string& name, int truth_rays) {
  const renderer::SceneDescription description = *lens_blur::blur_scene(name);
  const lens_blur::LitScene scene(description);
  for (const TestLens& lens : lenses) {
    const RgbImage truth = lens_blur::averaged(
        scene.reference(rays_of(scene, description.pose, lens, truth_rays, truth_side), threads), truth_side);
    const auto cell = [&](const RgbImage& samples, double ms) {
      const RgbImage picture = lens_blur::averaged(samples, side);
      const lens_blur::Likeness like = lens_blur::likeness(picture, truth);
      const std::vector<float> flip = lens_blur::flip(picture, truth);
      std::printf(" %.1f %.3f %.3f %.0f |", like.psnr_db, like.ssim,
                  std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size()), ms);
      std::fflush(stdout);
    };
    std::printf("| %s, %s |", name.c_str(), lens.name);
    for (const int count : {100, 32, 16}) {
      const petzval::LensRays rays = rays_of(scene, description.pose, lens, count, side);
      const petzval::PeelPlan plan =
          petzval::plan_peel(rays, rays.nearest_mm(), std::numeric_limits<double>::infinity());
      petzval::LayerSet layers;
      layers.peel(plan, 4, scene.peel(plan.camera, threads, plan.bias));
      const CircleOfConfusion circle = circle_of(rays);
      const auto filter = [&](const auto& work) {
        RgbImage filtered;
        const double ms = time_of([&] { filtered = work(layers, rays.camera(), circle); });
        cell(rays.shift_invariant() ? filtered : through(rays, circle.inverse_focus, filtered), ms);
      };
      if (count == 100) {
        filter([](const auto&... of) { return single_image_blur(of..., 100, threads); });
        filter([](const auto&... of) { return separable_blur(of..., threads); });
      }
      const petzval::GatherOptions options{.threads = threads,
                                           .highlights_above = lens_blur::threshold_of(layers, false)};
      petzval::BlurredImage picture;
      const double ms = time_of([&] { petzval::gather(layers, rays, options, picture); });
      cell(lens_blur::colours_of(picture), ms);
    }
    std::printf("\n");
  }
}

int run(std::vector<char*> arguments) {
  const int truth_rays = std::stoi(take_option(arguments, "--truth").value_or("4096"));
  const auto one = take_option(arguments, "--scene");
  print_conditions();
  std::printf(
      "%d x %d pixels, focus at %.1f m, %d threads. Truth: %d rays per pixel. Cells: PSNR (dB), SSIM, FLIP, ms.\n\n"
      "| scene, lens | gather discs | separable | 100 rays | 32 rays | 16 rays |\n|---|---|---|---|---|---|\n",
      columns, rows, focus_mm / 1000, threads, truth_rays);
  for (const char* name : {"town", "statues", "knot", "leaves", "street"}) {
    if (!one || *one == name) report(name, truth_rays);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return guarded(run, argc, argv); }
