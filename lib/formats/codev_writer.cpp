// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/text.hpp"
#include "glass_names.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text_file.hpp"
#include "written_lens.hpp"

namespace petzval {
namespace {

using namespace formats_detail;

constexpr double infinite_distance_mm = 1e13;
constexpr double f_nm = 486.1327, c_nm = 656.2725;

std::string quoted(std::string text) {
  std::ranges::replace(text, '\'', ' ');
  return '\'' + one_line(std::move(text)) + '\'';
}

/// "SCHOTT" for schott and schott-legacy.
std::string maker_of(const Glass& glass) { return upper(glass.catalogue.substr(0, glass.catalogue.find('-'))); }

class CodevWriter {
 public:
  CodevWriter(const Prescription& p, const GlassCatalogue* glasses) : out_(p, glasses), p_(out_.lens()) {}

  ExportedLens write() {
    out_.lose_the_wider_stop();
    out_.state_indices_at_d();
    name_media();
    header();
    private_glasses();
    design();
    out_.line("SO 0 " + distance(p_.design.object_distance_mm) + glass(p_.object_space));
    for (std::size_t i = 0; i < p_.surfaces.size(); ++i) surface(i);
    out_.line("SI 0 0");
    zooms();
    out_.line("GO");
    return out_.take();
  }

 private:
  static std::string distance(double mm) { return to_text(std::isfinite(mm) ? mm : infinite_distance_mm); }
  void name_media();
  void header();
  void private_glasses();
  void design();
  void surface(std::size_t i);
  std::string glass(const Medium& medium) const;
  std::optional<double> beam_diameter(std::size_t position);
  /// True if every zoom position has a beam and the beams differ.
  bool zoomed_beam() const {
    return std::ranges::all_of(beams_, [](const auto& beam) { return beam.has_value(); }) &&
           std::ranges::adjacent_find(beams_, std::ranges::not_equal_to()) != beams_.end();
  }
  void zooms();

