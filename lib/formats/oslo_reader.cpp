// SPDX-License-Identifier: Apache-2.0
// Lens files of OSLO: commands, one per line or separated by semicolons. NXT begins the next surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "oslo_surface.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// The commands of a line, separated by semicolons outside quotes; "//" begins a comment.
std::vector<std::string_view> commands_of(std::string_view line) {
  std::vector<std::string_view> commands;
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    const bool ends = i == line.size() || (!quoted && line.substr(i).starts_with("//"));
    if (ends || (!quoted && line[i] == ';')) {
      if (const auto command = trimmed(line.substr(start, i - start)); !command.empty()) commands.push_back(command);
      start = i + 1;
    }
    if (ends) break;
  }
  return commands;
}

class OsloReader {
 public:
  explicit OsloReader(Import& in) : in_(in) { lens_.surfaces.emplace_back(); }

  void read(std::string_view text) {
    for (Lines lines(text); lines.next();) {
      const auto commands = commands_of(lines.text());
      if (commands.empty() && trimmed(lines.text()).empty() && !has_next(text)) next_surface(lines.number());
      for (const auto command : commands) take(lines.number(), command);
    }
    if (lens_.surfaces.back().line == 0) lens_.surfaces.pop_back();  // a blank line at the end
    build_oslo(lens_, in_);
  }

 private:
  using Words = std::vector<std::string_view>;

  /// True if the text has an NXT; otherwise blank lines separate surfaces.
  bool has_next(std::string_view text) {
    if (!has_next_) {
      has_next_ = false;
      for (Lines lines(text); lines.next() && !*has_next_;) {
        for (const auto command : commands_of(lines.text())) *has_next_ |= same(command.substr(0, 3), "NXT");
      }
    }
    return *has_next_;
  }

  void next_surface(int line) {
    if (lens_.surfaces.back().line == 0 || ended_) return;  // two adjacent blank lines
    start_surface(line);
  }
  void start_surface(int line) {
    in_.limit(lens_.surfaces.size() + 1, "surfaces", 2);
    lens_.surfaces.back().line = std::max(lens_.surfaces.back().line, 1);
    lens_.surfaces.emplace_back().line = has_next_.value_or(false) ? line : 0;
  }

  double value(int line, const Words& w, std::size_t i = 1) const {
    if (i >= w.size()) in_.refuse(line, w[0], "missing", "a number");
    return in_.number(line, w[0], w[i]);
  }
  std::vector<double> values(int line, const Words& w) const {
    std::vector<double> result;
    for (std::size_t i = 1; i < w.size(); ++i) result.push_back(in_.number(line, w[0], w[i]));
    return result;
  }
  void warn_once(int line, std::string_view command, const std::string& message) {
    if (said_.size() < 1000 && said_.emplace(command.substr(0, 60)).second) in_.warn(line, command, message);
  }

  void take(int line, std::string_view text);
  bool take_general(int line, std::string_view command, const Words& w);
  bool take_surface(int line, std::string_view command, const Words& w, OsloSurface& s);
  bool take_asphere(int line, std::string_view command, const Words& w, OsloSurface& s);
  bool refuse_or_skip(int line, std::string_view command, const Words& w);
  void take_glass(int line, const Words& w, OsloSurface& s);
  void take_aperture(int line, const Words& w, OsloSurface& s);
  void take_pickup(int line, const Words& w, OsloSurface& s);

  Import& in_;
  OsloLens lens_;
  std::vector<double> inline_wavelengths_;
  std::set<std::string, std::less<>> said_;
  std::optional<bool> has_next_;
  bool ended_ = false;
};

void OsloReader::take(int line, std::string_view text) {
  const Words w = words(text, 1024);
  const std::string command = upper(w[0]);
  if (take_general(line, command, w)) return;
  if (ended_) {
    // The sections after the lens contain rays, variables and merit functions.
    if (command == "CFG") warn_once(line, command, "configurations are left out; the first one is read");
    return;
  }
  OsloSurface& s = lens_.surfaces.back();
  if (s.line == 0) s.line = line;
  if (take_surface(line, command, w, s) || take_asphere(line, command, w, s) || refuse_or_skip(line, command, w))
    return;
  warn_once(line, command, "an unknown command is left out");
}

