// SPDX-License-Identifier: Apache-2.0
// Pages of refractiveindex.info. Source of the form: M. N. Polyanskiy, Refractiveindex.info database of optical
// constants, Scientific Data 11, 94 (2024).
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "glass_reader.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

struct Value {
  std::string text;
  int line = 0;  ///< 0: absent
};

/// One entry of DATA.
struct Entry {
  Value type, range, coefficients, table;
};

struct Page {
  std::vector<Entry> data;
  Value nd, vd, absolute;
};

/// Keeps the few values of a page that define a glass, while yaml-cpp reads it. No tree is built, so that neither
/// aliases nor nested lists use memory.
class PageReader : public YAML::EventHandler {
 public:
  PageReader(Page& page, const GlassReader& reader) : page_(page), reader_(reader) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) reader_.refuse(mark.line + 1, "a second document", "one page");
  }
  void OnDocumentEnd() override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    reader_.refuse(mark.line + 1, "an alias", "a page without aliases");
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { take(mark, ""); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& value) override {
    take(mark, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, false);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, true);
    if (inside_.size() == 3 && inside_[0].key == "DATA" && !inside_[1].map) page_.data.emplace_back();
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    bool map, at_key;
    std::string key;
  };
  static constexpr std::size_t most_levels = 32;

  void open(const YAML::Mark& mark, bool map) {
    if (inside_.size() == most_levels) {
      reader_.refuse(mark.line + 1, "nested lists", "at most " + std::to_string(most_levels) + " levels deep");
    }
    if (!inside_.empty() && inside_.back().map && inside_.back().at_key) {
      reader_.refuse(mark.line + 1, "a list or an object as a key", "a word");
    }
    inside_.push_back({map, map, {}});
  }

  void close() {
    inside_.pop_back();
    value_ends();
  }

  /// Called after a value inside an object: a key comes next.
  void value_ends() {
    if (!inside_.empty() && inside_.back().map) inside_.back().at_key = true;
  }

  void take(const YAML::Mark& mark, const std::string& text) {
    if (inside_.empty()) return;
    Level& level = inside_.back();
    if (level.map && level.at_key) {
      level.key = text;
      level.at_key = false;
      return;
    }
    if (Value* value = slot(level.key)) *value = {text, mark.line + 1};
    value_ends();
  }

  /// The member that stores a value, by the keys that lead to it; null if the value is not used.
  Value* slot(const std::string& key) {
    const std::string& section = inside_[0].key;
    if (inside_.size() == 3 && section == "DATA" && !page_.data.empty()) {
      Entry& entry = page_.data.back();
      if (key == "type") return &entry.type;
      if (key == "wavelength_range" || key == "range") return &entry.range;
      if (key == "coefficients") return &entry.coefficients;
      if (key == "data") return &entry.table;
    }
    if (inside_.size() == 2) {
      const bool properties = section == "PROPERTIES" || section == "SPECS";
      if (properties && key == "nd") return &page_.nd;
      if (properties && key == "Vd") return &page_.vd;
      if (section == "CONDITIONS" && key == "n_is_absolute") return &page_.absolute;
    }
    return nullptr;
  }

  Page& page_;
  const GlassReader& reader_;
  std::vector<Level> inside_;
  int documents_ = 0;
};

/// Limits lines and documents: yaml-cpp stores the tokens of a line, hundreds of bytes each, until it knows if they are
/// a key. It also stores all tokens of a document that is followed by another one.
void check_lines(std::string_view text, const GlassReader& reader) {
  constexpr std::size_t most_bytes = 8 << 20, longest_line = 64 << 10;
  if (text.size() > most_bytes) {
    reader.refuse(1, "a page of " + std::to_string(text.size()) + " bytes", "at most 8 MiB");
  }
  int documents = 0;
  Lines lines(text);
  while (lines.next()) {
    if (lines.text().size() > longest_line) {
      reader.refuse(lines.number(), "a line of " + std::to_string(lines.text().size()) + " bytes", "at most 64 KiB");
    }
    if (lines.text().starts_with("---") && ++documents > 1)
      reader.refuse(lines.number(), "a second document", "one page");
  }
}