  Writer out_;
  const Prescription& p_;
  std::vector<std::pair<Medium, std::string>> names_;
  std::vector<std::pair<std::string, Medium>> private_;
  std::vector<std::optional<double>> beams_;  ///< diameter per position; empty if the design declares the beam
};

/// "BK7_SCHOTT": the name without dashes, and the maker, as CODE V names catalogue glasses.
std::string codev_name(const Glass& glass) {
  std::string name;
  for (const char c : glass.name) {
    if (c != '-' && c != ' ') name.push_back(c);
  }
  return name + '_' + maker_of(glass);
}

/// A catalogue glass keeps its name if name and maker identify it. Other media become private glasses.
void CodevWriter::name_media() {
  std::optional<GlassNames> names;
  std::vector<Medium> media{p_.object_space};
  for (const SurfaceRow& row : p_.surfaces) media.push_back(row.medium);
  for (const Medium& medium : media) {
    const bool known = std::ranges::any_of(names_, [&](const auto& entry) { return entry.first == medium; });
    if (known || medium.is_air()) continue;
    if (const Glass* found = out_.glass(medium); found && !medium.nd) {
      if (!names) names.emplace(out_.glasses());
      if (names->find(found->name, std::array{maker_of(*found)}, {}, Numbers::stated) == found) {
        names_.emplace_back(medium, codev_name(*found));
        continue;
      }
    }
    const std::string name = "PRIVATE" + std::to_string(private_.size() + 1);
    names_.emplace_back(medium, name);
    private_.emplace_back(name, medium);
  }
}

std::string CodevWriter::glass(const Medium& medium) const {
  const auto found = std::ranges::find_if(names_, [&](const auto& entry) { return entry.first == medium; });
  return found == names_.end() ? std::string() : ' ' + found->second;
}

void CodevWriter::header() {
  out_.line("RDM");
  out_.line("LEN");
  out_.line("TITLE " + quoted(p_.name));
  out_.line("DIM M");
  out_.lose_nominal_data(true, {});
}

void CodevWriter::private_glasses() {
  if (private_.empty()) return;
  out_.line("PRV");
  out_.line("PWL " + to_text(c_nm) + ' ' + to_text(d_line_nm) + ' ' + to_text(f_nm));
  bool without_vd = false;
  std::string list;
  for (const auto& entry : private_) {
    const std::string& name = entry.first;
    const Medium& medium = entry.second;
    const double nd = out_.index(medium);
    const auto at = [&](double nm) {
      const Glass* found = out_.glass(medium);
      if (found) return nd + refractive_index(*found, nm) - refractive_index(*found, d_line_nm);
      return medium.vd && *medium.vd > 0 ? abbe_index(nd, *medium.vd, nm) : nd;
    };
    without_vd = without_vd || !medium.vd;
    append(list, ", ", name + " (" + (medium.glass ? *medium.glass + ", " : "") + "n_d " + to_text(nd, 7) + ')');
    out_.line(quoted(name) + ' ' + to_text(at(c_nm)) + ' ' + to_text(nd) + ' ' + to_text(at(f_nm)));
  }
  out_.line("END");
  if (without_vd) out_.lose("vd", "glasses without V_d get the same index at all wavelengths");
  out_.lose("glass",
            "media without the name and n_d of a catalogue glass become private glasses with indices at C, d and "
            "F only: " +
                list);
}

/// Diameter of the parallel beam whose exact rays fill the stop in a zoom position; nullopt if the beam is unlimited.
std::optional<double> CodevWriter::beam_diameter(std::size_t position) {
  const Lens lens = out_.at_primary_wavelength(configured(p_, position));
  if (!has_pupils(lens)) return {};
  const Meridian meridian = main_meridian(lens);
  const double by_rays = std::abs(first_order(lens, {}, meridian).effective_focal_length) / real_f_number(lens);
  const bool parallel = std::isinf(p_.design.object_distance_mm) && std::isfinite(by_rays);
  const double diameter = parallel ? by_rays : pupils(lens, {}, meridian).entrance.diameter;
  return std::isfinite(diameter) && diameter > 0 ? std::optional(diameter) : std::nullopt;
}

void CodevWriter::design() {
  const DesignData& d = p_.design;
  const bool by_stop = d.aperture && d.aperture->setting == ApertureSetting::stop_size;
  if (d.aperture && !by_stop && d.aperture->value > 0) {
    const char* word = "EPD ";
    switch (d.aperture->setting) {
      case ApertureSetting::f_number:
      case ApertureSetting::working_f_number: word = "FNO "; break;
      case ApertureSetting::image_na: word = "NA "; break;
      case ApertureSetting::object_na: word = "NAO "; break;
      default: break;
    }
    out_.line(word + to_text(d.aperture->value));
  } else {
    for (std::size_t i = 0; i < std::max<std::size_t>(p_.configurations.size(), 1); ++i) {
      beams_.push_back(beam_diameter(i));
    }
    if (beams_[0]) out_.line("EPD " + to_text(*beams_[0]));
    if (by_stop) out_.lose("aperture", "given by the size of the stop becomes the diameter of the entrance pupil");
    if (d.aperture && !by_stop) {
      out_.lose("aperture",
                std::string(name(d.aperture->setting)) + " of 0 becomes the diameter of the entrance pupil");
    }
  }
  // Wavelengths must decrease.
  std::vector<std::pair<DesignWavelength, bool>> waves;
  for (std::size_t i = 0; i < d.wavelengths.size(); ++i)
    waves.emplace_back(d.wavelengths[i], i == d.primary_wavelength);
  if (waves.empty()) waves = {{{p_.reference_wavelength_nm, 1}, true}};
  std::ranges::stable_sort(waves, std::ranges::greater(), [](const auto& w) { return w.first.nm; });
  std::string nm = "WL", weights = "WTW";
  for (std::size_t i = 0; i < waves.size(); ++i) {
    nm += ' ' + to_text(waves[i].first.nm), weights += ' ' + to_text(waves[i].first.weight);
  }
  out_.line(nm);
  const auto reference = std::ranges::find(waves, true, [](const auto& w) { return w.second; });
  out_.line("REF " + std::to_string(reference - waves.begin() + 1));
  out_.line(weights);

  std::vector<DesignField> fields = d.fields;
  if (fields.empty()) fields = {{}};
  static constexpr std::array<std::array<const char*, 2>, 4> words = {
      {{"XAN", "YAN"}, {"XOB", "YOB"}, {"XIM", "YIM"}, {"XRI", "YRI"}}};
  const auto& [x, y] = words[static_cast<std::size_t>(d.field_kind)];
  const auto row = [&](const std::string& name, const auto& value) {
    std::string line = name;
    for (const DesignField& field : fields) line += ' ' + to_text(value(field));
    out_.line(line);
  };
  row(x, [](const DesignField& f) { return f.x; });
  row(y, [](const DesignField& f) { return f.y; });
  row("WTF", [](const DesignField& f) { return f.weight; });
  row("VUY", [](const DesignField& f) { return f.compress_y - f.decentre_y; });
  row("VLY", [](const DesignField& f) { return f.compress_y + f.decentre_y; });
  row("VUX", [](const DesignField& f) { return f.compress_x - f.decentre_x; });
  row("VLX", [](const DesignField& f) { return f.compress_x + f.decentre_x; });
  if (std::ranges::any_of(fields, [](const DesignField& f) { return f.angle_deg != 0; })) {
    out_.lose("fields", "angles of vignetted pupils are lost");
  }
}

void CodevWriter::surface(std::size_t i) {
  const SurfaceRow& row = p_.surfaces[i];
  out_.line("S " + to_text(row.radius) + ' ' + to_text(row.thickness) + (row.mirror ? " REFL" : glass(row.medium)));
  if (row.stop) out_.line("  STO");
  if (row.comment) out_.line("  SLB " + quoted(*row.comment));
  // The size of the stop is determined by the beams of the zoom positions.
  const bool limited = row.semi_diameter && std::isfinite(*row.semi_diameter) && !row.semi_diameter_computed &&
                       !(row.stop && zoomed_beam());
  if (limited) out_.line("  CIR " + to_text(*row.semi_diameter));
  if (row.obscuration_semi_diameter.value_or(0) > 0) {
    out_.line(std::string(row.mirror ? "  CIR HOL " : "  CIR OBS ") + to_text(*row.obscuration_semi_diameter));
  }
  if (row.curved_in == Section::x) out_.refuse(i, "a cylinder curved along x", "a cylinder curved along y for a .seq");
  if (row.curved_in == Section::y) {
    out_.line("  CYL");
    out_.line("  RDX 0");
  }
  if (row.conic == 0 && row.aspheric.empty()) return;
  out_.line(row.aspheric.empty() ? "  CON" : "  ASP");
  out_.line("  K " + to_text(row.conic));
  for (const AsphereTerm& term : row.aspheric) {
    if (term.order % 2 != 0 || term.order < 4 || term.order > 20) {
      out_.refuse(i, "an aspheric term of order " + std::to_string(term.order), "of even order 4 to 20 for a .seq");
    }
    out_.line("  " + std::string(1, "ABCDEFGHJ"[term.order / 2 - 2]) + ' ' + to_text(term.coefficient));
  }
}

void CodevWriter::zooms() {
  const auto& list = p_.configurations;
  if (list.size() < 2) return;
  out_.line("ZOO " + std::to_string(list.size()));
  std::string titles = "ZOO TIT";
  for (const Configuration& c : list) titles += ' ' + quoted(c.name);
  out_.line(titles);
  const auto far = [](const Configuration& c) { return !c.subject_distance_mm || std::isinf(*c.subject_distance_mm); };
  if (!std::ranges::all_of(list, far)) {
    std::string line = "ZOO THI SO";
    for (const Configuration& c : list) line += ' ' + distance(far(c) ? INFINITY : *c.subject_distance_mm);
    out_.line(line);
  }
  if (zoomed_beam()) {
    std::string line = "ZOO EPD";
    for (const auto& diameter : beams_) line += ' ' + to_text(*diameter);
    out_.line(line);
  }
  const auto values = [&](const char* name, std::optional<double> SurfaceChange::*member, double SurfaceRow::*of_row) {
    std::set<int> surfaces;
    for (const Configuration& c : list) {
      for (const SurfaceChange& change : c.changes) {
        if (change.*member) surfaces.insert(change.surface);
      }
    }
    for (const int s : surfaces) {
      std::string line = std::string("ZOO ") + name + " S" + std::to_string(s + 1);
      for (const Configuration& c : list) {
        const auto found = std::ranges::find(c.changes, s, &SurfaceChange::surface);
        const bool given = found != c.changes.end() && ((*found).*member).has_value();
        line += ' ' + to_text(given ? *((*found).*member) : p_.surfaces[static_cast<std::size_t>(s)].*of_row);
      }
      out_.line(line);
    }
  };
  values("THI", &SurfaceChange::thickness, &SurfaceRow::thickness);
  values("RDY", &SurfaceChange::radius, &SurfaceRow::radius);
  bool other = false, focusing = false;
  for (const Configuration& c : list) {
    focusing = focusing || c.focus_of;
    other = other || c.stop;
    for (const SurfaceChange& change : c.changes)
      other = other || change.conic || change.semi_diameter || change.medium;
  }
  if (other) out_.lose("configurations", "all get the conics, semi-diameters, glasses and stops of the first");
  if (focusing) out_.lose("focus_of", "the zoom position of a focused configuration is lost, except in its name");
}

}  // namespace

ExportedLens format_codev(const Prescription& prescription, const GlassCatalogue* glasses) {
  return CodevWriter(prescription, glasses).write();
}

}  // namespace petzval
