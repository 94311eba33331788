// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "core/text.hpp"
#include "glass_names.hpp"
#include "import.hpp"
#include "petzval/core/error.hpp"
#include "text_file.hpp"
#include "written_lens.hpp"

namespace petzval {
namespace {

using namespace formats_detail;

class ZemaxWriter {
 public:
  ZemaxWriter(const Prescription& p, const GlassCatalogue* glasses) : out_(p, glasses), p_(out_.lens()) {}

  ExportedLens write() {
    out_.refuse_closed_rims(".zmx");
    out_.lose_the_wider_stop();
    out_.state_indices_at_d();
    header();
    fields();
    wavelengths();
    object();
    for (std::size_t i = 0; i < p_.surfaces.size(); ++i) surface(i);
    start(p_.surfaces.size() + 1, "STANDARD", 0, 0);
    configurations();
    return out_.take();
  }

 private:
  void header();
  void choose_catalogues();
  const Glass* resolved(const Glass& glass);
  const Glass* table_glass(const Medium& medium);
  void aperture();
  void fields();
  void wavelengths();
  void object();
  void surface(std::size_t i);
  void start(std::size_t number, const std::string& type, double curvature, double thickness);
  std::string shape(std::size_t i);
  std::string glass(const Medium& medium);
  std::string glass_name(const Medium& medium);
  void configurations();

