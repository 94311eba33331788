// SPDX-License-Identifier: Apache-2.0
// Pages as printed, in the styles of patents and books, with the numbers of the lenses of data/lenses.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "lens_text.hpp"
#include "petzval/core/files.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::testing {
namespace {

struct Page {
  const char* file;
  const char* lens;
};

void PrintTo(const Page& page, std::ostream* out) { *out << page.file; }

/// The style of the page is in the name of the file.
constexpr Page pages[] = {{"canon_new", "modern_50mm_f1.0"},
                          {"canon_old", "double_gauss_52mm_f1.8"},
                          {"canon_prime", "modern_50mm_f1.0"},
                          {"canon_zoom", "zoom_14-30mm_f4"},
                          {"fuji_prime", "modern_41mm_f1.45"},
                          {"fuji_new", "zoom_70-210mm_f4"},
                          {"fuji_zoom", "zoom_70-210mm_f4"},
                          {"markdown", "tessar_100mm_f2.8"},
                          {"minolta", "fisheye_16mm_f2.8"},
                          {"minolta_8", "fisheye_8mm_f2.8"},
                          {"nikon_prime", "modern_58mm_f0.95"},
                          {"nikon_zoom", "zoom_57-143mm_f2.8"},
                          {"old_radii", "double_gauss_100mm_f2.0"},
                          {"olympus_new", "zoom_14-30mm_f4"},
                          {"olympus", "compact_31mm_f2.1"},
                          {"pentax", "fisheye_10mm_f4"},
                          {"pentax_new", "modern_41mm_f1.45"},
                          {"pentax_old", "sonnar_180mm_f2.8"},
                          {"smith", "double_gauss_100mm_f2.0"},
                          {"sony_phone", "phone_5.6mm_f3.5"},
                          {"sony_prime", "modern_51mm_f1.25"},
                          {"tabs", "planar_50mm_f1.4"},
                          {"tamron", "cine_100mm_t1.3"},
                          {"tamron_tele", "telephoto_392mm_f2.9"},
                          {"zeiss", "planar_1896_f4.5"},
                          {"zeiss_tessar", "tessar_100mm_f5.5_1902"}};

std::string page(const std::string& name) {
  return read_file(std::filesystem::path(PETZVAL_TEST_SAMPLES) / "pages" / (name + ".txt"), "a page");
}

/// The first difference of two lenses beyond the digits of a page; empty if they are equal. Distances of a table of
/// glass names may differ in V_d.
std::string difference(const Prescription& a, const Prescription& b, double vd_tolerance = 1e-6) {
  // A missing distance of the film is assumed, with a warning.
  const bool film_assumed = a.image_distance == "paraxial focus";
  const auto off = [](double u, double v, double relative) { return std::abs(u - v) > relative * std::abs(v) + 1e-30; };
  if (a.surfaces.size() != b.surfaces.size()) return "the number of surfaces";
  if (a.configurations.size() != b.configurations.size()) return "the number of positions";
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    const SurfaceRow &s = a.surfaces[i], &t = b.surfaces[i];
    const std::string at = " of surface " + std::to_string(i + 1);
    if (off(s.radius, t.radius, 1e-6)) return "the radius" + at;
    const bool film = film_assumed && i + 1 == a.surfaces.size();
    if (!film && off(s.thickness, t.thickness, 1e-6)) return "the thickness" + at;
    if (off(s.medium.nd.value_or(1), t.medium.nd.value_or(1), 1e-6 + 0.1 * vd_tolerance)) return "the index" + at;
    if (off(s.medium.vd.value_or(0), t.medium.vd.value_or(0), vd_tolerance)) return "the V-number" + at;
    if (std::abs(s.conic - t.conic) > 1e-4) return "the conic" + at;
    if (s.stop != t.stop) return "the stop" + at;
    if (s.aspheric.size() != t.aspheric.size()) return "the number of terms" + at;
    for (std::size_t k = 0; k < s.aspheric.size(); ++k) {
      const AsphereTerm &u = s.aspheric[k], &v = t.aspheric[k];
      if (u.order != v.order || off(u.coefficient, v.coefficient, 1e-4)) return "a term" + at;
    }
  }
  for (std::size_t c = 0; c < a.configurations.size(); ++c) {
    const Prescription p = configured(a, c), q = configured(b, c);
    for (std::size_t i = 0; i + film_assumed < p.surfaces.size(); ++i) {
      if (off(p.surfaces[i].thickness, q.surfaces[i].thickness, 1e-6))
        return "a thickness of position " + std::to_string(c);
    }
  }
  return {};
}

