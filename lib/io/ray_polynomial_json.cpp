// SPDX-License-Identifier: Apache-2.0
#include "io/ray_polynomial_json.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

using io_detail::describe;
using io_detail::in_quotes;
using io_detail::JsonValue;
using Domain = RayPolynomial::Domain;
using Fit = RayPolynomial::Fit;

constexpr std::string_view format_name = "petzval-ray-polynomial 1";
constexpr std::size_t most_fits = 10'000;
constexpr int highest_degree = 11;

Domain::Section& along_x(Domain& domain) {
  if (!domain.along_x) domain.along_x.emplace();
  return *domain.along_x;
}

/// A key and the member for its number.
template <class Record>
struct Number {
  std::string_view name;
  double& (*of)(Record&);
};
constexpr std::array<Number<Domain>, 8> domain_numbers{{
    {"film_z_mm", [](Domain& d) -> double& { return d.space.film_z; }},
    {"pupil_z_mm", [](Domain& d) -> double& { return d.space.pupil_z; }},
    {"film_radius_mm", [](Domain& d) -> double& { return d.film_radius; }},
    {"pupil_shift", [](Domain& d) -> double& { return d.pupil_shift; }},
    {"pupil_radius_mm", [](Domain& d) -> double& { return d.pupil_radius; }},
    {"reference_z_mm", [](Domain& d) -> double& { return d.reference_z; }},
    {"pupil_shift_x", [](Domain& d) -> double& { return along_x(d).pupil_shift; }},
    {"pupil_radius_x_mm", [](Domain& d) -> double& { return along_x(d).pupil_radius; }},
}};
/// Number of keys at the end that belong to polynomials with mirror symmetry: a file has both or neither.
constexpr std::size_t mirror_numbers = 2;
constexpr std::array<Number<Fit>, 5> fit_numbers{{
    {"wavelength_nm", [](Fit& f) -> double& { return f.wavelength_nm; }},
    {"rms_rad", [](Fit& f) -> double& { return f.rms_rad; }},
    {"max_rad", [](Fit& f) -> double& { return f.max_rad; }},
    {"rms_mm", [](Fit& f) -> double& { return f.rms_mm; }},
    {"max_mm", [](Fit& f) -> double& { return f.max_mm; }},
}};
struct List {
  std::string_view name;
  std::vector<double> Fit::*of;
};
constexpr std::array<List, 4> fit_lists{{
    {"direction_by_film", &Fit::direction_by_film},
    {"direction_by_pupil", &Fit::direction_by_pupil},
    {"offset_by_film", &Fit::offset_by_film},
    {"offset_by_pupil", &Fit::offset_by_pupil},
}};

/// The keys of a file and of a fit, in the order of writing.
constexpr std::array<std::string_view, 11> file_keys{"format",
                                                     domain_numbers[0].name,
                                                     domain_numbers[1].name,
                                                     domain_numbers[2].name,
                                                     domain_numbers[3].name,
                                                     domain_numbers[4].name,
                                                     domain_numbers[5].name,
                                                     domain_numbers[6].name,
                                                     domain_numbers[7].name,
                                                     "degree",
                                                     "fits"};
/// The keys of mirror symmetry, as bits of file_keys.
constexpr std::uint32_t mirror_keys = 0b11 << (1 + domain_numbers.size() - mirror_numbers);
constexpr std::array<std::string_view, 9> fit_keys{fit_numbers[0].name, fit_numbers[1].name, fit_numbers[2].name,
                                                   fit_numbers[3].name, fit_numbers[4].name, fit_lists[0].name,
                                                   fit_lists[1].name,   fit_lists[2].name,   fit_lists[3].name};

enum class Scope { file, fits, fit, list };

/// Builds a polynomial while nlohmann's parser walks the text.
class Reader : public io_detail::JsonReader {
 public:
  using JsonReader::JsonReader;
  RayPolynomial take() { return RayPolynomial(degree_, domain_, std::move(fits_)); }

 private:
  struct Open {
    Scope scope;
    std::size_t byte = 0;    ///< of the opening bracket
    std::uint32_t seen = 0;  ///< bits of the keys so far, by index
    std::size_t key = 0;     ///< the last key
  };

  static std::span<const std::string_view> keys(Scope scope) {
    if (scope == Scope::file) return file_keys;
    return fit_keys;
  }
  /// The list or object that must come next; nullopt if a plain value must come.
  std::optional<Scope> next_scope() const;

  void key(const std::string& name) override;
  void assign(JsonValue value) override;
  void open(bool list) override;
  void close() override;
  std::string here() const override;

  int degree_ = 0;
  Domain domain_;
  std::vector<Fit> fits_;
  std::vector<Open> open_;
};

std::string Reader::here() const {
  std::string text;
  if (open_.empty()) return text;
  const bool in_fit = open_.size() > 2;
  const Open& object = open_[in_fit ? 2 : 0];
  if (in_fit) text += "fit " + std::to_string(fits_.size() - 1);
  if (object.seen != 0) text += (text.empty() ? "" : ": ") + std::string(keys(object.scope)[object.key]);
  return text;
}