Page read_page(std::string text, const GlassReader& reader) {
  check_lines(text, reader);
  Page page;
  PageReader handler(page, reader);
  try {
    std::istringstream stream(std::move(text));
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(handler)) {
    }
  } catch (const YAML::Exception& error) {
    reader.refuse(error.mark.line + 1, "invalid or incomplete YAML (" + error.msg + ")",
                  "a page of refractiveindex.info");
  }
  return page;
}

std::vector<double> numbers(const Value& value, std::string_view what, const GlassReader& reader) {
  std::vector<double> result;
  Lines lines(value.text);
  while (lines.next()) {
    const int line = value.line + lines.number() - 1;
    for (const auto word : words(lines.text())) result.push_back(reader.number(line, what, word));
  }
  return result;
}

/// n^2 = C1 + C2 l^C3 / (l^2 - C4^C5) + C6 l^C7 / (l^2 - C8^C9) + C10 l^C11 + ...
std::vector<double> rational_terms(const std::vector<double>& c) {
  const auto at = [&](std::size_t i) { return i < c.size() ? c[i] : 0.0; };
  std::vector<double> terms = {at(0)};
  for (const std::size_t i : {1, 5}) {
    if (at(i) != 0) terms.insert(terms.end(), {at(i), at(i + 1), std::pow(at(i + 2), at(i + 3))});
  }
  for (std::size_t i = 9; i < c.size(); i += 2) terms.insert(terms.end(), {c[i], at(i + 1) + 2, 0});
  return terms;
}

class RiiReader {
 public:
  RiiReader(const std::string& name, GlassReader& reader) : reader_(reader) {
    glass_.catalogue = "rii";
    glass_.name = name;
  }

  void read(const Page& page) {
    if (page.absolute.text == "true") {
      reader_.warn(page.absolute.line, "n_is_absolute", "the index is relative to vacuum; it is taken unchanged");
    }
    const auto printed = [&](const Value& v) { return v.line > 0 ? reader_.number(v.line, "nd or Vd", v.text) : 0.0; };
    glass_.nd = printed(page.nd);
    glass_.vd = printed(page.vd);
    const Entry *taken = nullptr, *with_k = nullptr;
    for (const Entry& entry : page.data) {
      const std::string_view type = entry.type.text;
      if (type == "tabulated k") {
        if (with_k) reader_.warn(entry.type.line, type, "left out: an earlier entry has k");
        if (!with_k) with_k = &entry;
      } else if (taken) {
        reader_.warn(entry.type.line, type, "left out: an earlier entry has the indices");
      } else {
        taken = &entry;
      }
    }
    if (!taken) reader_.refuse(1, "no DATA with an index", "a formula or a table of n");
    line_ = taken->type.line;
    take(*taken);
    if (with_k && glass_.absorption.empty()) take_absorption(rows_of(with_k->table, false, true));
    reader_.add(std::move(glass_), line_);
  }

 private:
  /// A row of a table: wavelength (um), n and k. Missing columns are 1 and 0.
  struct Row {
    double l, n, k;
  };

  void take(const Entry& entry) {
    const std::string& type = entry.type.text;
    if (type == "tabulated n" || type == "tabulated nk") return take_table(entry.table, type == "tabulated nk");
    using enum DispersionFormula;
    std::vector<double> c = numbers(entry.coefficients, "coefficient", reader_);
    const auto pairs = [&](DispersionFormula formula) {
      if (c.size() % 2 == 0) {
        reader_.refuse(entry.coefficients.line, std::to_string(c.size()) + " coefficients", "C1 and pairs");
      }
      glass_.formula = formula;
      glass_.coefficients = std::move(c);
    };
    if (c.empty()) reader_.refuse(line_, type + " has no coefficients", "a list of coefficients");
    if (type == "formula 1") {
      pairs(sellmeier_squared);
    } else if (type == "formula 2") {
      pairs(sellmeier);
    } else if (type == "formula 3") {
      pairs(polynomial);
    } else if (type == "formula 4") {
      glass_.formula = rational;
      glass_.coefficients = rational_terms(c);
    } else if (type == "formula 5") {
      pairs(cauchy);
    } else if (type == "formula 7") {
      glass_.formula = herzberger;
      c.resize(6);
      glass_.coefficients = std::move(c);
    } else {
      reader_.refuse(line_, "type = \"" + std::string(beginning(type, 100)) + "\"",
                     "formula 1, 2, 3, 4, 5 or 7, or tabulated n or nk");
    }
    const auto range = numbers(entry.range, "wavelength_range", reader_);
    if (range.size() != 2) {
      reader_.refuse(line_, "a range of " + std::to_string(range.size()) + " numbers", "two wavelengths");
    }
    glass_.shortest_nm = range[0] * 1000;
    glass_.longest_nm = range[1] * 1000;
  }