class PageOf : public ::testing::TestWithParam<Page> {};

TEST_P(PageOf, ItsStyleIsReadAsItsLens) {
  const Page& p = GetParam();
  const Prescription lens = read(page(p.file)), truth = data_prescription(p.lens);
  EXPECT_EQ(difference(lens, truth, 2e-3), "");
  const double f = first_order(compile(lens)).effective_focal_length;
  EXPECT_NEAR(f / truth.focal_length_mm.value_or(f), 1, 0.02);
  if (lens.focal_length_mm) {
    EXPECT_NEAR(*lens.focal_length_mm, *truth.focal_length_mm, 0.005);
  }
  if (lens.f_number) {
    EXPECT_NEAR(*lens.f_number, *truth.f_number, 0.06);
  }
  if (lens.half_field_deg) {
    EXPECT_NEAR(*lens.half_field_deg, *truth.half_field_deg, 0.06);
  }
}

TEST(Page, PositionsHaveNamesAndDeclaredData) {
  const Prescription zoom = read(page("canon_zoom")), truth = data_prescription("zoom_14-30mm_f4");
  ASSERT_EQ(zoom.configurations.size(), 3u);
  EXPECT_EQ(zoom.configurations[0].name, "wide");
  EXPECT_EQ(zoom.configurations[2].name, "tele");
  EXPECT_DOUBLE_EQ(zoom.image_diagonal_mm.value(), 2 * 21.64);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(zoom.configurations[i].focal_length_mm.value(), *truth.configurations[i].focal_length_mm);
    EXPECT_DOUBLE_EQ(zoom.configurations[i].half_field_deg.value(), *truth.configurations[i].half_field_deg);
  }
}

TEST(Page, AnglesOfViewAreHalvedIfTheImageHeightSaysSo) {
  const std::string zoom = with(page("canon_zoom"), "Half angle of view", "Angle of view");
  EXPECT_DOUBLE_EQ(read(zoom).half_field_deg.value(), read(page("canon_zoom")).half_field_deg.value());
}

TEST(Page, EmbodimentsAreChosenByNumber) {
  const std::string two = page("canon_old") + '\n' + with(page("pentax_old"), "EXAMPLE 1", "EXAMPLE 2");
  const auto second = std::to_string(std::ranges::count(page("canon_old"), '\n') + 2);
  expect_tokens(refusal(two), {"x", 2, "line", second, "embodiment"});
  expect_tokens(refusal(two, "3"), {"embodiment", "3", second});
  EXPECT_EQ(difference(read(two, "1"), read(page("canon_old"))), "");
  EXPECT_EQ(difference(read(two, "2"), read(page("pentax_old"))), "");
}

/// A small lens as a page: each line may be replaced.
const std::string small =
    "Example 1\nf = 52.4\nNo. r d nd vd\n1* 60.0 5.0 1.5168 64.2\n2 -48.0 1.0\n3 (stop) inf 47.5\n"
    "Aspherical data\nSurface 1\nK = 0.5 A4 = 1.0E-06 A6 = 2.0E-09\n";

double conic(const std::string& text) { return read(text).surfaces[0].conic; }

TEST(Page, ConicsOfSpheresAre0Or1ByTheirName) {
  EXPECT_DOUBLE_EQ(conic(small), 0.5);
  for (const char* one : {"\u03ba = 0.5", "KA = 0.5", "\u03b5 = 0.5"}) {
    EXPECT_DOUBLE_EQ(conic(with(small, "K = 0.5", one)), -0.5) << one;
  }
  EXPECT_DOUBLE_EQ(conic(with(with(small, "K = 0.5", "\u03ba = 0.5"), "Aspherical data\n",
                              "Aspherical data\nX = y^2/(R(1+(1-(1+\u03ba)y^2/R^2)^1/2))\n")),
                   0.5);
  EXPECT_DOUBLE_EQ(conic(with(small, "K = 0.5", "K = 1")), 0);  // a sphere for all who print 1 for each asphere
}

