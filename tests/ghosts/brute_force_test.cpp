// SPDX-License-Identifier: Apache-2.0
// Ghosts of whole lenses against rays that are reflected and refracted at random by plain formulas.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "plain_optics.hpp"

namespace petzval {
namespace brute_force_test {

using testing::PlainLens;
using testing::V;

/// A ray in front of a surface with the field of one linear polarisation; its squared length is the power.
struct Branch {
  V origin, direction, field;
  std::size_t surface = 0;
  bool forward = true;

  double power() const { return glm::dot(field, field); }
  /// Moves to the next surface; false if the ray leaves the lens.
  bool step(std::size_t count) {
    if (forward ? surface + 1 == count : surface == 0) return false;
    forward ? ++surface : --surface;
    return true;
  }
};

/// Moves a ray to its surface and splits it; false if it is lost. The fields that do not exist are 0.
bool split(const PlainLens& lens, Branch& ray, Branch& reflected) {
  const auto& own = lens.surfaces[ray.surface];
  V normal;
  const auto hit = lens.meet(ray.surface, ray.origin, ray.direction, normal);
  if (!hit) return false;
  ray.origin = *hit;
  reflected.field = {0, 0, 0};
  const double in = ray.forward ? own.before : own.behind, out = ray.forward ? own.behind : own.before;
  if (in == out) return true;
  const V d = ray.direction;
  const testing::Bare bare(in, out, -glm::dot(d, normal));
  V s = glm::cross(d, normal);
  s = glm::dot(s, s) > 1e-24 ? glm::normalize(s) : glm::normalize(glm::cross(d, V{0.6, 0.8, 0}));
  const double along_s = glm::dot(ray.field, s), along_p = glm::dot(ray.field, glm::cross(s, d));
  reflected = ray;
  reflected.direction = testing::thrown_back(d, normal);
  reflected.field = s * (bare.fs * along_s) + glm::cross(s, reflected.direction) * (bare.fp * along_p);
  reflected.forward = !ray.forward;
  if (bare.ts + bare.tp > 0) ray.direction = testing::bent(d, normal, in, out);
  ray.field = s * (std::sqrt(bare.ts) * along_s) + glm::cross(s, ray.direction) * (std::sqrt(bare.tp) * along_p);
  return true;
}

/// A sum of random weights, and its variance.
struct Sum {
  double value = 0, squares = 0;
  int count = 0;

  void add(double weight) { value += weight, squares += weight * weight, ++count; }
};

constexpr int bins = 64;

/// The light of rays, as sums of weights.
struct Tally {
  double entered = 0, image = 0;
  Sum ghosts, higher;
  std::map<std::pair<std::size_t, std::size_t>, Sum> pairs;
  std::vector<Sum> picture{bins * bins};
};

/// Random rays of a far light. The first two reflections are forced: one surface is chosen among those that the ray
/// passes, by the reflected powers, and the weight is their sum. Behind them, light is reflected or refracted at
/// random.
class Tracer {
 public:
  Tracer(const Lens& lens, double angle, const Film& film)
      : lens_(lens), film_(film), d_(0, std::sin(angle), std::cos(angle)), up_(0, d_.z, -d_.y) {
    const auto& front = lens_.surfaces[0];
    for (int k = 0; k <= 64; ++k) {
      const double y = front.rim * (k / 32.0 - 1), z = front.sag(std::abs(y)).first;
      low_ = std::min(low_, y * up_.y + z * up_.z), high_ = std::max(high_, y * up_.y + z * up_.z);
    }
    // The rim is an ellipse, seen from the light; its sides can lie outside the section.
    const double side = front.sag(front.rim).first * up_.z;
    low_ = std::min(low_, side) - 0.01 * front.rim, high_ = std::max(high_, side) + 0.01 * front.rim;
  }

  double area_mm2() const { return 2 * lens_.surfaces[0].rim * (high_ - low_); }

  void trace(int rays) {
    for (int k = 0; k < rays; ++k) trace_one();
  }

  Tally tally;
  std::optional<std::pair<std::size_t, std::size_t>> only{};  ///< the first surface and the second of one pair

 private:
  double random() { return uniform_(engine_); }

