// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "../data_lenses.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "program.hpp"

namespace {

class LensMetadata : public Programs {};

TEST_F(LensMetadata, WritesBothFilesOfTheFocusedLens) {
  const auto outcome = run("metadata", {lens("biogon_35mm_f2.8"), "--f-number", "4", "--focus", "2000", "--from",
                                        "film", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto sample = read_json(path("out/biogon_35mm_f2.8.opentrackio.json")).at("lens");
  EXPECT_NEAR(sample.at("focusDistance").get<double>(), 2, 1e-6);
  EXPECT_NEAR(sample.at("fStop").get<double>(), 4, 0.05);
  EXPECT_FALSE(sample.contains("tStop"));  // losses are not modelled
  const auto parts = petzval::read_exr_parts(path("out/biogon_35mm_f2.8.stmap.exr"));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].width, 1920);
  EXPECT_NEAR(parts[1].numbers.at("focus"), 2, 1e-6);
}

TEST_F(LensMetadata, StatesTStopsWithCoatings) {
  const auto outcome = run(
      "metadata", {lens("biogon_35mm_f2.8"), "--f-number", "4", "--coatings", "none", "--out", path("out"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  const auto sample = read_json(path("out/biogon_35mm_f2.8.opentrackio.json")).at("lens");
  EXPECT_NEAR(sample.at("tStop").get<double>(), json.at("t_stop").get<double>(), 1e-9);
  EXPECT_GT(json.at("t_stop").get<double>(), 1.05 * json.at("area_f_number").get<double>());
  const auto parts = petzval::read_exr_parts(path("out/biogon_35mm_f2.8.stmap.exr"));
  EXPECT_NEAR(parts[1].numbers.at("tStop"), json.at("t_stop").get<double>(), 1e-5);
}

// The number asked for, and one T-stop, in the report and in the files.
TEST_F(LensMetadata, HasTheFNumberAndTStopOfTheReport) {
  const std::string file = lens("planar_50mm_f1.4");
  for (const std::string number : {"1.4", "2"}) {
    const std::vector<std::string> state{file, "--f-number", number, "--coatings", "mgf2", "--json"};
    auto shot = state;
    shot.insert(shot.end(), {"--focus", "inf", "--out", path("out")});
    const auto report = nlohmann::json::parse(run("report", state).out);
    const auto metadata = nlohmann::json::parse(run("metadata", shot).out);
    const auto sample = read_json(path("out/planar_50mm_f1.4.opentrackio.json")).at("lens");
    EXPECT_NEAR(report.at("f_number").get<double>(), std::stod(number), 2e-3);
    EXPECT_NEAR(metadata.at("f_number").get<double>(), report.at("f_number").get<double>(), 1e-9);
    EXPECT_NEAR(sample.at("fStop").get<double>(), report.at("f_number").get<double>(), 1e-9);
    EXPECT_NEAR(metadata.at("t_stop").get<double>(), report.at("t_stop").get<double>(), 1e-9);
  }
}

// The files contain the distance from the film, as the formats require, for any origin of distances on the command
// line.
TEST_F(LensMetadata, ConvertsDistancesToTheFormat) {
  const petzval::Lens whole = petzval::testing::data_lens("biogon_35mm_f2.8");
  const double film_z = petzval::with_focus(whole, 2000).film_z();
  ASSERT_EQ(run("metadata", {lens("biogon_35mm_f2.8"), "--focus", "2000", "--out", path("out")}).status, 0);
  const auto sample = read_json(path("out/biogon_35mm_f2.8.opentrackio.json")).at("lens");
  EXPECT_NEAR(sample.at("focusDistance").get<double>(), 2 + film_z / 1000, 1e-6);
}

TEST_F(LensMetadata, HasSquarePixelsOnAnyFilm) {
  const auto outcome = run("metadata", {lens("biogon_35mm_f2.8"), "--film", "32x8", "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto camera = read_json(path("out/biogon_35mm_f2.8.opentrackio.json")).at("static").at("camera");
  EXPECT_EQ(camera.at("activeSensorResolution").at("width"), 1920);
  EXPECT_EQ(camera.at("activeSensorResolution").at("height"), 480);
}

}  // namespace