void Reader::key(const std::string& name) {
  Open& object = open_.back();
  const auto known = keys(object.scope);
  const auto found = std::find(known.begin(), known.end(), name);
  const std::uint32_t seen = std::exchange(object.seen, 0);  // messages name this key, not the previous key
  if (found == known.end()) {
    std::string all;
    for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
    fail("key " + in_quotes(name) + " is unknown; must be one of " + all);
  }
  object.key = static_cast<std::size_t>(found - known.begin());
  const std::uint32_t bit = std::uint32_t{1} << object.key;
  if (seen & bit) fail("key " + in_quotes(name) + " is given twice; must be given once");
  object.seen = seen | bit;
}

std::optional<Scope> Reader::next_scope() const {
  if (open_.empty()) return Scope::file;
  const Open& in = open_.back();
  switch (in.scope) {
    case Scope::file: return file_keys[in.key] == "fits" ? std::optional(Scope::fits) : std::nullopt;
    case Scope::fits: return Scope::fit;
    case Scope::fit: return in.key >= fit_numbers.size() ? std::optional(Scope::list) : std::nullopt;
    case Scope::list: break;
  }
  return {};
}

void Reader::assign(JsonValue value) {
  if (const auto inner = next_scope()) {
    refuse_kind(describe(value), *inner == Scope::file || *inner == Scope::fit ? "an object" : "a list");
  }
  const Open& in = open_.back();
  if (in.scope == Scope::list) {
    const std::size_t key = open_[open_.size() - 2].key - fit_numbers.size();
    std::vector<double>& list = fits_.back().*fit_lists[key].of;
    static const std::size_t longest = 2 * RayPolynomial::mirror_terms(highest_degree).size();
    if (list.size() == longest) {
      fail("more than " + std::to_string(longest) + " numbers; must be a polynomial of degree " +
           std::to_string(highest_degree) + " or less");
    }
    list.push_back(number_of(value));
  } else if (in.scope == Scope::fit) {
    fit_numbers[in.key].of(fits_.back()) = number_of(value);
  } else if (file_keys[in.key] == "format") {
    if (text_of(value) != format_name) refuse(describe(value), in_quotes(format_name));
  } else if (file_keys[in.key] == "degree") {
    const double degree = number_of(value);
    if (!(degree >= 3 && degree <= highest_degree && degree == static_cast<int>(degree))) {
      refuse(describe(value), "3, 5, 7, 9 or 11");
    }
    degree_ = static_cast<int>(degree);
  } else {
    domain_numbers[in.key - 1].of(domain_) = number_of(value);
  }
}

void Reader::open(bool list) {
  const auto inner = next_scope();
  const std::string found = list ? "a list" : "an object";
  if (!inner) refuse_kind(found, open_.back().scope == Scope::list ? "a number" : "a plain value");
  const bool wants_list = *inner == Scope::fits || *inner == Scope::list;
  if (wants_list != list) refuse_kind(found, wants_list ? "a list" : "an object");
  if (*inner == Scope::fit) {
    if (fits_.size() == most_fits) {
      throw Error(where_ + ": more than " + std::to_string(most_fits) + " fits; must be one for each wavelength");
    }
    fits_.emplace_back();
  }
  open_.push_back({*inner, byte()});
}

void Reader::close() {
  Open& closed = open_.back();
  if (closed.scope == Scope::file || closed.scope == Scope::fit) {
    const auto known = keys(closed.scope);
    const std::uint32_t seen = std::exchange(closed.seen, 0);
    const std::uint32_t optional = closed.scope == Scope::file && !(seen & mirror_keys) ? mirror_keys : 0;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (!((seen | optional) & (std::uint32_t{1} << i)))
        fail(closed.byte, "key " + in_quotes(known[i]) + " is missing");
    }
  }
  open_.pop_back();
}

std::string line(std::string_view key, const std::string& value) { return "\"" + std::string(key) + "\": " + value; }

}  // namespace

RayPolynomial parse_ray_polynomial(std::string_view json, const std::string& where) {
  Reader reader(where);
  reader.parse(json);
  try {
    return reader.take();
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
}

RayPolynomial read_ray_polynomial(const std::filesystem::path& file) {
  return parse_ray_polynomial(read_file(file, "a ray polynomial file"), file.string());
}

std::string format_ray_polynomial(const RayPolynomial& polynomial) {
  using io_detail::json_number;
  std::string text = "{\n  " + line("format", in_quotes(format_name));
  Domain domain = polynomial.domain();
  const std::size_t numbers = domain_numbers.size() - (domain.along_x ? 0 : mirror_numbers);
  for (std::size_t i = 0; i < numbers; ++i) {
    text += ",\n  " + line(domain_numbers[i].name, json_number(domain_numbers[i].of(domain)));
  }
  text += ",\n  " + line("degree", std::to_string(polynomial.degree())) + ",\n  \"fits\": [";
  const char* separator = "\n    {";
  for (Fit fit : polynomial.fits()) {
    text += std::exchange(separator, ",\n    {");
    const char* before = "\n      ";
    for (const auto& entry : fit_numbers) {
      text += std::exchange(before, ",\n      ") + line(entry.name, json_number(entry.of(fit)));
    }
    for (const List& entry : fit_lists) {
      std::string list;
      for (const double c : fit.*entry.of) list += (list.empty() ? "" : ", ") + json_number(c);
      text += before + line(entry.name, "[" + list + "]");
    }
    text += "\n    }";
  }
  return text + "\n  ]\n}\n";
}

void write_ray_polynomial(const RayPolynomial& polynomial, const std::filesystem::path& file) {
  write_file(format_ray_polynomial(polynomial), file);
}

}  // namespace petzval
