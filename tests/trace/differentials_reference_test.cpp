// SPDX-License-Identifier: Apache-2.0
// Derivatives of batches, compared with dual numbers in the kernel (ceres::Jet over long double).
#include <gtest/gtest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <ceres/jet.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../digits.hpp"
#include "../report.hpp"
#include "differentials.hpp"
#include "extended.hpp"

namespace differentials_reference_test {

using namespace testing_differentials;
using L = long double;
using Jet = ceres::Jet<L, 6>;
constexpr double infinity = std::numeric_limits<double>::infinity();
using petzval::kernel::Vec;

/// The end of a ray and the Jacobian of its six numbers with respect to the six numbers in front of the lens.
struct Exactly {
  RayFate fate;
  std::array<Jet, 6> v;

  /// Component k of the derivative along a tangent.
  L along(std::size_t k, const std::array<L, 6>& tangent) const {
    L sum = 0;
    for (int i = 0; i < 6; ++i) sum += v[k].v[i] * tangent[static_cast<std::size_t>(i)];
    return sum;
  }
};

template <class T>
std::array<L, 6> numbers(const Ray<T>& r) {
  return {r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z};
}

/// Traces through surfaces [first, last) in the order of travel.
Exactly exactly(const petzval::kernel::LensView<L>& lens, std::array<L, 6> ray, Travel travel, std::size_t first,
                std::size_t last) {
  const L length = std::sqrt(ray[3] * ray[3] + ray[4] * ray[4] + ray[5] * ray[5]);
  for (std::size_t k = 3; k < 6; ++k) ray[k] /= length;
  const Vec<Jet> origin{Jet(ray[0], 0), Jet(ray[1], 1), Jet(ray[2], 2)};
  const Vec<Jet> direction{Jet(ray[3], 3), Jet(ray[4], 4), Jet(ray[5], 5)};
  const bool to_film = travel == Travel::to_film;
  const auto end = trace(lens, origin, direction,
                         {.travel = travel,
                          .apertures = false,
                          .first = to_film ? first : lens.count - last,
                          .last = to_film ? last : lens.count - first});
  return {end.fate, {end.origin.x, end.origin.y, end.origin.z, end.direction.x, end.direction.y, end.direction.z}};
}

std::array<L, 6> change(const Exactly& end, const std::array<L, 6>& tangent) {
  std::array<L, 6> result;
  for (std::size_t k = 0; k < 6; ++k) result[k] = end.along(k, tangent);
  return result;
}

L distance(const std::array<L, 6>& a, const std::array<L, 6>& b, std::size_t first) {
  L sum = 0;
  for (std::size_t k = first; k < first + 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

/// Change of the derivatives for a change of one eps in each number of the ray or of its tangent, at any surface.
struct Unit {
  L place = 0, turn = 0;
};

/// An exact ray: its end, the ends of rays one eps away, and the remaining map behind each surface.
class Truth {
 public:
  Truth(const testing_lenses::Tables<L>& tables, const std::array<L, 6>& ray, Travel travel, L eps, L size)
      : eps_(eps) {
    const auto lens = tables.view();
    for (std::size_t j = 0; j <= lens.count && steady_; ++j) {
      before_.push_back(exactly(lens, ray, travel, 0, j));
      steady_ = before_.back().fate == RayFate::transmitted;
      std::array<L, 6> here;
      for (std::size_t k = 0; k < 6; ++k) here[k] = before_.back().v[k].a;
      behind_.push_back(exactly(lens, here, travel, j, lens.count));
    }
    for (std::size_t k = 0; k < 6; ++k) {
      auto other = ray;
      other[k] += (k % 2 ? eps : -eps) * (k < 3 ? std::max(std::abs(other[k]), size) : 1);
      moved_.push_back(exactly(lens, other, travel, 0, lens.count));
      steady_ = steady_ && moved_.back().fate == RayFate::transmitted;
    }
  }

  /// True if the ray and the rays one eps away pass the surfaces.
  bool steady() const { return steady_; }

  std::array<L, 6> end(const std::array<L, 6>& tangent) const { return change(before_.back(), tangent); }

  Unit unit(const std::array<L, 6>& tangent) const {
    Unit tangents;
    for (std::size_t j = 0; j < before_.size(); ++j) {
      const auto here = change(before_[j], tangent);
      L place = 0, turn = 0;
      for (std::size_t k = 0; k < 6; ++k) {
        for (int i = 0; i < 6; ++i) {
          (k < 3 ? place : turn) += eps_ * std::abs(behind_[j].v[k].v[i] * here[static_cast<std::size_t>(i)]);
        }
      }
      tangents = {std::max(tangents.place, place), std::max(tangents.turn, turn)};
    }
    Unit rays;
    for (const Exactly& other : moved_) {
      const auto found = change(other, tangent);
      rays.place = std::max(rays.place, distance(found, end(tangent), 0));
      rays.turn = std::max(rays.turn, distance(found, end(tangent), 3));
    }
    return {tangents.place + rays.place, tangents.turn + rays.turn};
  }

 private:
  L eps_;
  bool steady_ = true;
  std::vector<Exactly> before_, behind_, moved_;
};

struct Worst {
  double error = 0;
  std::string where;
};

/// Largest errors of fast and reproducible batches on a lens.
template <class T>
void judge(const testing_lenses::Sample& sample, std::array<Worst, 2>& worst, int& judged) {
  const L eps = std::numeric_limits<T>::epsilon();
  const auto tables = testing_lenses::extended(petzval::kernel::view<double>(sample.lens));
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    const Beam<T> beam(rays_for<T>(sample, travel, 48), sample.size);
    const auto all = every_batch(travel);
    std::vector<Followed<T>> found;
    for (const auto& options : all) found.push_back(followed(sample.lens, beam, options));
    for (std::size_t i = 0; i < beam.rays.size(); ++i) {
      if (found[0].end.fates[i] != RayFate::transmitted) continue;
      const Truth truth(tables, numbers(beam.rays[i]), travel, eps, sample.size);
      if (!truth.steady()) continue;
      for (const bool second : {false, true}) {
        const auto tangent = numbers((second ? beam.v : beam.u)[i]), wanted = truth.end(tangent);
        const Unit one = truth.unit(tangent);
        ++judged;
        for (std::size_t w = 0; w < all.size(); ++w) {
          if (found[w].end.fates[i] != RayFate::transmitted) continue;
          const auto answer = numbers((second ? found[w].v : found[w].u)[i]);
          const L place = distance(answer, wanted, 0) / one.place, turn = distance(answer, wanted, 3) / one.turn;
          Worst& most = worst[all[w].arithmetic == petzval::Arithmetic::fast ? 0 : 1];
          const bool numbers_at_all = std::isfinite(place + turn);
          const double error = numbers_at_all ? static_cast<double>(std::max(place, turn)) : infinity;
          if (error > most.error) {
            most = {error, (place > turn ? "place, " : "direction, ") + sample.id + ", " + text(all[w]) + ", ray " +
                               std::to_string(i)};
          }
        }
      }
    }
  }
}

using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(DifferentialsOf, Plain);

template <class T>
void judge_all(const std::vector<testing_lenses::Sample>& samples, const std::string& row, double bound) {
  std::array<Worst, 2> worst;
  for (const auto& sample : samples) {
    int judged = 0;
    judge<T>(sample, worst, judged);
    EXPECT_GE(judged, 4) << sample.id;
  }
  for (const Worst& w : worst) EXPECT_LE(w.error, bound) << w.where;
  testing_report::put(row, testing_report::batch<T>,
                      petzval::testing::digits(worst[0].error, 2) + " / " + petzval::testing::digits(worst[1].error, 2),
                      petzval::testing::digits(bound) + " eps");
}

TYPED_TEST(DifferentialsOf, EveryLensEqualsExactRays) {
  judge_all<TypeParam>(testing_lenses::all(), "differentials: all 75 lenses, both ways", 16);
}

TYPED_TEST(DifferentialsOf, EveryKindOfSurfaceEqualsExactRays) {
  judge_all<TypeParam>(made(), "differentials: single surfaces, both ways", 8);
}

}  // namespace differentials_reference_test
