// SPDX-License-Identifier: Apache-2.0
// Images of layers through lenses: time and similarity, compared with the same rays through the scene and with a
// post-process of a single image. Uses all threads of the processor; times are minima of interleaved rounds; the
// numbers of a table come from one run.
//
//   build/tests/bench/blur_bench [--full]
//
// 400 x 300 pixels, one round, 100 mm; --full: 800 x 600, three rounds, and variations of layers and lenses.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "../blur/reference_gather.hpp"
#include "blur/gather_method.hpp"
#include "layers/blur_scenes.hpp"
#include "layers/lens_setup.hpp"
#include "layers/lit_scene.hpp"
#include "layers/picture_quality.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/image/image.hpp"
#include "single_image_blur.hpp"
#include "table.hpp"

namespace {

using petzval::RgbImage;

constexpr double focus_mm = 5000;
constexpr std::array scene_names{"town", "statues", "knot", "leaves"};

struct Settings {
  int columns = 400, rows = 300, rounds = 1, threads = petzval::processor_threads();
  bool full = false;
};

/// Duration of work in milliseconds.
template <class Work>
double time_of(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}
void keep_least(double& least, double ms) { least = least == 0 ? ms : std::min(least, ms); }

RgbImage colours_of(const petzval::BlurredImage& picture) {
  RgbImage image(picture.columns, picture.rows);
  for (std::size_t i = 0; i < picture.missed.size(); ++i) std::copy_n(&picture.rgba[4 * i], 3, &image.pixels[3 * i]);
  return image;
}

double miss_rate(const petzval::BlurredImage& picture) {
  return static_cast<double>(picture.missed_count) / static_cast<double>(picture.ray_count);
}

lens_blur::LensFlags thin_lens(double diameter_mm) {
  lens_blur::LensFlags lens;
  lens.setup.lens.thin_mm = 50, lens.setup.f_number = 50 / diameter_mm, lens.setup.focus_mm = focus_mm,
  lens.pattern.rays = 100;
  return lens;
}

/// A lens in front of a scene.
class View {
 public:
  View(const Settings& settings, const lens_blur::LitScene& scene, const renderer::Pose& pose,
       const lens_blur::LensFlags& lens)
      : settings_(settings),
        scene_(scene),
        lens_(lens, settings.columns, settings.rows, pose, false),
        nearest_mm_(0.8 * scene.nearest_mm(lens_.layers(), settings.threads)),
        rays(lens_.rays(nearest_mm_, settings.threads)),
        plan(petzval::plan_peel(rays, nearest_mm_, std::numeric_limits<double>::infinity())) {}

  void peel(int count, petzval::LayerSet& layers) const {
    layers.peel(plan, count, scene_.peel(plan.camera, settings_.threads));
  }
  void gather(const petzval::LayerSet& layers, petzval::BlurredImage& picture,
              const petzval::blur_detail::GatherMethod& method = {}) const {
    petzval::blur_detail::gather(layers, rays, {.threads = settings_.threads}, method, picture);
  }
  RgbImage reference() const { return scene_.reference(rays, settings_.threads); }

 private:
  const Settings& settings_;
  const lens_blur::LitScene& scene_;
  lens_blur::BlurLens lens_;
  double nearest_mm_;

 public:
  const petzval::LensRays rays;
  const petzval::PeelPlan plan;
};

struct LoadedScene {
  explicit LoadedScene(const std::string& scene_name)
      : name(scene_name), description(*lens_blur::blur_scene(scene_name)), lit(description) {}

  std::string name;
  renderer::SceneDescription description;
  lens_blur::LitScene lit;

