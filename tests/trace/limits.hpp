// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../digits.hpp"
#include "../report.hpp"
#include "batches.hpp"
#include "extended.hpp"

/// Compares single rays and batches of both arithmetics on every instruction set with exact rays.
namespace testing_limits {

using petzval::Arithmetic;
using petzval::Lens;
using petzval::Ray;
using petzval::RayFate;
using petzval::Travel;

using L = long double;
using Exactly = petzval::kernel::TraceState<L>;

/// A fate must equal the fate of an exact ray whose numbers differ by at most this many eps.
inline constexpr int eps_beside = 64;

/// The change for one eps: eps x max(|coordinate|, place) for a coordinate, eps x max(|component|, turn) for a
/// component of the direction.
struct Floors {
  double place = 1, turn = 0;
};

/// A lens traced in long double by the kernels, over the constants of double.
class Exact {
 public:
  explicit Exact(const Lens& lens)
      : tables_(testing_lenses::extended(petzval::kernel::view<double>(lens))), wider_(tables_), narrower_(tables_) {}

  template <class T>
  Exactly operator()(const Ray<T>& ray, Travel travel) const {
    return traced(tables_, exact(ray.origin), exact(ray.direction), travel);
  }

  /// True if a ray within eps_beside eps of this ray, with rims changed by as many eps, has this end.
  template <class T>
  bool ends_so_nearby(const Ray<T>& ray, Travel travel, const Floors& floors, RayFate fate, int surface) {
    const L eps = std::numeric_limits<T>::epsilon() * L(eps_beside);
    for (std::size_t i = 0; i < tables_.surfaces.size(); ++i) {
      const auto& s = tables_.surfaces[i];
      wider_.surfaces[i].semi_diameter_squared = s.semi_diameter_squared * (1 + 2 * eps);
      wider_.surfaces[i].obscuration_squared = s.obscuration_squared * (1 - 2 * eps);
      narrower_.surfaces[i].semi_diameter_squared = s.semi_diameter_squared * (1 - 2 * eps);
      narrower_.surfaces[i].obscuration_squared = s.obscuration_squared * (1 + 2 * eps);
    }
    testing_batches::Numbers random(1);
    for (int i = 0; i < 300; ++i) {
      auto o = exact(ray.origin), d = exact(ray.direction);
      const L reach = eps / (1 << i % 7);
      const auto nudge = [&](L& x, double floor) { x += reach * std::max(std::abs(x), L(floor)) * random(-1, 1); };
      for (L* x : {&o.x, &o.y, &o.z}) nudge(*x, floors.place);
      for (L* x : {&d.x, &d.y, &d.z}) nudge(*x, floors.turn);
      const auto& tables = i % 3 == 0 ? tables_ : i % 3 == 1 ? wider_ : narrower_;
      const auto end = traced(tables, o, d, travel);
      if (end.fate == fate && end.surface == surface) return true;
    }
    return false;
  }

  /// The unit of errors: the change of the end for changes of one eps of T in each number of the ray, and eps x floors.
  struct Unit {
    double place = 0, turn = 0;
    bool steady = true;  ///< true if the changed rays pass
  };
  template <class T>
  Unit unit(const Ray<T>& ray, Travel travel, const Floors& floors, const Exactly& end) const {
    const L eps = std::numeric_limits<T>::epsilon();
    Unit unit{static_cast<double>(eps * floors.place), static_cast<double>(eps)};
    double place = 0, turn = 0;
    for (int k = 0; k < 12; ++k) {
      auto o = exact(ray.origin), d = exact(ray.direction);
      L* const numbers[] = {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z};
      L& x = *numbers[k / 2];
      x += (k % 2 ? eps : -eps) * std::max(std::abs(x), L(k < 6 ? floors.place : floors.turn));
      const auto moved = traced(tables_, o, d, travel);
      if (moved.fate != end.fate || moved.surface != end.surface) return {0, 0, false};
      place = std::max(place, distance(moved.origin, end.origin));
      turn = std::max(turn, distance(moved.direction, end.direction));
    }
    return {unit.place + place, unit.turn + turn, true};
  }

  static double distance(const petzval::kernel::Vec<L>& a, const petzval::kernel::Vec<L>& b) {
    const auto v = a - b;
    return static_cast<double>(std::sqrt(dot(v, v)));
  }
  template <class T>
  static petzval::kernel::Vec<L> exact(const petzval::Vec3<T>& v) {
    return {L(v.x), L(v.y), L(v.z)};
  }

