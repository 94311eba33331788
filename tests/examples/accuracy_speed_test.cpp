// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "petzval/camera/ray_model.hpp"
#include "program.hpp"

namespace {

using Arguments = std::vector<std::string>;

class AccuracySpeed : public Programs {};

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

const std::set<std::string> row_keys{
    "model",          "rms_um",     "p99_um",   "max_um",  "rms_px", "max_px", "pupil_shape_error",
    "exposure_error", "ns_per_ray", "setup_ms", "on_front"};

TEST_F(AccuracySpeed, PrintsARowForEveryModel) {
  const auto outcome = run("accuracy_speed", {lens("double_gauss_52mm_f1.8"), "--json", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(rows.size(), petzval::models().size());
  std::map<std::string, nlohmann::json> by_model;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& row = rows[k];
    SCOPED_TRACE(row.dump());
    EXPECT_EQ(keys_of(row), row_keys);
    EXPECT_EQ(row["model"], petzval::name(petzval::models()[k]));
    by_model[row["model"]] = row;
    EXPECT_LE(row["rms_um"], row["max_um"]);
    EXPECT_LE(row["p99_um"], row["max_um"]);
    EXPECT_GT(row["ns_per_ray"], 0);
    EXPECT_GT(row["setup_ms"], 0);
    EXPECT_NEAR(row["max_px"].get<double>() * 9.375, row["max_um"].get<double>(), 1e-9 * row["max_um"].get<double>());
    // A row is on the front if no other row beats it.
    const bool beaten = std::ranges::any_of(rows, [&](const auto& other) {
      return other["ns_per_ray"] <= row["ns_per_ray"] && other["max_um"] <= row["max_um"] &&
             (other["ns_per_ray"] < row["ns_per_ray"] || other["max_um"] < row["max_um"]);
    });
    EXPECT_EQ(row["on_front"], !beaten);
  }
  EXPECT_EQ(by_model["exact_double"]["max_um"], 0);
  EXPECT_LT(by_model["exact_float"]["max_um"], 0.1);
  EXPECT_EQ(by_model["pinhole"]["pupil_shape_error"], 1);
  EXPECT_GT(by_model["thick"]["max_um"], 50);

  const auto csv = lines(read(path("out/double_gauss_52mm_f1.8_accuracy_speed.csv")));
  ASSERT_EQ(csv.size(), rows.size() + 1);
  EXPECT_EQ(csv[0],
            "model,rms_um,p99_um,max_um,rms_px,max_px,pupil_shape_error,exposure_error,ns_per_ray,setup_ms,on_front");
  EXPECT_TRUE(csv[1].starts_with("pinhole,")) << csv[1];
  const std::string svg = read(path("out/double_gauss_52mm_f1.8_accuracy_speed.svg"));
  for (const char* part : {"<svg", "Double Gauss", "polynomial_7", "ns per ray", "error on the film"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
}

TEST_F(AccuracySpeed, ChoosesForFourBudgets) {
  const auto outcome =
      run("accuracy_speed", {lens("cooke_triplet_50mm_f5"), "--film-mm", "24x16", "--resolution", "2400x1600"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("film 24 x 16 mm, 2400 x 1600 pixels of 10 um"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("errors from 1500 mm to infinity, and at the focus"), std::string::npos) << outcome.out;
  for (const char* budget : {"\n4 px: ", "\n1 px: ", "\n0.25 px: ", "\n0.05 px: "}) {
    EXPECT_NE(outcome.out.find(budget), std::string::npos) << budget;
  }
  EXPECT_EQ(outcome.out.find("nan"), std::string::npos);
}

TEST_F(AccuracySpeed, WritesAFileForEachPositionOfAZoom) {
  const auto outcome =
      run("accuracy_speed", {lens("zoom_70-210mm_f4"), "--configuration", "tele", "--json", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* ending : {".csv", ".svg"}) {
    EXPECT_TRUE(std::filesystem::exists(path(std::string("out/zoom_70-210mm_f4_tele_accuracy_speed") + ending)));
  }
}

TEST_F(AccuracySpeed, SkipsWhatCylindersDoNotHave) {
  const auto outcome = run("accuracy_speed", {lens("anamorphic_60mm_2x"), "--film-mm", "20x13", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(rows.size(), 9u);
  EXPECT_EQ(rows[1]["model"], "thick");
  EXPECT_EQ(rows[2]["model"], "polynomial_3");
  EXPECT_EQ(rows[7]["model"], "exact_float");
  EXPECT_NE(outcome.err.find("note: no thin_two_disc: "), std::string::npos) << outcome.err;
}

TEST_F(AccuracySpeed, ExplainsItselfAndRefusesABadCommandLine) {
  const auto help = run("accuracy_speed", {"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("Usage: accuracy_speed"), std::string::npos);
  const std::string file = lens("double_gauss_100mm_f2.0");
  expect_failure("accuracy_speed", {}, "LENS is required");
  expect_failure("accuracy_speed", {file, "--film-mm", "36"}, "--film-mm: found \"36\"");
  expect_failure("accuracy_speed", {file, "--resolution", "10.5x20"}, "--resolution: found \"10.5x20\"");
  expect_failure("accuracy_speed", {file, "--resolution", "0x20"}, "--resolution");
  expect_failure("accuracy_speed", {file, "--focus-mm", "-1"}, "--focus-mm");
  expect_failure("accuracy_speed", {file, "--f-number", "0.5"}, "fast");
  expect_failure("accuracy_speed", {file, "--out", ""}, "cannot be created as a folder");
}

}  // namespace
