// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"
#include "zemax_lens.hpp"
#include "zemax_surface.hpp"

namespace petzval::formats_detail {
namespace {

using Words = std::span<const std::string_view>;
using io_detail::in_quotes;

constexpr std::size_t most_operands = 100'000;

/// Commands that do not change the lens: windows, tolerances, analyses, coatings, colours and polarisation; variables
/// of the optimisation; pickups and solves, whose results are in the file.
constexpr std::string_view silent =
    // the file and its author
    "VERS PFIL LANG AUTH CSUM LUID BLNK "
    // rays and the pupil; pupil data that follow from the lens
    "RAIM PUSH SDMA OMMA ROPD HYPR PICB GFAC GLRS GSTD NSCD PUPD ZVDX ZVDY ZVCX ZVCY ZVAN "
    // coatings, polarisation, scattering, physical optics
    "POLS COFN POPS FIMP MEMA "
    // drawing and rows of the editor
    "HIDE MIRR SLAB SSID SCOL UDAD UNCO "
    // variables, pickups and solves
    "VDSZ VPAR VCON PPAR PCON PKUP EDGE TCED "
    // merit function and tolerances
    "DMFS EFFL CONF RAYS TOL TCMM";

class ZemaxReader {
 public:
  explicit ZemaxReader(Import& in) : in_(in) {}

  void read(std::string_view text);

 private:
  struct Command {
    std::string_view names;
    void (ZemaxReader::*take)(Words);
  };
  static std::span<const Command> of_file();
  static std::span<const Command> of_surfaces();

  bool take(std::span<const Command> commands, Words words);
  void unknown(Words words);
  void name_unknown();
  /// Number at a position in a line, in which the command is word 0; 0 if missing.
  double value(Words words, std::size_t at) const {
    return at < words.size() ? in_.number(line_, words[0], words[at]) : 0.0;
  }
  double length(Words words, std::size_t at) const { return value(words, at) * unit_; }
  /// A number that must be present.
  double stated(Words words, std::size_t at) const;
  int whole(Words words, std::size_t at, int least, int most) const;
  ZemaxSurface& surface() { return lens_.surfaces.back(); }
  std::string rest() const;
  void fields(Words words, double DesignField::*member);
  void wavelength(std::size_t number, double micrometres, double weight);
  void aperture(Words words, ApertureSetting setting, double scale);

  // Commands of the file.
  void mode(Words);
  void title(Words) { in_.lens.imported->title = rest(); }
  void note(Words);
  void end_note();
  void unit(Words);
  void entrance_pupil(Words w) { aperture(w, ApertureSetting::entrance_pupil_diameter, unit_); }
  void f_number(Words w);
  void object_aperture(Words w);
  void float_by_stop(Words w) { aperture(w, ApertureSetting::stop_size, 0); }
  void environment(Words);
  void catalogues(Words);
  void field_type(Words);
  void x_fields(Words w) { fields(w, &DesignField::x); }
  void y_fields(Words w) { fields(w, &DesignField::y); }
  void field_weights(Words w) { fields(w, &DesignField::weight); }
  void decentre_x(Words w) { fields(w, &DesignField::decentre_x); }
  void decentre_y(Words w) { fields(w, &DesignField::decentre_y); }
  void compress_x(Words w) { fields(w, &DesignField::compress_x); }
  void compress_y(Words w) { fields(w, &DesignField::compress_y); }
  void field_angles(Words w) { fields(w, &DesignField::angle_deg); }
  void wavelength_row(Words);
  void wavelength_list(Words);
  void wavelength_weights(Words);
  void primary(Words);
  void new_surface(Words);
  void configurations(Words);