  View through(const Settings& settings, const lens_blur::LensFlags& lens) const {
    return {settings, lit, description.pose, lens};
  }
};

/// Four layers, every method of gathering, the reference and the single image.
void report_thin(const Settings& settings, const LoadedScene& scene, double diameter_mm) {
  const View view = scene.through(settings, thin_lens(diameter_mm));
  petzval::LayerSet layers;
  petzval::BlurredImage picture, other;
  const CircleOfConfusion circle{view.plan.camera.focal_px * diameter_mm / 2, 1 / focus_mm};

  double peel = 0, n_buffer = 0, gather = 0, by_pixels = 0, unbounded = 0, single = 0, reference_ms = 0;
  RgbImage reference, post;
  for (int round = 0; round < settings.rounds; ++round) {
    const double filled = time_of([&] { view.peel(4, layers); });
    keep_least(n_buffer, 1e3 * layers.n_buffer_seconds());
    keep_least(peel, filled - 1e3 * layers.n_buffer_seconds());
    keep_least(gather, time_of([&] { view.gather(layers, picture); }));
    keep_least(by_pixels, time_of([&] { view.gather(layers, other, {.by_blocks = false}); }));
    keep_least(unbounded, time_of([&] { view.gather(layers, other, {.limit_steps = false}); }));
    keep_least(single,
               time_of([&] { post = single_image_blur(layers, view.rays.camera(), circle, 100, settings.threads); }));
    if (round < 2) keep_least(reference_ms, time_of([&] { reference = view.reference(); }));
  }
  const RgbImage ours = colours_of(picture);
  const lens_blur::Likeness four = lens_blur::likeness(ours, reference), of_post = lens_blur::likeness(post, reference);
  const double missed = miss_rate(picture), rays = static_cast<double>(picture.ray_count);
  view.peel(1, layers);
  view.gather(layers, picture);
  const double one = lens_blur::likeness(colours_of(picture), reference).psnr_db;

  std::printf("| %s, %.0f mm | %.1f | %.2f | %.1f | %.0f, %.0f, %.1fx | %.1f/%.3f | %.1f | %.1f/%.3f, %.0f | %.4f | ",
              scene.name.c_str(), diameter_mm, peel, n_buffer, gather, reference_ms, 1e-3 * rays / reference_ms,
              reference_ms / (peel + n_buffer + gather), four.psnr_db, four.ssim, one, of_post.psnr_db, of_post.ssim,
              single, 100 * missed);
  std::printf("%.1fx | %.1fx |\n", by_pixels / gather, unbounded / gather);
  std::fflush(stdout);
}

void report_layers(const Settings& settings, const LoadedScene& scene) {
  const View view = scene.through(settings, thin_lens(100));
  const RgbImage reference = view.reference();
  std::printf("| %s |", scene.name.c_str());
  for (const int count : {1, 2, 4, 8}) {
    petzval::LayerSet layers;
    petzval::BlurredImage picture;
    view.peel(count, layers);
    view.gather(layers, picture);
    std::printf(" %.1f, %.4f |", lens_blur::likeness(colours_of(picture), reference).psnr_db, 100 * miss_rate(picture));
  }
  std::printf("\n");
  std::fflush(stdout);
}

/// Lenses whose rays differ between pixels, and the largest lens of the paper.
void report_lenses(const Settings& settings, const LoadedScene& scene) {
  struct Row {
    const char* name;
    lens_blur::LensFlags lens;
  };
  lens_blur::LensFlags tilted = thin_lens(100);
  tilted.setup.film.tilt_rad = petzval::radians(1);
  lens_blur::LensFlags singlet;
  singlet.singlet = "102,-102,12,N-BK7", singlet.setup.focus_mm = focus_mm, singlet.fov_deg = 30,
  singlet.pattern.rays = 100;
  lens_blur::LensFlags chroma = singlet;
  chroma.wavelengths = "rgb";
  for (const Row& row : {Row{"thin, 300 mm", thin_lens(300)}, Row{"thin, 100 mm, film tilted by 1 degree", tilted},
                         Row{"singlet f/2", singlet}, Row{"singlet f/2, three colours", chroma}}) {
    const View view = scene.through(settings, row.lens);
    petzval::LayerSet layers;
    petzval::BlurredImage picture, other;
    double peel = 0, gather = 0, by_pixels = 0;
    for (int round = 0; round < settings.rounds; ++round) {
      keep_least(peel, time_of([&] { view.peel(4, layers); }));
      keep_least(gather, time_of([&] { view.gather(layers, picture); }));
      keep_least(by_pixels, time_of([&] { view.gather(layers, other, {.by_blocks = false}); }));
    }
    RgbImage reference;
    const double reference_ms = time_of([&] { reference = view.reference(); });
    const lens_blur::Likeness alike = lens_blur::likeness(colours_of(picture), reference);
    std::printf("| %s, %s | %.1f | %.1f | %.0f, %.1fx, %.1fx | %.1f/%.3f | %.4f | %.1fx |\n", scene.name.c_str(),
                row.name, peel, gather, reference_ms, reference_ms / gather, reference_ms / (peel + gather),
                alike.psnr_db, alike.ssim, 100 * miss_rate(picture), by_pixels / gather);
    std::fflush(stdout);
  }
}

/// Time of the gather through real lenses, as a multiple of that of the thin lens of the same focal length, f-number
/// and angle, with 1, 4 and 16 sets of rays.
void report_multiples(const Settings& settings, const LoadedScene& scene) {
  struct Row {
    const char* file;
    double focal_mm, f_number;
  };
  for (const Row& row : {Row{"double_gauss_52mm_f1.8", 51.6, 51.6 / 18}, Row{"double_gauss_52mm_f1.8", 51.6, 1.8},
                         Row{"planar_50mm_f1.4", 50, 1.4}, Row{"double_gauss_100mm_f1.1", 100, 1.1}, Row{"", 100, 2}}) {
    for (const int sets : {1, 4, 16}) {
      lens_blur::LensFlags thin, real, coloured;
      thin.setup.lens.thin_mm = row.focal_mm;
      real.setup.lens.file = row.file;
      if (*row.file == 0) real.singlet = "102,-102,12,N-BK7";
      coloured = real, coloured.wavelengths = "rgb";
      double least[3] = {};
      std::vector<View> views;
      std::vector<petzval::LayerSet> layers(3);
      for (lens_blur::LensFlags* flags : {&thin, &real, &coloured}) {
        flags->setup.f_number = row.f_number, flags->setup.focus_mm = focus_mm, flags->fov_deg = 30,
        flags->pattern.rays = 100;
        flags->pattern.jitter = sets == 16, flags->pattern.supersample = sets == 4 ? 2 : 1;
        Settings half = settings;
        if (sets == 4) half.columns /= 2, half.rows /= 2, flags->pattern.rays = 400;
        views.push_back(scene.through(half, *flags));
        views.back().peel(4, layers[views.size() - 1]);
      }
      petzval::BlurredImage picture;
      for (int round = 0; round < 2 * settings.rounds; ++round) {
        for (std::size_t i = 0; i < 3; ++i) keep_least(least[i], time_of([&] { views[i].gather(layers[i], picture); }));
      }
      std::printf("| %s, %s, f/%.1f, %d sets | %.1f | %.1f, %.1fx | %.1f, %.1fx |\n", scene.name.c_str(),
                  *row.file ? row.file : "singlet", row.f_number, sets, least[0], least[1], least[1] / least[0],
                  least[2], least[2] / least[0]);
      std::fflush(stdout);
    }
  }
}

/// The simplest correct code, on a small image.
void report_scalar(const Settings& settings, const LoadedScene& scene) {
  Settings small = settings;
  small.columns = 200, small.rows = 150, small.threads = 1;
  const View view = scene.through(small, thin_lens(100));
  petzval::LayerSet layers;
  petzval::BlurredImage picture;
  view.peel(4, layers);
  double gather = 0;
  for (int round = 0; round < settings.rounds; ++round) {
    keep_least(gather, time_of([&] { view.gather(layers, picture); }));
  }
  const double scalar = time_of([&] { petzval::testing::reference_gather(layers, view.rays); });
  std::printf("\n%s, 200 x 150, one thread: gather %.1f ms, scalar code in double %.0f ms, %.0fx (goal 50x)\n",
              scene.name.c_str(), gather, scalar, scalar / gather);
}

int run(std::vector<char*> arguments) {
  Settings settings;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    if (std::string(arguments[i]) != "--full") {
      throw petzval::Error(std::string(arguments[0]) + ": " + arguments[i] + "; must be --full");
    }
    settings.full = true, settings.columns = 800, settings.rows = 600, settings.rounds = 3;
  }
  print_conditions();
  std::printf("%d x %d, 100 rays, 4 layers, focus 5 m, %d threads; times in ms\n\n", settings.columns, settings.rows,
              settings.threads);