  Writer out_;
  const Prescription& p_;
  std::vector<std::string> catalogues_;  ///< GCAT
  std::optional<GlassNames> names_;      ///< names in the tables; filled with the first glass
};

void ZemaxWriter::header() {
  out_.line("VERS 140730 0 0");
  out_.line("MODE SEQ");
  out_.line("NAME " + one_line(p_.name));
  out_.lose_nominal_data(true, {"source_design", p_.design.fields.empty() ? "half_field_deg" : ""});
  if (!p_.source_design.empty()) out_.line("NOTE 0 " + one_line(p_.source_design));
  out_.line("UNIT MM X W X CM MR CPMM");
  aperture();
  out_.line("ENVD 20 1 0");
  choose_catalogues();
  std::string catalogues = "GCAT";
  for (const std::string& maker : catalogues_) catalogues += ' ' + maker;
  if (!catalogues_.empty()) out_.line(catalogues);
}

/// The medium of a code of n_d and V_d; nullopt if the medium has another name or other numbers.
std::optional<Medium> code_of(const Medium& medium) {
  const auto code = medium_of_code(medium.glass.value_or(""));
  return code && code->nd == medium.nd && code->vd == medium.vd ? code : std::nullopt;
}

/// The glass of a medium in the tables; null if absent. Names that are codes are no glasses in a .zmx, although tables
/// of 1983 have such names.
const Glass* ZemaxWriter::table_glass(const Medium& medium) {
  return medium_of_code(medium.glass.value_or("")) ? nullptr : out_.glass(medium);
}

/// Orders the makers of all glasses so that readers find the right glass for each name, if possible.
void ZemaxWriter::choose_catalogues() {
  std::vector<const Glass*> used;
  std::set<std::string> unknown;
  const auto use = [&](const Medium& medium) {
    const Glass* found = table_glass(medium);
    if (!found && medium.glass && !code_of(medium)) unknown.insert(*medium.glass);
    if (found && std::ranges::find(used, found) == used.end()) used.push_back(found);
  };
  use(p_.object_space);
  for (const SurfaceRow& row : p_.surfaces) use(row.medium);
  for (const Configuration& c : p_.configurations) {
    for (const SurfaceChange& change : c.changes) use(change.medium.value_or(Medium{}));
  }
  const auto maker_of = [](const Glass& g) { return one_word(upper(g.catalogue.substr(0, g.catalogue.find('-')))); };
  std::set<std::string> makers;
  for (const Glass* glass : used) makers.insert(maker_of(*glass));
  catalogues_.assign(makers.begin(), makers.end());
  // If an earlier maker has another glass of the same name, the maker of this glass moves before the earlier maker.
  for (std::size_t moves = 0; moves < catalogues_.size() * catalogues_.size(); ++moves) {
    const auto hidden = std::ranges::find_if(used, [&](const Glass* g) { return resolved(*g) != g; });
    if (hidden == used.end()) break;
    const auto own = std::ranges::find(catalogues_, maker_of(**hidden));
    const auto other = std::ranges::find(catalogues_, maker_of(*resolved(**hidden)));
    if (other < own) std::rotate(other, own, own + 1);
  }
  std::string names;
  for (const std::string& name : unknown) append(names, ", ", name);
  if (!names.empty()) out_.lose("glass", "names in no table become models of n_d and V_d: " + names);
  for (const Glass* glass : used) {
    if (const Glass* other = resolved(*glass); other != glass) {
      out_.lose("glass", describe(*glass) + " becomes " + describe(*other) + " with an offset of its index");
    }
  }
}

/// The glass that a reader of the .zmx finds for the name of a glass.
const Glass* ZemaxWriter::resolved(const Glass& glass) {
  if (!names_) names_.emplace(out_.glasses());
  const Glass* found = names_->find(one_word(glass.name), catalogues_, {}, Numbers::leftovers);
  return found ? found : &glass;
}

void ZemaxWriter::aperture() {
  const auto& set = p_.design.aperture;
  const std::string value = set ? to_text(set->value) : std::string();
  if (!set || set->setting == ApertureSetting::stop_size) return out_.line("FLOA 0 0");
  switch (set->setting) {
    case ApertureSetting::entrance_pupil_diameter: return out_.line("ENPD " + value);
    case ApertureSetting::f_number: return out_.line("FNUM " + value + " 0");
    case ApertureSetting::working_f_number: return out_.line("FNUM " + value + " 1");
    case ApertureSetting::object_na: return out_.line("OBNA " + value + " 0");
    default: break;
  }
  out_.lose("aperture", "given by the numerical aperture of the image side becomes the size of the stop");
  out_.line("FLOA 0 0");
}

void ZemaxWriter::fields() {
  std::vector<DesignField> fields = p_.design.fields;
  FieldKind kind = p_.design.field_kind;
  if (fields.empty()) {
    fields = {{}};
    kind = FieldKind::angle_deg;
    if (p_.half_field_deg)
      fields.push_back({.y = 0.7 * *p_.half_field_deg}), fields.push_back({.y = *p_.half_field_deg});
  }
  if (fields.size() > 12) out_.lose("fields", "all but the first 12 are lost"), fields.resize(12);
  const std::size_t waves = std::max<std::size_t>(p_.design.wavelengths.size(), 1);
  out_.line("FTYP " + std::to_string(static_cast<int>(kind)) + " 0 " + std::to_string(fields.size()) + ' ' +
            std::to_string(std::min<std::size_t>(waves, 24)) + " 0 0 0");
  const auto row = [&](const char* name, double DesignField::*member) {
    std::string line = name;
    for (std::size_t i = 0; i < 12; ++i) line += ' ' + to_text(i < fields.size() ? fields[i].*member : 0.0);
    out_.line(line);
  };
  row("XFLN", &DesignField::x);
  row("YFLN", &DesignField::y);
  row("FWGN", &DesignField::weight);
  row("VDXN", &DesignField::decentre_x);
  row("VDYN", &DesignField::decentre_y);
  row("VCXN", &DesignField::compress_x);
  row("VCYN", &DesignField::compress_y);
  row("VANN", &DesignField::angle_deg);
}

void ZemaxWriter::wavelengths() {
  std::vector<DesignWavelength> waves = p_.design.wavelengths;
  if (waves.empty()) waves = {{p_.reference_wavelength_nm, 1}};
  std::size_t primary = std::min(p_.design.primary_wavelength, waves.size() - 1);
  if (waves.size() > 24) {
    out_.lose("wavelengths",
              primary < 24 ? "all but the first 24 are lost" : "all but 23 and the primary wavelength are lost");
    if (primary >= 24) waves[23] = waves[primary], primary = 23;
    waves.resize(24);
  }
  for (std::size_t i = 0; i < waves.size(); ++i) {
    out_.line("WAVM " + std::to_string(i + 1) + ' ' + to_text(waves[i].nm / 1000, 15) + ' ' + to_text(waves[i].weight));
  }
  out_.line("PWAV " + std::to_string(primary + 1));
}

void ZemaxWriter::start(std::size_t number, const std::string& type, double curvature, double thickness) {
  out_.line("SURF " + std::to_string(number));
  out_.line("  TYPE " + type);
  out_.line("  CURV " + to_text(curvature) + " 0 0 0 0 \"\"");
  out_.line("  DISZ " + (std::isfinite(thickness) ? to_text(thickness) : std::string("INFINITY")));
}

void ZemaxWriter::object() {
  start(0, "STANDARD", 0, p_.design.object_distance_mm);
  if (p_.object_space != Medium{}) out_.line("  GLAS " + glass(p_.object_space));
}

/// Name of a medium's glass; empty if it has no name.
std::string ZemaxWriter::glass_name(const Medium& medium) {
  if (medium == Medium{}) return "AIR";
  if (code_of(medium)) return *medium.glass;
  const Glass* found = table_glass(medium);
  return found ? one_word(found->name) : std::string();
}

std::string ZemaxWriter::glass(const Medium& medium) {
  const Glass* found = table_glass(medium);
  if (!found) {
    const Glass* named = out_.glass(medium);
    return (code_of(medium) ? *medium.glass + " 0 0 " : "___BLANK 1 0 ") + to_text(out_.index(medium)) + ' ' +
           to_text(medium.vd.value_or(named ? named->vd : 0)) + " 0 0 0 0 0 0";
  }
  const Glass* meant = resolved(*found);
  const std::string numbers = " 0 " + to_text(meant->nd) + ' ' + to_text(meant->vd) + " 0 0 0 0 ";
  if (!medium.nd && meant == found) return one_word(found->name) + " 0" + numbers + "0 0";
  // If the n_d printed in a table differs from the catalogue, type 4 states the offset.
  const double offset = medium.nd.value_or(refractive_index(*found, d_line_nm)) - refractive_index(*meant, d_line_nm);
  return one_word(found->name) + " 4" + numbers + to_text(offset) + " 0";
}

/// The type of a surface; its terms are lines after CURV.
std::string ZemaxWriter::shape(std::size_t i) {
  const SurfaceRow& row = p_.surfaces[i];
  if (row.curved_in == Section::x) out_.refuse(i, "a cylinder curved along x", "a cylinder curved along y for a .zmx");
  if (row.curved_in == Section::y) {
    if (row.conic != 0 || !row.aspheric.empty()) out_.refuse(i, "an aspheric cylinder", "circular for a .zmx");
    return "TOROIDAL";
  }
  if (row.aspheric.empty()) return "STANDARD";
  int highest = 0;
  bool odd = false;
  for (const AsphereTerm& term : row.aspheric)
    highest = std::max(highest, term.order), odd = odd || term.order % 2 != 0;
  return odd ? (highest <= 8 ? "ODDASPHE" : "XOSPHERE") : (highest <= 16 ? "EVENASPH" : "XASPHERE");
}

void ZemaxWriter::surface(std::size_t i) {
  const SurfaceRow& row = p_.surfaces[i];
  const std::string type = shape(i);
  start(i + 1, type, row.radius == 0 ? 0 : 1 / row.radius, row.thickness);
  if (row.stop) out_.line("  STOP");
  if (row.comment) out_.line("  COMM " + one_line(*row.comment));
  if (type == "TOROIDAL") out_.line("  PARM 1 0");
  if (type == "EVENASPH" || type == "ODDASPHE") {
    for (const AsphereTerm& term : row.aspheric) {
      out_.line("  PARM " + std::to_string(type == "EVENASPH" ? term.order / 2 : term.order) + ' ' +
                to_text(term.coefficient));
    }
  }
  if (type == "XASPHERE" || type == "XOSPHERE") {
    const int step = type == "XASPHERE" ? 2 : 1;
    int highest = 0;
    for (const AsphereTerm& term : row.aspheric) highest = std::max(highest, term.order);
    const auto extra = [&](int number, double value) {
      out_.line("  XDAT " + std::to_string(number) + ' ' + to_text(value) + " 0 0 1 0 0 \"\"");
    };
    extra(1, highest / step);
    extra(2, 1);
    for (const AsphereTerm& term : row.aspheric) extra(term.order / step + 2, term.coefficient);
  }
  if (row.mirror) {
    out_.line("  GLAS MIRROR 0 0 1.5 40 0 0 0 0 0 0");
  } else if (row.medium != Medium{}) {
    out_.line("  GLAS " + glass(row.medium));
  }
  if (row.conic != 0) out_.line("  CONI " + to_text(row.conic));
  if (row.semi_diameter && std::isfinite(*row.semi_diameter) && !row.semi_diameter_computed) {
    out_.line("  DIAM " + to_text(*row.semi_diameter) + " 1 0 0 1 \"\"");
    const double inner = row.obscuration_semi_diameter.value_or(0);
    out_.line((inner > 0 ? "  CLAP " : "  FLAP ") + to_text(inner) + ' ' + to_text(*row.semi_diameter) + " 0");
  } else if (row.obscuration_semi_diameter.value_or(0) > 0) {
    out_.line("  OBSC 0 " + to_text(*row.obscuration_semi_diameter) + " 0");
  }
}

void ZemaxWriter::configurations() {
  const auto& list = p_.configurations;
  if (list.size() < 2) return;
  out_.line("MNUM " + std::to_string(list.size()) + " 1");
  // All values of an operand are adjacent; a configuration without a change gets the value of the rows.
  const auto operand = [&](const std::string& name, int surface,
                           const std::function<std::string(const Configuration&)>& value) {
    for (std::size_t c = 0; c < list.size(); ++c) {
      out_.line(name + ' ' + std::to_string(surface) + ' ' + std::to_string(c + 1) + ' ' + value(list[c]) +
                " 0 0 0 1 1 0 0 0 \"\" 0");
    }
  };
  operand("LTTL", 0, [&](const Configuration& c) { return '"' + one_word(c.name) + '"'; });
  const auto far = [](const Configuration& c) { return !c.subject_distance_mm || std::isinf(*c.subject_distance_mm); };
  if (!std::ranges::all_of(list, far)) {
    operand("THIC", 0, [&](const Configuration& c) { return far(c) ? "1e10" : to_text(*c.subject_distance_mm); });
  }
  const auto changes = [&](const char* name, const auto& member, const auto& of_row, const auto& words) {
    std::set<int> surfaces;
    for (const Configuration& c : list) {
      for (const SurfaceChange& change : c.changes) {
        if (change.*member) surfaces.insert(change.surface);
      }
    }
    for (const int s : surfaces) {
      const auto word = [&](const Configuration& c) {
        const auto found = std::ranges::find(c.changes, s, &SurfaceChange::surface);
        const bool given = found != c.changes.end() && ((*found).*member).has_value();
        return words(given ? *((*found).*member) : of_row(p_.surfaces[static_cast<std::size_t>(s)]));
      };
      if (std::ranges::any_of(list, [&](const Configuration& c) { return word(c).empty(); })) {
        out_.lose("configurations", "the glass of surface " + std::to_string(s) +
                                        " has no name in one configuration; all get the glass of the first");
      } else {
        operand(name, s + 1, word);
      }
    }
  };
  const auto number = [](double value) { return to_text(value); };
  changes(
      "THIC", &SurfaceChange::thickness, [](const SurfaceRow& r) { return r.thickness; }, number);
  changes(
      "CRVT", &SurfaceChange::radius, [](const SurfaceRow& r) { return r.radius; },
      [](double radius) { return to_text(radius == 0 ? 0 : 1 / radius); });
  changes(
      "CONN", &SurfaceChange::conic, [](const SurfaceRow& r) { return r.conic; }, number);
  // 0 means no rim.
  changes(
      "SDIA", &SurfaceChange::semi_diameter, [](const SurfaceRow& r) { return r.semi_diameter.value_or(0); },
      [](double rim) { return to_text(std::isfinite(rim) ? rim : 0); });
  changes(
      "GLSS", &SurfaceChange::medium, [](const SurfaceRow& r) { return r.medium; },
      [&](const Medium& medium) {
        const std::string glass = glass_name(medium);
        return glass.empty() ? glass : '"' + glass + '"';
      });

  const auto focusing = std::ranges::count_if(list, [](const Configuration& c) { return c.focus_of.has_value(); });
  if (focusing > 0 && static_cast<std::size_t>(focusing) + 1 < list.size()) {
    out_.lose("focus_of", "the zoom position of each focused configuration is lost, except in its name");
  }
  if (std::ranges::any_of(list, [](const Configuration& c) { return c.stop.has_value(); })) {
    out_.lose("stop", "of the first configuration is used in all");
  }
}

}  // namespace

ExportedLens format_zemax(const Prescription& prescription, const GlassCatalogue* glasses) {
  return ZemaxWriter(prescription, glasses).write();
}

}  // namespace petzval
