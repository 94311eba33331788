// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "footprint.hpp"
#include "ghost_paths.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/ghosts/ghosts.hpp"

namespace petzval {
namespace {

using namespace ghosts_detail;

/// A branch of a split ray in front of a surface.
struct Branch {
  Vec origin, direction;
  Wave wave;
  std::size_t surface = 0;
  bool forward = true;
  int reflections = 0;
};

/// Splits rays and adds up where their energy ends.
class Splitter {
 public:
  explicit Splitter(const Surfaces& surfaces, std::uint32_t seed) : surfaces_(surfaces), random_(seed) {}

  /// @return false if the ray does not enter the first surface within its rim
  bool split(const Ray<double>& ray, double energy) {
    Branch first{kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction), {}};
    Contact contact;
    if (surfaces_.meet(0, true, first.origin, first.direction, true, contact) != RayFate::transmitted) return false;
    first.wave = Wave::along(first.direction);
    energy_ = energy;
    branches_ = {first};
    while (!branches_.empty()) {
      const Branch branch = branches_.back();
      branches_.pop_back();
      follow(branch);
    }
    return true;
  }

  GhostAudit ends;  ///< sums of energies

 private:
  void follow(Branch branch) {
    constexpr double least = 1e-5;
    const std::size_t count = surfaces_.count();
    for (;;) {
      const double before = branch.wave.power();
      if (branch.reflections > 2 && before < least) return end(ends.higher_order, before);
      Contact contact;
      const std::size_t surface = branch.surface;
      if (surfaces_.meet(surface, branch.forward, branch.origin, branch.direction, true, contact) !=
          RayFate::transmitted) {
        return end(ends.stopped, before);
      }
      // Outside the lens, rays are whole lines.
      const std::size_t space = branch.forward ? surface : surface + 1;
      const Vec moved = contact.point - branch.origin;
      const double kept =
          space == 0 || space == count ? 1 : std::exp(-surfaces_.absorption(space) * std::sqrt(dot(moved, moved)));
      scale(branch.wave, kept);
      const double arriving = before * kept;
      end(ends.absorbed, before - arriving);
      branch.origin = contact.point;
      if (surface == count) {
        const double reflected = contact.light.reflectance();
        auto& reached = branch.reflections == 0   ? ends.image
                        : branch.reflections == 2 ? ends.ghosts
                                                  : ends.higher_order;
        end(reached, arriving * (1 - reflected));
        if (!(reflected > 0)) return;
        Surfaces::reflect(contact, branch.direction, branch.wave);
        ++branch.reflections;
        branch.forward = false;
      } else if (surfaces_.mirror(surface)) {
        Surfaces::reflect(contact, branch.direction, branch.wave);
        end(ends.absorbed, arriving - branch.wave.power());
      } else {
        Branch other = branch;
        double left = 0;
        if (surfaces_.refract(surface, branch.forward, contact, branch.direction, branch.wave)) {
          left = branch.wave.power();
        }
        if (contact.light.reflectance() > 0) {
          Surfaces::reflect(contact, other.direction, other.wave);
          other.forward = !other.forward;
          ++other.reflections;
          end(ends.absorbed, arriving - left - other.wave.power());
          if (left == 0) {
            branch = other;
          } else if (chosen(other) && step(other)) {
            branches_.push_back(other);
          }
        }
      }
      if (!step(branch)) return;
    }
  }

  /// Chooses some of the reflected branches of a lens of many surfaces at random; they stand for the others.
  bool chosen(Branch& branch) {
    const double probability = std::min(1.0, most_split / static_cast<double>(surfaces_.count()));
    if (probability == 1) return true;
    scale(branch.wave, 1 / probability);
    return std::uniform_real_distribution<double>()(random_) < probability;
  }
  /// Moves on to the next surface; false if the branch leaves through the first.
  bool step(Branch& branch) {
    if (!branch.forward && branch.surface == 0) {
      end(ends.back_out, branch.wave.power());
      return false;
    }
    branch.forward ? ++branch.surface : --branch.surface;
    return true;
  }

  static void scale(Wave& wave, double power) noexcept {
    const double field = std::sqrt(power);
    wave = {wave.first * field, wave.second * field};
  }
  void end(double& sum, double power) const noexcept { sum += power * energy_; }

  static constexpr double most_split = 48;  ///< largest number of surfaces of which all branches are followed

  const Surfaces& surfaces_;
  std::minstd_rand random_;
  double energy_ = 0;
  std::vector<Branch> branches_;
};

}  // namespace

GhostAudit ghost_audit(const Lens& lens, const ScenePoint& light, const GhostOptions& options, std::size_t rays) {
  if (rays < 1) throw Error("ghost_audit: rays = 0; must be at least 1");
  const GhostPaths paths(lens, light, options);
  const Surfaces surfaces(lens, options.wavelength, options.film_reflectance);
  rays = std::min(rays, std::max<std::size_t>(32, 100 * rays / std::max<std::size_t>(100, lens.surface_count())));
  // Half of the rays aim at the part of the front through which the image is formed: it may be a thousandth of the
  // front.
  std::vector<lens_detail::Passage> direct;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) direct.push_back({i, false});
  const Box box = paths.entrance.box(), lit = LightPath(lens, direct).region(paths.entrance, options.wavelength);
  const auto density = [](const Box& of, const Vec2<double>& at) {
    const Vec2<double> size = of.high - of.low;
    const bool inside = at.x >= of.low.x && at.y >= of.low.y && at.x <= of.high.x && at.y <= of.high.y;
    return inside && size.x * size.y > 0 ? 1 / (size.x * size.y) : 0;
  };
  constexpr std::size_t block = 16;
  std::vector<GhostAudit> sums((rays + block - 1) / block);
  std::vector<double> entered(sums.size());
  parallel_for(rays, block, options.threads, [&](std::size_t begin, std::size_t end) {
    Splitter splitter(surfaces, static_cast<std::uint32_t>(begin + 1));
    for (std::size_t k = begin; k < end; ++k) {
      const Box& from = k % 2 == 1 && lit.high.x > lit.low.x ? lit : box;
      const auto index = static_cast<std::uint32_t>(k / 2);
      const Vec2<double> at = from.low + (from.high - from.low) * owen_sobol(index, static_cast<std::uint32_t>(k % 2));
      const double energy = paths.entrance.flux(at) / (density(box, at) + density(lit, at));
      if (splitter.split(paths.entrance.ray(at), energy)) entered[begin / block] += energy;
    }
    sums[begin / block] = splitter.ends;
  });
  GhostAudit result;
  const double total = std::accumulate(entered.begin(), entered.end(), 0.0);
  if (!(total > 0)) throw Error("ghost_audit: rays = " + std::to_string(rays) + "; must be more: none enters the lens");
  for (double GhostAudit::*part : {&GhostAudit::image, &GhostAudit::higher_order, &GhostAudit::absorbed,
                                   &GhostAudit::stopped, &GhostAudit::back_out}) {
    for (const GhostAudit& own : sums) result.*part += own.*part / total;
    result.sum += result.*part;
  }
  const Ghosts ghosts = ghost_pairs(lens, light, options);
  for (const GhostPair& pair : ghosts.pairs) result.ghosts += pair.energy * (1 - options.film_reflectance);
  result.sum += result.ghosts;
  return result;
}

}  // namespace petzval
