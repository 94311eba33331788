// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "petzval/analysis/report.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/io/json.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "program.hpp"
#include "relay_zmx.hpp"

namespace {

class LensReport : public Programs {};

TEST_F(LensReport, NumbersEqualTheLibrary) {
  const std::string file = lens("double_gauss_100mm_f1.35");
  const auto outcome = run("report", {file, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = nlohmann::json::parse(outcome.out);
  const std::vector<double> wavelengths = json["wavelengths_nm"];
  const petzval::Lens lens = petzval::compile(petzval::read_prescription(file), wavelengths);
  const petzval::LensReport report = petzval::lens_report(lens, {.fields_deg = json["fields_deg"]});
  const nlohmann::json whole = nlohmann::json::parse(petzval::to_json(report));
  for (const auto& [key, value] : whole.items()) EXPECT_EQ(json[key], value) << key;

  EXPECT_EQ(json["dispersion"], "catalogue");
  EXPECT_EQ(json["edge_thicknesses_mm"][0], petzval::edge_thicknesses(lens)[0].value());
  EXPECT_TRUE(json["edge_thicknesses_mm"].back().is_null());
  // Values printed by the sources (data/README.md).
  EXPECT_NEAR(json["effective_focal_length_mm"].get<double>(), 100.437, 0.0005);
  EXPECT_NEAR(json["f_number"].get<double>(), 1.353, 0.0005);

  EXPECT_EQ(json["seidel"][2]["surface"], 2);
  EXPECT_EQ(json["seidel"][2]["S5"], report.seidel->surfaces[2].s5);
  EXPECT_EQ(json["paraxial_rays"][3]["chief_u"], report.paraxial_rays->surfaces[3].chief_u);
  EXPECT_NEAR(json["ray_fans"][16]["tangential_waves"].get<double>(), 0, 1e-9);  // the chief ray
  EXPECT_EQ(json["mtf"][24]["sagittal"], (*report.mtf)[1][3].sagittal);
  EXPECT_EQ(json["mtf_over_field"][32]["sampling_error"], (*report.mtf_over_field)[10][2].sampling_error);
  const auto& mtf = json["mtf_diffraction"][1];
  EXPECT_EQ(mtf["field_deg"], json["fields_deg"][1]);
  EXPECT_EQ(mtf["wavelengths"], json["wavelengths_nm"]);
  EXPECT_EQ(mtf["lp_per_mm"][5], 40);
  EXPECT_EQ(mtf["sagittal"][5], (*report.mtf_diffraction)[1][5].sagittal);
  EXPECT_EQ(mtf["error"], (*report.mtf_diffraction)[1][0].sampling_error);
  EXPECT_NEAR(mtf["image_height_mm"].get<double>(), std::abs(*(*report.spots)[1][1].chief_ray_height), 1e-9);
  ASSERT_EQ(json["mtf_chart"].size(), 8u);  // wide open and at f/8
  const auto& line = json["mtf_chart"][5];
  EXPECT_EQ(line["f_number"], 8);
  EXPECT_EQ(line["lp_per_mm"], 20);
  EXPECT_EQ(line["tangential"][3], report.mtf_chart->at(1).second[3][1].tangential);
  EXPECT_EQ(line["image_height_mm"][10], json["mtf_diffraction"][2]["image_height_mm"]);
  EXPECT_EQ(json["encircled_energy"][7]["radius_um"], 1000 * *(*report.encircled_energy)[1][3].radius_mm);
  EXPECT_EQ(json["lateral_colour"][8]["chief_ray_shift_um"], 1000 * *(*report.lateral_colour)[2][2]);
  EXPECT_EQ(json["wavefront"][5]["wavelength_nm"], wavelengths[2]);
  EXPECT_EQ(json["wavefront"][5]["rms_waves"], (*report.wavefront)[1][2]->rms_waves);
  EXPECT_EQ(json["wavefront"][5]["zernike_fringe"][8], (*report.wavefront)[1][2]->zernike[8]);

  const auto one = nlohmann::json::parse(run("report", {file, "--json", "--wavelengths", "550"}).out);
  EXPECT_TRUE(one["seidel_sums"]["C1"].is_null());
}

constexpr const char* two_planes = R"({"format": "petzval-lens 1", "id": "window", "name": "Window",
  "source": {"design": "test", "numbers": "test"}, "focal_length_mm": null, "f_number": null, "half_field_deg": null,
  "image_diagonal_mm": null, "reference_wavelength_nm": 587.5618,
  "surfaces": [
    {"radius": 0.0, "thickness": 5.0, "glass": null, "nd": 1.5, "vd": 60.0, "semi_diameter": 10.0, "conic": 0.0, "aspheric": [], "stop": false},
    {"radius": 0.0, "thickness": 50.0, "glass": null, "nd": 1.0, "vd": null, "semi_diameter": 10.0, "conic": 0.0, "aspheric": [], "stop": false}
  ]
})";

TEST_F(LensReport, WindowHasNoFocalLengthAndFindingsAreNoFailure) {
  write("window.json", two_planes);
  const auto outcome = run("report", {path("window.json"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["afocal"], true);
  EXPECT_TRUE(json["effective_focal_length_mm"].is_null());
  EXPECT_EQ(json["stop_inferred"], true);
  petzval::testing::expect_tokens(outcome.err, {"stop", "surface"});
  ASSERT_FALSE(json["lint"].empty());
  EXPECT_EQ(json["lint"][0]["kind"], "no_stop");
  EXPECT_FALSE(json["lint"][0]["message"].get<std::string>().empty());
}

TEST_F(LensReport, ReportsTheAbbeModelOnce) {
  const auto outcome = run("report", {lens("petzval_portrait_100mm_f3.4"), "--json", "--wavelengths", "500"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["dispersion"], "abbe");
  petzval::testing::expect_tokens(outcome.err, {"petzval_portrait_100mm_f3.4", 4, "n_d/V_d", 587.5618});
  EXPECT_EQ(lines(outcome.err).size(), 1u);
}

// Indices at the reference wavelength equal the printed indices of the file, not the glass tables.
TEST_F(LensReport, HasNoNoteAboutGlassesAtTheReferenceWavelength) {
  for (const char* program : {"report", "focus"}) {
    const auto outcome = run(program, {lens("petzval_portrait_100mm_f3.4"), "--json"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "") << program;
  }
  // Figures in F, d and C use the model.
  const auto page = run("report", {lens("petzval_portrait_100mm_f3.4"), "--out", path("page")});
  petzval::testing::expect_tokens(page.err, {4, "media"});
}

const std::string litho = examples_testing::relay_zmx(R"(VERS 140124 258 36214 0 0
MODE SEQ
NAME Relay at 450 nm
UNIT MM X W X CM MR CPMM
ENPD 12.5
FTYP 1 0 2 2 0 0 0
YFLN 0.0 6.0
)");

// The file gives the object distance, the wavelengths with weights, the primary wavelength and the fields.
TEST_F(LensReport, UsesTheConditionsOfTheFile) {
  write("relay.zmx", litho);
  const auto outcome = run("report", {path("relay.zmx"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["wavelength_nm"], 450);
  EXPECT_EQ(json["wavelengths_nm"], (nlohmann::json{550, 450}));
  EXPECT_EQ(json["wavelength_weights"], (nlohmann::json{1, 0.25}));
  EXPECT_EQ(json["subject_distance_mm"], 200);
  EXPECT_EQ(json["film"], "file");
  EXPECT_EQ(json["film_z_mm"], 68);
  EXPECT_NEAR(json["fields_deg"][1].get<double>(), std::atan(6.0 / 200) * 180 / 3.141592653589793, 1e-4);
  // OpticStudio prints the declared entrance pupil, and the focal length over its diameter as the f-number.
  EXPECT_EQ(json["declared_entrance_pupil_diameter_mm"], 12.5);
  EXPECT_NEAR(json["declared_f_number"].get<double>(), json["effective_focal_length_mm"].get<double>() / 12.5, 1e-12);
  const double ratio = 12.5 / json["entrance_pupil_diameter_mm"].get<double>();
  EXPECT_NEAR(json["seidel_sums_declared"]["S1"].get<double>(),
              json["seidel_sums"]["S1"].get<double>() * std::pow(ratio, 4), 1e-12);
  EXPECT_NEAR(json["optical_invariant_declared_mm"].get<double>(), json["optical_invariant_mm"].get<double>() * ratio,
              1e-12);
  ASSERT_EQ(run("report", {path("relay.zmx"), "--out", path("page")}).status, 0);
  const std::string page = read(path("page/relay.html"));
  EXPECT_EQ(page.find("subject at infinity"), std::string::npos);
  EXPECT_NE(page.find("subject at z = -200 mm"), std::string::npos);
  EXPECT_NE(page.find("weight 0.25"), std::string::npos);
}

TEST_F(LensReport, FindsTheDeclaredPupilOfEverySetting) {
  const auto declared = [&](const std::string& aperture) {
    std::string file = litho;
    file.replace(file.find("ENPD 12.5"), 9, aperture);
    write("relay.zmx", file);
    return nlohmann::json::parse(run("report", {path("relay.zmx"), "--json"}).out);
  };
  // The cone of the object fills the entrance pupil, which is the front of this lens.
  EXPECT_NEAR(declared("OBNA 0.05 0")["declared_entrance_pupil_diameter_mm"].get<double>(),
              2 * 200 * std::tan(std::asin(0.05)), 1e-3);
  EXPECT_NEAR(declared("FNUM 4 0")["declared_f_number"].get<double>(), 4, 1e-9);
  const auto floating = declared("FLOA");
  EXPECT_EQ(floating["declared_entrance_pupil_diameter_mm"], floating["entrance_pupil_diameter_mm"]);
  EXPECT_TRUE(nlohmann::json::parse(
                  run("report", {lens("double_gauss_100mm_f2.0"), "--json"}).out)["declared_entrance_pupil_diameter_mm"]
                  .is_null());
}

TEST_F(LensReport, AllowsTheDLineAloneWithoutVd) {
  const auto outcome = run("report", {lens("fisheye_10mm_f4"), "--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["dispersion"], "none");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(LensReport, ReportsBothSectionsOfALensWithCylinders) {
  const std::string file = lens("anamorphic_60mm_2x");
  const auto json = nlohmann::json::parse(run("report", {file, "--json"}).out);
  EXPECT_EQ(json["meridian"], "y");
  const auto &x = json["meridians"]["x"], &y = json["meridians"]["y"];
  // Values printed by the patent.
  EXPECT_NEAR(y["effective_focal_length_mm"].get<double>(), 60.55, 0.01);
  EXPECT_NEAR(x["effective_focal_length_mm"].get<double>(), 31.49, 0.01);
  for (const auto& [key, value] : y.items()) EXPECT_EQ(json[key], value) << key;
  const auto compiled = petzval::compile(petzval::read_prescription(file));
  const auto pupils = petzval::pupils(compiled, 0, petzval::Meridian::x);
  EXPECT_EQ(x["entrance_pupil_diameter_mm"], pupils.entrance.diameter);
  EXPECT_EQ(x["f_number_paraxial"], x["effective_focal_length_mm"].get<double>() / pupils.entrance.diameter);

  const auto round = nlohmann::json::parse(run("report", {lens("cooke_triplet_50mm_f5"), "--json"}).out);
  EXPECT_TRUE(round["meridians"].is_null());
  EXPECT_EQ(round["meridian"], "y");
}

TEST_F(LensReport, DrawsFiguresAndAPage) {
  const std::string file = lens("cooke_triplet_50mm_f5");
  const auto outcome = run("report", {file, "--out", path("out")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto written = lines(outcome.out);
  const std::vector<std::string> names{"layout.svg",    "spots.svg",     "through_focus.svg", "energy.svg",
                                       "fans.svg",      "wavefront.svg", "footprints.svg",    "focus.svg",
                                       "mtf_chart.svg", "mtf.svg",       "mtf_focus.svg",     "mtf_field.svg",
                                       "colour.svg",    "field.svg",     "seidel.svg",        "illumination.svg"};
  ASSERT_EQ(written.size(), names.size() + 1);
  const std::string page = read(path("out/cooke_triplet_50mm_f5.html"));
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(written[i], path("out/cooke_triplet_50mm_f5_" + names[i]));
    const std::string svg = read(written[i]);
    EXPECT_TRUE(svg.starts_with("<svg")) << names[i];
    EXPECT_NE(page.find(svg), std::string::npos) << names[i] << " is in the page";
  }
  // The fields are 0, 0.7 and 1 of the declared 20 degrees; the page names the source and the findings.
  for (const char* field : {"field 0\u00b0", "field 14\u00b0", "field 20\u00b0"}) {
    EXPECT_NE(page.find(field), std::string::npos) << field;
  }
  EXPECT_NE(page.find("textbook Cooke triplet"), std::string::npos);
  for (const char* table : {">Wavefront</h2>", ">Third order</h2>", ">Lint</h2>"}) {
    EXPECT_NE(page.find(table), std::string::npos) << table;
  }
  EXPECT_EQ(page.find("href=\"h"), std::string::npos) << "it needs no other file";

  // Ghosts of a light at 14 degrees, as the library finds them; the order of the rows is that of energies.
  const petzval::Lens bare = petzval::with_coating(petzval::compile(petzval::read_prescription(file)), {});
  const auto light =
      petzval::scene_point(bare, {.field_rad = petzval::radians(14), .z = -std::numeric_limits<double>::infinity()});
  const auto ghosts = petzval::ghost_pairs(bare, light).pairs;
  const std::string table = page.substr(page.find(">Ghosts</h2>"), 4000);
  const std::regex row(R"((\d+), then (\d+)</td><td class="number">([\d.e-]+)<)");
  std::size_t k = 0;
  for (std::sregex_iterator found(table.begin(), table.end(), row), end; found != end; ++found, ++k) {
    ASSERT_LT(k, std::min<std::size_t>(10, ghosts.size()));
    EXPECT_EQ((*found)[1], std::to_string(ghosts[k].second));
    EXPECT_EQ((*found)[2], std::to_string(ghosts[k].first));
    EXPECT_NEAR(std::stod((*found)[3]) / ghosts[k].energy, 1, 0.02);
  }
  EXPECT_EQ(k, 10u);

  run("report", {file, "--out", path("again")});
  EXPECT_EQ(read(path("again/cooke_triplet_50mm_f5.html")), page);
}

/// The groups of a pattern in a text, as numbers; a group may be a list like "2, 3".
std::vector<int> numbers_in(const std::string& text, const std::string& pattern) {
  std::vector<int> result;
  const std::regex whole(pattern), digits("[0-9]+");
  for (std::sregex_iterator match(text.begin(), text.end(), whole), end; match != end; ++match) {
    const std::string group = (*match)[1];
    for (std::sregex_iterator each(group.begin(), group.end(), digits); each != end; ++each) {
      result.push_back(std::stoi(each->str()));
    }
  }
  return result;
}

/// Surface 2 clips the beam of the stop, surface 1; the rims of surfaces 0 and 3 are computed; no glass has a name.
constexpr const char* small_rim = R"({"format": "petzval-lens 1", "id": "rims", "name": "Rims",
  "source": {"design": "test", "numbers": "test"}, "focal_length_mm": null, "f_number": null, "half_field_deg": 2,
  "image_diagonal_mm": null, "reference_wavelength_nm": 587.5618,
  "surfaces": [
    {"radius": 60.0, "thickness": 4.0, "glass": null, "nd": 1.5678, "vd": 61.0, "semi_diameter": null, "conic": 0.0, "aspheric": [], "stop": false},
    {"radius": -60.0, "thickness": 2.0, "glass": null, "nd": null, "vd": null, "semi_diameter": 10.0, "conic": 0.0, "aspheric": [], "stop": true},
    {"radius": 60.0, "thickness": 4.0, "glass": null, "nd": 1.5678, "vd": 61.0, "semi_diameter": 5.0, "conic": 0.0, "aspheric": [], "stop": false},
    {"radius": 0.0, "thickness": 20.0, "glass": null, "nd": null, "vd": null, "semi_diameter": null, "conic": 0.0, "aspheric": [], "stop": false}
  ]
})";

TEST_F(LensReport, CountsSurfacesFromOneIfAsked) {
  write("rims.json", small_rim);
  const std::string file = path("rims.json");
  const auto report = [&](const std::string& base, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{file, "--surfaces-from", base};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run("report", arguments);
  };
  const auto expect_shifted = [](std::string zero, std::string one, const std::string& pattern, std::size_t least) {
    std::vector<int> from_zero = numbers_in(zero, pattern);
    EXPECT_GE(from_zero.size(), least) << pattern << '\n' << zero;
    for (int& number : from_zero) ++number;
    EXPECT_EQ(numbers_in(one, pattern), from_zero) << pattern;
  };
  const std::string named = "surfaces? ([0-9]+(?:, [0-9]+)*)";

  // Text: the stop, two computed rims, two missing glasses, and four surfaces in two or more findings.
  const auto text = report("0", {}), text_from_one = report("1", {});
  ASSERT_EQ(text_from_one.status, 0) << text_from_one.err;
  EXPECT_EQ(run("report", {file}).out, text.out);
  EXPECT_NE(text.out.find("surfaces are numbered from 0"), std::string::npos);
  EXPECT_NE(text_from_one.out.find("surfaces are numbered from 1"), std::string::npos);
  EXPECT_NE(text.out.find("surface 1: the stop passes"), std::string::npos) << text.out;
  EXPECT_NE(text_from_one.out.find("but surface 3 clips it"), std::string::npos) << text_from_one.out;
  expect_shifted(text.out, text_from_one.out, named, 8);

  // JSON: only surface numbers change.
  const auto json = nlohmann::json::parse(report("0", {"--json"}).out);
  const auto from_one = nlohmann::json::parse(report("1", {"--json"}).out);
  EXPECT_EQ(json["surfaces_from"], 0);
  EXPECT_EQ(json["stop_surface"], 1);
  EXPECT_EQ(json["computed_apertures"], (nlohmann::json{0, 3}));
  std::size_t shifted = 0;
  const auto difference = nlohmann::json::diff(json, from_one);
  for (const auto& change : difference) {
    const std::string key = change["path"];
    ASSERT_EQ(change["op"], "replace") << key;
    if (key.ends_with("/message")) continue;
    EXPECT_TRUE(key.ends_with("/surface") || key.starts_with("/computed_apertures/") || key == "/surfaces_from" ||
                key == "/stop_surface")
        << key;
    EXPECT_EQ(change["value"], json[nlohmann::json::json_pointer(key)].get<int>() + 1) << key;
    ++shifted;
  }
  EXPECT_EQ(shifted, 1 + 1 + 2 + 4 + 4 + json["lint"].size());  // base, stop, apertures, Seidel sums, rays, findings
  expect_shifted(json["lint"].dump(), from_one["lint"].dump(), named, 3);

  // Page and figures.
  ASSERT_EQ(report("0", {"--out", path("zero")}).status, 0);
  ASSERT_EQ(report("1", {"--out", path("one")}).status, 0);
  const std::string page = read(path("zero/rims.html")), page_from_one = read(path("one/rims.html"));
  expect_shifted(page, page_from_one, named, 6);
  expect_shifted(page, page_from_one, "<tr><td class=\"number\">([0-9]+)</td>", 4);
  expect_shifted(page, page_from_one, "surfaces are numbered from ([0-9]+)", 2);
  for (const char* figure : {"layout", "footprints"}) {
    const std::string name = std::string("/rims_") + figure + ".svg";
    expect_shifted(read(path("zero" + name)), read(path("one" + name)), named, 1);
  }
  expect_shifted(read(path("zero/rims_seidel.svg")), read(path("one/rims_seidel.svg")), "surface, from ([0-9])", 2);
}

TEST_F(LensReport, CountsSurfacesFromOneInTheNoteAboutTheStop) {
  write("window.json", two_planes);
  const std::string zero = run("report", {path("window.json")}).err;
  const std::string one = run("report", {path("window.json"), "--surfaces-from", "1"}).err;
  EXPECT_NE(zero.find("surface 0, which limits"), std::string::npos) << zero;
  EXPECT_NE(one.find("surface 1, which limits"), std::string::npos) << one;
  const auto refused = run("report", {path("window.json"), "--surfaces-from", "2"});
  EXPECT_NE(refused.status, 0);
  petzval::testing::expect_tokens(refused.err, {"--surfaces-from", "2"});
}

/// The cells of the row of a surface in one of the tables of a page.
std::vector<std::string> row_of(const std::string& page, const std::string& heading, const std::string& first) {
  std::vector<std::string> cells;
  std::size_t at = page.find("<tr><td class=\"number\">" + first + "</td>", page.find('>' + heading + "</h2>"));
  if (at == std::string::npos) at = page.find("<tr><td>" + first + "</td>", page.find('>' + heading + "</h2>"));
  if (at == std::string::npos) return cells;
  const std::string row = page.substr(at, page.find("</tr>", at) - at);
  const std::regex cell("<td[^>]*>([^<]*)</td>");
  for (std::sregex_iterator each(row.begin(), row.end(), cell), end; each != end; ++each) cells.push_back((*each)[1]);
  return cells;
}

// Every number of the table can be compared with the source.
TEST_F(LensReport, TableOfThePageHasTheNumbersOfTheSource) {
  const auto page = [&](const std::string& id) {
    EXPECT_EQ(run("report", {lens(id), "--out", path("out"), "--surfaces-from", "1"}).status, 0) << id;
    return read(path("out/" + id + ".html"));
  };
  using Cells = std::vector<std::string>;
  const std::string cine = page("cine_100mm_t1.3");
  const Cells row = row_of(cine, "Table", "11");
  EXPECT_EQ(Cells(row.begin(), row.begin() + 7), (Cells{"11", "-230.02127", "2.8", "1.61344", "44.29", "", "26.78"}));
  EXPECT_EQ(row.back(), "asphere");
  EXPECT_EQ(row_of(cine, "Aspheres", "11"),
            (Cells{"11", "0", "8.669e-07", "9.23e-11", "2.783e-14", "-9.209e-16", "1.576e-18", "-8.587e-22"}));
  const petzval::Lens compiled = petzval::compile(petzval::read_prescription(lens("cine_100mm_t1.3")));
  const auto edges = petzval::edge_thicknesses(compiled);
  ASSERT_TRUE(edges[0]);
  EXPECT_NEAR(std::stod(row_of(cine, "Table", "1").at(7)), *edges[0], 1e-4 * *edges[0]);
  EXPECT_EQ(row_of(cine, "Table", "23").at(7), "");

  // Values with more digits than the source has, from a conversion of units or a solve.
  const std::string mirrors = page("catadioptric_corrector_25mm_f1.25");
  EXPECT_EQ(row_of(mirrors, "Table", "4").at(1), "-55.9");
  EXPECT_EQ(row_of(mirrors, "Aspheres", "4"), (Cells{"4", "1.077", "", ""}));
  EXPECT_EQ(row_of(mirrors, "Aspheres", "5"), Cells{});

  const std::string zoom = page("zoom_70-210mm_f4");
  EXPECT_EQ(row_of(zoom, "Positions", "focal length"), (Cells{"focal length", "70.55", "137.04", "205.31"}));
  EXPECT_EQ(row_of(zoom, "Positions", "13"), (Cells{"13", "18.42", "2.87", "8.5"}));
  EXPECT_EQ(zoom.find(">Aspheres</h2>"), std::string::npos);

  const std::string anamorphic = page("anamorphic_60mm_2x");
  EXPECT_EQ(row_of(anamorphic, "Table", "1").back(), "cylinder, curved in x");
  EXPECT_EQ(row_of(anamorphic, "Table", "1").at(7), "");
  EXPECT_NE(row_of(anamorphic, "Table", "7").at(7), "");
  EXPECT_EQ(anamorphic.find(">Positions</h2>"), std::string::npos);
}

TEST_F(LensReport, ReportsTheLightOfCoatings) {
  const std::string file = lens("double_gauss_100mm_f1.35");
  const auto report = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{file, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("report", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const auto plain = report({}), bare = report({"--coatings", "none"}), coated = report({"--coatings", "mgf2"});
  EXPECT_TRUE(plain["transmittance"].is_null());
  EXPECT_TRUE(plain["t_stop"].is_null());
  ASSERT_EQ(bare["transmittance"].size(), 9u);
  EXPECT_GT(coated["transmittance"][0]["value"].get<double>(), bare["transmittance"][0]["value"].get<double>() + 0.2);
  EXPECT_GT(bare["t_stop"].get<double>(), coated["t_stop"].get<double>());
  EXPECT_EQ(bare["coatings"], "none");
  EXPECT_NEAR(bare["colour"]["light_correlated_colour_temperature_k"].get<double>(), 6504, 5);
  EXPECT_GT(bare["colour"]["shift_mired"].get<double>(), 0);  // high indices of flint reflect more blue

  // Reflectances of 1 % at each of the eight surfaces to air.
  std::ofstream(path("coating.csv")) << "wavelength_nm,reflectance\n300,0.01\n900,0.01\n";
  EXPECT_NEAR(report({"--coatings", path("coating.csv")})["transmittance"][0]["value"].get<double>(), std::pow(0.99, 8),
              0.02);
  std::ofstream(path("layers.csv")) << "index,absorption,thickness_nm\n1.38,0,99.6377\n";
  EXPECT_NEAR(report({"--coatings", path("layers.csv")})["t_stop"].get<double>(), coated["t_stop"].get<double>(), 1e-5);
  const auto page = run("report", {file, "--coatings", "mgf2", "--out", path("light")});
  EXPECT_EQ(page.status, 0);
  for (const char* figure : {"transmittance", "transmittance_field"}) {
    const std::string name = path(std::string("light/double_gauss_100mm_f1.35_") + figure + ".svg");
    EXPECT_NE(page.out.find(name), std::string::npos);
    EXPECT_TRUE(read(name).starts_with("<svg"));
  }
  EXPECT_NE(read(path("light/double_gauss_100mm_f1.35.html")).find("T-stop 1.38"), std::string::npos);
  EXPECT_NE(run("report", {file, "--coatings", "gold"}).err.find("must be none, mgf2, file or a file.csv"),
            std::string::npos);
}

TEST_F(LensReport, CoatingFiles_WithValuesOutOfRange_AreNamedWithLineAndValue) {
  const std::string file = path("layers.csv"), head = "index,absorption,thickness_nm\n1.38,0,100\n";
  const auto refused = [&](const std::string& rows, const std::vector<petzval::testing::Token>& tokens) {
    write("layers.csv", head + rows);
    expect_failure("report", {lens("double_gauss_100mm_f2.0"), "--coatings", file, "--quiet"}, tokens);
  };
  refused("1e-300,0,100\n", {"layers.csv", "line 3", "index", "1e-300"});
  refused("1.38,2e3,100\n", {"layers.csv", "line 3", "absorption", "2e3"});
  refused("1.38,0,1e300\n", {"layers.csv", "line 3", "thickness_nm", "1e300"});
  std::string many;
  for (int i = 0; i < 10'000; ++i) many += "1.38,0,1\n";
  refused(many, {"layers.csv", 10001, 10000});
}

TEST_F(LensReport, WritesPageAndJsonAtChosenWavelengths) {
  const auto outcome =
      run("report", {lens("planar_50mm_f1.4"), "--json", "--out", path("both"), "--wavelengths", "450,550,650"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["wavelengths_nm"], (std::vector<double>{450, 550, 650}));
  EXPECT_EQ(json["wavelength_nm"], 550);  // the nearest to d
  EXPECT_EQ(json["f_number"].get<double>() < json["f_number_paraxial"].get<double>(), true);
  EXPECT_TRUE(json["wavefront"].back()["strehl"].is_null());
  EXPECT_TRUE(json["wavefront"].back()["strehl_error"].is_null());
  const std::string page = read(path("both/planar_50mm_f1.4.html"));
  EXPECT_LT(page.find("<nav>"), page.find("effective focal length"));
  EXPECT_LT(page.find("effective focal length"), page.find("<svg"));
  EXPECT_NE(page.find("prefers-color-scheme"), std::string::npos);
  const std::string text = run("report", {lens("planar_50mm_f1.4")}).out;
  EXPECT_EQ(text.find("--match-glasses"), text.rfind("--match-glasses"));
  EXPECT_NE(text.find("--match-glasses"), std::string::npos);
}

TEST_F(LensReport, CountsSurfacesAsTheFileDoes) {
  write("table.txt", "no R d nd vd semi\n1 50 5 1.5168 64.2 10\n2 -50 46 1 - 10\n");
  EXPECT_EQ(nlohmann::json::parse(run("report", {path("table.txt"), "--json"}).out)["surfaces_from"], 1);
  EXPECT_EQ(
      nlohmann::json::parse(run("report", {path("table.txt"), "--json", "--surfaces-from", "0"}).out)["surfaces_from"],
      0);
  EXPECT_EQ(nlohmann::json::parse(run("report", {lens("planar_50mm_f1.4"), "--json"}).out)["surfaces_from"], 0);
}

TEST_F(LensReport, UsesTheCoatingsOfTheFile) {
  auto lens_file = read_json(lens("double_gauss_100mm_f1.35"));
  for (const int surface : {0, 1}) lens_file["surfaces"][surface]["coating"] = "mgf2";
  write("coated.json", lens_file.dump());
  const auto report = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {path("coated.json"), "--json"});
    return nlohmann::json::parse(run("report", more).out);
  };
  const auto own = report({}), bare = report({"--coatings", "none"}), coated = report({"--coatings", "mgf2"});
  EXPECT_EQ(own["coatings"], "file");
  EXPECT_EQ(own, report({"--coatings", "file"}));
  EXPECT_EQ(own["uncoated_surfaces"].size(), 6u);
  EXPECT_LT(own["t_stop"].get<double>(), bare["t_stop"].get<double>());
  EXPECT_GT(own["t_stop"].get<double>(), coated["t_stop"].get<double>());
  EXPECT_EQ(coated["coatings"], "mgf2");
  EXPECT_TRUE(coated["uncoated_surfaces"].empty());
  const std::string text = run("report", {path("coated.json"), "--fields", "0"}).out;
  EXPECT_NE(text.find("coatings: of the file; surfaces 2, "), std::string::npos) << text;
  EXPECT_NE(text.find("to air have none and are uncoated"), std::string::npos);
  EXPECT_NE(run("report", {path("coated.json"), "--out", path("of_file")}).out.find("_transmittance.svg"),
            std::string::npos);
}

// Without dispersion the transmittance is known at one wavelength only.
TEST_F(LensReport, ReportsTheKnownLightOnly) {
  const auto outcome = run("report", {lens("fisheye_10mm_f4"), "--json", "--coatings", "mgf2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["colour"].is_null());
  EXPECT_GT(json["transmittance"][0]["value"].get<double>(), 0.8);
}

TEST_F(LensReport, DrawsRequestedFieldsAndBothSections) {
  const auto outcome = run("report", {lens("anamorphic_60mm_2x"), "--out", path("out"), "--fields", "3,6",
                                      "--wavelengths", "550", "--f-number", "8"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(read(path("out/anamorphic_60mm_2x_layout.svg")).find("Section y-z"), std::string::npos);
  EXPECT_NE(read(path("out/anamorphic_60mm_2x_layout_x.svg")).find("Section x-z"), std::string::npos);
  const std::string spots = read(path("out/anamorphic_60mm_2x_spots.svg"));
  EXPECT_NE(spots.find("field 6\u00b0"), std::string::npos);
  EXPECT_EQ(spots.find("field 0\u00b0"), std::string::npos);
  EXPECT_NE(spots.find("f/8,"), std::string::npos);  // at 550 nm, the primary wavelength
  EXPECT_NE(spots.find("550 nm"), std::string::npos);
  EXPECT_EQ(spots.find("656"), std::string::npos);
}

TEST_F(LensReport, PrintsDeclaredAndComputedApertures) {
  const auto zmx = [](const std::string& aperture, const std::string& object) {
    return "MODE SEQ\nUNIT MM\n" + aperture + "\nSURF 0\n  CURV 0\n  DISZ " + object +
           "\nSURF 1\n  STOP\n  CURV 0\n  DISZ 2\n  DIAM 6 1\nSURF 2\n  CURV 0.02\n  DISZ 4\n"
           "  GLAS ___BLANK 1 0 1.5 60\nSURF 3\n  CURV -0.02\n  DISZ 90\nSURF 4\n  CURV 0\n  DISZ 0\n";
  };
  struct Case {
    const char *aperture, *object, *setting;
    double declared, computed;
  };
  // A front stop of 6 mm clips wider beams.
  for (const Case& c :
       {Case{"ENPD 10", "INFINITY", "entrance_pupil_diameter", 10, 10},
        Case{"ENPD 14", "INFINITY", "entrance_pupil_diameter", 14, 12}, Case{"FNUM 8 0", "INFINITY", "f_number", 8, 8},
        Case{"OBNA 0.03 0", "100", "object_na", 0.03, 0.03}, Case{"FNUM 16 1", "100", "working_f_number", 16, 16}}) {
    write("declared.zmx", zmx(c.aperture, c.object));
    const auto json = nlohmann::json::parse(run("report", {path("declared.zmx"), "--json"}).out)["design_aperture"];
    EXPECT_EQ(json["setting"], c.setting);
    EXPECT_EQ(json["value"], c.declared);
    EXPECT_NEAR(json["computed"].get<double>(), c.computed, 1e-6 * c.computed) << c.aperture;
  }
  write("declared.zmx", zmx("FLOA 0", "INFINITY"));
  const auto json = nlohmann::json::parse(run("report", {path("declared.zmx"), "--json"}).out)["design_aperture"];
  EXPECT_EQ(json["setting"], "stop_size");
  EXPECT_TRUE(json["value"].is_null());
  EXPECT_EQ(json["computed"], 6);
}

}  // namespace