TEST(Page, TermsHaveTheOrdersOfTheirNamesOrOfTheFormula) {
  const auto orders = [](const std::string& terms, const std::string& formula = "") {
    const std::string text = with(small, "A4 = 1.0E-06 A6 = 2.0E-09", terms);
    std::vector<int> result;
    const Prescription lens = read(with(text, "Aspherical data\n", "Aspherical data\n" + formula));
    for (const AsphereTerm& t : lens.surfaces[0].aspheric) {
      result.push_back(t.order);
    }
    return result;
  };
  using Orders = std::vector<int>;
  EXPECT_EQ(orders("C4 = 1E-6 C6 = 2E-9"), (Orders{4, 6}));
  EXPECT_EQ(orders("A3 = 1E-6 A 5 = 2E-9"), (Orders{3, 5}));
  EXPECT_EQ(orders("A = 1E-6 B = 2E-9"), (Orders{4, 6}));
  EXPECT_EQ(orders("B = 1E-6 C = 2E-9"), (Orders{4, 6}));
  EXPECT_EQ(orders("A = 1E-7 B = 2E-9", "X = cH^2/(1+(1-(1+K)c^2H^2)^1/2)+AH^2+BH^4\n"), (Orders{2, 4}));
  EXPECT_EQ(orders("B = 1E-6 C = 2E-9", "X = cH^2/(1+(1-(1+K)c^2H^2)^1/2)+BH^4+CH^6\n"), (Orders{4, 6}));
}

TEST(Page, PowersOfTenAreReadInEachPrintedForm) {
  for (const char* power : {"1.2345E-06", "1.2345e-6", "1.2345 E - 06", "1.2345D-06", "1.2345-6", "1.2345\u00d710-6",
                            "1.2345 \u00d7 10\u207b\u2076", "1.2345x10^-6", ".12345\u00d710\u22125"}) {
    const Prescription lens = read(with(small, "1.0E-06", power));
    ASSERT_EQ(lens.surfaces[0].aspheric.size(), 2u) << power;
    EXPECT_NEAR(lens.surfaces[0].aspheric[0].coefficient, 1.2345e-6, 1e-15) << power;
  }
}

TEST(Page, AsphericDataMayBeATableOfRowsOrOfColumns) {
  const Prescription lens = read(small);
  const std::string start = small.substr(0, small.find("Surface 1"));
  EXPECT_EQ(difference(read(start + "Surface K A4 A6\n1 0.5 1E-6 2E-9\n"), lens), "");
  EXPECT_EQ(difference(read(start + "Surface K A4\n1 0.5 1E-6\nSurface A6\n1 2E-9\n"), lens), "");
  EXPECT_EQ(difference(read(start + "Surface No. 1\nK 0.5\nA4 1E-6\nA6 2E-9\n"), lens), "");
  EXPECT_EQ(difference(read(start + "1st surface\nK: 0.5, A4: 1E-6, A6: 2E-9\n"), lens), "");
  EXPECT_EQ(difference(read(start + "r1:\nK = 0.5\nA4 = 1E-6\nA6 = 2E-9\n"), lens), "");
}