bool OsloReader::take_general(int line, std::string_view command, const Words& w) {
  const auto length = [&](std::optional<double>& entry_index) { return entry_index = value(line, w), true; };
  if (command == "LEN") {
    if (w.size() < 3 || !same(w[1], "NEW")) in_.refuse(line, "LEN", "incomplete", "LEN NEW \"name\"");
    lens_.line = line;
    in_.lens.imported->title = w[2];
    if (w.size() > 3) lens_.scale = value(line, w, 3);
    return true;
  }
  if (command == "EBR") return length(lens_.beam_radius);
  if (command == "NAO") return length(lens_.object_na);
  if (command == "NAP") return length(lens_.image_na);
  if (command == "FNO") return length(lens_.f_number);
  if (command == "ANG") return length(lens_.angle);
  if (command == "OBH") return length(lens_.object_height);
  if (command == "GIH") return length(lens_.image_height);
  if (command == "UNI") {
    lens_.unit = value(line, w);
    if (!(lens_.unit > 0)) in_.refuse(line, "UNI", to_text(lens_.unit), "positive (millimetres per unit)");
    in_.lens.imported->units = lens_.unit == 10 ? "cm" : lens_.unit == 25.4 ? "in" : lens_.unit == 1000 ? "m" : "mm";
    if (lens_.unit != 1) in_.warn(line, "UNI", "a unit is taken as " + to_text(lens_.unit) + " mm");
    return true;
  }
  if (command == "WV") {
    lens_.wavelengths = values(line, w);
    inline_wavelengths_ = lens_.wavelengths;
    return true;
  }
  if (command.starts_with("WV") && number(command.substr(2)).value_or(0) >= 1) {
    const double entry_index = *number(command.substr(2));
    if (!(entry_index <= 100 && entry_index == std::floor(entry_index)))
      in_.refuse(line, command, "an index outside the list", "WV1 to WV100");
    const auto i = static_cast<std::size_t>(entry_index);
    if (lens_.wavelengths.size() < i) lens_.wavelengths.resize(i);
    lens_.wavelengths[i - 1] = value(line, w);
    return true;
  }
  if (command == "WW") return lens_.weights = values(line, w), true;
  if (command == "DES" || command.starts_with("SNO")) {
    std::string note;
    for (std::size_t i = 1; i < w.size(); ++i) append(note, " ", w[i]);
    in_.note(note);
    return true;
  }
  if (command == "NXT") {
    if (!ended_) {
      has_next_ = true;
      start_surface(line);
    }
    return true;
  }
  if (command == "END") return ended_ = true;
  return false;
}

bool OsloReader::take_surface(int line, std::string_view command, const Words& w, OsloSurface& s) {
  if (command == "RD") {
    const double radius = value(line, w);
    s.curvature = radius == 0 ? 0 : 1 / radius;
  } else if (command == "CV") {
    s.curvature = value(line, w);
  } else if (command == "TH") {
    s.thickness = value(line, w);
  } else if (command == "AIR") {
    s.medium = {line, OsloMedium::Kind::air, {}, {}, {}};
  } else if (command == "RFL" || command == "RFH") {
    s.medium = {line, OsloMedium::Kind::mirror, {}, {}, {}};
  } else if (command == "GLA") {
    take_glass(line, w, s);
  } else if (command == "AP") {
    take_aperture(line, w, s);
  } else if (command == "AST") {
    s.stop = true;
  } else if (command == "CC") {
    s.conic = value(line, w);
  } else if (command == "PK") {
    take_pickup(line, w, s);
  } else if (command == "PY") {
    s.height = value(line, w);
  } else if (is_one_of(command, "PYC PUC PU EC PI PIC APC APL")) {
    warn_once(line, command, "a solve is not evaluated; the value in the file is taken");
  } else {
    return false;
  }
  return true;
}

void OsloReader::take_glass(int line, const Words& w, OsloSurface& s) {
  if (w.size() < 2) in_.refuse(line, "GLA", "missing", "a name or indices");
  s.medium = {line, OsloMedium::Kind::glass, std::string(w[1]), {}, {}};
  if (same(w[1], "PK")) {
    take_pickup(line, {"PK", "GLA", w.size() > 2 ? w[2] : ""}, s);
    return;
  }
  const bool model = same(w[1], "MOD");
  if (!model && !number(w[1])) return;
  s.medium.kind = OsloMedium::Kind::indices;
  const std::size_t first = model ? 3 : 1;  // a model has a name
  if (w.size() <= first) in_.refuse(line, "GLA", "a model without indices", "a model with indices at the wavelengths");
  for (std::size_t i = first; i < w.size(); ++i) s.medium.indices.push_back(in_.number(line, "GLA", w[i]));
  s.medium.wavelengths = inline_wavelengths_;
}

void OsloReader::take_aperture(int line, const Words& w, OsloSurface& s) {
  std::size_t i = 1;
  if (w.size() > 1 && same(w[1], "PK")) return take_pickup(line, {"PK", "AP", w.size() > 2 ? w[2] : ""}, s);
  if (w.size() > 1 && same(w[1], "CHK")) s.checked = true, i = 2;
  if (w.size() <= i) return;
  const double radius = value(line, w, i);
  if (radius < 0) in_.refuse(line, "AP", to_text(radius), "at least 0");
  s.aperture = radius;
}

