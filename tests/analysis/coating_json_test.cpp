// SPDX-License-Identifier: Apache-2.0
// Light that lenses pass whose coatings stand in a JSON file.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/io/json.hpp"

namespace petzval {
namespace coating_json_test {

TEST(CoatingJson, PassesTheLightOfTheSameCoatingSetByCode) {
  const Coating table{.table = {{380, 0.02}, {780, 0.01}}};
  for (const Coating& coating : {Coating{}, Coating::quarter_wave(), table}) {
    Prescription p = testing::data_prescription("achromat_100mm");
    const Lens bare = compile(p);
    for (SurfaceRow& row : p.surfaces) row.coating = coating;
    const Lens by_code = compile(p);
    const Lens from_file = compile(parse_prescription(format_prescription(p), "x.json"));
    for (const double y : {0.0, 3.0, 8.0}) {
      const Ray<double> ray{{0.5, y, -20}, {0, 0.02, std::sqrt(1 - 0.0004)}};
      const auto light = transmittance(by_code, ray);
      ASSERT_TRUE(light);
      EXPECT_EQ(light == transmittance(bare, ray), coating == Coating{});
      EXPECT_EQ(transmittance(from_file, ray), light);
    }
  }
}

TEST(CoatingJson, WordsPassTheLightOfTheirCoatings) {
  const auto window = [](const std::string& coating) {
    return compile(parse_prescription(
        R"({"format": "petzval-lens 1", "surfaces": [)"
        R"({"radius": 0, "thickness": 5, "nd": 1.9044, "vd": 0, "semi_diameter": 10, "coating": )" +
            coating + R"(}, {"radius": 0, "thickness": 50, "semi_diameter": 10, "coating": "none"}]})",
        "x.json"));
  };
  const Ray<double> axis{{0, 0, -2}, {0, 0, 1}};
  const double bare = 1 - std::pow(0.9044 / 2.9044, 2);
  EXPECT_NEAR(transmittance(window("\"none\""), axis).value(), bare * bare, 1e-12);
  // A layer of the index 1.38 is perfect at its wavelength on glass of the index 1.38^2 = 1.9044.
  EXPECT_NEAR(
      transmittance(window(R"({"layers": [{"index": 1.38, "thickness_nm": 106.44235507246377}]})"), axis).value(), bare,
      1e-9);
  EXPECT_NEAR(transmittance(window("\"mgf2\""), axis).value(),
              bare * surface_light(Coating::quarter_wave(), 1, 1.9044, 1, d_line_nm).transmittance(), 1e-12);
}

}  // namespace coating_json_test
}  // namespace petzval
