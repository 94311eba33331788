// SPDX-License-Identifier: Apache-2.0
// Time of a focal surface: frames in float on one thread, 800 x 600 film points by the loops of each
// instruction set on one thread, and single film points in double.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "camera/moving_least_squares.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "table.hpp"

namespace {

using namespace petzval;

std::vector<FocalPoint> points_on(const Film& film, std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<FocalPoint> points(count);
  for (FocalPoint& point : points) {
    point.film_point = film.point(unit(random) * film.columns, unit(random) * film.rows);
    point.inverse_distance = 1e-3 * unit(random);
  }
  return points;
}

void frame(benchmark::State& state, const Film& film, std::size_t count) {
  const FocalSurface surface(thin_lens(50, 2), film, points_on(film, count));
  std::vector<float> distances(static_cast<std::size_t>(film.columns) * static_cast<std::size_t>(film.rows));
  for (auto _ : state) {
    surface.frame<float>(film, 1, distances.data(), nullptr);
    benchmark::DoNotOptimize(distances.data());
  }
  state.SetItemsProcessed(state.iterations());
}

void values(benchmark::State& state, SurfaceKind kind, double beta) {
  const Film film{.columns = 800, .rows = 600};
  std::vector<camera_detail::WeighedValue> points;
  for (const FocalPoint& point : points_on(film, 16)) points.push_back({point.film_point, *point.inverse_distance});
  const camera_detail::MovingLeastSquares surface("surface_bench: ", points, 29, kind, beta);
  std::vector<float> x, y;
  for (int r = 0; r < film.rows; ++r) {
    for (int c = 0; c < film.columns; ++c) {
      const FilmPoint at = film.point(c + 0.5, r + 0.5);
      x.push_back(static_cast<float>(at.x));
      y.push_back(static_cast<float>(at.y));
    }
  }
  std::vector<float> out(x.size());
  for (auto _ : state) {
    surface.at(x.size(), x.data(), y.data(), out.data());
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations());
}

void single(benchmark::State& state) {
  const Film film{.z_mm = 50};
  const FocalSurface surface(thin_lens(50, 2), film, points_on(film, 16));
  const std::vector<FocalPoint> places = points_on(film, 1024);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(surface.at(places[i++ % places.size()].film_point).inverse_distance);
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

int main(int argc, char** argv) {
  initialize(argc, argv);
  const Film small{.columns = 800, .rows = 600, .z_mm = 50}, large{.columns = 1920, .rows = 1080, .z_mm = 50};
  const auto add = [](const std::string& name, auto&&... work) {
    return benchmark::RegisterBenchmark(name.c_str(), work...)->UseRealTime();
  };
  add("800 x 600, 16 points", frame, small, std::size_t{16});
  add("1920 x 1080, 64 points", frame, large, std::size_t{64});
  for (const SurfaceKind kind : {SurfaceKind::affine, SurfaceKind::shepard}) {
    for (const double beta : {2.0, 3.0, 2.5}) {
      char text[64];
      std::snprintf(text, sizeof text, "%s, beta %g", std::string(name(kind)).c_str(), beta);
      add(text, values, kind, beta);
    }
  }
  add("single place, 16 points", single);
  Rounds rounds;
  benchmark::RunSpecifiedBenchmarks(&rounds);
  std::printf("%-34s %9s\n", "focal surface (minima)", "us");
  for (const auto& line : rounds.lines())
    std::printf("%-34s %9s\n", line.name.c_str(), digits(1e6 * line.min()).c_str());
  return 0;
}
