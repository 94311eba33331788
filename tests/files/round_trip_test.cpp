// SPDX-License-Identifier: Apache-2.0
// Every lens of data/lenses goes into another program's format and comes back as the same lens.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "../data_lenses.hpp"
#include "../message.hpp"
#include "petzval/files/lens_file.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/media/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace {

using petzval::Lens;
using petzval::Prescription;
using petzval::WrittenLens;

const petzval::GlassCatalogue& glasses() {
  static const auto tables = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return tables;
}

/// Whole lenses, with the configurations of those that zoom.
std::vector<Prescription> lenses() {
  std::vector<Prescription> result;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const std::string id = p.id.substr(0, p.id.find(':'));
    if (result.empty() || result.back().id != id) result.push_back(petzval::testing::data_prescription(id));
  }
  return result;
}

Prescription read(const WrittenLens& written) {
  return petzval::parse_lens(written.text, "back", {.glasses = &glasses()});
}

/// The largest distance on the film between rays of both, over heights and fields.
double largest_difference(const Lens& a, const Lens& b, bool rims) {
  double worst = 0;
  const double size = a.surfaces()[0].semi_diameter;
  for (const double height : {0.0, 0.3, 0.6, -0.5}) {
    for (const double slope : {0.0, 0.05, -0.1}) {
      const double norm = std::hypot(1.0, slope);
      const petzval::Ray<double> ray{{0.1 * size, height * size - 20 * slope, -20}, {0, slope / norm, 1 / norm}};
      const auto from_a = petzval::trace(a, ray), from_b = petzval::trace(b, ray);
      if (rims) {
        EXPECT_EQ(from_a.transmitted(), from_b.transmitted()) << a.name() << ' ' << height << ' ' << slope;
      }
      if (!from_a.transmitted() || !from_b.transmitted()) continue;
      const auto at_film = [](const Lens& lens, const auto& exit) {
        const double t = (lens.film_z() - exit.ray.origin.z) / exit.ray.direction.z;
        return petzval::Vec2<double>{exit.ray.origin.x + t * exit.ray.direction.x,
                                     exit.ray.origin.y + t * exit.ray.direction.y};
      };
      const auto in_a = at_film(a, from_a), in_b = at_film(b, from_b);
      worst = std::max(worst, std::hypot(in_a.x - in_b.x, in_a.y - in_b.y));
    }
  }
  return worst;
}

/// Writes and reads each lens; how many the format takes.
int compare(const std::function<WrittenLens(const Prescription&)>& write, double tolerance, bool colours) {
  int compared = 0;
  for (const Prescription& p : lenses()) {
    std::optional<WrittenLens> written;
    const std::string refusal = petzval::testing::message([&] { written = write(p); });
    if (!written) {
      EXPECT_NE(refusal.find("wanted"), std::string::npos) << refusal;
      continue;
    }
    const Prescription back = read(*written);
    EXPECT_EQ(back.surfaces.size() >= p.surfaces.size(), true);
    const std::size_t positions = std::max<std::size_t>(p.configurations.size(), 1);
    if (colours) {
      EXPECT_EQ(std::max<std::size_t>(back.configurations.size(), 1), positions) << p.id;
    }
    const bool rims =
        std::ranges::find(written->losses, "configurations", &petzval::ImportWarning::command) == written->losses.end();
    for (std::size_t c = 0; c < (colours ? positions : 1); ++c) {
      const double size = std::abs(petzval::first_order(compile(p, {.configuration = c})).effective_focal_length);
      const double scale = std::isfinite(size) ? size : 100;
      EXPECT_LT(largest_difference(compile(p, {.configuration = c}), compile(back, {.configuration = c}), rims),
                tolerance * scale)
          << p.id << ' ' << c;
    }
    if (colours) {
      for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
        EXPECT_NEAR(back.surfaces[i].medium.nd, p.surfaces[i].medium.nd, 1e-12) << p.id << ' ' << i;
        if (p.surfaces[i].medium.vd && back.surfaces[i].medium.vd) {
          EXPECT_NEAR(*back.surfaces[i].medium.vd, *p.surfaces[i].medium.vd, 0.6) << p.id << ' ' << i;
        }
      }
    }
    ++compared;
  }
  return compared;
}

TEST(RoundTrip, ZemaxKeepsTheRaysOfEveryLens) {
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_zemax(p, &glasses()); }, 1e-9, true), 68);
}

TEST(RoundTrip, CodevKeepsTheRaysOfEveryLensItCanSay) {
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_codev(p, &glasses()); }, 1e-9, true), 66);
}

TEST(RoundTrip, TablesKeepTheRaysOfEveryLensOfSpheres) {
  // Planes of glass become spheres of 1e6 mm.
  EXPECT_GE(compare([](const Prescription& p) { return petzval::format_table(p); }, 3e-5, false), 40);
}

TEST(RoundTrip, ZemaxTakesWhatItWroteAsItIs) {
  for (const Prescription& p : lenses()) {
    std::optional<WrittenLens> written;
    petzval::testing::message([&] { written = petzval::format_zemax(p, &glasses()); });
    if (!written) continue;
    const Prescription back = read(*written);
    EXPECT_EQ(petzval::format_zemax(back, &glasses()).text.size(),
              petzval::format_zemax(read(petzval::format_zemax(back, &glasses())), &glasses()).text.size())
        << p.id;
  }
}

TEST(RoundTrip, WhatIsLostIsSaid) {
  const auto lost = [](const WrittenLens& written, std::string_view what) {
    return std::ranges::find(written.losses, what, &petzval::ImportWarning::command) != written.losses.end();
  };
  const auto glass = petzval::testing::data_prescription("double_gauss_100mm_f1.35");
  EXPECT_TRUE(lost(petzval::format_table(glass), "vd"));
  const auto zoom = petzval::testing::data_prescription("zoom_57-143mm_f2.8");
  EXPECT_TRUE(lost(petzval::format_table(zoom), "configurations"));
  EXPECT_TRUE(lost(petzval::format_table(petzval::testing::data_prescription("achromat_100mm")), "stop"));
}

}  // namespace
