// SPDX-License-Identifier: Apache-2.0
// Zemax glass catalogues. Source of the form: Ansys, OpticStudio user guide, "The AGF & BGF file formats".
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "glass_reader.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

struct Form {
  DispersionFormula formula;
  std::vector<double> coefficients;
};

constexpr std::size_t coefficient_count = 10;
using Coefficients = std::array<double, coefficient_count>;

/// n^2 = a0 + sum a_i l^e_i
Form powers(const Coefficients& a, std::initializer_list<double> exponents) {
  Form form{DispersionFormula::polynomial, {a[0]}};
  std::size_t i = 1;
  for (const double exponent : exponents) form.coefficients.insert(form.coefficients.end(), {a[i++], exponent});
  return form;
}

/// n^2 = c0 + 1 + sum K l^2 / (l^2 - L), for pairs of K and L
Form poles(double c0, std::span<const double> pairs) {
  Form form{DispersionFormula::sellmeier, {c0}};
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    if (pairs[i] != 0) form.coefficients.insert(form.coefficients.end(), {pairs[i], pairs[i + 1]});
  }
  return form;
}

/// The forms of formulas 1 to 13; empty for other numbers. Formula 4 has two readings.
std::vector<Form> forms(int number, const Coefficients& a) {
  const std::span<const double> all(a);
  switch (number) {
    case 1: return {powers(a, {2, -2, -4, -6, -8})};  // Schott
    case 2: return {poles(0, all.first(6))};          // Sellmeier 1
    case 3: return {{DispersionFormula::herzberger, {a[0], a[1], a[2], a[3], a[4], a[5]}}};
    case 4:  // Sellmeier 2: the last term with and without l^2 in the numerator
      return {{DispersionFormula::rational, {1 + a[0], a[1], 2, a[2] * a[2], a[3], 0, a[4] * a[4]}},
              {DispersionFormula::rational, {1 + a[0], a[1], 2, a[2] * a[2], a[3], 2, a[4] * a[4]}}};
    case 5: return {{DispersionFormula::cauchy, {a[0], a[1], -1, a[2], -3.5}}};          // Conrady
    case 6: return {poles(0, all.first(8))};                                             // Sellmeier 3
    case 7: return {{DispersionFormula::rational, {a[0], a[1], 0, a[2], -a[3], 4, 0}}};  // Handbook of Optics 1
    case 8: return {{DispersionFormula::rational, {a[0], a[1], 2, a[2], -a[3], 4, 0}}};  // Handbook of Optics 2
    case 9: return {poles(a[0] - 1, all.subspan(1, 4))};                                 // Sellmeier 4
    case 10: return {powers(a, {2, -2, -4, -6, -8, -10, -12})};                          // Extended
    case 11: return {poles(0, all)};                                                     // Sellmeier 5
    case 12: return {powers(a, {2, -2, -4, -6, -8, 4, 6})};                              // Extended 2
    case 13: return {powers(a, {2, 4, -2, -4, -6, -8, -10, -12})};                       // Extended 3
    default: return {};
  }
}

/// An IT: the internal transmittance at one wavelength and thickness.
struct Transmittance {
  double nm, value, thickness_mm;
};

/// Absorption coefficients of the measured transmittances, one per wavelength.
///
/// If a wavelength has several thicknesses, the largest product of transmittance and thickness is used: its coefficient
/// has the smallest error from the rounding of the transmittance. A transmittance of 0 is read as 0.0005, half of the
/// third decimal that catalogues print; the thinnest of these gives the largest lower bound.
std::vector<AbsorptionEntry> absorption_of(std::vector<Transmittance> list) {
  constexpr double smallest = 0.0005;
  std::ranges::sort(list, [](const Transmittance& a, const Transmittance& b) {
    const double from_a = a.value * a.thickness_mm, from_b = b.value * b.thickness_mm;
    return std::tie(a.nm, from_b, a.thickness_mm) < std::tie(b.nm, from_a, b.thickness_mm);
  });
  std::vector<AbsorptionEntry> result;
  for (const auto& [nm, value, thickness_mm] : list) {
    if (!result.empty() && result.back().wavelength_nm == nm) continue;
    result.push_back({nm, std::log(1 / std::clamp(value, smallest, 1.0)) / thickness_mm});
  }
  return result;
}