TEST(Page, LinesMayBePrintedInOtherForms) {
  const Prescription lens = read(small);
  const std::pair<const char*, const char*> forms[] = {
      {"f = 52.4", "f = 52.4mm"},
      {"f = 52.4", "Unit mm\nF = 52.4"},
      {"f = 52.4", "Focal length f (mm) 52.4"},
      {"No. r d nd vd", "Surface number r d nd vd"},
      {"No. r d nd vd", "S No. Ri (radius of curvature) Di Ndj (refractive index) \u03bddj"},
      {"No. r d nd vd", "Fl\u00e4che Radius Dicke Brechzahl Abbe-Zahl"},
      {"No. r d nd vd", "Surface # Curvature radius r (mm) Surface distance d Index Abbe #"},
      {"No. r d nd vd\n", "No. r d nd vd\n0 Object inf inf\n"},
      {"1* 60.0", "*1) 60.0"},
      {"1* 60.0", "L1 1 60.0*"},
      {"1* 60.0", "1 Lens 1 60.0 (ASP)"},
      {"64.2\n", "64.2 L1\n"},
      {"64.2\n", "64.2\nSecond lens group\n"},
      {"64.2\n", "64.2\nUS 9,256,059 B2\n23 24\n-continued\n"},
      {"3 (stop) inf", "3(St) inf"},
      {"3 (stop) inf", "3 inf(stop)"},
      {"3 (stop) inf", "S inf"},
      {"47.5\n", "47.5\nImage plane inf\n"},
      {"Aspherical data\n", "Conic and other coefficients\n"},
      {"Surface 1\n", "First surface\n"},
      {"Surface 1\n", "(1st surface)\n"},
      {"Surface 1\n", "[Aspherical data of surface 1]\n"},
      {"Surface 1\nK", "NO.1; K"},
      {"Surface 1\nK", "R1 K"},
      {"Surface 1\nK = 0.5 A4", "r1: K = 0.5\nA4"},
      {"K = 0.5 A4", "Conic constant (K) = 0.5 A4"},
      {"3 (stop) inf", "ST 3 1.E+18"},
      {"64.2\n", "64.2\nUS 9,256,059 B2\nApr. 28, 2016\n1 2\n"},
      {"K = 0.5 A4", "Conic constant = 0.5 \u03b14"},
      {"K = 0.5", "KA = 1.5"},
      {"2.0E-09\n", "2.0E-09\n(1) f1/f = 1.2\nf1 = 22.1 f2 = -11.0\nF/2.8\n"},
  };
  for (const auto& [old, form] : forms) {
    const std::string text = with(small, old, form);
    SCOPED_TRACE(form);
    if (const std::string found = refusal(text); found != "no error") {
      ADD_FAILURE() << found;
      continue;
    }
    EXPECT_EQ(difference(read(text), lens), "");
  }
}

TEST(Page, ConicsFollowTheFormula) {
  EXPECT_DOUBLE_EQ(conic(with(small, "Example 1\n", "Example 1\nThe constant K = 1 for a sphere.\n")), -0.5);
  for (const char* formula : {"1-K\u00b7h2/r2", "1\u2212K\u00d7c2\u00d7h2", "1-KC2Y2"}) {
    EXPECT_DOUBLE_EQ(
        conic(with(small, "Aspherical data\n", "Aspherical data\nX = ch2/(1+(" + std::string(formula) + ")^1/2)\n")),
        -0.5);
  }
  const std::string text = with(small, "A4 = 1.0E-06 A6 = 2.0E-09", "A2 = 1E-06 A3 = 2E-09");
  const Prescription lens = read(with(text, "Aspherical data\n", "Aspherical data\nX = ch2/2+A2h4+A3h6\n"));
  EXPECT_EQ(lens.surfaces[0].aspheric, (std::vector<AsphereTerm>{{4, 1e-6}, {6, 2e-9}}));
}

/// A lens of two positions, with radii by name.
const std::string zoom =
    "f = 31.9\nr1 = 50 d1 = 4 n1 = 1.5168 v1 = 64\nr2 = -50 d2 = variable\nr3 = 80 (stop) d3 = 3 n2 = 1.5168 v2 = 64\n"
    "r4 = -80 d4 = 20\n";