  /// Reads the rows of a table, sorted by wavelength.
  std::vector<Row> rows_of(const Value& table, bool with_n, bool with_k) {
    std::vector<Row> rows;
    const std::size_t columns = with_n && with_k ? 3 : 2;
    Lines lines(table.text);
    while (lines.next()) {
      const int line = table.line + lines.number();  // the rows begin on the line after the key
      const auto w = words(lines.text(), columns + 1);
      if (w.empty()) continue;
      if (w.size() != columns) {
        reader_.refuse(line, "a row of " + std::to_string(w.size()) + " numbers", std::to_string(columns));
      }
      const auto at = [&](std::size_t i) { return reader_.number(line, "data", w[i]); };
      rows.push_back({at(0), with_n ? at(1) : 1, with_k ? at(columns - 1) : 0});
    }
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.l < b.l; });
    const auto same = std::unique(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.l == b.l; });
    if (same != rows.end()) {
      reader_.warn(line_, "data", std::to_string(rows.end() - same) + " rows with repeated wavelengths are left out");
      rows.erase(same, rows.end());
    }
    return rows;
  }

  void take_absorption(const std::vector<Row>& rows) {
    for (const auto& [l, n, k] : rows) {
      const double per_mm = 4 * std::numbers::pi * k / (l / 1000);
      if (l > 0 && k >= 0 && std::isfinite(per_mm)) glass_.absorption.push_back({l * 1000, per_mm});
    }
    if (const std::size_t invalid = rows.size() - glass_.absorption.size()) {
      reader_.warn(line_, "data",
                   std::to_string(invalid) + " rows of k without a positive wavelength or with k below 0 are left out");
    }
  }

  void take_table(const Value& table, bool with_k) {
    const std::vector<Row> rows = rows_of(table, true, with_k);
    // If k exceeds 0.01, a millimetre is opaque; the longest range of clear wavelengths is used.
    constexpr double max_extinction = 0.01;
    std::size_t first = 0, count = 0;
    for (std::size_t i = 0, start = 0; i < rows.size(); ++i) {
      if (rows[i].k > max_extinction) start = i + 1;
      if (i + 1 > start && i + 1 - start > count) first = start, count = i + 1 - start;
    }
    if (count < 2) {
      reader_.refuse(line_, "a table with " + std::to_string(count) + " rows of a clear medium (k at most 0.01)",
                     "at least two");
    }
    if (count < rows.size()) {
      reader_.warn(line_, "tabulated nk",
                   "absorbs outside " + to_text(rows[first].l * 1000, 7) + " to " +
                       to_text(rows[first + count - 1].l * 1000, 7) + " nm; these wavelengths are left out");
    }
    if (with_k) take_absorption(rows);
    glass_.formula = DispersionFormula::tabulated;
    for (std::size_t i = first; i < first + count; ++i) {
      glass_.coefficients.insert(glass_.coefficients.end(), {rows[i].l, rows[i].n});
    }
    glass_.shortest_nm = rows[first].l * 1000;
    glass_.longest_nm = rows[first + count - 1].l * 1000;
  }

  GlassReader& reader_;
  Glass glass_;
  int line_ = 0;
};

}  // namespace

void read_rii(std::string text, const std::string& name, GlassReader& reader) {
  RiiReader(name, reader).read(read_page(std::move(text), reader));
}

}  // namespace petzval::formats_detail
