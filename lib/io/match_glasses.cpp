// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lint.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval {
namespace {

/// A medium without a glass name, and its positions in the lens.
struct Anonymous {
  Medium medium;
  std::vector<std::string> locations;
};

/// Calls a function for each medium of a lens, with the name of its position.
void for_each_medium(Prescription& lens, const auto& call) {
  call(lens.object_space, "object_space");
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) call(lens.surfaces[i].medium, "surface " + std::to_string(i));
  for (Configuration& configuration : lens.configurations) {
    for (SurfaceChange& change : configuration.changes) {
      if (!change.medium) continue;
      call(*change.medium, "surface " + std::to_string(change.surface) + " of configuration " + configuration.name);
    }
  }
}

std::string joined(const std::vector<std::string>& locations) {
  std::string text;
  for (const std::string& location : locations) text += (text.empty() ? "" : ", ") + location;
  return text;
}

std::string numbers(double nd, double vd) { return "n_d " + to_text(nd, 7) + ", V_d " + to_text(vd, 5); }

std::string described(const Glass& glass) {
  return glass.name + " (" + glass.catalogue + ", " + numbers(glass.nd, glass.vd) + ")";
}

}  // namespace

MatchedGlasses match_glasses(const Prescription& prescription, const GlassCatalogue& glasses, double max_nd_difference,
                             double max_vd_difference) {
  for (const auto& [name, value] : {std::pair("nd", max_nd_difference), std::pair("vd", max_vd_difference)}) {
    if (value >= 0 && std::isfinite(value)) continue;
    throw Error(std::string("match_glasses: ") + name + " = " + to_text(value) +
                "; must be a finite number of 0 or more");
  }
  MatchedGlasses result{.prescription = prescription, .matched = {}, .unmatched = {}};
  std::vector<Anonymous> media;
  for_each_medium(result.prescription, [&](const Medium& medium, const std::string& location) {
    if (medium.glass || medium.is_air()) return;
    auto known = std::ranges::find(media, medium, &Anonymous::medium);
    if (known == media.end()) known = media.insert(media.end(), {medium, {}});
    known->locations.push_back(location);
  });
  for (const Anonymous& entry : media) {
    const double nd = *entry.medium.nd;
    const std::string locations = joined(entry.locations);
    const auto keep = [&](const std::string& reason) { result.unmatched.push_back({0, locations, reason}); };
    if (entry.medium.vd.value_or(0) == 0) {
      keep("n_d " + to_text(nd, 7) + " without V_d: a glass has both");
      continue;
    }
    if (prescription.reference_wavelength_nm != d_line_nm) {
      keep("index " + to_text(nd, 7) + " at " + to_text(prescription.reference_wavelength_nm) +
           " nm: glasses are compared by n_d");
      continue;
    }
    const auto nearest = nearest_glasses(glasses, nd, entry.medium.vd, 1);
    if (nearest.empty()) {
      keep("the catalogue has no glasses");
      continue;
    }
    const Glass& glass = *nearest.front();
    const std::string found = numbers(nd, *entry.medium.vd) + ": ";
    if (std::abs(glass.nd - nd) > max_nd_difference || std::abs(glass.vd - *entry.medium.vd) > max_vd_difference) {
      keep(found + "the nearest glass is " + described(glass));
      continue;
    }
    for_each_medium(result.prescription, [&](Medium& medium, const std::string&) {
      if (!(medium == entry.medium)) return;
      medium.glass = glass.name;
      medium.catalogue = glass.catalogue;
      medium.glass_origin = "matched";
    });
    result.matched.push_back({0, locations, found + described(glass)});
  }
  return result;
}

}  // namespace petzval