/// The record of one glass, from its NM to the next NM.
struct Record {
  int line = 0;
  int formula = 0;
  Glass glass{};
  std::optional<Coefficients> coefficients{};
  bool has_range = false;
  std::vector<Transmittance> transmittances{};
  bool warned_of_transmittance = false;
};

bool gives_printed_index(const Glass& glass) {
  try {
    return std::abs(refractive_index(glass, d_line_nm) - glass.nd) <= 1e-4;
  } catch (const Error&) {
    return false;
  }
}

bool is_command(std::string_view word) {
  static constexpr std::array<std::string_view, 10> commands = {"CC", "NM", "GC", "ED", "CD",
                                                                "TD", "MD", "OD", "LD", "IT"};
  return std::ranges::find(commands, word) != commands.end();
}

class AgfReader {
 public:
  AgfReader(const std::string& catalogue, GlassReader& reader) : catalogue_(catalogue), reader_(reader) {}

  void read(std::string_view text) {
    Lines lines(text);
    while (lines.next()) read_line(lines.number(), lines.text());
    if (record_ && !record_->coefficients) {
      reader_.refuse(lines.number(), "the file ends before the CD of glass " + record_->glass.name, "complete");
    }
    close_record();
  }

 private:
  void read_line(int line, std::string_view text) {
    const auto w = words(text, 32);
    if (w.empty() || w[0].starts_with('!')) return;
    const std::string_view command = w[0];
    if (!began_ && !is_command(command)) return;  // text about the catalogue
    if (command == "NM") {
      began_ = true;
      close_record();
      open_record(line, w);
    } else if (command == "CD") {
      Coefficients c{};
      const std::size_t count = std::min(w.size() - 1, coefficient_count);
      for (std::size_t i = 0; i < count; ++i) c[i] = reader_.number(line, "CD", w[i + 1]);
      record_of(line, command).coefficients = c;
    } else if (command == "LD") {
      if (w.size() < 3) reader_.refuse(line, "LD has " + std::to_string(w.size() - 1) + " numbers", "two");
      Record& record = record_of(line, command);
      record.glass.shortest_nm = reader_.number(line, "LD", w[1]) * 1000;
      record.glass.longest_nm = reader_.number(line, "LD", w[2]) * 1000;
      record.has_range = true;
    } else if (command == "IT") {
      read_transmittance(line, w);
    } else if (command != "CC" && command != "GC") {
      leave_out(line, command);
    }
  }

  /// Reads wavelength, transmittance and thickness. Invalid entries are left out with one warning per glass: the glass
  /// still has its index. Rounding may give a transmittance slightly above 1.
  void read_transmittance(int line, const std::vector<std::string_view>& w) {
    Record& record = record_of(line, "IT");
    constexpr double longest_um = 1e3, thinnest_mm = 1e-3, thickest_mm = 1e6, largest = 1.01;
    const auto within = [&](std::size_t i, double most) {
      const auto value = i < w.size() ? number(w[i]) : std::nullopt;
      return value && *value >= 0 && *value <= most ? value : std::nullopt;
    };
    const auto um = within(1, longest_um), value = within(2, largest), mm = within(3, thickest_mm);
    if (um && value && mm && *um > 0 && *mm >= thinnest_mm) {
      record.transmittances.push_back({*um * 1000, *value, *mm});
    } else if (!std::exchange(record.warned_of_transmittance, true)) {
      std::string text;
      for (std::size_t i = 1; i < std::min<std::size_t>(w.size(), 4); ++i) append(text, " ", beginning(w[i], 32));
      reader_.warn(line, record.glass.name,
                   "IT = \"" + text + "\" is left out; must be a wavelength (um), a transmittance from 0 to 1 and a " +
                       "thickness (mm)");
    }
  }

