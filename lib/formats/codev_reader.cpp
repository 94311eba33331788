// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "codev_lens.hpp"
#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "statements.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using Words = std::span<const std::string_view>;
using io_detail::in_quotes;

class CodevReader {
 public:
  explicit CodevReader(Import& in) : in_(in) {}

  void read(std::string_view text);

 private:
  struct Command {
    std::string_view names;
    void (CodevReader::*take)(Words);
  };
  static std::span<const Command> commands();

  void statement(std::string_view text);
  double value(Words w, std::size_t at) const { return at < w.size() ? in_.number(line_, w[0], w[at]) : 0.0; }
  double needed(Words w, std::size_t at) const {
    if (at >= w.size()) in_.refuse(line_, w[0], "missing", "a number");
    return in_.number(line_, w[0], w[at]);
  }
  CodevSurface& surface(Words w);
  CodevSurface& numbered(Words w, std::string_view word);
  std::optional<int> number_of(std::string_view word) const;

  void new_lens(Words) {}
  void radius_mode(Words w) { lens_.curvatures = w.size() > 1 && same(w[1], "N"); }
  void title(Words w) { in_.lens.imported->title = w.size() > 1 ? std::string(beginning(w[1], 4096)) : std::string(); }
  void dimension(Words);
  void aperture(Words);
  void wavelengths(Words);
  void reference(Words);
  void wavelength_weights(Words);
  void field(Words);
  void field_weights(Words);
  void vignetting(Words);
  void object(Words);
  void lens_surface(Words);
  void image(Words);
  void stop(Words w) { (w.size() > 1 ? numbered(w, w[1]) : surface(w)).stop = true; }
  void circle(Words);
  void conic(Words w) { surface(w).conic = needed(w, 1); }
  void term(Words);
  void asphere_begins(Words w) { surface(w); }
  void paraxial_image(Words) { lens_.paraxial_image = line_; }
  void tilt(Words);
  void label(Words w) { surface(w).label = w.size() > 1 ? std::string(beginning(w[1], 200)) : std::string(); }
  void thickness(Words);
  void shape(Words);
  void glass(Words);
  void reflect(Words w) { surface(w).mirror = true; }
  void cylinder(Words);
  void pickup(Words);
  void zoom(Words);
  void zoomed(Words);
  bool zoomed_values(Words);
  void private_begins(Words) { in_private_ = true; }
  void refused_surface(Words);
  void refused_edit(Words w) { in_.refuse(line_, w[0], "an edit of the lens above", "applied before saving"); }
  void not_a_shape(Words);

  void private_statement(Words);

  Import& in_;
  int line_ = 0;
  CodevLens lens_;
  bool in_private_ = false;
};

std::span<const CodevReader::Command> CodevReader::commands() {
  using C = CodevReader;
  static constexpr Command all[] = {
      {"LEN", &C::new_lens},
      {"RDM", &C::radius_mode},
      {"TIT", &C::title},
      {"DIM", &C::dimension},
      {"EPD FNO NA NAO", &C::aperture},
      {"WL", &C::wavelengths},
      {"REF", &C::reference},
      {"WTW", &C::wavelength_weights},
      {"XAN YAN XOB YOB XIM YIM XRI YRI", &C::field},
      {"WTF", &C::field_weights},
      {"VUY VLY VUX VLX", &C::vignetting},
      {"SO", &C::object},
      {"S", &C::lens_surface},
      {"SI", &C::image},
      {"STO", &C::stop},
      {"CIR", &C::circle},
      {"K", &C::conic},
      {"A B C D E F G H J IC", &C::term},
      {"ASP CON SPH", &C::asphere_begins},
      {"PIM", &C::paraxial_image},
      {"XDE YDE ZDE ADE BDE CDE DAR BEN REV RET", &C::tilt},
      {"SLB SCO", &C::label},
      {"THI", &C::thickness},
      {"RDY CUY", &C::shape},
      {"GLA GL1", &C::glass},
      {"RMD REFL", &C::reflect},
      {"CYL RDX CUX", &C::cylinder},
      {"PIK", &C::pickup},
      {"ZOO", &C::zoom},
      {"PRV", &C::private_begins},
      {"SPS XTO YTO AAS DIF GRT HOE SPL UDS NSS GRN FRE", &C::refused_surface},
      {"REX REY ELX ELY ADX ADY ARO POL XRX", &C::not_a_shape},
      {"INS SCA DEL FLY", &C::refused_edit},
  };
  return all;
}