  /// Follows the refracted ray and lists the reflected rays. @return true if the ray leaves the lens
  bool pass(Branch& ray) {
    choices_.clear();
    Branch reflected;
    for (;;) {
      if (!split(lens_, ray, reflected)) return false;
      // A ray that the front surface reflects has left the lens.
      if (reflected.power() > 0 && (ray.surface > 0 || !ray.forward)) choices_.push_back(reflected);
      if (!(ray.power() > 0)) return false;
      if (!ray.step(lens_.surfaces.size())) return true;
    }
  }
  /// Chooses one of the reflected rays; false if no surface reflects.
  bool choose(Branch& ray, double& weight, std::size_t surface) {
    if (only) std::erase_if(choices_, [&](const Branch& choice) { return choice.surface != surface; });
    double sum = 0;
    for (const Branch& choice : choices_) sum += choice.power();
    if (!(sum > 0)) return false;
    weight *= sum;
    double left = random() * sum;
    std::size_t chosen = 0;
    while (chosen + 1 < choices_.size() && left > choices_[chosen].power()) left -= choices_[chosen++].power();
    ray = choices_[chosen];
    ray.field = glm::normalize(ray.field);
    return true;
  }

  void trace_one() {
    const double x = (2 * random() - 1) * lens_.surfaces[0].rim, y = low_ + (high_ - low_) * random();
    const double turn = 2 * std::numbers::pi * random();
    Branch ray{V{x, 0, 0} + up_ * y, d_, V{std::cos(turn), 0, 0} + up_ * std::sin(turn)};
    V normal;
    if (!lens_.meet(0, ray.origin, ray.direction, normal)) return;
    tally.entered += 1;
    const std::size_t count = lens_.surfaces.size();
    if (pass(ray) && ray.direction.z > 0) tally.image += ray.power();
    double weight = 1;
    if (!choose(ray, weight, only ? only->second : 0)) return;
    const std::size_t second = ray.surface;
    if (!ray.step(count)) return;
    pass(ray);
    if (!choose(ray, weight, only ? only->first : 0)) return;
    const std::size_t first = ray.surface;
    Branch reflected;
    for (int reflections = 2; ray.step(count);) {
      if (!split(lens_, ray, reflected)) return;
      if (random() * (ray.power() + reflected.power()) < reflected.power()) {
        ray = reflected;
        ++reflections;
      }
      ray.field = glm::normalize(ray.field);
      if (!ray.forward || ray.surface + 1 < count) continue;
      if (!(ray.direction.z > 0)) return;
      if (reflections > 2) return tally.higher.add(weight);
      tally.ghosts.add(weight);
      tally.pairs[{first, second}].add(weight);
      const V at = ray.origin + ray.direction * ((lens_.film_z - ray.origin.z) / ray.direction.z);
      const Vec2<double> q = film_.raster({at.x, at.y});
      if (!(q.x >= 0 && q.y >= 0 && q.x < bins && q.y < bins)) return;
      return tally.picture[static_cast<std::size_t>(q.y) * bins + static_cast<std::size_t>(q.x)].add(weight);
    }
  }