void OsloReader::take_pickup(int line, const Words& w, OsloSurface& s) {
  if (w.size() < 3 || w.size() > 4 || !is_one_of(w[1], "CV CVM TH THM GLA AP CC")) {
    in_.warn(line, "PK", "an unknown pickup is left out; the value in the file is taken");
    return;
  }
  const double surface = in_.number(line, "PK", w[2]);
  const auto own = static_cast<double>(lens_.surfaces.size() - 1);
  if (!(surface >= 0 && surface < own && surface == std::floor(surface))) {
    in_.refuse(line, "PK", "surface " + to_text(surface), "an earlier surface");
  }
  OsloPickup pickup{line, upper(w[1]), static_cast<int>(surface), w.size() > 3 ? value(line, w, 3) : 0};
  s.pickups.push_back(std::move(pickup));
}

/// AD to AG are r^4 to r^10. General aspheres: ASn is r^2n (ASR) or r^n (ARA).
bool OsloReader::take_asphere(int line, std::string_view command, const Words& w, OsloSurface& s) {
  static constexpr std::array<std::string_view, 4> classic = {"AD", "AE", "AF", "AG"};
  if (const auto found = std::ranges::find(classic, command); found != classic.end()) {
    s.terms[4 + 2 * static_cast<int>(found - classic.begin())] = value(line, w);
    return true;
  }
  if (command == "ASP") {
    s.asphere = w.size() > 1 ? lower(w[1]) : std::string();
    if (s.asphere != "asr" && s.asphere != "ara") {
      in_.refuse(line, "ASP", io_detail::in_quotes(s.asphere), "ASR (even powers) or ARA (all powers)");
    }
    return true;
  }
  if (!command.starts_with("AS") || !number(command.substr(2))) return false;
  const double entry_index = *number(command.substr(2)), coefficient = value(line, w);
  if (coefficient == 0) return true;
  if (s.asphere.empty()) in_.refuse(line, command, "a term before ASP", "after ASP, the kind of asphere");
  const double order = s.asphere == "asr" ? 2 * entry_index : entry_index;
  if (!(order >= 2 && order <= 40 && order == std::floor(order))) {
    in_.refuse(line, command, "order " + to_text(order), "2 to 40");
  }
  s.terms[static_cast<int>(order)] = coefficient;
  return true;
}

/// Refuses commands that define another kind of lens, and skips commands that do not affect the lens.
bool OsloReader::refuse_or_skip(int line, std::string_view command, const Words& w) {
  if (is_one_of(command, "DCX DCY DCZ TLA TLB TLC CVX RDX CCX")) {
    if (value(line, w) != 0) {
      in_.refuse(line, command, to_text(value(line, w)), "0 (surfaces of revolution about one axis)");
    }
    return true;
  }
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 10> others = {{
      {"PFL", "a perfect lens"},
      {"PFM", "a perfect lens"},
      {"GSP", "a grating"},
      {"GOR", "a grating"},
      {"HOR", "a hologram"},
      {"DOR", "a diffractive surface"},
      {"GDT", "a gradient index"},
      {"GRT", "a gradient index"},
      {"ARX", "a lens array"},
      {"SPL", "a spline"},
  }};
  const auto other = std::ranges::find_if(others, [&](const auto& entry) { return entry.first == command; });
  if (other != others.end()) in_.refuse(line, command, std::string(other->second), "spheres, conics and aspheres");
  if (command == "LMO") {
    if (w.size() > 1 && (same(w[1], "NSS") || same(w[1], "ARR"))) {
      in_.refuse(line, command, std::string(w[1]), "a sequence of surfaces");
    }
    return true;
  }
  // Bends and returns belong to tilted surfaces, which are refused because of their angles.
  if (is_one_of(command, "TCE DT DRW BEN RCO TLM PEN ELE")) return true;
  if (command == "APN" || command.starts_with("ATP") || command.starts_with("AX") || command.starts_with("AY") ||
      command.starts_with("AAC") || command.starts_with("AVX")) {
    warn_once(line, command, "apertures that are not circular are left out");
    return true;
  }
  return false;
}

}  // namespace

bool is_oslo(std::string_view text) {
  int tried = 0;
  for (Lines lines(text); lines.next() && tried < 100;) {
    for (const auto command : commands_of(lines.text())) {
      const auto w = words(command, 5);
      if (w.size() >= 4 && same(w[0], "LEN") && same(w[1], "NEW") && number(w[3])) return true;
      ++tried;
    }
  }
  return false;
}

void read_oslo(std::string_view text, Import& in) { OsloReader(in).read(text); }

}  // namespace petzval::formats_detail