/// Statements that do not change the lens: author, drawing, variables, derived numbers.
constexpr std::string_view silent =
    "INI CCY THC KC AC BC CC DC EC FC GC HC JC CLS DER GO CUM THM CRA NUM SET CA SUR OUT VIE EVA "
    "END CON_ WTA MFL ID TOL BUF FIE";

std::optional<int> CodevReader::number_of(std::string_view word) const {
  if (word.size() < 2 || lower(word[0]) != 's') return {};
  if (same(word, "SI")) return static_cast<int>(lens_.surfaces.size()) - 1;
  if (same(word, "SO")) return 0;
  const auto number = formats_detail::number(word.substr(1));
  if (!number || *number < 0 || *number > 1e6 || *number != std::floor(*number)) return {};
  return static_cast<int>(*number);
}

CodevSurface& CodevReader::numbered(Words w, std::string_view word) {
  const auto at = number_of(word);
  if (at && static_cast<std::size_t>(*at) < lens_.surfaces.size()) return lens_.surfaces[static_cast<std::size_t>(*at)];
  in_.refuse(line_, w[0], "surface " + in_quotes(word), "a surface defined before this line");
}

CodevSurface& CodevReader::surface(Words w) {
  if (lens_.surfaces.empty()) in_.refuse(line_, w[0], "a command before the first surface", "after a surface");
  return lens_.surfaces.back();
}

void CodevReader::dimension(Words w) {
  static constexpr std::array<std::pair<std::string_view, double>, 3> units = {{{"M", 1}, {"C", 10}, {"I", 25.4}}};
  const std::string_view word = w.size() > 1 ? w[1].substr(0, 1) : std::string_view();
  const auto found = std::ranges::find_if(units, [&](const auto& u) { return same(u.first, word); });
  if (found == units.end())
    in_.refuse(line_, "DIM", w.size() > 1 ? in_quotes(w[1]) : "empty", "M (mm), C (cm) or I (inch)");
  lens_.unit = found->second;
  in_.lens.imported->units = lens_.unit == 1 ? "mm" : lens_.unit == 10 ? "cm" : "in";
  lens_.unit_given = true;
}

void CodevReader::aperture(Words w) {
  using enum ApertureSetting;
  const ApertureSetting setting = same(w[0], "EPD")   ? entrance_pupil_diameter
                                  : same(w[0], "FNO") ? working_f_number
                                  : same(w[0], "NA")  ? image_na
                                                      : object_na;
  const double number = needed(w, 1);
  if (!(number > 0)) in_.refuse(line_, w[0], to_text(number), "positive");
  in_.lens.design.aperture = DesignAperture{setting, number};
}

void CodevReader::wavelengths(Words w) {
  auto& list = in_.lens.design.wavelengths;
  list.clear();
  for (std::size_t i = 1; i < std::min<std::size_t>(w.size(), 1000); ++i) {
    const double nm = value(w, i);
    if (!(nm >= 10 && nm <= 1e5)) in_.refuse(line_, "WL", to_text(nm), "10 to 100000 nm");
    list.push_back({nm, 1});
  }
  in_.lens.design.primary_wavelength = list.size() / 2;
}

void CodevReader::reference(Words w) {
  const double number = needed(w, 1);
  const auto count = static_cast<double>(in_.lens.design.wavelengths.size());
  if (!(number >= 1 && number <= count && number == std::floor(number))) {
    in_.refuse(line_, "REF", to_text(number), "the number of a wavelength, 1 to " + to_text(count));
  }
  in_.lens.design.primary_wavelength = static_cast<std::size_t>(number) - 1;
}

void CodevReader::wavelength_weights(Words w) {
  auto& list = in_.lens.design.wavelengths;
  for (std::size_t i = 0; i < std::min(list.size(), w.size() - 1); ++i) list[i].weight = value(w, i + 1);
}

