// SPDX-License-Identifier: Apache-2.0
// Derivatives of batches: laws for every ray, and the slots of a batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../digits.hpp"
#include "../report.hpp"
#include "differentials.hpp"

namespace differentials_test {

using namespace testing_differentials;
using petzval::Arithmetic;
using petzval::InstructionSet;

using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(DifferentialsOf, Plain);

constexpr Travel both_ways[] = {Travel::to_film, Travel::to_scene};

double length(const Vec3<double>& v) { return std::sqrt(glm::dot(v, v)); }

template <class T>
Ray<double> in_double(const Ray<T>& r) {
  return {Vec3<double>(r.origin), Vec3<double>(r.direction)};
}

/// Largest errors of both arithmetics, in eps.
template <class T>
class Most {
 public:
  void operator()(const BatchOptions& options, double error, const std::string& where) {
    const bool reproducible = options.arithmetic == Arithmetic::reproducible;
    error /= std::numeric_limits<T>::epsilon();
    if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
    if (error <= error_[reproducible]) return;
    error_[reproducible] = error;
    where_[reproducible] = where + ", " + text(options);
  }
  void close(const std::string& row, double bound) const {
    for (const bool r : {false, true}) EXPECT_LE(error_[r], bound) << row << ": " << where_[r];
    testing_report::put(row, testing_report::batch<T>,
                        petzval::testing::digits(error_[0], 2) + " / " + petzval::testing::digits(error_[1], 2),
                        petzval::testing::digits(bound) + " eps");
  }

 private:
  double error_[2] = {};
  std::string where_[2];
};

/// Calls take(sample, options, beam, answer, ray) for every ray of every lens in both directions and arithmetics.
template <class T, class Take>
void on_every_ray(std::size_t rays, const Take& take) {
  for (const auto* samples : {&testing_lenses::all(), &made()}) {
    for (const auto& sample : *samples) {
      for (const Travel travel : both_ways) {
        const Beam<T> beam(rays_for<T>(sample, travel, rays), sample.size);
        for (const auto& options : every_batch(travel))
          take(sample, options, beam, followed(sample.lens, beam, options));
      }
    }
  }
}

// ---- Laws

// The Lagrange invariant n (x_u d_v - x_v d_u) of two tangents is equal on both sides of a lens: J^T Omega J = Omega.
TYPED_TEST(DifferentialsOf, LagrangeInvariantIsConserved) {
  using T = TypeParam;
  Most<T> most;
  on_every_ray<T>(100, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    double n_in = sample.lens.index(0, 0), n_out = sample.lens.index(sample.lens.surface_count(), 0);
    if (options.travel == Travel::to_scene) std::swap(n_in, n_out);
    double terms = 0;
    const auto invariant = [&](double n, const Ray<T>& with_u, const Ray<T>& with_v) {
      const auto u = in_double(with_u), v = in_double(with_v);
      terms += n * (length(u.origin) * length(v.direction) + length(v.origin) * length(u.direction));
      return n * (glm::dot(u.origin, v.direction) - glm::dot(v.origin, u.direction));
    };
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      if (found.end.fates[i] != RayFate::transmitted) continue;
      terms = 0;
      const double before = invariant(n_in, beam.u[i], beam.v[i]), after = invariant(n_out, found.u[i], found.v[i]);
      most(options, std::abs(after - before) / terms, sample.id);
    }
  });
  most.close("differentials: Lagrange invariant", 128);
}

TYPED_TEST(DifferentialsOf, DirectionsKeepUnitLength) {
  using T = TypeParam;
  Most<T> most;
  on_every_ray<T>(100, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      if (found.end.fates[i] != RayFate::transmitted) continue;
      const auto d = in_double(found.end.rays[i]).direction;
      for (const auto& tangent : {found.u[i], found.v[i]}) {
        const auto turn = in_double(tangent).direction;
        most(options, std::abs(glm::dot(d, turn)) / std::max(1.0, length(turn)), sample.id);
      }
    }
  });
  most.close("differentials: unit length of directions", 32);
}

// Doubled tangents give doubled derivatives to the bit; a sum of tangents gives the sum.
TYPED_TEST(DifferentialsOf, AreLinear) {
  using T = TypeParam;
  Most<T> most;
  on_every_ray<T>(40, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    auto other = beam;
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      other.u[i] = {beam.u[i].origin + beam.v[i].origin, beam.u[i].direction + beam.v[i].direction};
      other.v[i] = {T(2) * beam.v[i].origin, T(2) * beam.v[i].direction};
    }
    const auto again = followed(sample.lens, other, options);
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      if (found.end.fates[i] != RayFate::transmitted) continue;
      const Ray<T> v = found.v[i], doubled{T(2) * v.origin, T(2) * v.direction};
      EXPECT_TRUE(same_bits(again.v[i], doubled)) << sample.id << " " << text(options);
      const auto a = in_double(found.u[i]), b = in_double(v), sum = in_double(again.u[i]);
      const double place = sample.size + length(a.origin) + length(b.origin);
      const double turn = 1 + length(a.direction) + length(b.direction);
      most(options, length(sum.origin - (a.origin + b.origin)) / place, sample.id + " place");
      most(options, length(sum.direction - (a.direction + b.direction)) / turn, sample.id + " direction");
    }
  });
  most.close("differentials: linearity", 64);
}

