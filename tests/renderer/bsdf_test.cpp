// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include <glm/glm.hpp>

#include "renderer/random.hpp"

namespace renderer {
namespace {

struct Case {
  const char* name;
  Material material;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class Scattering : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    object_.material = GetParam().material;
    point_.object = &object_;
    for (int c = 0; c < 3; ++c) colours_.from_rgb[c][c] = colours_.to_rgb[c][c] = 1;
  }
  Bsdf from(const glm::vec3& wo) const { return {point_, wo, colours_}; }
  static glm::vec3 direction(float cosine, float turn) {
    const float sine = std::sqrt(1 - cosine * cosine);
    return {sine * std::cos(turn), sine * std::sin(turn), cosine};
  }

  Object object_;
  SurfacePoint point_;
  PathColours colours_;
};

TEST_P(Scattering, SamplesHaveTheStatedDensityAndMean) {
  for (const float cosine : {0.95f, 0.3f, -0.6f}) {
    const Bsdf bsdf = from(direction(cosine, 0.4f));
    Random random(1, 2, static_cast<std::uint64_t>(100 * (cosine + 1)));
    constexpr int count = 400'000;
    double kept = 0, density = 0, mean = 0, integral = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
      const float choice = random(), u = random(), v = random();
      if (const auto s = bsdf.sample(choice, u, v, Carries::radiance)) {
        kept += 1.0 / count;
        mean += static_cast<double>(s->weight.g) / count;
        EXPECT_NEAR(glm::length(s->wi), 1, 1e-5);
        EXPECT_NEAR(s->pdf, bsdf.pdf(s->wi), 1e-4 * s->pdf);
        EXPECT_NEAR(s->pdf_reverse, bsdf.pdf_reverse(s->wi), 1e-4 * s->pdf_reverse);
      }
      const glm::vec3 wi = on_sphere(random(), random());
      density += bsdf.pdf(wi) * 4 * std::numbers::pi / count;
      const double f = static_cast<double>(bsdf.times_cosine(wi, Carries::radiance).g) * 4 * std::numbers::pi;
      integral += f / count;
      squares += f * f / count;
    }
    const double error = std::sqrt(squares / count);
    EXPECT_NEAR(density, kept, 0.02) << cosine;
    EXPECT_NEAR(mean, integral, 5 * error + 1e-3) << cosine;
    // Radiance grows by the square of the index in glass, without a gain of power.
    const bool glass = std::holds_alternative<Glass>(GetParam().material);
    EXPECT_LT(mean, glass ? 2.26 : 1.001) << cosine;
  }
}

TEST_P(Scattering, IsReciprocalForPower) {
  Random random(3, 4, 5);
  int both = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 a = on_sphere(random(), random()), b = on_sphere(random(), random());
    const Lanes there = from(a).times_cosine(b, Carries::radiance), back = from(b).times_cosine(a, Carries::power);
    const auto there_f = static_cast<double>(there.g / std::abs(b.z)),
               back_f = static_cast<double>(back.g / std::abs(a.z));
    EXPECT_NEAR(there_f, back_f, 2e-3 * std::abs(there_f) + 1e-6) << i;
    EXPECT_NEAR(from(a).pdf_reverse(b), from(b).pdf(a), 1e-3 * from(b).pdf(a) + 1e-9);
    both += there_f > 0;
  }
  EXPECT_GT(both, 20);
}

INSTANTIATE_TEST_SUITE_P(Materials, Scattering,
                         testing::Values(Case{"diffuse", Diffuse{{.colour = {0.2f, 0.7f, 0.9f}}}},
                                         Case{"rough", Rough{{0.9f, 0.8f, 0.5f}, 0.3f}},
                                         Case{"very_rough", Rough{{1, 1, 1}, 1}},
                                         Case{"varnish", Varnish{{.colour = {0.1f, 0.6f, 0.2f}}, 0.25f}},
                                         Case{"white_varnish", Varnish{{.colour = {1, 1, 1}}, 0.5f}},
                                         Case{"rough_glass", Glass{1.5f, 0.35f}}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(SmoothGlass, SplitsLightByFresnel) {
  Object object;
  object.material = Glass{1.5f, 0};
  SurfacePoint point;
  point.object = &object;
  PathColours colours;
  const Bsdf head_on(point, {0, 0, 1}, colours), inside(point, glm::normalize(glm::vec3{0.9f, 0, -0.3f}), colours);
  EXPECT_TRUE(head_on.specular());
  Random random(1, 1, 1);
  int reflected = 0;
  constexpr int count = 20'000;
  for (int i = 0; i < count; ++i) {
    const auto s = head_on.sample(random(), 0, 0, Carries::power);
    ASSERT_TRUE(s);
    reflected += s->wi.z > 0;
    EXPECT_FLOAT_EQ(s->weight.x, 1);
  }
  EXPECT_NEAR(reflected / static_cast<double>(count), 0.04, 0.005);
  const auto total = inside.sample(0.99f, 0, 0, Carries::power);  // beyond the critical angle
  ASSERT_TRUE(total);
  EXPECT_LT(total->wi.z, 0);
  EXPECT_NEAR(total->wi.x, -inside.sample(0, 0, 0, Carries::power)->wi.x * -1, 1e-6);
}

TEST(InterpolatedNormals, ConserveThePowerOfLightPaths) {
  // Scattered power equals the power scattered in the reverse direction, weighted by both normals (Veach 1997, section
  // 5.3).
  Object object;
  object.material = Diffuse{{.colour = {0.5f, 0.5f, 0.5f}}};
  SurfacePoint point;
  point.object = &object;
  point.shading = glm::normalize(glm::vec3{0.3f, 0.1f, 1});
  PathColours colours;
  for (int c = 0; c < 3; ++c) colours.from_rgb[c][c] = 1;
  Random random(9, 9, 9);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 a = by_cosine(random(), random()), b = by_cosine(random(), random());
    const float there = Bsdf(point, a, colours).times_cosine(b, Carries::radiance).x * a.z;
    const float back = Bsdf(point, b, colours).times_cosine(a, Carries::power).x * b.z;
    EXPECT_NEAR(there, back, 1e-4f * there + 1e-7f);
  }
}

}  // namespace
}  // namespace renderer
