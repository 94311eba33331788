// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include "../data_lenses.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"

namespace {

class CameraRays : public Programs {
 protected:
  static constexpr const char* header = "film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm\n";

  std::vector<std::string> arguments(const std::string& lens_id, const std::string& model,
                                     const std::vector<std::string>& more) const {
    std::vector<std::string> result{lens(lens_id), "--table", path("samples.csv"), "--out", path("rays.csv"),
                                    "--focus",     "3000",    "--model",           model};
    result.insert(result.end(), more.begin(), more.end());
    return result;
  }

  /// Rows of the result without the header, split at commas.
  std::vector<std::vector<std::string>> rays(const std::string& lens_id, const std::string& csv,
                                             const std::string& model = "exact_double",
                                             const std::vector<std::string>& more = {}) const {
    write("samples.csv", csv);
    const auto outcome = run("camera-rays", arguments(lens_id, model, more));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    auto rows = lines(read(path("rays.csv")));
    EXPECT_EQ(rows.at(0), "x_mm,y_mm,z_mm,dx,dy,dz,weight,pdf_pupil_per_mm2,pdf_direction_per_sr,fate");
    std::vector<std::vector<std::string>> result;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      std::istringstream row(rows[i]);
      result.emplace_back();
      for (std::string cell; std::getline(row, cell, ',');) result.back().push_back(cell);
      EXPECT_EQ(result.back().size(), 10u) << rows[i];
    }
    return result;
  }

  void expect_refusal(const std::string& csv, const std::vector<petzval::testing::Token>& tokens,
                      const std::string& lens_id = "double_gauss_100mm_f2.0") const {
    SCOPED_TRACE(csv);
    write("samples.csv", csv);
    expect_failure("camera-rays", arguments(lens_id, "exact_double", {}), tokens);
    EXPECT_FALSE(std::filesystem::exists(path("rays.csv")));
  }
};

TEST_F(CameraRays, NumbersEqualTheLibrary) {
  using petzval::ModelKind;
  const petzval::Lens open = petzval::testing::data_lens("double_gauss_100mm_f2.0"),
                      at_3m = petzval::with_focus(open, 3000);
  const petzval::Film tilted{.tilt_rad = petzval::radians(8.0), .swing_rad = petzval::radians(-3.0)};
  const petzval::BokehControls weights{.lens_ratio = 1.2, .rate_of_change = 0.5, .weight_distribution = -4};
  struct Case {
    Arguments flags;
    petzval::Camera camera;
  };
  std::string csv = header;
  for (int i = 0; i < 64; ++i) csv += "7.5,-10.25," + std::to_string(i / 64.) + ",0.9,587.5618\n";
  std::set<std::string> directions;
  const std::vector<Case> cases{
      {{}, {at_3m, {}, {.model = ModelKind::exact_double}}},
      {{}, {at_3m, {}, {.model = ModelKind::thick}}},
      {{"--f-number", "4"},
       {petzval::with_focus(petzval::with_f_number(open, 4), 3000), {}, {.model = ModelKind::exact_double}}},
      {{"--criterion", "paraxial"},
       {petzval::with_focus(open, 3000, {petzval::FocusCriterion::paraxial}), {}, {.model = ModelKind::exact_double}}},
      {{"--tilt", "8", "--swing", "-3"}, {at_3m, tilted, {.model = ModelKind::thick}}},
      {{"--tilt", "8", "--swing", "-3"}, {at_3m, tilted, {.model = ModelKind::exact_double}}},
      {{"--blades", "6", "--lens-ratio", "1.2", "--rate-of-change", "0.5", "--weight-distribution", "-4"},
       {petzval::with_focus(petzval::with_iris(open, {.blades = 6}), 3000),
        {},
        {.model = ModelKind::thin, .bokeh = weights}}}};
  for (const auto& [flags, camera] : cases) {
    SCOPED_TRACE(testing::PrintToString(flags) + std::string(petzval::name(camera.model())));
    const auto rows = rays("double_gauss_100mm_f2.0", csv, std::string(petzval::name(camera.model())), flags);
    for (std::size_t k = 0; k < 64; ++k) {
      const auto r = camera.sample({{7.5, -10.25}, static_cast<double>(k) / 64, 0.9});
      const double expected[] = {r.ray.origin.x,    r.ray.origin.y,    r.ray.origin.z,
                                 r.ray.direction.x, r.ray.direction.y, r.ray.direction.z,
                                 r.weight,          r.pdf_pupil,       r.pdf_direction};
      for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_NEAR(std::stod(rows.at(k)[i]), expected[i], 1e-12 * std::max(1.0, std::abs(expected[i]))) << i;
      }
      EXPECT_EQ(rows[k][9], petzval::name(r.fate));
    }
    directions.insert(rows[0][4]);
  }
  EXPECT_EQ(directions.size(), cases.size());  // each flag changes the rays
}

TEST_F(CameraRays, PointsOutsideTheFilmHaveAFate) {
  const std::string csv = std::string(header) + "0,0,0.5,0.5,587.5618\n0,12.5,0.5,0.5,587.5618\n";
  auto rows = rays("double_gauss_100mm_f2.0", csv);
  EXPECT_EQ(rows[0][9], "transmitted");
  EXPECT_EQ(rows[1][9], "outside_film");
  EXPECT_EQ(std::stod(rows[1][6]), 0);
  rows = rays("double_gauss_100mm_f2.0", csv, "exact_double", {"--film", "24x36"});
  EXPECT_EQ(rows[1][9], "transmitted");
}

TEST_F(CameraRays, InvalidValuesAreNamedWithLineAndColumn) {
  const std::string good = std::string(header) + "0,0,0.5,0.5,587.5618\n";
  expect_refusal("x,y\n", {"samples.csv", "line 1", "\"x,y\""});
  expect_refusal(good + "0,0,0.5,0.5\n", {"samples.csv", "line 3", 4, 5});
  expect_refusal(good + "0,nan,0.5,0.5,587.5618\n", {"line 3", "film_y_mm", "\"nan\""});
  expect_refusal(good + "0,0,1.5,0.5,587.5618\n", {"line 3", "pupil_u", "\"1.5\""});
  expect_refusal(good + "0,0,0.5,-0.1,587.5618\n", {"line 3", "pupil_v", "\"-0.1\""});
  expect_refusal(good + "0,0,0.5,0.5,0\n", {"line 3", "wavelength_nm", "\"0\""});
  expect_refusal(good + "0,0,0.5,0.5,20\n", {"line 3", "wavelength_nm"}, "achromat_100mm");
}

TEST_F(CameraRays, TableOrPovrayIsRequired) {
  const std::vector<std::string> base{
      lens("double_gauss_100mm_f2.0"), "--focus", "3000", "--model", "thin", "--out", path("out")};
  expect_failure("camera-rays", base, {"--table", "--povray"});
  std::vector<std::string> large = base;
  large.insert(large.end(), {"--povray", "--size", "4000x3000"});
  expect_failure("camera-rays", large, {"--size", "--spp", 3.84e8, "10000000"});
}

}  // namespace
