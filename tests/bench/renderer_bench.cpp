// SPDX-License-Identifier: Apache-2.0
// Cost of a lens in a renderer: paths in equal time through the models of a lens, by three integrators, and the
// fraction of time spent in the lens. Also measures the gain of bidirectional path tracing for small lights. One
// thread, minima of interleaved rounds.
//
//   build/tests/bench/renderer_bench [ROUNDS]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "renderer/built_in_scenes.hpp"
#include "renderer/unit_tracer.hpp"
#include "table.hpp"

namespace {

using namespace renderer;
using Clock = std::chrono::steady_clock;

constexpr int columns = 150, rows = 100;
constexpr double focus_mm = 880;

petzval::Lens lens_for(const PathColourSource& colours, double distance_mm) {
  const auto folder = petzval::data_directory();
  const auto glasses = petzval::GlassCatalogue::load(folder / "glass");
  const petzval::Lens lens =
      petzval::compile(petzval::read_prescription(folder / "lenses/double_gauss_100mm_f2_28deg.json"),
                       colours.compiled_nm(), {.glasses = &glasses, .missing_glass = petzval::MissingGlass::abbe});
  return petzval::with_focus(lens, distance_mm);
}

LensCamera camera_of(const petzval::Lens& lens, petzval::ModelKind model, const Scene& scene) {
  return {petzval::Camera(lens, {.columns = columns, .rows = rows},
                          {.model = model, .normalisation = petzval::Normalisation::unity_on_axis}),
          scene.description().pose};
}

struct Pass {
  double seconds = 0, lens_seconds = 0;
};

/// Another pass over the film with some samples per pixel.
Pass add_pass(const Scene& scene, const LensCamera& lens, const PathColourSource& colours, Integrator integrator,
              std::uint32_t samples, std::uint64_t seed, PictureSums& sums) {
  const UnitTracer tracer(scene, lens, colours, integrator, seed);
  Pass pass;
  const auto begin = Clock::now();
  for (std::size_t tile = 0; tile < sums.tiles(); ++tile) {
    Splats film, light;
    const auto round = static_cast<std::uint32_t>(sums.samples(tile) / samples % PictureSums::rounds);
    tracer.trace(sums.block(tile), {round, sums.samples(tile, round), samples}, film, light, pass.lens_seconds);
    sums.add(tile, round, samples, film.all());
    sums.add(tile, round, samples, light.all(), PictureSums::Of::light);
  }
  pass.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return pass;
}

const char* name(Integrator integrator) {
  return integrator == Integrator::path ? "path" : integrator == Integrator::light ? "light" : "bidirectional";
}
constexpr std::array integrators{Integrator::path, Integrator::light, Integrator::bidirectional};

void report_models(int rounds) {
  const Scene scene(*built_in_scene("chess"));
  constexpr std::array models{petzval::ModelKind::pinhole,       petzval::ModelKind::thin,
                              petzval::ModelKind::thin_two_disc, petzval::ModelKind::polynomial(7),
                              petzval::ModelKind::exact_float,   petzval::ModelKind::exact_double};
  for (const ColourMode mode : {ColourMode::d, ColourMode::hero}) {
    const PathColourSource colours(mode);
    const petzval::Lens lens = lens_for(colours, focus_mm);
    std::vector<LensCamera> cameras;
    for (const petzval::ModelKind model : models) cameras.push_back(camera_of(lens, model, scene));
    std::printf("\nchess, %s: us per path, samples in equal time relative to thin, fraction of time in the lens\n",
                mode == ColourMode::d ? "one wavelength" : "hero wavelengths");
    std::printf("| model |");
    for (const Integrator integrator : integrators) std::printf(" %s |", name(integrator));
    std::printf("\n|---|---|---|---|\n");
    std::array<std::array<Pass, models.size()>, integrators.size()> best{};
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < integrators.size(); ++i) {
        for (std::size_t m = 0; m < models.size(); ++m) {
          PictureSums sums(columns, rows);
          const Pass pass = add_pass(scene, cameras[m], colours, integrators[i], 8, 1, sums);
          if (round == 0 || pass.seconds < best[i][m].seconds) best[i][m] = pass;
        }
      }
    }
    for (std::size_t m = 0; m < models.size(); ++m) {
      std::printf("| %s |", std::string(petzval::name(models[m])).c_str());
      for (std::size_t i = 0; i < integrators.size(); ++i) {
        const Pass& pass = best[i][m];
        std::printf(" %.2f, %.1f %%, %.0f %% |", pass.seconds / (8.0 * columns * rows) * 1e6,
                    100 * best[i][1].seconds / pass.seconds, 100 * pass.lens_seconds / pass.seconds);
      }
      std::printf("\n");
    }
  }
}

double squared_error(const petzval::RgbImage& image, const petzval::RgbImage& reference) {
  double sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double d = static_cast<double>(image.pixels[i] - reference.pixels[i]);
    sum += d * d;
  }
  return sum / static_cast<double>(image.pixels.size());
}

/// Errors relative to an image with many samples, after equal time of each integrator; also with values clipped to
/// white.
void report_small_lights(double seconds) {
  std::printf("\nRMS errors after %.0f s relative to bidirectional path tracing; of pictures clipped at white\n",
              seconds);
  std::printf("| scene | path | light | bidirectional: samples, rms error of white |\n|---|---|---|---|\n");
  const PathColourSource colours(ColourMode::d);
  for (const auto& [scene_name, distance] :
       {std::pair{"balls", 800.0}, std::pair{"balls", 1000.0}, std::pair{"street", 2960.0}}) {
    const Scene scene(*built_in_scene(scene_name));
    const LensCamera lens = camera_of(lens_for(colours, distance), petzval::ModelKind::exact_float, scene);
    PictureSums reference(columns, rows);
    for (double spent = 0; spent < 20 * seconds;) {
      spent += add_pass(scene, lens, colours, Integrator::bidirectional, 16, 99, reference).seconds;
    }
    const auto clipped = [](petzval::RgbImage image) {
      for (float& x : image.pixels) x = std::min(x, 1.0f);
      return image;
    };
    const petzval::RgbImage truth = reference.picture();
    std::array<double, 3> error{}, white{};
    double samples = 0;
    for (std::size_t i = 0; i < integrators.size(); ++i) {
      PictureSums sums(columns, rows);
      double spent = 0, pass = 0;
      do {
        pass = add_pass(scene, lens, colours, integrators[i], 4, 1, sums).seconds;
        spent += pass;
      } while (spent + pass / 2 < seconds);
      const double share = spent / seconds;  // errors fall with the root of time
      error[i] = std::sqrt(squared_error(sums.picture(), truth) * share);
      white[i] = std::sqrt(squared_error(clipped(sums.picture()), clipped(truth)) * share);
      if (integrators[i] == Integrator::bidirectional) samples = static_cast<double>(sums.samples(0));
    }
    std::printf("| %s, focus %.0f mm | %.1f, %.1f | %.1f, %.1f | %.0f, %.3f |\n", scene_name, distance,
                error[0] / error[2], white[0] / white[2], error[1] / error[2], white[1] / white[2], samples, white[2]);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  print_conditions();
  report_models(rounds);
  report_small_lights(3);
}
