// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <set>

#include "petzval/core/units.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/lens_json.hpp"
#include "program.hpp"

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Arguments = std::vector<std::string>;

class FocusReport : public Programs {
 protected:
  nlohmann::json rows(const std::string& id, const Arguments& more = {}) const {
    Arguments arguments{lens(id), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("focus_report", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }
};

double or_infinity(const nlohmann::json& value) { return value.is_null() ? infinity : value.get<double>(); }

TEST_F(FocusReport, SaysWhatTheLibraryFinds) {
  const std::string id = "double_gauss_100mm_f2.0";
  const petzval::Lens lens = petzval::compile(petzval::read_prescription(Programs::lens(id)));
  const auto json = rows(id, {"--distance-mm", "700,3000,inf", "--criterion", "thin,paraxial,min_rms,min_max",
                              "--blur-mm", "0.2", "--distance-from", "film"});
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

TEST_F(FocusReport, HasRowsForUsualDistancesUnasked) {
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

TEST_F(FocusReport, DeepensTheFieldAsTheLensIsStoppedDown) {
  const auto near = [&](const std::string& f_number) {
    return rows("double_gauss_100mm_f2.0",
                {"--distance-mm", "3000", "--criterion", "min_rms", "--f-number", f_number})[0]["near_limit_mm"]
        .get<double>();
  };
  EXPECT_GT(near("5.6"), near("8"));
  EXPECT_GT(near("8"), near("16"));
}

TEST_F(FocusReport, CountsFieldsAndWavelengths) {
  const auto film = [&](const Arguments& more) {
    Arguments arguments{"--distance-mm", "2000", "--criterion", "min_rms"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rows("cooke_triplet_50mm_f5", arguments)[0]["film_z_mm"].get<double>();
  };
  EXPECT_NE(film({}), film({"--field-deg", "0,14"}));
  EXPECT_NE(film({}), film({"--wavelengths-nm", "486.1327,587.5618,656.2725"}));
}

TEST_F(FocusReport, SaysWhatIsOutOfReach) {
  const auto json = rows("double_gauss_100mm_f2.0", {"--distance-mm", "40,1000", "--criterion", "paraxial"});
  EXPECT_EQ(json[0]["status"], "unreachable");
  for (const char* key : {"film_z_mm", "focus_blur_mm", "near_limit_mm", "far_limit_mm", "breathing"}) {
    EXPECT_TRUE(json[0][key].is_null()) << key;
  }
  EXPECT_NEAR(json[0]["nearest_distance_mm"].get<double>(), 54.2448912, 1e-6);
  EXPECT_EQ(json[1]["status"], "solved");
}

TEST_F(FocusReport, RefusesAFieldThatNoLightReaches) {
  expect_failure("focus_report", {lens("cooke_triplet_50mm_f5"), "--field-deg", "0,75"}, "--field-deg = 75");
}

// A report without any answer is an error, and a distance that looks like metres gets a hint.
TEST_F(FocusReport, TellsMetresFromMillimetres) {
  const std::string file = lens("double_gauss_100mm_f2.0");
  expect_failure("focus_report", {file, "--distance-mm", "2"}, "2000 mm");
  const auto both = run("focus_report", {file, "--distance-mm", "2,3000", "--criterion", "min_rms"});
  EXPECT_EQ(both.status, 0);
  EXPECT_NE(both.out.find("unreachable"), std::string::npos) << both.out;
  EXPECT_NE(both.err.find("2000 mm"), std::string::npos) << both.err;
}

TEST_F(FocusReport, LosesOneRowWhereTheLensRefusesASubject) {
  const auto json = rows("zoom_14-30mm_f4", {"--criterion", "paraxial,min_rms", "--distance-mm", "0.001,1000"});
  ASSERT_EQ(json.size(), 4u);
  EXPECT_EQ(json[0]["status"], "solved");
  EXPECT_TRUE(json[0]["message"].is_null());
  EXPECT_EQ(json[2]["status"], "refused");
  EXPECT_NE(json[2]["message"].get<std::string>().find("where the first surface begins"), std::string::npos);
  EXPECT_TRUE(json[2]["film_z_mm"].is_null());
  EXPECT_EQ(json[3]["status"], "solved");
  expect_failure("focus_report", {lens("zoom_14-30mm_f4"), "--criterion", "min_rms", "--distance-mm", "0.001"},
                 "where the first surface begins");
}

TEST_F(FocusReport, PrintsATable) {
  const auto outcome = run("focus_report", {lens("double_gauss_100mm_f2.0")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("paraxial: nearest 54.2, hyperfocal 16"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n      1000.0      147.0174     0.0000"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("too_blurred"), std::string::npos);
  EXPECT_EQ(outcome.out.find("nan"), std::string::npos);
}

TEST_F(FocusReport, ExplainsItselfAndRefusesABadCommandLine) {
  const auto help = run("focus_report", {"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("Usage: focus_report"), std::string::npos);
  const std::string file = lens("double_gauss_100mm_f2.0");
  expect_failure("focus_report", {}, "LENS is required");
  expect_failure("focus_report", {file, "--distance-mm", "0"}, "--distance-mm: found \"0\"");
  expect_failure("focus_report", {file, "--blur-mm", "-1"}, "--blur-mm: found \"-1\"");
  expect_failure("focus_report", {file, "--criterion", "sharp"}, "--criterion");
  expect_failure("focus_report", {file, "--criterion", "thin,thin"}, "--criterion: found thin twice");
  expect_failure("focus_report", {file, "--distance-from", "moon"}, "--distance-from");
  expect_failure("focus_report", {file, "--f-number", "0.5"}, "fast");
}

}  // namespace
