// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/choose_model.hpp"

#include <algorithm>

#include "core/text.hpp"
#include "model_table.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using analysis_detail::ModelTable;
using analysis_detail::Tolerance;

void check(const ErrorBudget& budget) {
  const auto refuse = [](const char* what, const std::optional<double>& item) {
    if (!item || *item >= 0) return;
    throw Error(std::string("choose_model: budget: ") + what + " = " + to_text(*item) + "; must be at least 0");
  };
  refuse("max_px", budget.max_px);
  refuse("max_of_blur", budget.max_of_blur);
  refuse("exposure", budget.exposure);
  refuse("pupil_shape", budget.pupil_shape);
}

std::string percent(double fraction) { return to_text(100 * fraction, 3) + " %"; }

/// One limit of a budget and the error of a model.
struct BudgetItem {
  bool inside = true;
  std::string needs, budget;  ///< in words
};

/// Ray errors compared with a budget; nullopt if the budget does not limit them.
/// @param of_tolerance error divided by the allowed error
std::optional<BudgetItem> ray_item(double px, double of_blur, double of_tolerance, const ErrorBudget& budget) {
  if (budget.max_px && budget.max_of_blur) {
    return BudgetItem{of_tolerance <= 1, to_text(px, 3) + " px (" + percent(of_tolerance) + " of what is allowed)",
                      to_text(*budget.max_px) + " px, or " + percent(*budget.max_of_blur) + " of the local blur"};
  }
  if (budget.max_px) return BudgetItem{px <= *budget.max_px, to_text(px, 3) + " px", to_text(*budget.max_px) + " px"};
  if (!budget.max_of_blur) return {};
  return BudgetItem{of_blur <= *budget.max_of_blur, percent(of_blur) + " of the local blur",
                    percent(*budget.max_of_blur) + " of it"};
}

std::optional<BudgetItem> fraction_item(double value, const std::optional<double>& allowed) {
  if (!allowed) return {};
  return BudgetItem{value <= *allowed, percent(value), percent(*allowed)};
}

/// The limits of a budget that a model keeps, and the limits that it exceeds.
struct Judgement {
  bool inside = true;
  std::string kept, missed;  ///< in words
};
Judgement judge(const ModelCandidate& candidate, double of_tolerance, const ErrorBudget& budget) {
  Judgement result;
  const auto count = [&](const char* what, const std::optional<BudgetItem>& item) {
    if (!item) return;
    std::string& words = item->inside ? result.kept : result.missed;
    words += (words.empty() ? "" : "; ") + (what + (' ' + item->needs)) + " (budget " + item->budget + ")";
    result.inside = result.inside && item->inside;
  };
  count("rays are off by up to", ray_item(candidate.bound_px, candidate.bound_of_blur, of_tolerance, budget));
  count("exposure by up to", fraction_item(candidate.bound_exposure, budget.exposure));
  count("pupil shape by up to", fraction_item(candidate.bound_pupil_shape, budget.pupil_shape));
  return result;
}

std::vector<std::string> not_needed(const ModelTable& table, std::size_t budget_number, const ErrorBudget& budget) {
  std::vector<std::string> result;
  const auto rays = [&](const std::optional<analysis_detail::RayStudy::Largest>& largest) -> std::optional<BudgetItem> {
    if (!largest) return {};
    return ray_item(largest->mm / table.pixel_mm, largest->of_blur, largest->of_tolerance[budget_number], budget);
  };
  if (const auto item = rays(table.one_wavelength); item && item->inside) {
    result.push_back(std::to_string(table.wavelengths) + " wavelengths: " + to_text(table.central_nm, 6) +
                     " nm can stand for all, with ray errors up to " + item->needs + " (budget " + item->budget + ")");
  }
  if (const auto item = fraction_item(table.constant_pupil_shape, budget.pupil_shape); item && item->inside) {
    result.push_back("a pupil for each field: the pupil of the film centre differs by up to " + item->needs +
                     " of the area elsewhere (budget " + item->budget + ")");
  }
  if (const auto item = rays(table.no_distortion); item && item->inside) {
    result.push_back("distortion: chief rays to first order are off by up to " + item->needs + " (budget " +
                     item->budget + ")");
  }
  return result;
}

ModelChoice choose(const ModelTable& table, std::size_t budget_number, const ErrorBudget& budget) {
  ModelChoice choice;
  choice.table = table.models;
  std::vector<Judgement> judgements;
  const ModelCandidate* chosen = nullptr;
  for (std::size_t k = 0; k < choice.table.size(); ++k) {
    ModelCandidate& candidate = choice.table[k];
    Judgement& judgement = judgements.emplace_back();
    if (!candidate.available) continue;
    judgement = judge(candidate, table.of_tolerance[k][budget_number], budget);
    candidate.inside = judgement.inside;
    if (candidate.inside && (!chosen || candidate.cost < chosen->cost)) chosen = &candidate;
  }
  choice.model = chosen->model;
  const auto called = [](const ModelCandidate& candidate) {
    return std::string(name(candidate.model)) + " (cost " + to_text(candidate.cost, 2) + "; " +
           to_text(candidate.ns_per_ray, 3) + " ns per ray here)";
  };
  const std::string& kept = judgements[static_cast<std::size_t>(chosen - choice.table.data())].kept;
  choice.reasons.push_back(called(*chosen) + " is the fastest inside the budget" + (kept.empty() ? "" : ": " + kept));
  for (std::size_t k = 0; k < choice.table.size(); ++k) {
    const ModelCandidate& candidate = choice.table[k];
    if (!candidate.available) {
      choice.reasons.push_back(std::string(name(candidate.model)) + " cannot be built: " + candidate.remark);
    } else if (!candidate.inside && candidate.cost < chosen->cost) {
      choice.reasons.push_back(called(candidate) + " will not do: " + judgements[k].missed);
    }
  }
  choice.not_needed = not_needed(table, budget_number, budget);
  choice.without_transmission = table.without_transmission;
  const auto& [exposure, field, colour] = table.without_transmission;
  const std::string costs = "without it the film is " + percent(exposure) +
                            " too bright (surfaces of unknown coating are uncoated), and light changes by up to " +
                            percent(field) + " over the film" +
                            (table.wavelengths > 1 ? " and " + percent(colour) + " over the wavelengths" : "");
  const auto item = fraction_item(std::max(field, colour), budget.exposure);
  if (item && item->inside) {
    choice.not_needed.push_back("transmission: " + costs + " (budget of these changes " + item->budget + ")");
  } else {
    choice.reasons.push_back("transmission is a separate choice: " + costs);
  }
  return choice;
}

}  // namespace

ModelChoice choose_model(const Lens& lens, const SceneRequirements& scene, const ErrorBudget& budget, int threads) {
  return choose_models(lens, scene, std::span(&budget, 1), threads).front();
}

std::vector<ModelChoice> choose_models(const Lens& lens, const SceneRequirements& scene,
                                       std::span<const ErrorBudget> budgets, int threads) {
  std::vector<Tolerance> tolerances;
  for (const ErrorBudget& budget : budgets) {
    check(budget);
    tolerances.push_back({budget.max_px.value_or(0) * scene.film.pixel_mm(), budget.max_of_blur.value_or(0)});
  }
  const ModelTable table = analysis_detail::model_table(lens, scene, tolerances, threads);
  std::vector<ModelChoice> choices;
  for (std::size_t k = 0; k < budgets.size(); ++k) choices.push_back(choose(table, k, budgets[k]));
  return choices;
}

}  // namespace petzval
