// SPDX-License-Identifier: Apache-2.0
// The kernel with numbers that have derivatives (ceres::Jet).
#include <gtest/gtest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <ceres/jet.h>
#pragma GCC diagnostic pop

#include <array>
#include <cmath>
#include <string>

#include "../report.hpp"
#include "extended.hpp"
#include "lenses.hpp"

namespace derivative_test {

using petzval::RayFate;
using petzval::kernel::LensView;
using petzval::kernel::Vec;
using testing_lenses::all;
using testing_lenses::passing_rays;
using testing_lenses::Sample;

using Jet = ceres::Jet<double, 4>;

/// A ray behind the lens: position in a plane of constant z and transverse components of the direction.
template <class T>
struct State {
  std::array<T, 4> v;  ///< x, y, L, M
};

/// Traces from the plane z_in to the plane z_out. sign: sign of the z component of the direction in front of the lens.
template <class T>
State<T> through(const LensView<petzval::kernel::Storage<T>>& lens, const State<T>& in,
                 petzval::kernel::Storage<T> z_in, petzval::kernel::Storage<T> z_out, bool& transmitted,
                 Vec<T>* raw = nullptr, double sign = 1) {
  using R = petzval::kernel::Storage<T>;
  using std::sqrt;
  const T n = T(sqrt(T(R(1) - in.v[2] * in.v[2] - in.v[3] * in.v[3])) * R(sign));
  const auto end = trace(lens, Vec<T>{in.v[0], in.v[1], T(z_in)}, Vec<T>{in.v[2], in.v[3], n}, {.apertures = false});
  transmitted = end.fate == RayFate::transmitted;
  if (raw) {
    raw[0] = end.origin;
    raw[1] = end.direction;
  }
  const T t = (z_out - end.origin.z) / end.direction.z;
  return {{end.origin.x + end.direction.x * t, end.origin.y + end.direction.y * t, end.direction.x, end.direction.y}};
}

State<Jet> seeded(const petzval::Ray<double>& ray) {
  return {{Jet(ray.origin.x, 0), Jet(ray.origin.y, 1), Jet(ray.direction.x, 2), Jet(ray.direction.y, 3)}};
}

double sign(double x) { return x < 0 ? -1 : 1; }

TEST(Derivative, ValueEqualsThePlainRayToTheBit) {
  for (const Sample& s : all()) {
    const auto view = petzval::kernel::view<double>(s.lens);
    for (const auto& ray : passing_rays(s.lens, 8)) {
      const double z = ray.origin.z, out = s.lens.film_z(), towards = sign(ray.direction.z);
      bool passed = false, passed_too = false;
      Vec<Jet> with[2];
      Vec<double> plain[2];
      through(view, seeded(ray), z, out, passed, with, towards);
      through(view, State<double>{{ray.origin.x, ray.origin.y, ray.direction.x, ray.direction.y}}, z, out, passed_too,
              plain, towards);
      ASSERT_TRUE(passed && passed_too) << s.id;
      for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(with[i].x.a, plain[i].x) << s.id;
        EXPECT_EQ(with[i].y.a, plain[i].y) << s.id;
        EXPECT_EQ(with[i].z.a, plain[i].z) << s.id;
      }
    }
  }
}

TEST(Derivative, AgreesWithCentralDifferences) {
  double most = 0;
  for (const Sample& s : all()) {
    const auto view = petzval::kernel::view<double>(s.lens);
    const auto tables = testing_lenses::extended(view);
    for (const auto& ray : passing_rays(s.lens, 6)) {
      const double z = ray.origin.z, out = s.lens.film_z(), towards = sign(ray.direction.z);
      bool passed = false;
      const State<Jet> with = through(view, seeded(ray), z, out, passed, static_cast<Vec<Jet>*>(nullptr), towards);
      for (int j = 0; j < 4; ++j) {
        // Fourth-order differences in long double.
        const long double unit = j < 2 ? s.size : 1, h = 2e-6L * unit;
        const auto at = [&](long double step) {
          State<long double> in{{ray.origin.x, ray.origin.y, ray.direction.x, ray.direction.y}};
          in.v[static_cast<std::size_t>(j)] += step;
          bool ok = false;
          return through<long double>(tables.view(), in, z, out, ok, nullptr, towards);
        };
        const auto a = at(h), b = at(-h), c = at(2 * h), d = at(-2 * h);
        for (std::size_t i = 0; i < 4; ++i) {
          const long double difference = (8 * (a.v[i] - b.v[i]) - (c.v[i] - d.v[i])) / (12 * h);
          // In units of the lens, to compare positions and directions.
          const long double per = (i < 2 ? s.size : 1) / unit;
          const double error = static_cast<double>(std::abs(difference - with.v[i].v[j]) / per);
          const double magnitude = std::max(1.0, static_cast<double>(std::abs(difference) / per));
          EXPECT_LE(error / magnitude, 1e-9) << s.id << " d" << i << "/d" << j;
          most = std::max(most, error / magnitude);
        }
      }
    }
  }
  testing_report::put("derivatives of rays, all 75 lenses, relative", testing_report::one_ray<double>, most, "1e-9");
}

// Rays between planes in (x, y, nL, nM) are a canonical map: J^T Omega J = Omega. Cylinders and mirrors included.
TEST(Derivative, JacobianIsSymplectic) {
  double most = 0;
  for (const Sample& s : all()) {
    const auto view = petzval::kernel::view<double>(s.lens);
    const double n_in = s.lens.index(0, 0), n_out = s.lens.index(view.count, 0);
    for (const auto& ray : passing_rays(s.lens, 8)) {
      bool passed = false;
      const State<Jet> with = through(view, seeded(ray), ray.origin.z, s.lens.film_z(), passed,
                                      static_cast<Vec<Jet>*>(nullptr), sign(ray.direction.z));
      ASSERT_TRUE(passed) << s.id;
      double j[4][4];
      for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k)
          j[i][k] = with.v[static_cast<std::size_t>(i)].v[k] * (i < 2 ? 1 : n_out) / (k < 2 ? 1 : n_in);
      }
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          double sum = 0, terms = 1;
          for (int i = 0; i < 2; ++i) {
            const double first = j[i][a] * j[i + 2][b], second = j[i + 2][a] * j[i][b];
            sum += first - second;
            terms = std::max({terms, std::abs(first), std::abs(second)});
          }
          const double wanted = b == a + 2 ? 1 : a == b + 2 ? -1 : 0;
          EXPECT_LE(std::abs(sum - wanted) / terms, 1e-12) << s.id << " " << a << b;
          most = std::max(most, std::abs(sum - wanted) / terms);
        }
      }
    }
  }
  testing_report::put("symplectic Jacobian, all 75 lenses", testing_report::one_ray<double>, most, "1e-12");
}

}  // namespace derivative_test
