// SPDX-License-Identifier: Apache-2.0
#include "petzval/formats/lens_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "core/text.hpp"
#include "glass/glass_table.hpp"
#include "glass_reader.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "text_file.hpp"

namespace petzval {
namespace formats_detail {
namespace {

constexpr std::size_t most_warnings = 1000, most_glasses = 100'000;

/// The index of a glass; nullopt if the formula gives no real index or the wavelength is outside its range.
std::optional<double> index_at(const Glass& glass, double nm) {
  try {
    return refractive_index(glass, nm);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// V_d of a glass with this n_d; 0 if the formula is not valid at the F and C lines.
double abbe_number(const Glass& glass, double nd) {
  const double n_f = index_at(glass, spectral_line_nm("F")).value_or(0);
  const double n_c = index_at(glass, spectral_line_nm("C")).value_or(0);
  return n_f > 0 && n_c > 0 && n_f != n_c ? (nd - 1) / (n_f - n_c) : 0;
}

bool looks_like_rii(std::string_view text) {
  return text.starts_with("DATA:") || text.find("\nDATA:") != std::string_view::npos;
}

}  // namespace

void GlassReader::warn(int line, std::string_view command, const std::string& message) {
  if (file_.warnings.size() < most_warnings) {
    file_.warnings.push_back({line, std::string(command), message});
  } else {
    ++warnings_left_out_;
  }
}

void GlassReader::refuse(int line, const std::string& found, const std::string& rule) const {
  throw Error(where_ + ": line " + std::to_string(line) + ": " + found + "; must be " + rule);
}

double GlassReader::number(int line, std::string_view what, std::string_view word) const {
  const auto value = formats_detail::number(word);
  if (!value) {
    refuse(line, std::string(what) + " = \"" + std::string(beginning(word, 100)) + "\"", "a finite number");
  }
  return *value;
}

void GlassReader::check_against_formula(Glass& glass, int line, double nm) {
  const double n = refractive_index(glass, nm), v = abbe_number(glass, n);
  if (glass.nd <= 1) {
    warn(line, glass.name, "no n_d is printed; the formula gives " + to_text(n, 7) + " at " + to_text(nm, 7) + " nm");
    glass.nd = n;
    glass.vd = v;
    return;
  }
  if (nm != d_line_nm) return;
  if (std::abs(n - glass.nd) > 1e-4) {
    warn(line, glass.name, "the formula gives n_d " + to_text(n, 7) + ", but " + to_text(glass.nd) + " is printed");
  }
  if (glass.vd == 0) glass.vd = v;
  if (v != 0 && std::abs(v - glass.vd) > 0.2) {
    warn(line, glass.name, "the formula gives V_d " + to_text(v, 4) + ", but " + to_text(glass.vd) + " is printed");
  }
}

void GlassReader::add(Glass glass, int line) {
  if (!(glass.shortest_nm > 0 && glass.shortest_nm < glass.longest_nm)) {
    warn(line, glass.name,
         "left out: its range is " + to_text(glass.shortest_nm, 7) + " to " + to_text(glass.longest_nm, 7) + " nm");
    return;
  }
  const double nm = std::clamp(d_line_nm, glass.shortest_nm, glass.longest_nm);
  if (!index_at(glass, nm)) {
    warn(line, glass.name, "left out: its formula gives no real index at " + to_text(nm, 7) + " nm");
    return;
  }
  if (file_.glasses.size() == most_glasses) {
    refuse(line, "one more glass", "at most " + std::to_string(most_glasses) + " per file");
  }
  if (!names_.insert(lower(glass.name)).second) warn(line, glass.name, "is given before; the name refers to the first");
  check_against_formula(glass, line, nm);
  file_.glasses.push_back(std::move(glass));
}

GlassFile GlassReader::finish() {
  if (file_.glasses.empty()) {
    const std::string why = file_.warnings.empty()
                                ? std::string()
                                : " (line " + std::to_string(file_.warnings[0].line) + ": " +
                                      file_.warnings[0].command + ": " + file_.warnings[0].message + ")";
    throw Error(where_ + ": no usable glass" + why + "; must be at least one");
  }
  if (warnings_left_out_ > 0) {
    file_.warnings.push_back({0, "", std::to_string(warnings_left_out_) + " more warnings are left out"});
  }
  return std::move(file_);
}

}  // namespace formats_detail

GlassFile read_glasses(const std::filesystem::path& file) {
  using namespace formats_detail;
  const std::string rule = "glasses: a Zemax catalogue (.agf), a page of refractiveindex.info (.yml) or a glass table";
  std::string text = read_as_utf8(file, rule);
  GlassReader reader(file.string());
  if (text.starts_with(glass_detail::glass_table_header)) {
    std::vector<Glass> glasses;
    std::istringstream stream(std::move(text));
    glass_detail::read_glass_table(stream, file.string(), glasses);
    for (std::size_t i = 0; i < glasses.size(); ++i) reader.add(std::move(glasses[i]), static_cast<int>(i) + 2);
  } else if (looks_like_agf(text)) {
    read_agf(text, lower(file.stem().string()), reader);
  } else if (looks_like_rii(text)) {
    read_rii(std::move(text), file.stem().string(), reader);
  } else {
    throw Error(file.string() + ": its first lines match no glass format; must be " + rule);
  }
  return reader.finish();
}

}  // namespace petzval