// A ray and its neighbours, reversed behind the lens, return along their own lines.
TYPED_TEST(DifferentialsOf, ReversedRaysReturn) {
  using T = TypeParam;
  Most<T> most;
  on_every_ray<T>(60, [&](const auto& sample, auto options, const auto& beam, const auto& found) {
    Beam<T> turned = beam;
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      const Ray<T> end = found.end.rays[i], u = found.u[i], v = found.v[i];
      turned.rays[i] = {end.origin, -end.direction};
      turned.u[i] = {u.origin, -u.direction};
      turned.v[i] = {v.origin, -v.direction};
    }
    options.travel = options.travel == Travel::to_film ? Travel::to_scene : Travel::to_film;
    options.apertures = false;
    const auto back = followed(sample.lens, turned, options);
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      if (found.end.fates[i] != RayFate::transmitted || back.end.fates[i] != RayFate::transmitted) continue;
      const auto ray = in_double(beam.rays[i]), there = in_double(back.end.rays[i]);
      const double way = glm::dot(there.origin - ray.origin, ray.direction);
      const auto judge = [&](const Ray<double>& before, const Ray<double>& between, const Ray<double>& after) {
        auto place = after.origin - before.origin - way * before.direction;
        place -= glm::dot(place, ray.direction) * ray.direction;
        const double amplified = 1 + length(between.origin) / sample.size + length(between.direction);
        most(options, length(place) / sample.size / amplified, sample.id + " place");
        most(options, length(after.direction + before.direction) / amplified, sample.id + " direction");
      };
      judge(in_double(beam.u[i]), in_double(found.u[i]), in_double(back.u[i]));
      judge(in_double(beam.v[i]), in_double(found.v[i]), in_double(back.v[i]));
    }
  });
  most.close("differentials: reversed", 512);
}

// ---- Slots

TYPED_TEST(DifferentialsOf, RaysEqualTheTraceWithoutDerivatives) {
  using T = TypeParam;
  Most<T> most;
  on_every_ray<T>(150, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    const auto plain = traced(sample.lens, beam.rays, options);
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      const std::string what = sample.id + " ray " + std::to_string(i);
      ASSERT_EQ(found.end.fates[i], plain.fates[i]) << what << " " << text(options);
      ASSERT_EQ(found.end.surfaces[i], plain.surfaces[i]) << what << " " << text(options);
      if (options.arithmetic == Arithmetic::reproducible) {
        ASSERT_TRUE(same_bits(found.end.rays[i], plain.rays[i])) << what << " " << text(options);
      }
      const auto a = in_double(found.end.rays[i]), b = in_double(plain.rays[i]);
      most(options, length(a.origin - b.origin) / sample.size, what + " place");
      most(options, length(a.direction - b.direction), what + " direction");
    }
  });
  most.close("differentials: rays, compared with the trace", 16);
}

TYPED_TEST(DifferentialsOf, LostRaysGiveZerosAndFiniteLanes) {
  using T = TypeParam;
  std::size_t lost = 0;
  on_every_ray<T>(150, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    EXPECT_TRUE(found.guards_hold());
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
      ASSERT_TRUE(finite(found.end.rays[i]) && finite(found.u[i]) && finite(found.v[i])) << what;
      const bool passed = found.end.fates[i] == RayFate::transmitted;
      lost += !passed;
      ASSERT_EQ(is_zero(found.u[i]), !passed) << what;
      ASSERT_EQ(is_zero(found.v[i]), !passed) << what;
    }
  });
  EXPECT_GT(lost, 1000u);
}

TYPED_TEST(DifferentialsOf, BitsAreIndependentOfTheCount) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const Beam<T> beam(rays_for<T>(sample, travel, 130), sample.size);
      for (const auto& options : every_batch(travel)) {
        const auto whole = followed(sample.lens, beam, options);
        for (std::size_t count = 0; count < 130; ++count) {
          auto some = beam;
          for (auto* column : {&some.rays, &some.u, &some.v}) column->resize(count);
          const auto found = followed(sample.lens, some, options);
          ASSERT_TRUE(found.guards_hold()) << sample.id << " " << text(options) << " " << count;
          for (std::size_t i = count < 3 ? 0 : count - 3; i < count; ++i) {
            ASSERT_TRUE(same_bits(found, i, whole, i)) << sample.id << " " << text(options) << " " << i << "/" << count;
          }
        }
      }
    }
  }
}