  // Commands of a surface.
  void type(Words w) { surface().type = w.size() > 1 ? std::string(w[1]) : std::string(); }
  void curvature(Words);
  void conic(Words w) { surface().conic = stated(w, 1); }
  void parameter(Words w) { surface().parameters[whole(w, 1, 0, 1000)] = stated(w, 2); }
  void extra(Words w) { surface().extra[whole(w, 1, 0, 1000)] = stated(w, 2); }
  void thickness(Words);
  void glass(Words);
  void semi_diameter(Words);
  void clear_aperture(Words);
  void obscuration(Words);
  void decentred_aperture(Words);
  void other_aperture(Words);
  void stop(Words) { surface().stop = true; }
  void comment(Words) { surface().comment = rest(); }
  void coating(Words w) {
    surface().coating = w.size() > 1 ? std::string(beginning(w[1], 60)) : std::string();
    surface().coating_line = line_;
  }
  void thickness_pickup(Words);
  void marginal_height(Words);
  void thickness_sum(Words);
  void position(Words);

  Import& in_;
  ZemaxLens lens_;
  int line_ = 0;
  std::string_view text_;  ///< current line
  double unit_ = 1;        ///< mm
  std::size_t field_count_ = 0, wavelength_count_ = 0;
  std::string note_;
  struct Unknown {
    std::string name;
    int line = 0;  ///< first line
    std::size_t lines = 0;
  };
  std::vector<Unknown> unknown_;
  bool in_configurations_ = false, unit_given_ = false;
};

std::span<const ZemaxReader::Command> ZemaxReader::of_file() {
  using Z = ZemaxReader;
  static constexpr Command commands[] = {
      {"MODE", &Z::mode},
      {"NAME", &Z::title},
      {"NOTE", &Z::note},
      {"UNIT", &Z::unit},
      {"ENPD", &Z::entrance_pupil},
      {"FNUM", &Z::f_number},
      {"OBNA", &Z::object_aperture},
      {"FLOA", &Z::float_by_stop},
      {"ENVD", &Z::environment},
      {"GCAT", &Z::catalogues},
      {"FTYP", &Z::field_type},
      {"XFLN XFLD", &Z::x_fields},
      {"YFLN YFLD", &Z::y_fields},
      {"FWGN FWGT", &Z::field_weights},
      {"VDXN", &Z::decentre_x},
      {"VDYN", &Z::decentre_y},
      {"VCXN", &Z::compress_x},
      {"VCYN", &Z::compress_y},
      {"VANN", &Z::field_angles},
      {"WAVM", &Z::wavelength_row},
      {"WAVL WAVN", &Z::wavelength_list},
      {"WWGT WWGN WEIG", &Z::wavelength_weights},
      {"PWAV", &Z::primary},
      {"SURF", &Z::new_surface},
      {"MNUM", &Z::configurations},
  };
  return commands;
}

std::span<const ZemaxReader::Command> ZemaxReader::of_surfaces() {
  using Z = ZemaxReader;
  static constexpr Command commands[] = {
      {"TYPE", &Z::type},
      {"CURV", &Z::curvature},
      {"CONI", &Z::conic},
      {"PARM", &Z::parameter},
      {"XDAT", &Z::extra},
      {"DISZ", &Z::thickness},
      {"GLAS", &Z::glass},
      {"DIAM", &Z::semi_diameter},
      {"CLAP FLAP", &Z::clear_aperture},
      {"OBSC", &Z::obscuration},
      {"OBDC", &Z::decentred_aperture},
      {"SQAP SQOB ELAP ELOB SPID UDAP UDOB", &Z::other_aperture},
      {"STOP", &Z::stop},
      {"COMM", &Z::comment},
      {"COAT", &Z::coating},
      {"PZUP", &Z::thickness_pickup},
      {"MAZH", &Z::marginal_height},
      {"TCOM", &Z::thickness_sum},
      {"TOLE", &Z::position},
  };
  return commands;
}

void ZemaxReader::read(std::string_view text) {
  for (Lines lines(text); lines.next();) {
    line_ = lines.number(), text_ = lines.text();
    const auto all = words(text_);
    if (all.empty()) continue;
    if (entry_of(silent, all[0]) == all[0]) continue;
    if (!lens_.surfaces.empty() && !in_configurations_ && take(of_surfaces(), all)) continue;
    if (take(of_file(), all)) continue;
    unknown(all);
  }
  end_note();
  name_unknown();
  if (!unit_given_) in_.warn(0, "UNIT", "is missing; lengths are taken as millimetres");
  if (lens_.surfaces.size() < 3) {
    throw Error(in_.where() + ": " + std::to_string(lens_.surfaces.size()) +
                " surfaces; must be an object, at least one lens surface and an image");
  }
  DesignData& design = in_.lens.design;
  design.fields.resize(std::min(design.fields.size(), std::max<std::size_t>(field_count_, 1)));
  if (design.field_kind != FieldKind::angle_deg) {
    for (DesignField& field : design.fields) field.x *= unit_, field.y *= unit_;
  }
  if (wavelength_count_ > 0 && design.wavelengths.size() > wavelength_count_) {
    design.wavelengths.resize(wavelength_count_);
  }
  if (design.primary_wavelength >= std::max<std::size_t>(design.wavelengths.size(), 1)) {
    in_.warn(0, "PWAV", "is not the number of a wavelength; the first is taken");
    design.primary_wavelength = 0;
  }
  build_lens(std::move(lens_), unit_, in_);
}

bool ZemaxReader::take(std::span<const Command> commands, Words words) {
  const auto found =
      std::ranges::find_if(commands, [&](const Command& c) { return entry_of(c.names, words[0]) == words[0]; });
  if (found == commands.end()) return false;
  (this->*found->take)(words);
  return true;
}

void ZemaxReader::unknown(Words words) {
  if (in_configurations_ && words.size() >= 4) {
    if (lens_.operands.size() >= most_operands) {
      throw Error(in_.where() + ": more than " + std::to_string(most_operands) +
                  " values of configurations; must be fewer");
    }
    lens_.operands.push_back({line_, std::string(words[0]), whole(words, 1, 0, 100'000), whole(words, 2, 0, 100'000),
                              std::string(words[3])});
    return;
  }
  // An operand of the merit function: four letters and at least eight numbers.
  const bool operand = !lens_.surfaces.empty() && words[0].size() == 4 && words.size() >= 9 &&
                       std::ranges::all_of(words.subspan(1, 8), [](auto word) { return number(word).has_value(); });
  if (operand) return;
  const auto known = std::ranges::find(unknown_, words[0], &Unknown::name);
  if (known != unknown_.end()) {
    ++known->lines;
  } else if (unknown_.size() < 100) {
    unknown_.push_back({std::string(words[0]), line_, 1});
  } else {
    in_.warn(line_, words[0], "is not known and is left out");
  }
}

/// Warns once per unknown command.
void ZemaxReader::name_unknown() {
  for (const Unknown& u : unknown_) {
    in_.warn(u.line, u.name,
             "is not known and is left out" +
                 (u.lines > 1 ? ", here and in " + std::to_string(u.lines - 1) + " more lines" : std::string()));
  }
}

double ZemaxReader::stated(Words words, std::size_t at) const {
  if (at >= words.size()) in_.refuse(line_, words[0], "missing", "a number");
  return value(words, at);
}

int ZemaxReader::whole(Words words, std::size_t at, int least, int most) const {
  const double number = value(words, at);
  if (number >= least && number <= most && number == std::floor(number)) return static_cast<int>(number);
  in_.refuse(line_, words[0], to_text(number),
             "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

/// The text after the command.
std::string ZemaxReader::rest() const {
  const std::string_view line = trimmed(text_);
  const std::string_view behind = trimmed(line.substr(std::min(line.find_first_of(" \t"), line.size())));
  return std::string(beginning(behind, 4096));
}

void ZemaxReader::fields(Words words, double DesignField::*member) {
  auto& list = in_.lens.design.fields;
  const std::size_t count = std::min<std::size_t>(words.size() - 1, 1000);
  if (list.size() < count) list.resize(count);
  for (std::size_t i = 0; i < count; ++i) list[i].*member = value(words, i + 1);
}

void ZemaxReader::aperture(Words words, ApertureSetting setting, double scale) {
  auto& aperture = in_.lens.design.aperture;
  if (aperture && aperture->setting != setting) {
    in_.warn(line_, words[0], "is a second aperture; it is taken, the first is left out");
  }
  // The size of the stop is stated at its surface.
  aperture = DesignAperture{setting, setting == ApertureSetting::stop_size ? 0 : stated(words, 1) * scale};
}

void ZemaxReader::mode(Words words) {
  if (words.size() > 1 && words[1] == "SEQ") return;
  in_.refuse(line_, "MODE", words.size() > 1 ? in_quotes(words[1]) : "empty", "SEQ, a sequential lens");
}

void ZemaxReader::note(Words) {
  // "NOTE 0 text" continues the previous line, "NOTE 4" ends a paragraph.
  constexpr std::size_t max_note_size = 65'536;
  const std::string text = rest();
  if (text.starts_with("0")) {
    const bool blank = text.size() > 1 && (text[1] == ' ' || text[1] == '\t');
    if (note_.size() < max_note_size) note_ += text.substr(blank ? 2 : 1);
  } else {
    end_note();
  }
}

void ZemaxReader::end_note() {
  auto& notes = in_.lens.imported->notes;
  if (!note_.empty() && notes.size() < 1000) notes.push_back(std::exchange(note_, {}));
}

void ZemaxReader::unit(Words words) {
  static constexpr std::array<std::pair<std::string_view, double>, 6> units = {
      {{"MM", 1}, {"CM", 10}, {"IN", 25.4}, {"METER", 1000}, {"M", 1000}, {"METERS", 1000}}};
  const auto found = std::ranges::find(units, words.size() > 1 ? words[1] : std::string_view(),
                                       [](const auto& entry) { return entry.first; });
  if (found == units.end()) {
    in_.refuse(line_, "UNIT", words.size() > 1 ? in_quotes(words[1]) : "empty", "MM, CM, IN or METER");
  }
  if (!lens_.surfaces.empty()) in_.refuse(line_, "UNIT", "a command after the first surface", "before all surfaces");
  // Rescale a length that was read before the unit.
  if (auto& set = in_.lens.design.aperture; set && set->setting == ApertureSetting::entrance_pupil_diameter) {
    set->value *= found->second / unit_;
  }
  unit_ = found->second;
  unit_given_ = true;
  in_.lens.imported->units = unit_ == 1 ? "mm" : unit_ == 10 ? "cm" : unit_ == 25.4 ? "in" : "m";
}

void ZemaxReader::f_number(Words words) {
  aperture(words, value(words, 2) == 1 ? ApertureSetting::working_f_number : ApertureSetting::f_number, 1);
}

void ZemaxReader::object_aperture(Words words) {
  // The second number is 1 if the first number is an angle.
  const bool angle = value(words, 2) == 1;
  aperture(words, ApertureSetting::object_na, 1);
  if (angle) in_.lens.design.aperture->value = std::sin(value(words, 1) * std::acos(-1.0) / 180);
}

void ZemaxReader::environment(Words words) {
  const double celsius = value(words, 1), atmospheres = value(words, 2);
  if (celsius == 20 && atmospheres == 1) return;
  in_.warn(line_, "ENVD",
           to_text(celsius) + " degrees and " + to_text(atmospheres) +
               " atm are left out; indices apply to 20 degrees and 1 atm");
}

void ZemaxReader::catalogues(Words words) {
  for (const auto name : words.subspan(1)) {
    if (lens_.catalogues.size() < 100) lens_.catalogues.emplace_back(name);
  }
}

void ZemaxReader::field_type(Words words) {
  const int kind = whole(words, 1, 0, 10);
  if (kind > 3) {
    in_.warn(line_, "FTYP", "field type " + std::to_string(kind) + " is not known; fields are left out");
    field_count_ = 0;
  } else {
    in_.lens.design.field_kind = std::array{FieldKind::angle_deg, FieldKind::object_height, FieldKind::paraxial_image,
                                            FieldKind::real_image_height}[static_cast<std::size_t>(kind)];
    field_count_ = static_cast<std::size_t>(whole(words, 3, 0, 1000));
  }
  if (value(words, 2) != 0) lens_.telecentric = line_;
  wavelength_count_ = static_cast<std::size_t>(whole(words, 4, 0, 1000));
}

void ZemaxReader::wavelength(std::size_t number, double micrometres, double weight) {
  auto& list = in_.lens.design.wavelengths;
  if (list.size() <= number) list.resize(number + 1, {.nm = 550});
  if (!(micrometres >= 0.01 && micrometres <= 100)) {
    in_.refuse(line_, "wavelength", to_text(micrometres) + " um", "0.01 to 100 um");
  }
  // Micrometres have few decimals; remove the rounding of the product with 1000.
  list[number] = {*formats_detail::number(to_text(micrometres * 1000, 12)), weight};
}

void ZemaxReader::wavelength_row(Words words) {
  wavelength(static_cast<std::size_t>(whole(words, 1, 1, 1000)) - 1, value(words, 2),
             words.size() > 3 ? value(words, 3) : 1);
}

void ZemaxReader::wavelength_list(Words words) {
  for (std::size_t i = 1; i < std::min<std::size_t>(words.size(), 1000); ++i) wavelength(i - 1, value(words, i), 1);
}

void ZemaxReader::wavelength_weights(Words words) {
  auto& list = in_.lens.design.wavelengths;
  for (std::size_t i = 0; i < std::min(list.size(), words.size() - 1); ++i) list[i].weight = value(words, i + 1);
}

void ZemaxReader::primary(Words words) {
  in_.lens.design.primary_wavelength = static_cast<std::size_t>(whole(words, 1, 1, 1000)) - 1;
}

void ZemaxReader::new_surface(Words words) {
  const int number = whole(words, 1, 0, 1'000'000);
  in_.limit(lens_.surfaces.size() + 1, "surfaces", 2);
  const int next = lens_.surfaces.empty() ? 0 : surface().number + 1;
  if (number < next || (number > 0 && next == 0)) {
    in_.refuse(line_, "SURF", std::to_string(number), std::to_string(next) + ", the next number");
  }
  if (number > next) {
    in_.warn(line_, "SURF",
             std::to_string(number) + " follows " + std::to_string(next - 1) + "; no surface is between");
  }
  lens_.surfaces.emplace_back();
  surface().line = line_;
  surface().number = number;
}

void ZemaxReader::configurations(Words words) {
  lens_.configurations = whole(words, 1, 1, 1000);
  in_configurations_ = true;
}

void ZemaxReader::curvature(Words words) {
  ZemaxSurface& s = surface();
  s.curvature = stated(words, 1) / unit_;
  // For other solves, the file states the results.
  if (const int solve = words.size() > 2 ? whole(words, 2, 0, 100) : 0; solve == 4) {
    s.curvature_pickup = ZemaxPickup{line_, whole(words, 3, 0, 100'000), value(words, 4), value(words, 5) / unit_};
  }
}

void ZemaxReader::thickness(Words words) {
  if (surface().has_thickness) in_.warn(line_, "DISZ", "is given twice for a surface; the last is taken");
  surface().has_thickness = true;
  if (words.size() > 1 && same(words[1], "INFINITY")) {
    surface().thickness = std::numeric_limits<double>::infinity();
  } else {
    surface().thickness = stated(words, 1) * unit_;
  }
}

void ZemaxReader::glass(Words words) {
  if (words.size() < 2) in_.refuse(line_, "GLAS", "empty", "the name of a glass");
  ZemaxGlass glass{.line = line_, .name = std::string(words[1])};
  const int mode = words.size() > 2 ? whole(words, 2, 0, 100) : 0;
  // Words: name, solve type (0 fixed, 1 model, 2 pickup, 4 offset), surface of a pickup, n_d, V_d, dPgF, three flags of
  // variables, offsets of n_d and V_d. n_d and V_d are valid for a model. For other types they are values of an earlier
  // model, or 1.5 and 40.
  glass.model = mode == 1 || glass.name == "___BLANK";
  const double nd = value(words, 4), vd = value(words, 5);
  const bool known = nd != 0 && (glass.model || !(nd == 1.5 && vd == 40));
  if (known) glass.nd = nd;
  // A model with V_d = 0 has the same index at all wavelengths.
  if (known && (vd > 0 || (glass.model && vd == 0))) glass.vd = vd;
  if (mode == 2) glass.pickup = whole(words, 3, 0, 100'000);
  if (mode == 4) glass.nd_offset = value(words, 10), glass.vd_offset = value(words, 11);
  surface().glass = std::move(glass);
}

void ZemaxReader::semi_diameter(Words words) {
  surface().semi_diameter = std::abs(stated(words, 1) * unit_);
  surface().fixed_semi_diameter = words.size() > 2 && value(words, 2) != 0;
}

void ZemaxReader::clear_aperture(Words words) {
  const double inner = length(words, 1), outer = length(words, 2);
  if (outer > 0) surface().aperture = outer;
  if (inner > 0) surface().obscuration = inner;
}

void ZemaxReader::obscuration(Words words) {
  const double inner = length(words, 1), outer = length(words, 2);
  if (inner > 0 && outer > inner) {
    surface().ring = ZemaxRing{line_, inner, outer};
  } else if (outer > 0 && inner <= 0) {
    surface().obscuration = outer;
  }
}

void ZemaxReader::decentred_aperture(Words words) {
  if (value(words, 1) == 0 && value(words, 2) == 0) return;
  in_.warn(line_, "OBDC", "the aperture is decentred; it is taken as centred");
}

void ZemaxReader::other_aperture(Words words) {
  in_.warn(line_, words[0], "an aperture that is not round is left out; the semi-diameter is taken");
}

void ZemaxReader::thickness_pickup(Words words) {
  // Pickups of a curvature or a glass are on the line of the value; for a thickness, the offset is the third number.
  surface().thickness_pickup = ZemaxPickup{line_, whole(words, 1, 0, 100'000), value(words, 2), length(words, 3)};
}

void ZemaxReader::marginal_height(Words words) {
  surface().marginal_height = {length(words, 1), value(words, 2)};
  surface().solve_line = line_;
}

void ZemaxReader::thickness_sum(Words words) {
  surface().thickness_sum = ZemaxPickup{line_, whole(words, 1, 0, 100'000), 1, length(words, 2)};
}

void ZemaxReader::position(Words words) {
  surface().position = ZemaxPickup{line_, whole(words, 1, 0, 100'000), 1, length(words, 2)};
}

}  // namespace

bool is_zemax(std::string_view text) {
  bool surface = false, begins = false;
  for (Lines lines(text); lines.next() && !(surface && begins);) {
    const auto first = words(lines.text(), 2);
    if (first.empty()) continue;
    surface = surface || (first[0] == "SURF" && first.size() > 1 && number(first[1]));
    begins = begins || first[0] == "VERS" || first[0] == "MODE" || first[0] == "UNIT" || first[0] == "DISZ";
  }
  return surface && begins;
}

void read_zemax(std::string_view text, Import& in) { ZemaxReader(in).read(text); }

}  // namespace petzval::formats_detail