 private:
  static Exactly traced(const testing_lenses::Tables<L>& tables, const petzval::kernel::Vec<L>& origin,
                        const petzval::kernel::Vec<L>& direction, Travel travel) {
    return trace(tables.view(), origin, direction, {.travel = travel});
  }

  testing_lenses::Tables<L> tables_, wider_, narrower_;
};

/// Largest errors of the tracers in one case, in the unit above.
template <class T>
class Judge {
 public:
  void operator()(const Lens& lens, const std::vector<Ray<T>>& rays, Travel travel, const Floors& floors,
                  const std::string& what) {
    Exact exact(lens);
    std::vector<Exactly> ends;
    std::vector<Exact::Unit> units;
    for (const Ray<T>& ray : rays) {
      ends.push_back(exact(ray, travel));
      const bool passes = ends.back().fate == RayFate::transmitted;
      units.push_back(passes ? exact.unit(ray, travel, floors, ends.back()) : Exact::Unit{0, 0, false});
    }
    const auto take = [&](std::size_t tracer, std::size_t i, const Ray<T>& end, RayFate fate, int surface,
                          const std::string& how) {
      const auto where = [&] { return what + ", " + how + ", ray " + std::to_string(i) + shown(rays[i]); };
      ++judged_;
      if (fate != ends[i].fate || surface != ends[i].surface) {
        ++beside_;
        // If a ray misses the aperture of an asphere, the iteration may or may not find a hit outside.
        const bool lost_outside = surface == ends[i].surface && fate != RayFate::transmitted &&
                                  fate != RayFate::totally_reflected && aspheric(lens, surface);
        if (!lost_outside && !exact.ends_so_nearby(rays[i], travel, floors, fate, surface) && ++wrong_ <= 10) {
          ADD_FAILURE() << where() << ": " << name(fate) << " at " << surface << ", exactly " << name(ends[i].fate)
                        << " at " << ends[i].surface;
        }
        return;
      }
      if (!units[i].steady) return;
      ++measured_;
      const double place = Exact::distance(Exact::exact(end.origin), ends[i].origin) / units[i].place;
      const double turn = Exact::distance(Exact::exact(end.direction), ends[i].direction) / units[i].turn;
      if (std::max(place, turn) > worst_[tracer].error) {
        worst_[tracer] = {std::max(place, turn), (place > turn ? "place, " : "direction, ") + where()};
      }
    };
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto one = petzval::trace(lens, rays[i], {.travel = travel});
      take(0, i, one.ray, one.fate, one.surface, "one ray");
    }
    for (const auto& options : testing_batches::every_batch(travel)) {
      const auto batch = testing_batches::traced(lens, rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        take(options.arithmetic == Arithmetic::fast ? 1 : 2, i, batch.rays[i], batch.fates[i], batch.surfaces[i],
             testing_batches::text(options));
      }
    }
  }

  /// Compares the largest errors with a bound in eps and reports the errors.
  void close(const std::string& row, double bound, double least_measured = 0.2) const {
    EXPECT_EQ(wrong_, 0u) << row << ": fates that no ray within " << eps_beside << " eps has";
    EXPECT_GE(static_cast<double>(measured_), least_measured * static_cast<double>(judged_)) << row;
    for (const Worst& worst : worst_) EXPECT_LE(worst.error, bound) << row << ": " << worst.where;
    const auto number = [&](std::size_t tracer) { return petzval::testing::digits(worst_[tracer].error, 2); };
    const std::string limit = petzval::testing::digits(bound) + " eps";
    testing_report::put(row, testing_report::one_ray<T>, number(0), limit);
    testing_report::put(row, testing_report::batch<T>, number(1) + " / " + number(2), limit);
  }

  /// Fraction of the fates that differ from exact rays.
  double beside() const { return static_cast<double>(beside_) / static_cast<double>(judged_); }

 private:
  static bool aspheric(const Lens& lens, int surface) {
    return !lens.surfaces()[static_cast<std::size_t>(surface)].aspheric.empty();
  }
  static std::string shown(const Ray<T>& r) {
    std::string text = " (";
    for (const T x : {r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z}) {
      text += " " + petzval::testing::digits(static_cast<double>(x));
    }
    return text + " )";
  }

  struct Worst {
    double error = 0;
    std::string where;
  };
  std::array<Worst, 3> worst_;  // single rays, fast batches, reproducible batches
  std::size_t judged_ = 0, measured_ = 0, beside_ = 0, wrong_ = 0;
};

}  // namespace testing_limits