TYPED_TEST(DifferentialsOf, ResultsMayReplaceTheInput) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const Beam<T> beam(rays_for<T>(sample, travel, 100), sample.size);
      for (const auto& options : every_batch(travel)) {
        const auto wanted = followed(sample.lens, beam, options);
        Arrays<T> rays(beam.rays), u(beam.u), v(beam.v);
        const auto in = std::as_const(rays).in();
        petzval::trace_differentials<T>(sample.lens, beam.rays.size(), in, {u.in(), v.in()}, rays.out(),
                                        {u.out(), v.out()}, nullptr, nullptr, options);
        for (std::size_t i = 0; i < beam.rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          ASSERT_TRUE(same_bits(rays[i], wanted.end.rays[i])) << what;
          ASSERT_TRUE(same_bits(u[i], wanted.u[i]) && same_bits(v[i], wanted.v[i])) << what;
        }
      }
    }
  }
}

// Invalid rays and tangents do not change other lanes; an invalid tangent changes neither its ray nor the other
// tangent.
TYPED_TEST(DifferentialsOf, InvalidNumbersDoNotChangeOtherLanes) {
  using T = TypeParam;
  const T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const Beam<T> beam(rays_for<T>(sample, travel, 147), sample.size);
      Beam<T> spoilt = beam;
      for (std::size_t i = 5; i + 1 < beam.rays.size(); i += 9) {
        spoilt.rays[i].origin.x = i % 2 ? nan : infinity;
        spoilt.u[i + 1].direction.y = nan;
      }
      for (const auto& options : every_batch(travel)) {
        const auto wanted = followed(sample.lens, beam, options), found = followed(sample.lens, spoilt, options);
        for (std::size_t i = 0; i < beam.rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          if (i % 9 == 5) {
            ASSERT_NE(found.end.fates[i], RayFate::transmitted) << what;
            ASSERT_TRUE(finite(found.end.rays[i]) && is_zero(found.u[i]) && is_zero(found.v[i])) << what;
          } else if (i % 9 == 6) {
            ASSERT_TRUE(same_bits(found.end, i, wanted.end, i) && same_bits(found.v[i], wanted.v[i])) << what;
          } else {
            ASSERT_TRUE(same_bits(found, i, wanted, i)) << what;
          }
        }
      }
    }
  }
}

TYPED_TEST(DifferentialsOf, MixedBatchEqualsBatchesOfOneWavelength) {
  using T = TypeParam;
  Most<T> most;
  for (const char* id : {"double_gauss_100mm_f2.0", "catadioptric_mangin_1000mm_f7.5", "phone_5.6mm_f3.5"}) {
    auto sample = testing_lenses::load(id);
    sample.lens = petzval::compile(sample.prescription, std::vector{587.5618, 435.8343, 656.2725},
                                   {.missing_glass = petzval::MissingGlass::abbe});
    for (const Travel travel : both_ways) {
      const Beam<T> beam(rays_for<T>(sample, travel, 150), sample.size);
      std::vector<std::uint16_t> mixed(beam.rays.size());
      for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = static_cast<std::uint16_t>(i * i % 7 % 4);  // 3: none
      for (auto options : every_batch(travel)) {
        std::vector<Followed<T>> alone;
        for (std::size_t w = 0; w < 4; ++w) {
          options.wavelengths = {w};
          alone.push_back(followed(sample.lens, beam, options));
        }
        options.wavelengths = {.each = mixed.data()};
        const auto found = followed(sample.lens, beam, options);
        for (std::size_t i = 0; i < mixed.size(); ++i) {
          const std::string what = std::string(id) + " ray " + std::to_string(i);
          const Followed<T>& wanted = alone[mixed[i]];
          if (options.arithmetic == Arithmetic::reproducible) {
            ASSERT_TRUE(same_bits(found, i, wanted, i)) << what << " " << text(options);
          }
          ASSERT_EQ(found.end.fates[i], wanted.end.fates[i]) << what << " " << text(options);
          const auto a = in_double(found.u[i]), b = in_double(wanted.u[i]);
          most(options, length(a.origin - b.origin) / (sample.size + length(b.origin)), what + " place");
          most(options, length(a.direction - b.direction) / (1 + length(b.direction)), what + " direction");
        }
      }
    }
  }
  most.close("differentials: wavelengths mixed", 64);
}

TYPED_TEST(DifferentialsOf, ReproducibleBitsAreEqualOnEveryInstructionSet) {
  using T = TypeParam;
  on_every_ray<T>(130, [&](const auto& sample, const auto& options, const auto& beam, const auto& found) {
    if (options.arithmetic == Arithmetic::fast) return;
    const InstructionSet set = limit_batches(InstructionSet::baseline);
    const auto wanted = followed(sample.lens, beam, options);
    limit_batches(set);
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      ASSERT_TRUE(same_bits(found, i, wanted, i)) << sample.id << " ray " << i;
    }
  });
}

}  // namespace differentials_test