void CodevReader::field(Words w) {
  const std::string kind = lower(w[0]);
  DesignData& design = in_.lens.design;
  design.field_kind = kind.ends_with("an")   ? FieldKind::angle_deg
                      : kind.ends_with("ob") ? FieldKind::object_height
                      : kind.ends_with("im") ? FieldKind::paraxial_image
                                             : FieldKind::real_image_height;
  const std::size_t count = std::min<std::size_t>(w.size() - 1, 1000);
  if (design.fields.size() < count) design.fields.resize(count);
  for (std::size_t i = 0; i < count; ++i) (kind[0] == 'x' ? design.fields[i].x : design.fields[i].y) = value(w, i + 1);
}

void CodevReader::field_weights(Words w) {
  auto& list = in_.lens.design.fields;
  for (std::size_t i = 0; i < std::min(list.size(), w.size() - 1); ++i) list[i].weight = value(w, i + 1);
}

void CodevReader::vignetting(Words w) {
  static constexpr std::array<std::string_view, 4> names = {"VUY", "VLY", "VUX", "VLX"};
  const auto which = std::ranges::find_if(names, [&](auto name) { return same(name, w[0]); }) - names.begin();
  const std::size_t count = std::min<std::size_t>(w.size() - 1, 1000);
  if (lens_.vignetting.size() < count) lens_.vignetting.resize(count);
  for (std::size_t i = 0; i < count; ++i) lens_.vignetting[i][static_cast<std::size_t>(which)] = value(w, i + 1);
}

void CodevReader::object(Words w) {
  if (!lens_.surfaces.empty()) in_.refuse(line_, "SO", "a second object", "a single object, before all surfaces");
  lens_surface(w);
}

void CodevReader::lens_surface(Words w) {
  if (lens_.ended) in_.refuse(line_, w[0], "a surface after SI, the image", "before SI");
  if (lens_.surfaces.empty() && !same(w[0], "SO")) in_.refuse(line_, w[0], "a surface before SO", "after SO");
  in_.limit(lens_.surfaces.size() + 1, "surfaces", 2);
  // Other programs write planes and infinite distances as "inf". Without RDM, such a number is not a curvature.
  const bool plane = w.size() > 1 && is_infinite(w[1]), endless = w.size() > 2 && is_infinite(w[2]);
  if (plane && lens_.curvatures.value_or(false)) in_.must_be(line_, w[0], in_quotes(w[1]), "a finite curvature");
  CodevSurface s{.line = line_, .shape = plane ? 0 : value(w, 1), .thickness = endless ? codev_endless : value(w, 2)};
  if (w.size() > 3) {
    if (same(w[3], "REFL") || same(w[3], "REFL.")) {
      s.mirror = true;
    } else {
      s.glass = w[3];
    }
  }
  for (std::size_t i = 4; i < w.size(); ++i) in_.warn(line_, w[0], "its word " + in_quotes(w[i]) + " is left out");
  lens_.surfaces.push_back(std::move(s));
}

void CodevReader::image(Words w) {
  lens_surface(w);
  lens_.ended = true;
}

void CodevReader::circle(Words w) {
  // CIR 5, CIR EDG 5, CIR HOL 5, CIR OBS 5, CIR S3 5, and labels L'A'.
  CodevSurface* s = nullptr;
  std::string kind;
  std::optional<double> size;
  for (std::size_t i = 1; i < w.size(); ++i) {
    if (const auto number = formats_detail::number(w[i])) {
      size = number;
    } else if (number_of(w[i])) {
      s = &numbered(w, w[i]);
    } else if (same(w[i], "EDG") || same(w[i], "HOL") || same(w[i], "OBS") || same(w[i], "CLR")) {
      kind = lower(w[i]);
    } else if (!w[i].starts_with('l') && !w[i].starts_with('L')) {  // an empty quoted word is not a label
      in_.warn(line_, "CIR", "its word " + in_quotes(w[i]) + " is left out");
    }
  }
  if (!s) s = &surface(w);
  if (!size || *size < 0) in_.refuse(line_, "CIR", size ? to_text(*size) : "missing", "a radius of at least 0");
  (kind == "edg" ? s->edge : kind == "hol" || kind == "obs" ? s->obscuration : s->aperture) = *size;
}

