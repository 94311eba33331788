// SPDX-License-Identifier: Apache-2.0
// A program of a user of petzval: one lens from code, one from the data of the library.
//
//     consumer DATA_DIRECTORY      the data directory that the library is expected to find, and CMake or pkg-config to
//                                  have named (CONSUMER_DATA)
#include <cmath>
#include <filesystem>
#include <iostream>

#include "petzval/petzval.hpp"

namespace {

/// Distance behind the last vertex at which a ray parallel to the axis, 0.01 mm above it, crosses the axis.
double focus_behind(const petzval::Lens& lens) {
  const auto [ray, fate, surface] = petzval::trace(lens, petzval::Ray<double>{{0, 0.01, -10}, {0, 0, 1}});
  if (fate != petzval::RayFate::transmitted) throw petzval::Error(lens.name() + ": the ray is lost");
  return ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y - lens.surfaces().back().vertex_z;
}

bool near(const char* what, double found, double wanted) {
  std::cout << what << ": focus " << found << " mm behind the last vertex, expected " << wanted << " mm\n";
  return std::abs(found - wanted) < 1e-6 * wanted;
}

bool throws_an_error_that_can_be_caught() {
  try {
    petzval::parse_prescription("{", "nothing");
  } catch (const petzval::Error& error) {
    std::cout << "an error, as expected: " << error.what() << '\n';
    return true;
  }
  return false;
}

/// petzval.hpp also includes the vector functions of GLM, which are found with and without their namespace.
bool vectors_have_functions() {
  const petzval::Vec3<double> x{2, 0, 0}, y{0, 3, 0};
  const petzval::Vec2<double> across{3, 4};
  return dot(x, y) == 0 && petzval::dot(x, x) == 4 && cross(x, y) == petzval::Vec3<double>{0, 0, 6} &&
         petzval::cross(y, x).z == -6 && length(across) == 5 && petzval::length(x) == 2 &&
         normalize(y) == petzval::Vec3<double>{0, 1, 0} && std::abs(petzval::normalize(across).x - 0.6) < 1e-15;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;

  // By the lens-maker's equation: curvatures 1/50 and -1/50, thickness 5 mm, index 1.5.
  petzval::Prescription singlet;
  singlet.name = "singlet";
  singlet.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                      {.radius = -50, .thickness = 48, .semi_diameter = 10}};
  const double power = 0.5 * (1.0 / 50 + 1.0 / 50) - 0.5 * 0.5 * 5 / (1.5 * 50 * 50);
  const double back_focus = (1 - 0.5 * 5 / (1.5 * 50)) / power;
  bool good = near("singlet from code", focus_behind(petzval::compile(singlet)), back_focus);

  const auto data = petzval::data_directory();
  std::cout << "data found in " << data << '\n';
  good = std::filesystem::equivalent(data, argv[1]) && std::filesystem::equivalent(data, CONSUMER_DATA) && good;
  const auto lens = petzval::read_prescription(data / "lenses" / "analytic_plano_hyperbolic_100mm.json");
  good = near("lens from data", focus_behind(petzval::compile(lens)), 100) && good;

  return vectors_have_functions() && throws_an_error_that_can_be_caught() && good ? 0 : 1;
}