TEST(Page, PositionsMayBePrintedInOtherForms) {
  const Prescription truth = read(zoom + "d2 5 10\n");
  ASSERT_EQ(truth.configurations.size(), 2u);
  EXPECT_TRUE(truth.surfaces[2].stop);
  for (const char* form : {"d2 = 5~10\n", "d2 = 5 to 10\n", "d2 = 5 - 10\n", "d2 = 5, 10\n", "Wide Tele\nD2 5 10\n",
                           "Position Focal length d2\nWide 31.9 5\nTele 33.3 10\n"}) {
    SCOPED_TRACE(form);
    ASSERT_EQ(refusal(zoom + form), "no error");
    EXPECT_EQ(difference(read(zoom + form), truth), "");
  }
  EXPECT_EQ(difference(read(with(zoom, "d2 = variable", "d2 = 5~10")), truth), "");
  const Prescription close = read(zoom + "d2 5 10\nClose\nd0 300 300\nd2 6 12\n");
  EXPECT_EQ(close.configurations.size(), 4u);
  EXPECT_DOUBLE_EQ(close.configurations[3].subject_distance_mm.value(), 300);
}

TEST(Page, FaultsAreRefusedWithLineAndCell) {
  expect_tokens(refusal(with(small, "60.0", "6O.0")), {"x:4", "\"6O.0\""});
  expect_tokens(refusal(with(small, "1.5168", "l.5168")), {"x:4", "\"l.5168\""});
  expect_tokens(refusal(with(small, "-48.0", "48.0")), {"line 2", 52.4, 48, "line 5"});
  expect_tokens(refusal(with(small, "f = 52.4", "f = 55")), {"line 2", 55});
  expect_tokens(refusal(with(small, "1.0E-06", "1.0E06")), {"x:9", "A4"});
  expect_tokens(refusal(with(small, "1.0E-06", "1.0E-O6")), {"x:9"});
  expect_tokens(refusal(with(small, "Surface 1", "Surface 7")), {"x:9", 7});
  expect_tokens(refusal(with(small, "Surface 1", "Surface 2")), {"x:4", "asphere"});
  expect_tokens(refusal(with(small, "K = 0.5", "K = 0.5 K = 0.6")), {"x:9", "K"});
  expect_tokens(refusal(with(small, "2 -48.0 1.0\n", "")), {"x:5"});
  expect_tokens(refusal(with(small, " 64.2", "")), {"x:4"});
  expect_tokens(refusal(with(small, "-48.0 1.0", "-48.0 d2")), {"x:5", "thickness", "\"d2\""});
  expect_tokens(refusal(small + "Various data\n1.0 2.0 3.0\n"), {"x:11"});
  expect_tokens(refusal(small + "SC = 0.5\n"), {"x:10"});
  EXPECT_NE(refusal(with(small, "1* 60.0 5.0 1.5168 64.2\n", "")), "no error");
  expect_tokens(refusal(with(small, "1.5168 64.2", "")), {"x:4", "index"});
  // A line behind a clean table is no row.
  const std::string clean = "No. r d nd vd\n1 60.0 5.0 1.5168 64.2\n2 -48.0 47\n";
  EXPECT_EQ(read(clean + "f 52.4\n").surfaces.size(), 2u);
  EXPECT_EQ(refusal("Focal length 70\n" + clean).find("no error"), std::string::npos);
}