void CodevReader::term(Words w) {
  // A B C D E F G H J: r^4, r^6, ..., r^20. IC: true if a ray may use the alternative intersection.
  if (same(w[0], "IC")) return;
  const std::string_view letters = "abcdefghj";
  const auto order = static_cast<int>(letters.find(lower(w[0][0]))) * 2 + 4;
  const double coefficient = needed(w, 1);
  auto& terms = surface(w).aspheric;
  std::erase_if(terms, [&](const AsphereTerm& t) { return t.order == order; });
  if (coefficient != 0) terms.push_back({order, coefficient});
}

void CodevReader::tilt(Words w) {
  const bool any = w.size() < 2 || std::ranges::any_of(w.subspan(1), [](auto word) { return number(word) != 0.0; });
  if (!any) return;
  in_.refuse(line_, w[0], "a tilt or decentre", "0 (a centred lens)");
}

void CodevReader::refused_surface(Words w) {
  std::string text(w[0]);
  if (w.size() > 1) text += ' ' + std::string(w[1]);
  in_.refuse(line_, "surface", in_quotes(text), "spheres, conics and aspheres (CON, ASP), or cylinders");
}

void CodevReader::not_a_shape(Words w) {
  in_.warn(line_, w[0], "an aperture that is not round and centred is left out");
}

void CodevReader::thickness(Words w) {
  if (zoomed_values(w)) return;
  const bool named = w.size() > 1 && number_of(w[1]);
  const std::size_t at = named ? 2 : 1;
  const bool endless = at < w.size() && is_infinite(w[at]);
  (named ? numbered(w, w[1]) : surface(w)).thickness = endless ? codev_endless : needed(w, at);
}

void CodevReader::shape(Words w) {
  if (zoomed_values(w)) return;
  const bool named = w.size() > 1 && number_of(w[1]);
  const double given = needed(w, named ? 2 : 1);
  const bool is_curvature = same(w[0], "CUY");
  if (!lens_.curvatures) lens_.curvatures = is_curvature;
  const double other = given == 0 ? 0 : 1 / given;
  (named ? numbered(w, w[1]) : surface(w)).shape = is_curvature == *lens_.curvatures ? given : other;
}

void CodevReader::glass(Words w) {
  if (zoomed_values(w)) return;
  const bool named = w.size() > 2 && number_of(w[1]);
  CodevSurface& s = named ? numbered(w, w[1]) : surface(w);
  if (w.size() <= (named ? 2u : 1u)) in_.refuse(line_, "GLA", "empty", "the name of a glass");
  const std::string_view name = w[named ? 2 : 1];
  s.mirror = same(name, "REFL");
  s.glass = s.mirror ? std::string() : std::string(name);
}

void CodevReader::cylinder(Words w) {
  CodevSurface& s = surface(w);
  if (same(w[0], "CYL")) {
    s.cylinder_y = true;
    return;
  }
  const double given = needed(w, 1);
  if (given == 0) {
    s.cylinder_y = true;
  } else if (s.shape == 0) {
    s.cylinder_x = true;
    s.shape = given;
  } else {
    in_.refuse(line_, w[0], to_text(given), "0 (a cylinder); a surface curved in both sections must be a sphere");
  }
}

void CodevReader::pickup(Words w) {
  // PIK RDY S4 Z1 RDY S2 Z1 [scale]; zoom positions may be omitted.
  CodevPickup p{.line = line_};
  std::vector<double> numbers;
  for (std::size_t i = 1; i < w.size(); ++i) {
    if (const auto at = number_of(w[i])) {
      (p.surface == 0 ? p.surface : p.from) = *at;
    } else if (const auto number = formats_detail::number(w[i])) {
      numbers.push_back(*number);
    } else if (!(w[i].size() > 1 && lower(w[i][0]) == 'z' && formats_detail::number(w[i].substr(1)))) {
      (p.what.empty() ? p.what : p.of) = lower(w[i]);
    }
  }
  if (!numbers.empty()) p.scale = numbers[0];
  if (numbers.size() > 1 && numbers[1] != 0) in_.warn(line_, "PIK", "its offset is left out");
  lens_.pickups.push_back(std::move(p));
  in_.limit(lens_.pickups.size(), "pickups");
}

