// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>

#include "core/text.hpp"
#include "petzval/core/units.hpp"
#include "petzval/files/lens_file.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "program.hpp"

namespace {

class SpotDiagram : public Programs {
 protected:
  nlohmann::json rows(const std::string& id, std::vector<std::string> more) const {
    std::vector<std::string> arguments{lens(id), "--out", path("spots")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("spot_diagram", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines(outcome.out),
              (std::vector<std::string>{path("spots/" + id + "_spots.svg"), path("spots/" + id + "_spots.csv"),
                                        path("spots/" + id + "_spots.json")}));
    return read_json(path("spots/" + id + "_spots.json"));
  }
};

TEST_F(SpotDiagram, ItsNumbersAreThoseOfItsHits) {
  const auto json = rows("cooke_triplet_50mm_f5", {"--field-deg", "0,14", "--wavelengths-nm", "486.1,587.6,656.3"});
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
    const auto key = petzval::to_text(row["field_deg"]) + ',' + petzval::to_text(row["wavelength_nm"]);
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

TEST_F(SpotDiagram, PutsTheFilmAtTheParaxialImageOfTheDLine) {
  const petzval::Lens triplet = petzval::compile(petzval::read_prescription(lens("cooke_triplet_50mm_f5")));
  const auto film_z = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--field-deg", "0", "--wavelengths-nm", "500,587.5618", "--samples", "64"});
    return rows("cooke_triplet_50mm_f5", more)[0]["film_z_mm"].get<double>();
  };
  EXPECT_NEAR(film_z({}), petzval::first_order(triplet).rear_focal_z, 1e-12);
  EXPECT_NEAR(film_z({"--subject-distance-mm", "1000"}), petzval::paraxial_image_z(triplet, -1000), 1e-12);
  EXPECT_NEAR(film_z({"--defocus-mm", "-0.25"}), petzval::first_order(triplet).rear_focal_z - 0.25, 1e-12);
}

TEST_F(SpotDiagram, FocusesAnAnalyticLensToAPoint) {
  const auto json = rows("analytic_plano_hyperbolic_100mm",
                         {"--field-deg", "0", "--wavelengths-nm", "587.5618", "--samples", "1000"});
  EXPECT_LT(json[0]["max_radius_mm"].get<double>(), 1e-12);
  EXPECT_EQ(json[0]["rays_sent"], 1000);
}

TEST_F(SpotDiagram, TellsHowMuchLightReachesTheFilm) {
  const auto json = rows("fisheye_6.3mm_f2.8", {"--field-deg", "0,60,90,110", "--wavelengths-nm", "587.5618"});
  EXPECT_EQ(json[0]["relative_illumination"], 1.0);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_LT(json[i]["relative_illumination"].get<double>(), json[i - 1]["relative_illumination"].get<double>());
    EXPECT_LT(json[i]["chief_ray_height_mm"].get<double>(), json[i - 1]["chief_ray_height_mm"].get<double>() - 2);
    EXPECT_GT(json[i]["rays_transmitted"].get<double>(), 0.95 * json[i]["rays_sent"].get<double>());
  }
  EXPECT_GT(json[3]["relative_illumination"].get<double>(), 0.2);

  const auto beyond = rows("cooke_triplet_50mm_f5", {"--field-deg", "90", "--wavelengths-nm", "587.5618"})[0];
  for (const char* key : {"chief_ray_height_mm", "relative_illumination", "rms_radius_mm", "max_radius_mm"}) {
    EXPECT_TRUE(beyond[key].is_null()) << key;
  }
  EXPECT_EQ(beyond["rays_transmitted"], 0);
}

TEST_F(SpotDiagram, RefusesABadCommandLineInOneLine) {
  const auto refuse = [&](const std::string& id, std::vector<std::string> more, const std::string& reason) {
    std::vector<std::string> arguments{lens(id), "--out", path("spots")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_failure("spot_diagram", arguments, reason);
    EXPECT_FALSE(std::filesystem::exists(path("spots")));
  };
  const std::string triplet = "cooke_triplet_50mm_f5";
  refuse(triplet, {"--field-deg", "0"}, "--wavelengths-nm is required");
  refuse(triplet, {"--field-deg", "0,,10", "--wavelengths-nm", "500"}, "--field-deg: found \"\"");
  refuse(triplet, {"--field-deg", "0,10x", "--wavelengths-nm", "500"}, "--field-deg: found \"10x\"");
  refuse(triplet, {"--field-deg", "nan", "--wavelengths-nm", "500"}, "--field-deg: found \"nan\"");
  refuse(triplet, {"--field-deg", "190", "--wavelengths-nm", "500"}, "field is 190 degrees, wanted -180 to 180");
  refuse(triplet, {"--field-deg", "95", "--wavelengths-nm", "500", "--subject-distance-mm", "1000"}, "95 degrees");
  refuse(triplet, {"--field-deg", "0,10,-0", "--wavelengths-nm", "500"}, "twice, wanted every number once");
  refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "-500"}, "--wavelengths-nm: found \"-500\"");
  refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "5"}, "5 nm");
  refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "500", "--samples", "0"}, "--samples: found \"0\"");
  refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "500", "--samples", "1.5"}, "a whole number");
  refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "500", "--subject-distance-mm", "10"}, "cannot be focused");
  for (const std::string shift : {"1e160", "-1e160", "1000001", "inf"}) {
    refuse(triplet, {"--field-deg", "0", "--wavelengths-nm", "500", "--defocus-mm", shift},
           "--defocus-mm: found \"" + shift + "\", wanted a number from -1000000 to 1000000");
  }
  refuse("fisheye_10mm_f4", {"--field-deg", "0", "--wavelengths-nm", "500"}, "no V_d");
}

}  // namespace