  void open_record(int line, const std::vector<std::string_view>& w) {
    if (w.size() < 6) {
      reader_.refuse(line, "NM has " + std::to_string(w.size() - 1) + " words",
                     "a name, a formula, a code, n_d and V_d");
    }
    const auto printed = [&](std::size_t i) { return w[i] == "-" ? 0.0 : reader_.number(line, "NM", w[i]); };
    record_.emplace();
    record_->line = line;
    record_->glass.catalogue = catalogue_;
    record_->glass.name = w[1];
    const double formula = reader_.number(line, "NM", w[2]);
    record_->formula = formula >= 1 && formula <= 13 && formula == std::floor(formula) ? static_cast<int>(formula) : 0;
    if (record_->formula == 0) {
      reader_.warn(line, record_->glass.name,
                   "left out: its formula is " + std::string(beginning(w[2], 100)) + "; formulas 1 to 13 are known");
    }
    record_->glass.nd = printed(4);
    record_->glass.vd = printed(5);
  }

  Record& record_of(int line, std::string_view command) {
    if (!record_) reader_.refuse(line, std::string(command) + " is before the first NM", "after the NM of a glass");
    return *record_;
  }

  void close_record() {
    if (!record_) return;
    Record record = std::move(*record_);
    record_.reset();
    if (record.formula == 0) return;
    Glass& glass = record.glass;
    if (!record.coefficients) {
      reader_.warn(record.line, glass.name, "left out: it has no CD");
      return;
    }
    if (!record.has_range) {
      reader_.warn(record.line, glass.name, "it has no LD: its range is assumed to be 400 to 700 nm");
      glass.shortest_nm = 400;
      glass.longest_nm = 700;
    }
    glass.absorption = absorption_of(std::move(record.transmittances));
    auto candidates = forms(record.formula, *record.coefficients);
    std::vector<Glass> glasses;
    for (Form& form : candidates) {
      glass.formula = form.formula;
      glass.coefficients = std::move(form.coefficients);
      if (candidates.size() == 1 || gives_printed_index(glass)) glasses.push_back(glass);
    }
    if (glasses.size() == 1) {
      reader_.add(std::move(glasses[0]), record.line);
    } else {
      reader_.warn(record.line, glass.name,
                   "left out: formula 4 has two readings, and its n_d does not distinguish them");
    }
  }

  /// Warns once per unused command.
  void leave_out(int line, std::string_view command) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> unused = {{
        {"ED", "thermal expansion and density are not used"},
        {"TD", "thermal dispersion is not used: indices are those at the temperature of the catalogue"},
        {"MD", "mechanical data are not used"},
        {"OD", "price and resistance to chemicals are not used"},
    }};
    if (said_.size() >= 1000 || !said_.emplace(command.substr(0, 32)).second) return;
    const auto known = std::find_if(unused.begin(), unused.end(), [&](const auto& u) { return u.first == command; });
    reader_.warn(line, command.substr(0, 32),
                 known != unused.end() ? std::string(known->second) : "an unknown command is left out");
  }

  std::string catalogue_;
  GlassReader& reader_;
  bool began_ = false;  ///< the first NM was read
  std::optional<Record> record_;
  std::set<std::string> said_;
};

}  // namespace

bool looks_like_agf(std::string_view text) {
  Lines lines(text);
  while (lines.next() && lines.number() <= 1000) {
    const auto w = words(lines.text(), 3);
    if (w.empty() || w[0].starts_with('!')) continue;
    if (w[0] == "CC") return true;
    if (w[0] == "NM") return lines.number() == 1 || (w.size() > 2 && number(w[2]));
  }
  return false;
}

void read_agf(std::string_view text, const std::string& catalogue, GlassReader& reader) {
  AgfReader(catalogue, reader).read(text);
}

}  // namespace petzval::formats_detail
