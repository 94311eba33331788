// SPDX-License-Identifier: Apache-2.0
// Lists the shipped lenses, or those whose name, source or kind contains all words.
//
//   petzval lenses gauss 50
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/prescription/prescription.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using examples::number;
using examples::or_null;
using petzval::Prescription;

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::vector<Prescription> shipped_lenses() {
  std::vector<Prescription> lenses;
  for (const auto& file : examples::entries(petzval::data_directory() / "lenses")) {
    if (file.extension() == ".json") lenses.push_back(petzval::read_prescription(file));
  }
  std::ranges::sort(lenses, {}, &Prescription::id);
  return lenses;
}

bool contains_all(const Prescription& lens, const std::vector<std::string>& words) {
  const std::string text = lower(lens.id + ' ' + lens.name + ' ' + lens.source_design + ' ' + lens.source_numbers);
  return std::ranges::all_of(words,
                             [&](const std::string& word) { return text.find(lower(word)) != std::string::npos; });
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size() + 1, width), ' ');
  return text;
}

}  // namespace

int commands::lenses(int argc, char** argv) {
  std::vector<std::string> words;
  bool json = false;
  examples::App app(
      "Lists the shipped lenses whose name or source contains all words, with focal length (mm), f-number and half "
      "field (degrees) as the source declares them. Every command takes the first column as LENS.",
      "petzval lenses");
  app.add_option("WORD", words, "words to search; upper and lower case are equal");
  app.add_flag("--json", json, "print JSON");
  return examples::run(app, argc, argv, [&] {
    Json rows = Json::array();
    std::size_t found = 0;
    for (const Prescription& lens : shipped_lenses()) {
      if (!contains_all(lens, words)) continue;
      ++found;
      if (json) {
        rows.push_back({{"id", lens.id},
                        {"name", lens.name},
                        {"source", lens.source_design},
                        {"focal_length_mm", or_null(lens.focal_length_mm)},
                        {"f_number", or_null(lens.f_number)},
                        {"half_field_deg", or_null(lens.half_field_deg)},
                        {"surfaces", lens.surfaces.size()}});
        continue;
      }
      const auto shown = [](const std::optional<double>& value) {
        return value ? number(*value, 6) : std::string("-");
      };
      std::cout << padded(lens.id, 40) << padded(shown(lens.focal_length_mm), 9) << padded(shown(lens.f_number), 7)
                << padded(shown(lens.half_field_deg), 7) << lens.name << '\n';
    }
    if (json) std::cout << rows.dump(1) << '\n';
    if (found == 0) examples::note("no shipped lens contains all words; petzval lenses lists all");
  });
}
