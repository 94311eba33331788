// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <set>

#include "../data_lenses.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "program.hpp"

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class FocusReport : public Programs {
 protected:
  nlohmann::json rows(const std::string& id, const Arguments& more = {}) const {
    Arguments arguments{lens(id), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("focus", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
};

double or_infinity(const nlohmann::json& value) { return value.is_null() ? infinity : value.get<double>(); }

TEST_F(FocusReport, NumbersEqualTheLibrary) {
  const std::string id = "double_gauss_100mm_f2.0";
  const petzval::Lens lens = petzval::testing::data_lens(id);
  const auto json = rows(
      id, {"--at", "700,3000,inf", "--criterion", "thin,paraxial,min_rms,min_max", "--blur", "0.2", "--from", "film"});
  ASSERT_EQ(json.size(), 12u);
  std::size_t i = 0;
  for (const auto criterion : {petzval::FocusCriterion::thin, petzval::FocusCriterion::paraxial,
                               petzval::FocusCriterion::min_rms, petzval::FocusCriterion::min_max}) {
    const petzval::FocusOptions options{criterion, petzval::DistanceOrigin::film};
    for (const double distance : {700.0, 3000.0, infinity}) {
      const auto& row = json[i++];
      SCOPED_TRACE(row.dump());
      EXPECT_EQ(row["criterion"], petzval::name(criterion));
      EXPECT_EQ(row["distance_from"], "film");
      EXPECT_EQ(or_infinity(row["distance_mm"]), distance);
      EXPECT_EQ(row["status"], "solved");
      EXPECT_EQ(row["blur_mm"], 0.2);

      const petzval::Lens set = petzval::with_focus(lens, distance, options);
      EXPECT_EQ(row["film_z_mm"], set.film_z());
      EXPECT_EQ(row["focus_blur_mm"], petzval::blur_diameter(set, distance, options).value());
      EXPECT_EQ(row["breathing"], petzval::breathing(lens, set.film_z(), options).value());
      const auto depth = petzval::depth_of_field(set, 0.2, options);
      EXPECT_EQ(row["depth_status"], "solved");
      EXPECT_EQ(row["near_limit_mm"], depth.near_distance);
      EXPECT_EQ(or_infinity(row["far_limit_mm"]), depth.far_distance);
      EXPECT_EQ(row["hyperfocal_mm"], petzval::hyperfocal(lens, 0.2, options).distance);
      EXPECT_EQ(row["nearest_distance_mm"], petzval::nearest_focus(lens, options).distance);
    }
  }
}

TEST_F(FocusReport, HasRowsForUsualDistancesByDefault) {
  const auto json = rows("double_gauss_100mm_f2.0");
  ASSERT_EQ(json.size(), 15u);
  std::set<std::string> criteria;
  for (const auto& row : json) criteria.insert(row["criterion"].get<std::string>());
  EXPECT_EQ(criteria, (std::set<std::string>{"paraxial", "min_rms", "min_max"}));
  // Spherical aberration at f/2 gives a blur of 0.07 mm, more than the 0.03 mm allowed.
  EXPECT_EQ(json[0]["criterion"], "min_rms");
  EXPECT_EQ(json[0]["distance_mm"], 1000);
  EXPECT_EQ(json[0]["status"], "solved");
  EXPECT_EQ(json[0]["depth_status"], "too_blurred");
  EXPECT_TRUE(json[0]["near_limit_mm"].is_null());
  EXPECT_TRUE(json[0]["hyperfocal_mm"].is_null());
  EXPECT_EQ(json[5]["criterion"], "paraxial");
  EXPECT_TRUE(json[9]["distance_mm"].is_null());
  EXPECT_EQ(json[9]["breathing"], 0);
  EXPECT_TRUE(json[9]["far_limit_mm"].is_null());
}

TEST_F(FocusReport, FieldsAndWavelengthsChangeTheFocus) {
  const auto film = [&](const Arguments& more) {
    Arguments arguments{"--at", "2000", "--criterion", "min_rms"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rows("cooke_triplet_50mm_f5", arguments)[0]["film_z_mm"].get<double>();
  };
  EXPECT_NE(film({}), film({"--fields", "0,14"}));
  EXPECT_NE(film({}), film({"--wavelengths", "486.1327,587.5618,656.2725"}));
}

TEST_F(FocusReport, ReportsSubjectsOutOfReach) {
  const auto json = rows("double_gauss_100mm_f2.0", {"--at", "40,1000", "--criterion", "paraxial"});
  EXPECT_EQ(json[0]["status"], "unreachable");
  for (const char* key : {"film_z_mm", "focus_blur_mm", "near_limit_mm", "far_limit_mm", "breathing"}) {
    EXPECT_TRUE(json[0][key].is_null()) << key;
  }
  EXPECT_NEAR(json[0]["nearest_distance_mm"].get<double>(), 54.2448912, 1e-6);
  EXPECT_EQ(json[1]["status"], "solved");
}

TEST_F(FocusReport, RefusedSubjectCostsOneRow) {
  const auto json = rows("zoom_14-30mm_f4", {"--criterion", "paraxial,min_rms", "--at", "0.001,1000"});
  ASSERT_EQ(json.size(), 4u);
  EXPECT_EQ(json[0]["status"], "solved");
  EXPECT_TRUE(json[0]["message"].is_null());
  EXPECT_EQ(json[2]["status"], "refused");
  petzval::testing::expect_tokens(json[2]["message"].get<std::string>(), {-0.001});
  EXPECT_TRUE(json[2]["film_z_mm"].is_null());
  EXPECT_EQ(json[3]["status"], "solved");
}

}  // namespace
