// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/choose_model.hpp"
#include "petzval/analysis/transmittance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "analysis/model_errors.hpp"
#include "camera/make_model.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace choose_model_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_tokens;
constexpr double infinity = std::numeric_limits<double>::infinity();

Lens focused(const std::string& id, double distance) {
  return with_focus(data_lens(id), distance, {.origin = DistanceOrigin::film});
}

const ModelCandidate& candidate_of(const ModelChoice& choice, ModelKind model) {
  return *std::ranges::find(choice.table, model, &ModelCandidate::model);
}

/// Budgets hold for samples that the choice did not use, and no faster model meets the budgets.
struct Scene {
  const char* id;
  double width, focus, near, far;
  double f_number = 0;
};
void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.id; }

class Promise : public ::testing::TestWithParam<Scene> {};

TEST_P(Promise, HoldsForOtherSamples) {
  const Scene& scene = GetParam();
  const Lens lens = focused(scene.id, scene.focus);
  const Film film{.width_mm = scene.width, .height_mm = scene.width / 1.5};
  SceneRequirements wanted{.near_mm = scene.near, .far_mm = scene.far, .film = film, .origin = DistanceOrigin::film};
  if (scene.f_number > 0) wanted.f_number = scene.f_number;
  const std::array<ErrorBudget, 6> budgets{{{.max_px = 4},
                                            {.max_px = 1},
                                            {.max_px = 0.25},
                                            {.max_px = 0.05},
                                            {.max_px = 2, .exposure = 0.01, .pupil_shape = 0.02},
                                            {.max_of_blur = 0.05}}};
  const std::vector<ModelChoice> choices = choose_models(lens, wanted, budgets);
  ASSERT_EQ(choices.size(), budgets.size());

  std::mt19937 random(4711);
  std::uniform_real_distribution<double> unit;
  std::vector<double> depths{lens.film_z() - scene.near, lens.film_z() - scene.far};
  for (int k = 0; k < 3; ++k) {
    depths.push_back(lens.film_z() - 1 / (1 / scene.far + unit(random) * (1 / scene.near - 1 / scene.far)));
  }
  const ErrorSamples fresh{.depths_z = depths,
                           .sharpest_between_z = {{depths[0], depths[1]}},
                           .film_points = 256,
                           .seed = static_cast<std::uint32_t>(random())};
  const Lens stopped = scene.f_number > 0 ? with_f_number(lens, scene.f_number) : lens;
  std::vector<std::shared_ptr<const RayModel>> built;
  for (const ModelCandidate& c : choices[0].table) {
    if (c.available) built.push_back(camera_detail::make_model(c.model, stopped, film.radius_mm()));
  }
  const std::vector<ModelError> errors = model_errors(stopped, film, built, fresh);
  auto next = errors.begin();
  for (const ModelCandidate& candidate : choices[0].table) {
    if (!candidate.available) continue;
    const ModelError& seen = *next++;
    SCOPED_TRACE(std::string(name(candidate.model)) + ": px " + std::to_string(seen.all.max_px) + " bound " +
                 std::to_string(candidate.bound_px) + ", blur " + std::to_string(seen.all.max_of_blur) + " bound " +
                 std::to_string(candidate.bound_of_blur) + ", shape " + std::to_string(seen.pupil_shape) + " bound " +
                 std::to_string(candidate.bound_pupil_shape) + ", exposure " + std::to_string(seen.exposure) +
                 " bound " + std::to_string(candidate.bound_exposure));
    EXPECT_LE(seen.all.max_px, candidate.bound_px);
    EXPECT_LE(seen.all.max_of_blur, candidate.bound_of_blur);
    EXPECT_LE(seen.pupil_shape, candidate.bound_pupil_shape);
    EXPECT_LE(seen.exposure, candidate.bound_exposure);
    for (std::size_t k = 0; k < budgets.size(); ++k) {
      const ErrorBudget& budget = budgets[k];
      const auto inside = [&](double slack) {
        return seen.all.max_px <= slack * budget.max_px.value_or(infinity) &&
               seen.all.max_of_blur <= slack * budget.max_of_blur.value_or(infinity) &&
               seen.exposure <= slack * budget.exposure.value_or(infinity) &&
               seen.pupil_shape <= slack * budget.pupil_shape.value_or(infinity);
      };
      if (candidate.model == choices[k].model) {
        EXPECT_TRUE(inside(1)) << "budget " << k;
      }
      // Samples may miss sharp minima of the blur; then the result is only an upper bound.
      if (!budget.max_of_blur && candidate.cost < candidate_of(choices[k], choices[k].model).cost) {
        EXPECT_FALSE(inside(0.9)) << "budget " << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(TwentyLenses, Promise,
                         ::testing::Values(Scene{"double_gauss_52mm_f1.8", 36, 3000, 1000, infinity},
                                           Scene{"double_gauss_100mm_f2.0", 36, 3000, 2000, 10000, 2.8},
                                           Scene{"double_gauss_100mm_f2_28deg", 36, 2000, 1000, infinity},
                                           Scene{"double_gauss_100mm_f1.35", 36, 5000, 2000, infinity, 2},
                                           Scene{"cooke_triplet_50mm_f5", 30, 3000, 1000, infinity},
                                           Scene{"tessar_100mm_f2.8", 36, infinity, 3000, infinity},
                                           Scene{"tessar_100mm_f3.5", 36, 4000, 3000, 6000, 5.6},
                                           Scene{"planar_50mm_f1.4", 36, 1500, 800, infinity, 2.8},
                                           Scene{"planar_55mm_f1.4", 36, 3000, 1500, infinity},
                                           Scene{"biogon_35mm_f2.8", 36, 2000, 1000, infinity},
                                           Scene{"sonnar_180mm_f2.8", 36, 10000, 5000, infinity},
                                           Scene{"telephoto_250mm_f5.6", 36, 20000, 10000, infinity},
                                           Scene{"retrofocus_100mm_f2", 36, 3000, 2000, infinity},
                                           Scene{"modern_50mm_f1.0", 36, 3000, 1000, infinity, 1.4},
                                           Scene{"ernostar_100mm_f2", 36, 3000, 1500, 5000},
                                           Scene{"zoom_14-30mm_f4:middle", 36, 2000, 1000, infinity},
                                           Scene{"petzval_portrait_100mm_f3.4", 36, 3000, 2000, infinity},
                                           Scene{"heliar_100mm_f4", 36, 1000, 600, infinity},
                                           Scene{"fisheye_16mm_f2.8", 36, 2000, 500, infinity},
                                           Scene{"anamorphic_60mm_2x", 20, 5000, 3000, infinity}),
                         [](const auto& scene) {
                           std::string name = scene.param.id;
                           std::ranges::replace_if(
                               name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
                           return name;
                         });

SceneRequirements usual() { return {.near_mm = 1500}; }

Lens usual_lens() { return focused("double_gauss_52mm_f1.8", 3000); }

/// Budgets for several tests.
enum Usual : std::size_t { none, one_px, px_and_shape, zero_px, half_px, tenth_of_blur, either, px_and_no_blur, all };
const std::vector<ModelChoice>& usual_choices() {
  static const std::vector<ModelChoice> choices = [] {
    std::vector<ErrorBudget> budgets(all + 1, ErrorBudget{.pupil_shape = {}});
    budgets[one_px].max_px = 1;
    budgets[px_and_shape] = {.max_px = 1, .pupil_shape = 0.02};
    budgets[zero_px].max_px = 0;
    budgets[half_px].max_px = 0.5;
    budgets[tenth_of_blur].max_of_blur = 0.1;
    budgets[either].max_px = 0.5, budgets[either].max_of_blur = 0.1;
    budgets[px_and_no_blur].max_px = 1, budgets[px_and_no_blur].max_of_blur = 0;
    budgets[all] = {.max_px = 0.25, .exposure = 0.01, .pupil_shape = 0.02};
    return choose_models(usual_lens(), usual(), budgets);
  }();
  return choices;
}

TEST(ChooseModel, MeasuresEveryModelInOrder) {
  const ModelChoice& choice = usual_choices()[one_px];
  ASSERT_EQ(choice.table.size(), models().size());
  for (std::size_t k = 0; k < models().size(); ++k) {
    const ModelCandidate& c = choice.table[k];
    EXPECT_EQ(c.model, models()[k]);
    EXPECT_TRUE(c.available);
    EXPECT_GT(c.ns_per_ray, 0);
    EXPECT_GT(c.setup_ms, 0);
    EXPECT_GE(c.bound_px, c.error.all.max_px);
    EXPECT_EQ(c.inside, c.bound_px <= 1) << name(c.model);
  }
  EXPECT_EQ(candidate_of(choice, ModelKind::exact_double).bound_px, 0);
  EXPECT_EQ(candidate_of(choice, ModelKind::exact_double).bound_pupil_shape, 0);
  EXPECT_TRUE(candidate_of(choice, choice.model).inside);
}

TEST(ChooseModel, ChoosesTheFastestWithinTheBudget) {
  for (const ModelChoice& choice : usual_choices()) {
    for (const ModelCandidate& c : choice.table) {
      if (!c.inside) continue;
      EXPECT_GE(c.cost, candidate_of(choice, choice.model).cost) << name(c.model);
    }
  }
  EXPECT_TRUE(std::ranges::all_of(usual_choices()[none].table, &ModelCandidate::inside));
  EXPECT_EQ(usual_choices()[zero_px].model, ModelKind::exact_double);
  EXPECT_EQ(std::ranges::count_if(usual_choices()[zero_px].table, &ModelCandidate::inside), 1);
}

/// Each ray must meet one budget of the pair, so that a model that meets one budget is accepted.
TEST(ChooseModel, AcceptsPixelsOrAFractionOfTheBlur) {
  const auto& choices = usual_choices();
  for (std::size_t k = 0; k < models().size(); ++k) {
    const bool px = choices[half_px].table[k].inside, blur = choices[tenth_of_blur].table[k].inside;
    // The margin of blur_guard may exclude a model that is just within the pixels.
    if (px && choices[half_px].table[k].bound_px * 1.15 > 0.5) continue;
    EXPECT_GE(choices[either].table[k].inside, px || blur) << name(models()[k]);
    EXPECT_EQ(choices[px_and_no_blur].table[k].inside, choices[one_px].table[k].inside) << name(models()[k]);
  }
}

TEST(ChooseModel, GivesReasonsWithNumbers) {
  const ModelChoice& choice = usual_choices()[all];
  ASSERT_FALSE(choice.reasons.empty());
  EXPECT_TRUE(choice.reasons[0].starts_with(name(choice.model))) << choice.reasons[0];
  expect_tokens(choice.reasons[0], {0.25, 1});  // the budget, px and per cent
  for (const ModelCandidate& c : choice.table) {
    const bool faster = c.cost < candidate_of(choice, choice.model).cost;
    const bool named = std::ranges::any_of(choice.reasons, [&](const std::string& r) {
      return r.starts_with(std::string(name(c.model)) + " (") && testing::has_token(r, "not");
    });
    EXPECT_EQ(faster, named) << name(c.model);
  }
}

bool says(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& l) { return l.find(part) != std::string::npos; });
}

// A ray that only one of model and lens transmits counts in pupil_shape only. The limit in pixels therefore ignores
// that the pupil of a thin lens is round where the lens has cat's eyes.
TEST(ChooseModel, RequiresThePupilsOfTheLensByDefault) {
  const Lens lens = focused("modern_41mm_f1.45", 3000);
  const std::vector<ErrorBudget> budgets{{.max_px = 40}, {.max_px = 40, .pupil_shape = {}}, {}};
  const auto choices = choose_models(lens, {.near_mm = 1500}, budgets);
  for (const std::size_t by_default : {0, 2}) {
    const ModelChoice& choice = choices[by_default];
    EXPECT_LE(candidate_of(choice, choice.model).bound_pupil_shape, 0.1) << name(choice.model);
    EXPECT_FALSE(candidate_of(choice, ModelKind::thin).inside);
    EXPECT_FALSE(candidate_of(choice, ModelKind::pinhole).inside);
  }
  EXPECT_TRUE(candidate_of(choices[1], ModelKind::thin).inside);
  EXPECT_GT(candidate_of(choices[1], choices[1].model).bound_pupil_shape, 0.5) << name(choices[1].model);
  EXPECT_TRUE(says(choices[0].reasons, "pupil shape"));
}

// Eight air surfaces of index 1.6 pass about 0.95 each. Single layers take most of the changes of field and colour.
TEST(ChooseModel, StatesTheLightThatIsLeftOut) {
  const std::array nm{486.1, 587.6, 656.3};
  const Lens bare = with_focus(compile(data_prescription("double_gauss_100mm_f1.35"), nm), 3000),
             coated = with_coating(bare, Coating::quarter_wave());
  const TransmissionError of_bare = transmission_error(bare, {}), of_coated = transmission_error(coated, {});
  EXPECT_NEAR(1 / (1 + of_bare.exposure), transmittance(bare, FieldPoint{.z = -3000}).value(), 2e-3);
  EXPECT_GT(of_bare.exposure, 0.7);
  EXPECT_LT(of_coated.exposure, 0.1);
  EXPECT_GT(of_bare.field, 1e-3);
  EXPECT_GT(of_bare.colour, 0.005);
  const std::vector<ErrorBudget> budgets{{.max_px = 20, .exposure = 0.2}, {.max_px = 20, .exposure = 1e-4}, {}};
  const auto choices = choose_models(bare, {.near_mm = 1500}, budgets);
  EXPECT_TRUE(says(choices[0].not_needed, "transmission"));
  EXPECT_FALSE(says(choices[0].reasons, "transmission"));
  for (const std::size_t k : {1, 2}) EXPECT_TRUE(says(choices[k].reasons, "transmission")) << k;
  EXPECT_NEAR(choices[0].without_transmission.exposure, of_bare.exposure, 1e-9);
  EXPECT_NEAR(choices[0].table[0].error.without_transmission.exposure, of_bare.exposure, 1e-9);
}

TEST(ChooseModel, ReportsUnneededFeatures) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = with_focus(compile(data_prescription("cooke_triplet_50mm_f5"), std::array{486.1, 587.6, 656.3},
                                       {.glasses = &glasses, .missing_glass = MissingGlass::abbe}),
                               3000, {.origin = DistanceOrigin::film});
  const Film film{.width_mm = 6, .height_mm = 4, .columns = 600, .rows = 400};
  const std::vector<ErrorBudget> budgets{
      {.max_px = 20, .pupil_shape = 0.2}, {.max_px = 1e-3, .pupil_shape = 1e-3}, {.max_px = 20, .pupil_shape = {}}};
  const auto loose = choose_models(lens, {.near_mm = 1500, .film = film, .f_number = 16}, budgets);
  for (const char* part : {"587.6", "a pupil for each field", "distortion"}) {
    EXPECT_TRUE(says(loose[0].not_needed, part)) << part;
  }
  EXPECT_TRUE(loose[1].not_needed.empty()) << loose[1].not_needed[0];
  const auto one = choose_model(lens, {.near_mm = 1500, .film = film, .wavelengths_nm = {656.3}}, budgets[0]);
  EXPECT_FALSE(says(one.not_needed, "wavelengths"));
  EXPECT_EQ(one.table[0].error.wavelength.size(), 1u);
  // Unset limits give no reasons.
  EXPECT_FALSE(says(loose[2].not_needed, "pupil"));
}

TEST(ChooseModel, SkipsModelsThatCannotBeBuilt) {
  const Lens lens = focused("anamorphic_60mm_2x", 5000);
  const ModelChoice choice =
      choose_model(lens, {.near_mm = 3000, .film = {.width_mm = 20, .height_mm = 13}}, {.max_px = 4});
  EXPECT_EQ(choice.model, ModelKind::polynomial(7));
  EXPECT_TRUE(candidate_of(choice, ModelKind::thick).available);
  EXPECT_FALSE(candidate_of(choice, ModelKind::thin_two_disc).available);
  EXPECT_FALSE(candidate_of(choice, ModelKind::thin_two_disc).inside);
  EXPECT_FALSE(candidate_of(choice, ModelKind::thin_two_disc).remark.empty());
  EXPECT_TRUE(says(choice.reasons, "thin_two_disc"));
}

TEST(ChooseModel, StopsTheLensDown) {
  const double open = candidate_of(usual_choices()[none], ModelKind::polynomial(5)).bound_px;
  const double stopped =
      candidate_of(choose_model(usual_lens(), {.near_mm = 1500, .f_number = 8}, {}), ModelKind::polynomial(5)).bound_px;
  EXPECT_LT(stopped, 0.5 * open);
}

// The origin only shifts the distances of a scene.
TEST(ChooseModel, DistancesCountFromTheirOrigin) {
  const Lens lens = usual_lens();
  const auto bound = [&](double near, DistanceOrigin origin) {
    return candidate_of(choose_model(lens, {.near_mm = near, .origin = origin}, {}), ModelKind::thick).bound_px;
  };
  const double from_vertex = bound(1500, DistanceOrigin::front_vertex);
  EXPECT_NEAR(bound(1500 + lens.film_z(), DistanceOrigin::film), from_vertex, 1e-9 * from_vertex);
  EXPECT_GT(std::abs(bound(1500, DistanceOrigin::film) - from_vertex), 1e-3 * from_vertex);
}

TEST(ChooseModel, RefusesImpossibleScenesAndBudgets) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000);
  const auto refusal = [&](const SceneRequirements& scene, const ErrorBudget& budget) {
    return testing::message([&] { choose_model(lens, scene, budget); });
  };
  for (const double near : {0.0, -1.0, std::nan("")}) {
    expect_tokens(refusal({.near_mm = near}, {}), {"near_mm"});
  }
  expect_tokens(refusal({.near_mm = 60, .origin = DistanceOrigin::film}, {}), {"near_mm", 60});
  expect_tokens(refusal({.near_mm = 2000, .far_mm = 1000}, {}), {"far_mm", 1000});
  expect_tokens(refusal({.near_mm = 2000, .wavelengths_nm = {400}}, {}), {400});
  expect_tokens(refusal({.near_mm = 2000, .film = {.rows = 0}}, {}), {3840, 0});
  expect_tokens(refusal(usual(), {.max_px = -1}), {"max_px", -1});
  expect_tokens(refusal(usual(), {.pupil_shape = std::nan("")}), {"pupil_shape", "nan"});
  expect_tokens(refusal({.near_mm = 2000, .f_number = 0.5}, {}), {"f", 0.5});
}

}  // namespace choose_model_test
}  // namespace petzval