/// A change of a page: moves nothing, or takes or damages one number.
enum class Change { blanks, line_ends, columns, missing_cell, ocr, missing_row };

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  return lines;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string operator()(const std::string& text, Change change) {
    std::vector<std::string> lines = lines_of(text);
    if (change == Change::columns) swap_columns(lines);
    std::string& line = lines[below(lines.size())];
    if (change == Change::missing_cell) line = without_number(line);
    if (change == Change::missing_row) without_row(lines);
    if (change == Change::ocr) replace_digit(line);
    std::string result;
    const std::string end = change == Change::line_ends ? (below(2) != 0 ? "\r\n" : "\r") : "\n";
    for (const std::string& each : lines) result += (change == Change::blanks ? with_blanks(each) : each) + end;
    return result;
  }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }

 private:
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  /// Start and end of a number with a point; equal if the line has no number.
  std::pair<std::size_t, std::size_t> number_in(const std::string& line) {
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (!is_digit(line[i]) || (i > 0 && line[i - 1] != ' ' && line[i - 1] != '-' && line[i - 1] != '\t')) continue;
      const std::size_t start = i > 0 && line[i - 1] == '-' ? i - 1 : i;
      std::size_t end = std::min(line.find_first_of(" \t", i), line.size());
      if (line[end - 1] == ',') --end;
      if (line.substr(i, end - i).find_first_of(".,") != std::string::npos) found.emplace_back(start, end);
      i = end;
    }
    return found.empty() ? std::pair<std::size_t, std::size_t>() : found[below(found.size())];
  }
  std::string without_number(std::string line) {
    const auto [start, end] = number_in(line);
    return line.erase(start, end - start);
  }
  /// Clears a line that begins with the number of a surface.
  void without_row(std::vector<std::string>& lines) {
    std::vector<std::string*> rows;
    for (std::string& line : lines) {
      const std::size_t digit = line.find_first_of("0123456789");
      const bool row = digit == 0 || (digit == 1 && std::string_view("Rr*").find(line[0]) != std::string_view::npos);
      if (row && std::ranges::count(line, '.') > 1) rows.push_back(&line);
    }
    if (!rows.empty()) rows[below(rows.size())]->clear();
  }
  void replace_digit(std::string& line) {
    const auto [start, end] = number_in(line);
    for (std::size_t i = start; i < end; ++i) {
      if (line[i] != '0' && line[i] != '1') continue;
      line[i] = line[i] == '0' ? 'O' : 'l';
      return;
    }
  }
  std::string with_blanks(const std::string& line) {
    std::string result;
    for (const char c : line) result += c == ' ' ? std::string(1 + below(3), ' ') : std::string(1, c);
    return result + std::string(below(3), ' ');
  }
  /// Exchanges index and V-number in head and rows.
  static void swap_columns(std::vector<std::string>& lines) {
    for (std::string& line : lines) {
      const std::size_t last = line.find_last_not_of(' '), v = line.rfind(' ', last);
      if (v == std::string::npos || v == 0) continue;
      const std::size_t n = line.rfind(' ', line.find_last_not_of(' ', v));
      if (n == std::string::npos) continue;
      const std::string first = line.substr(n + 1, line.find_last_not_of(' ', v) - n),
                        second = line.substr(v + 1, last - v);
      const bool head = first == "nd" || first == "Nd" || first == "\u03bdd";
      const auto is_index = [](const std::string& cell) { return cell.starts_with("1.") || cell.starts_with("2.0"); };
      const auto is_abbe = [](const std::string& cell) { return cell.find('.') == 2 && cell.size() < 7; };
      const bool glass = (is_index(first) && is_abbe(second)) || (is_abbe(first) && is_index(second));
      if (head || glass) line = line.substr(0, n + 1) + second + ' ' + first;
    }
  }

  std::mt19937 random_;
};

TEST_P(PageOf, MutationsAreReadRightOrRefusedByLine) {
  const std::string style = GetParam().file, text = page(style);
  const Prescription truth = read(text);
  Mutator mutate(7);
  int read_right = 0, refused = 0;
  for (int i = 0; i < 84; ++i) {
    auto change = static_cast<Change>(i % 6);
    // Rows without numbers are not missed; only rows that state all cells have their columns exchanged.
    if (change == Change::missing_row && style == "smith") change = Change::ocr;
    const bool two_last = style == "sony_prime" || style == "sony_phone" || style.starts_with("tamron");
    if (change == Change::columns && !two_last) change = Change::missing_cell;
    const std::string changed = mutate(text, change);
    const std::string trace = "mutation " + std::to_string(i);
    try {
      EXPECT_EQ(difference(read(changed), truth), "") << trace << "\n" << changed;
      ++read_right;
    } catch (const Error& e) {
      const std::string message = e.what();
      const bool named = message.find("line ") != std::string::npos || message.starts_with("x:");
      EXPECT_TRUE(named) << trace << ": " << message;
      EXPECT_GE(static_cast<int>(change), static_cast<int>(Change::missing_cell)) << trace << ": " << message;
      ++refused;
    }
  }
  EXPECT_GT(read_right, 28);
  EXPECT_GT(refused, 14);
}

INSTANTIATE_TEST_SUITE_P(Styles, PageOf, ::testing::ValuesIn(pages), [](const auto& p) { return p.param.file; });

}  // namespace
}  // namespace petzval::testing