  PlainLens lens_;
  Film film_;
  V d_, up_;
  double low_ = 0, high_ = 0;
  std::mt19937_64 engine_{5};
  std::uniform_real_distribution<double> uniform_;
  std::vector<Branch> choices_;
};

struct Case {
  const char* lens;
  double degrees;
};

void compare(const Case& of, int rays) {
  SCOPED_TRACE(of.lens);
  const Lens lens = testing::data_lens(of.lens);
  const double angle = radians(of.degrees);
  const ScenePoint light{{0, -std::sin(angle), -std::cos(angle)}, true};
  const Film film{.width_mm = 43, .height_mm = 43, .columns = bins, .rows = bins};
  Tracer tracer(lens, angle, film);
  tracer.trace(rays);
  const Tally& t = tracer.tally;
  const double n = t.entered;
  // Few rays have the mean weight of all.
  const double weight = t.ghosts.value / t.ghosts.count;
  const auto noise = [&](const Sum& sum, double expected) {
    return std::sqrt(std::max(sum.squares / n, expected * weight) / n);
  };

  // The stated errors of pairs.
  const Ghosts ghosts = ghost_pairs(lens, light, {.tolerance = 0.01});
  EXPECT_NEAR(ghosts.entering_mm2, n / rays * tracer.area_mm2(), 4 * tracer.area_mm2() / std::sqrt(rays));
  auto missing = t.pairs;
  double energy = 0;
  for (const GhostPair& pair : ghosts.pairs) {
    energy += pair.energy;
    const Sum own = missing[{pair.first, pair.second}];
    missing.erase({pair.first, pair.second});
    if (pair.energy < 1e-6) continue;
    EXPECT_NEAR(own.value / n, pair.energy, 0.01 * pair.energy + 4 * noise(own, pair.energy))
        << pair.first << ", " << pair.second;
  }
  for (const auto& [pair, sum] : missing) EXPECT_LT(sum.value / n, 1e-6) << pair.first << ", " << pair.second;
  EXPECT_NEAR(t.ghosts.value / n, energy, 0.003 * energy + 4 * noise(t.ghosts, 0));

  // The picture: squares in which rays arrive, those with few rays together.
  std::vector<float> picture(bins * bins);
  add_ghosts(lens, light, film, std::array{Wavelength{}}, picture);
  const double scale = film.area_mm2() / (bins * bins) / ghosts.entering_mm2;
  double chi2 = 0, expected = 0, edges = 0;
  int squares = 0;
  Sum sum;
  for (int k = 0; k < bins * bins; ++k) {
    const auto at = [&](int square) { return scale * static_cast<double>(picture[static_cast<std::size_t>(square)]); };
    const double left = at(k % bins > 0 ? k - 1 : k), right = at(k % bins + 1 < bins ? k + 1 : k);
    const double above = at(k >= bins ? k - bins : k), below = at(k < bins * (bins - 1) ? k + bins : k);
    // Tolerance of pictures: steps of 1 %, and edges within 0.1 pixels.
    expected += at(k), edges += 0.05 * (std::abs(right - left) + std::abs(below - above));
    const Sum& own = t.picture[static_cast<std::size_t>(k)];
    sum.value += own.value, sum.squares += own.squares, sum.count += own.count;
    if (sum.count < 40) continue;
    const double off = sum.value / n - expected;
    chi2 += off * off / (sum.squares / (n * n) + std::pow(0.01 * expected + edges, 2));
    ++squares;
    expected = edges = 0, sum = {};
  }
  EXPECT_GT(squares, 50);
  EXPECT_LT(chi2 / squares, 1 + 4 * std::sqrt(2.0 / squares));

  const GhostAudit audit = ghost_audit(lens, light, {.tolerance = 1}, 512);
  EXPECT_NEAR(audit.image, t.image / n, 0.05 * audit.image);
  // With light that is not followed.
  EXPECT_GT(audit.higher_order, t.higher.value / n - 4 * noise(t.higher, 0));
}

constexpr std::array cases{Case{"double_gauss_52mm_f1.8", 12}, Case{"fisheye_16mm_f2.8", 40},
                           Case{"compact_31mm_f2.1", 10}, Case{"anamorphic_60mm_2x", 4}};

TEST(BruteForce, RandomReflectionsEqualGhosts) {
  for (const Case& of : {cases[0], cases[1], cases[2]}) compare(of, 1'000'000);
}

// Light enters along an arc, and in a disc inside of a ring.
TEST(BruteForce, PairsOfArcsAndRingsAreComplete) {
  for (const auto& [name, degrees, first, second] :
       {std::tuple{"modern_50mm_f1.0", 11.65, 3U, 9U}, {"fisheye_10mm_f4", 0.0, 1U, 3U}}) {
    const Lens lens = testing::data_lens(name);
    const double angle = radians(degrees);
    Tracer tracer(lens, angle, {.width_mm = 43, .height_mm = 43, .columns = bins, .rows = bins});
    tracer.only = {first, second};
    tracer.trace(400'000);
    const Sum& sum = tracer.tally.ghosts;
    const double expected = sum.value / tracer.tally.entered, noise = std::sqrt(sum.squares) / tracer.tally.entered;
    const ScenePoint light{{0, -std::sin(angle), -std::cos(angle)}, true};
    const Ghosts ghosts = ghost_pairs(lens, light, {.only = {{first, second}}});
    EXPECT_LT(noise, 0.06 * expected);
    EXPECT_NEAR(ghosts.pairs.at(0).energy, expected, 0.05 * expected + 3 * noise) << name;
  }
}

TEST(BruteForce, ManyRandomReflectionsEqualGhosts) {
  for (const Case& of : cases) compare(of, 25'000'000);
}

}  // namespace brute_force_test
}  // namespace petzval
