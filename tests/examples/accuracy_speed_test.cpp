// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <string>

#include "petzval/camera/camera.hpp"
#include "program.hpp"

namespace {

class AccuracySpeed : public Programs {};

TEST_F(AccuracySpeed, PrintsARowForEveryModel) {
  const auto outcome = run("models", {lens("double_gauss_52mm_f1.8"), "--json", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(rows.size(), petzval::models().size());
  std::map<std::string, nlohmann::json> by_model;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& row = rows[k];
    SCOPED_TRACE(row.dump());
    EXPECT_EQ(row["model"], petzval::name(petzval::models()[k]));
    by_model[row["model"]] = row;
    EXPECT_LE(row["rms_um"], row["max_um"]);
    EXPECT_LE(row["p99_um"], row["max_um"]);
    EXPECT_GT(row["ns_per_ray"], 0);
    EXPECT_GT(row["setup_ms"], 0);
    EXPECT_NEAR(row["max_px"].get<double>() * 9.375, row["max_um"].get<double>(), 1e-9 * row["max_um"].get<double>());
    // A row is on the Pareto front if no other row is both faster and more accurate.
    const bool beaten = std::ranges::any_of(rows, [&](const auto& other) {
      return other["cost"] <= row["cost"] && other["max_um"] <= row["max_um"] &&
             (other["cost"] < row["cost"] || other["max_um"] < row["max_um"]);
    });
    EXPECT_EQ(row["on_front"], !beaten);
  }
  EXPECT_EQ(by_model["exact_double"]["max_um"], 0);
  EXPECT_LT(by_model["exact_float"]["max_um"], 0.1);
  EXPECT_EQ(by_model["pinhole"]["pupil_shape_error"], 1);
  EXPECT_GT(by_model["thick"]["max_um"], 50);

  const auto csv = lines(read(path("out/double_gauss_52mm_f1.8_accuracy_speed.csv")));
  ASSERT_EQ(csv.size(), rows.size() + 1);
  EXPECT_EQ(
      csv[0],
      "model,rms_um,p99_um,max_um,rms_px,max_px,pupil_shape_error,exposure_error,ns_per_ray,setup_ms,cost,on_front");
  EXPECT_TRUE(csv[1].starts_with("pinhole,")) << csv[1];
  const std::string svg = read(path("out/double_gauss_52mm_f1.8_accuracy_speed.svg"));
  for (const char* part : {"<svg", "Double Gauss", "polynomial_7", "ns per ray", "error on the film"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
}

TEST_F(AccuracySpeed, WritesAFileForEachPositionOfAZoom) {
  const auto outcome =
      run("models", {lens("zoom_70-210mm_f4"), "--configuration", "tele", "--json", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* ending : {".csv", ".svg"}) {
    EXPECT_TRUE(std::filesystem::exists(path(std::string("out/zoom_70-210mm_f4_tele_accuracy_speed") + ending)));
  }
}

}  // namespace