  std::vector<std::unique_ptr<LoadedScene>> scenes;
  for (const char* name : scene_names) scenes.push_back(std::make_unique<LoadedScene>(name));

  std::printf(
      "| thin lens, diameter | peel | N-buffer | gather | reference, Mray/s, times as slow | PSNR/SSIM | of one layer "
      "| "
      "single image, ms | missed, %% | lines of each pixel: times as slow | unbounded: times as slow |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n"
      "| goal, 18 mm | | | | 15x | 33.5/.960 | | 3 dB less | .01 | | |\n"
      "| goal, 100 mm | | | | 6x; 10x statues, knot | 39/.985; leaves .955 | | 3 dB less | .01; leaves .5 | | |\n");
  for (const double diameter : {18.0, 100.0}) {
    if (diameter < 100 && !settings.full) continue;
    for (const auto& scene : scenes) report_thin(settings, *scene, diameter);
  }
  if (!settings.full) return 0;

  std::printf("\n| PSNR, missed %%, by layers, 100 mm | 1 | 2 | 4 | 8 |\n|---|---|---|---|---|\n");
  for (const auto& scene : scenes) report_layers(settings, *scene);
  std::printf(
      "\n| lens | peel, N-buffer | gather | reference, times as slow as gather, as both | PSNR/SSIM | missed, %% | "
      "lines of each pixel: times as slow |\n|---|---|---|---|---|---|---|\n"
      "| goal | | | singlet 10x | 300 mm 42/.985, tilt 41/.985, singlet 44/.98, colours 45/.985 | | |\n");
  report_lenses(settings, *scenes[0]);
  std::printf("\n| lens | thin lens | one colour | three colours |\n|---|---|---|---|\n| goal | | 3x | 6x |\n");
  report_multiples(settings, *scenes[0]);
  report_scalar(settings, *scenes[0]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return guarded(run, argc, argv); }