void CodevReader::zoom(Words w) {
  if (w.size() == 2 && number(w[1])) {
    const double count = *number(w[1]);
    if (!(count >= 1 && count <= 1000 && count == std::floor(count))) {
      in_.refuse(line_, "ZOO", to_text(count), "1 to 1000 positions");
    }
    lens_.zoom_positions = static_cast<std::size_t>(count);
    return;
  }
  if (w.size() < 3) in_.refuse(line_, "ZOO", "incomplete", "a number of positions, or a value, a surface and numbers");
  zoomed(w.subspan(1));
}

void CodevReader::zoomed(Words w) {
  CodevZoom z{.line = line_, .what = lower(w[0])};
  std::size_t first = 1;
  if (const auto at = number_of(w[1])) z.surface = *at, first = 2;
  for (std::size_t i = first; i < std::min<std::size_t>(w.size(), 1002); ++i) z.values.emplace_back(w[i]);
  lens_.zooms.push_back(std::move(z));
  in_.limit(lens_.zooms.size(), "zoomed values");
}

bool CodevReader::zoomed_values(Words w) {
  // THI S3 1 2 3, one value per position.
  if (lens_.zoom_positions < 2 || w.size() < 2 || !number_of(w[1]) || w.size() - 2 != lens_.zoom_positions)
    return false;
  zoomed(w);
  return true;
}

void CodevReader::private_statement(Words w) {
  if (same(w[0], "END")) {
    in_private_ = false;
  } else if (same(w[0], "PWL")) {
    lens_.private_nm.clear();
    for (std::size_t i = 1; i < std::min<std::size_t>(w.size(), 100); ++i) lens_.private_nm.push_back(value(w, i));
  } else {
    PrivateGlass glass{std::string(w[0]), {}};
    for (std::size_t i = 1; i < std::min<std::size_t>(w.size(), 100); ++i) glass.indices.push_back(value(w, i));
    if (lens_.private_glasses.size() < 10'000) lens_.private_glasses.push_back(std::move(glass));
  }
}

void CodevReader::statement(std::string_view text) {
  const auto w = words(text);
  if (w.empty()) return;
  if (in_private_) return private_statement(w);
  // Only the first three letters count: TITLE is TIT, LENS is LEN.
  const std::string name = upper(w[0]);
  for (const std::string& word : {name, name.substr(0, 3)}) {
    for (const Command& command : commands()) {
      const std::string_view entry = entry_of(command.names, word);
      if (entry.empty()) continue;
      std::vector<std::string_view> known = w;
      known[0] = entry;  // commands compare this spelling
      return (this->*command.take)(known);
    }
  }

  // S3 50 2 NBK7: a surface given by its number.
  if (const auto at = number_of(w[0]); at && w.size() > 1) {
    if (*at == 0 && lens_.surfaces.empty()) {
      std::vector<std::string_view> as_object(w.begin(), w.end());
      as_object[0] = "SO";
      return object(as_object);
    }
    if (static_cast<std::size_t>(*at) == lens_.surfaces.size()) return lens_surface(w);
    CodevSurface& s = numbered(w, w[0]);
    s.shape = value(w, 1);
    if (w.size() > 2) s.thickness = value(w, 2);
    if (w.size() > 3) s.glass = w[3];
    return;
  }
  if (is_one_of(name, silent) || is_one_of(std::string_view(name).substr(0, 3), silent)) return;
  in_.warn(line_, w[0], "is not known and is left out");
}

void CodevReader::read(std::string_view text) {
  for (Statements statements(text); statements.next();) {
    line_ = statements.line();
    statement(statements.text());
  }
  build_codev(std::move(lens_), in_);
}

}  // namespace

bool is_codev(std::string_view text) {
  bool object = false, surface = false, image = false;
  for (Statements statements(text); statements.next() && !(object && surface && image);) {
    const auto first = words(statements.text(), 2);
    if (first.size() < 2) continue;
    object = object || same(first[0], "SO") || same(first[0], "S0");
    surface = surface || (object && (same(first[0], "S") || same(first[0], "S1")));
    image = image || (surface && same(first[0], "SI"));
  }
  return object && surface;
}

void read_codev(std::string_view text, Import& in) { CodevReader(in).read(text); }

}  // namespace petzval::formats_detail
