// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"
#include "relay_zmx.hpp"

namespace {

class SpotDiagram : public Programs {
 protected:
  nlohmann::json rows(const std::string& id, std::vector<std::string> more) const {
    std::vector<std::string> arguments{lens(id), "--out", path("spots")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("spots", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines(outcome.out),
              (std::vector<std::string>{path("spots/" + id + "_spots.svg"), path("spots/" + id + "_spots.csv"),
                                        path("spots/" + id + "_spots.json")}));
    return read_json(path("spots/" + id + "_spots.json"));
  }
};

TEST_F(SpotDiagram, NumbersEqualTheHits) {
  const auto json = rows("cooke_triplet_50mm_f5", {"--fields", "0,14", "--wavelengths", "486.1,587.6,656.3"});
  ASSERT_EQ(json.size(), 6u);
  std::map<std::string, std::vector<std::array<double, 2>>> spots;
  const auto csv = lines(read(path("spots/cooke_triplet_50mm_f5_spots.csv")));
  ASSERT_EQ(csv.at(0), "field_deg,wavelength_nm,x_mm,y_mm");
  for (std::size_t i = 1; i < csv.size(); ++i) {
    const auto comma = csv[i].find(',', csv[i].find(',') + 1);
    const auto next = csv[i].find(',', comma + 1);
    spots[csv[i].substr(0, comma)].push_back({std::stod(csv[i].substr(comma + 1)), std::stod(csv[i].substr(next + 1))});
  }
  ASSERT_EQ(spots.size(), 6u);
  for (const auto& row : json) {
    const auto key = petzval::testing::digits(row["field_deg"]) + ',' + petzval::testing::digits(row["wavelength_nm"]);
    const auto& hits = spots.at(key);
    ASSERT_EQ(hits.size(), row["rays_transmitted"].get<std::size_t>()) << key;
    double cx = 0, cy = 0, squares = 0, largest = 0;
    for (const auto& [x, y] : hits)
      cx += x / static_cast<double>(hits.size()), cy += y / static_cast<double>(hits.size());
    for (const auto& [x, y] : hits) {
      const double r2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
      squares += r2 / static_cast<double>(hits.size());
      largest = std::max(largest, r2);
    }
    EXPECT_NEAR(row["rms_radius_mm"].get<double>(), std::sqrt(squares), 1e-12) << key;
    EXPECT_NEAR(row["max_radius_mm"].get<double>(), std::sqrt(largest), 1e-12) << key;
    EXPECT_EQ(row["reference"], "centroid");
    EXPECT_EQ(row["dispersion"], "catalogue");
    const double tangent = std::tan(petzval::radians(row["field_deg"].get<double>()));
    EXPECT_NEAR(row["chief_ray_height_mm"].get<double>(), -50.02 * tangent, 0.2) << key;
  }
  EXPECT_TRUE(read(path("spots/cooke_triplet_50mm_f5_spots.svg")).starts_with("<"));
}

TEST_F(SpotDiagram, FocusesTheFilmAtTheDLine) {
  const petzval::Lens triplet = petzval::testing::data_lens("cooke_triplet_50mm_f5");
  const auto film_z = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--fields", "0", "--wavelengths", "500, d", "--rays", "64"});
    return rows("cooke_triplet_50mm_f5", more)[0]["film_z_mm"].get<double>();
  };
  const double sharpest = petzval::solve_focus(triplet, HUGE_VAL).film_z;
  EXPECT_NEAR(film_z({}), sharpest, 1e-9);
  EXPECT_NEAR(film_z({"--defocus", "-0.25"}), sharpest - 0.25, 1e-9);
  EXPECT_NEAR(film_z({"--criterion", "paraxial"}), petzval::first_order(triplet).rear_focal_z, 1e-12);
  EXPECT_NEAR(film_z({"--at", "1000", "--criterion", "paraxial"}), petzval::paraxial_image_z(triplet, -1000), 1e-12);
  const petzval::FocusOptions from_film{.origin = petzval::DistanceOrigin::film};
  EXPECT_NEAR(film_z({"--at", "1000", "--from", "film"}), petzval::solve_focus(triplet, 1000, from_film).film_z, 1e-9);
  EXPECT_EQ(film_z({"--film-position", "file"}), triplet.film_z());
  EXPECT_EQ(film_z({"--film-position", "file", "--at", "1000"}), triplet.film_z());
  const petzval::Lens stopped = petzval::with_f_number(triplet, 11);
  EXPECT_NEAR(film_z({"--f-number", "11"}), petzval::solve_focus(stopped, HUGE_VAL).film_z, 1e-9);
}

// Without flags, a lens of another program uses the wavelengths, fields and object distance of its file.
TEST_F(SpotDiagram, UsesTheConditionsOfTheFile) {
  write("relay.zmx", examples_testing::relay_zmx(R"(VERS 140124 258 36214 0 0
MODE SEQ
NAME Relay
UNIT MM X W X CM MR CPMM
ENPD 10.0
FTYP 1 0 3 2 0 0 0
YFLN 0.0 6.0 -10.0
)"));
  const auto outcome = run("spots", {path("relay.zmx"), "--out", path("spots"), "--film-position", "file"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = read_json(path("spots/relay_spots.json"));
  ASSERT_EQ(json.size(), 6u);
  EXPECT_EQ(json[0]["wavelength_nm"], 550);
  EXPECT_EQ(json[1]["wavelength_nm"], 450);
  EXPECT_EQ(json[1]["wavelength_weight"], 0.25);
  EXPECT_EQ(json[0]["subject_distance_mm"], 200);
  EXPECT_EQ(json[0]["film_z_mm"], 68);
  // Object heights, seen from the entrance pupil, which is the front of this lens.
  const double heights[] = {0, 6, 10};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::tan(petzval::radians(json[2 * i]["field_deg"].get<double>())) * 200, heights[i], 1e-3);
  }
  EXPECT_NE(read(path("spots/relay_spots.svg")).find("subject at z = -200 mm"), std::string::npos);
}

// A field lens with the film on its last vertex, and an eyepiece with the film in front of the last vertex.
TEST_F(SpotDiagram, ReadsFilmsOnAndBeforeTheLastVertex) {
  for (const std::string gap : {"0", "-12"}) {
    write("field.json",
          R"({"format": "petzval-lens 1", "name": "field lens", "source": {"design": "test", "numbers": "test"},
      "focal_length_mm": null, "f_number": null, "half_field_deg": 3, "surfaces": [
      {"radius": 50, "thickness": 5, "nd": 1.5168, "vd": 64.2, "semi_diameter": 10, "stop": true},
      {"radius": -50, "thickness": 60, "semi_diameter": 10},
      {"radius": 30, "thickness": 2, "nd": 1.5168, "vd": 64.2, "semi_diameter": 10},
      {"radius": 0, "thickness": )" +
              gap + R"(, "semi_diameter": 10}]})");
    const auto outcome = run("spots", {path("field.json"), "--out", path("spots"), "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json[0]["film"], "file");
    EXPECT_GT(json[0]["rays_transmitted"].get<int>(), 0);
    EXPECT_EQ(json[0]["relative_illumination"].is_null(), gap == "0");
    EXPECT_EQ(run("report", {path("field.json"), "--out", path("report")}).status, 0);
  }
}

}  // namespace
