// SPDX-License-Identifier: Apache-2.0
// The tables of lib/docs/reports.md and picture_reports.md describe the JSON of every command: each key of a report has
// a row with its type, and each row has a key in some report.
#include <algorithm>
#include <fstream>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <sstream>

#include "program.hpp"
#include "relay_zmx.hpp"

namespace {

using nlohmann::json;

/// A key of the tables.
struct Row {
  std::string type;
  bool nullable = false, optional = false;
  bool common = false;  ///< explained by the table of the common keys
};
using Table = std::map<std::string, Row>;  ///< by path: "results[].focus_mm"

std::vector<std::string> cells_of(const std::string& line) {
  static const std::regex between(" *\\| *");
  return {std::sregex_token_iterator(line.begin(), line.end(), between, -1), {}};
}

/// The tables of a page, by heading.
std::map<std::string, Table> tables_of(const std::string& page) {
  static const std::regex key("`([^`]+)`");
  std::map<std::string, Table> tables;
  std::string heading, line;
  for (std::istringstream in(page); std::getline(in, line);) {
    if (line.starts_with("## ")) heading = line.substr(3);
    if (heading.empty() || !line.starts_with("| `")) continue;
    const auto cells = cells_of(line);  // the first is empty
    if (cells.size() < 3) continue;
    const std::string last = cells.size() > 5 ? cells[5] : "";
    for (std::sregex_iterator found(cells[1].begin(), cells[1].end(), key), end; found != end; ++found) {
      tables[heading][(*found)[1]] = {cells[2], last.find("null") != std::string::npos,
                                      last.find("absent") != std::string::npos,
                                      line.find("[common]") != std::string::npos};
    }
  }
  return tables;
}

bool has_type(const json& value, const std::string& type) {
  if (const std::size_t between = type.find(" or "); between != std::string::npos) {
    return has_type(value, type.substr(0, between)) || has_type(value, type.substr(between + 4));
  }
  return type == "number"    ? value.is_number()
         : type == "integer" ? value.is_number_integer()
         : type == "string"  ? value.is_string()
         : type == "boolean" ? value.is_boolean()
         : type == "object"  ? value.is_object()
         : type == "array"   ? value.is_array()
                             : false;
}

/// Compares reports with a table.
struct Check {
  const Table& table;
  std::vector<std::string> aliases;  ///< objects whose keys stand in the table without the path of the object
  std::set<std::string> seen = {}, faults = {};

  void keys(const json& value, const std::string& path) {
    for (const auto& [key, member] : value.items()) look(member, path + key);
  }
  void look(const json& value, std::string path) {
    for (const std::string& alias : aliases) {
      if (path == alias) return keys(value, "");
      if (path == alias.substr(0, alias.find("[]"))) seen.insert(path);
    }
    const auto row = table.find(path);
    if (row != table.end()) {
      seen.insert(path);
      if (value.is_null() ? !row->second.nullable : !has_type(value, row->second.type)) {
        faults.insert(path + ": " + value.dump().substr(0, 40) + " is no " + row->second.type);
      }
    } else if (!value.is_structured() || !has_inner(path)) {
      faults.insert(path + ": has no row");
    }
    if (path == "setup") return;  // has the keys of petzval::to_json()
    if (value.is_object()) keys(value, path + '.');
    if (value.is_array()) elements(value, path + "[]");
  }
  void elements(const json& list, const std::string& path) {
    for (const json& element : list) {
      if (!element.is_object()) continue;
      if (std::ranges::find(aliases, path) != aliases.end()) {
        keys(element, "");
      } else {
        keys(element, path + '.');
      }
    }
  }
  void report(const json& value) { value.is_array() ? elements(value, "[]") : keys(value, ""); }

  bool has_inner(const std::string& path) const {
    return std::ranges::any_of(table, [&](const auto& row) {
      return row.first.starts_with(path + '.') || row.first.starts_with(path + "[].");
    });
  }
  std::vector<std::string> unseen() const {
    std::vector<std::string> result;
    for (const auto& [path, row] : table) {
      if (!row.optional && !seen.contains(path)) result.push_back(path);
    }
    return result;
  }
};

/// A command and valid command lines; a report is a file, or the standard output if `file` is empty.
struct Reporter {
  std::string command, file;
  std::vector<Arguments> lines;
  std::vector<std::string> aliases{};
};
std::ostream& operator<<(std::ostream& out, const Reporter& reporter) { return out << reporter.command; }

const std::vector<Reporter> reporters = {
    {"lenses", "", {{"gauss", "52", "--json"}}},
    {"report",
     "",
     {{"LENS", "--json"},
      {"LENS", "--coatings", "none", "--json"},
      {"LENS:anamorphic_60mm_2x", "--json"},
      {"@relay.zmx", "--json"}},
     {"meridians.x", "meridians.y"}},
    {"convert",
     "",
     {{"LENS:zoom_70-210mm_f4", "@zoom.dat", "--json"},
      {"@relay.zmx", "@relay.json", "--json"},
      {"@relay.zmx", "@relay.json", "--strict", "--json"},
      {"@bad.json", "@good.json", "--repair", "--json"}}},
    {"focus", "", {{"LENS", "--json"}, {"LENS", "--at", "1m,20mm", "--json"}}},
    {"export",
     "",
     {{"LENS", "--focus", "inf", "--calibration", "@out", "--json"},
      {"LENS", "--focus", "inf", "--size", "24", "--lens-samples", "2", "--ray-map", "@rays.exr", "--json"},
      {"LENS", "--camera", "@camera.bin", "--json"},
      {"--all", "--camera", "@tables", "--json"}}},
    {"metadata", "", {{"LENS", "--film", "36x1", "--coatings", "mgf2", "--out", "@out", "--json"}}},
    {"spots", "out/double_gauss_100mm_f2_28deg_spots.json", {{"LENS", "--rays", "1", "--out", "@out", "--json"}}},
    {"psf",
     "out/double_gauss_100mm_f2_28deg_bokeh.json",
     {{"LENS", "--at", "inf", "--focus", "1m,inf", "--rays", "16", "--format", "pfm", "--out", "@out", "--json"}}},
    {"psf-set",
     "out/psf_set.json",
     {{"LENS", "--fields", "0,5", "--at", "2m", "--rays", "16", "--size", "3", "--check", "--out", "@out", "--json"}}},
    {"colour",
     "out/double_gauss_100mm_f2_28deg_chromatic.json",
     {{"LENS", "--at", "2m", "--focus", "2m", "--fields", "0", "--rays", "1", "--out", "@out", "--json"}}},
    {"ghosts",
     "out/ghosts.json",
     {{"LENS", "--light", "0,5", "--wavelengths", "d", "--size", "8", "--out", "@out", "--json"},
      {"LENS", "--light", "0,5,2m", "--wavelengths", "d", "--size", "8", "--out", "@out", "--json"}}},
    {"expressive", "out/expressive.json", {{"LENS", "--at", "2m", "--rays", "1", "--out", "@out", "--json"}}},
    {"models", "", {{"LENS", "--json"}}},
    {"choose", "", {{"LENS", "--near", "1m", "--far", "2m", "--budget", "1", "--json"}}},
#ifdef PETZVAL_TEST_HAS_tilt
    {"tilt",
     "",
     {{"--thin-lens", "50", "--f-number", "2", "--points", "@slope.json", "--out", "@out", "--json"},
      {"--thin-lens", "50", "--f-number", "2", "--points", "@points.json", "--out", "@out", "--json"}}},
    {"pull", "", {{"LENS", "--keys", "@keys.json", "--out", "@out", "--json"}}},
#endif
#ifdef PETZVAL_TEST_HAS_render
    {"render",
     "out/render.json",
     {{"--scene", "balls", "LENS", "--focus", "1m", "--size", "8x8", "--spp", "1", "--ghosts", "1", "--out", "@out"}}},
#endif
#ifdef PETZVAL_TEST_HAS_blur
    {"blur",
     "out/blur.json",
     {{"--scene", "town", "--thin-lens", "50", "--f-number", "8", "--focus", "3m", "--size", "8x8", "--compare",
       "--supersample", "1", "--rays", "4", "--compare-rays", "8", "--out", "@out"},
      {"--scene", "town", "--thin-lens", "50", "--f-number", "8", "--focus", "3m", "--size", "8x8", "--compare",
       "--frames", "2", "--rays", "4", "--out", "@out"}},
     {"frames[]"}},
#endif
#ifdef PETZVAL_TEST_HAS_view
    {"view", "", {{"--replay", "@thin.json", "--json"}, {"--replay", "@thick.json", "--json"}}},
#endif
};

/// A report, or the reports of `view`: one in each line.
std::vector<json> reports_of(const std::string& text) {
  if (json::accept(text)) return {json::parse(text)};
  std::vector<json> reports;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) reports.push_back(json::parse(line));
  return reports;
}

std::map<std::string, Table> documented() {
  std::map<std::string, Table> tables;
  for (const char* name : {"reports.md", "picture_reports.md"}) {
    std::ifstream in(std::filesystem::path(PETZVAL_TEST_DATA).parent_path() / "lib/docs" / name);
    std::ostringstream page;
    page << in.rdbuf();
    tables.merge(tables_of(page.str()));
  }
  return tables;
}

class Reports : public Programs, public testing::WithParamInterface<Reporter> {
 protected:
  void SetUp() override {
    Programs::SetUp();
    write_inputs();
    write("slope.json",
          R"([{"position_mm": [0, 0, -1000]}, {"position_mm": [90, 0, -1100]}, {"position_mm": [0, 90, -1100]},
      {"position_mm": [0, 0, 1000]}])");
    write("relay.zmx",
          examples_testing::relay_zmx("VERS 140124 258 36214 0 0\nMODE SEQ\nNAME Relay\nUNIT MM\nENPD 12.5\n"
                                      "GCAT NOWHERE\nFTYP 1 0 2 2 0 0 0\nYFLN 0.0 6.0\n"));
    write("thin.json", R"({"scene": "town", "lens": {"thin_mm": 50, "f_number": 4}, "size": [8, 8], "events": [
      {"type": "add_point", "pixel": [4, 7]}, {"type": "add_point", "pixel": [4, 0]}, {"type": "zoom"}, {"type": "still"},
      {"type": "setup", "setup": {"f_number": 1}}]})");
    write("thick.json", R"({"scene": "town", "lens": "tessar_100mm_f2.8", "size": [8, 8], "events": [
      {"type": "add_point", "position_mm": [0, 0, 1e6]}]})");
    write("bad.json", R"({"format": "petzval-lens 1", "name": "bad", "focal_length_mm": 50, "f_number": 5, "surfaces": [
      {"radius": 506, "thickness": 52, "nd": 1.5168, "semi_diameter": 100, "stop": true},
      {"radius": -506, "thickness": 600, "nd": 1, "semi_diameter": 120, "stop": true}]})");
  }
};

TEST_P(Reports, HaveExactlyTheKeysOfTheGuide) {
  const auto& [command, file, lines, aliases] = GetParam();
  const auto tables = documented();
  ASSERT_TRUE(tables.contains(command));
  Check check{tables.at(command), aliases};
  for (const Arguments& line : lines) {
    const Outcome outcome = run(command, expanded(line));
    // 3: convert with --strict. 1: view, whose report includes refused events.
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3 || command == "view") << outcome.err;
    if (file.empty()) {
      for (const json& report : reports_of(outcome.out)) check.report(report);
    } else {
      check.report(read_json(path(file)));
      EXPECT_TRUE(line.back() != "--json" || outcome.out == read(path(file))) << outcome.out;
    }
  }
  EXPECT_EQ(check.faults, std::set<std::string>());
  EXPECT_EQ(check.unseen(), std::vector<std::string>());
}

INSTANTIATE_TEST_SUITE_P(All, Reports, testing::ValuesIn(reporters), [](const auto& test) {
  std::string name = test.param.command;
  std::ranges::replace(name, '-', '_');
  return name;
});

using ReportGuide = Programs;

TEST_F(ReportGuide, HasATableForEveryCommandWithJson) {
  const auto tables = documented();
  const std::string overview = run("petzval", {"help"}).out;
  static const std::regex line("\n  ([a-z-]+) +[a-zA-Z]");
  for (std::sregex_iterator found(overview.begin(), overview.end(), line), end; found != end; ++found) {
    const std::string command = (*found)[1];
    if (run("petzval", {"help", command}).out.find("--json") == std::string::npos) continue;
    EXPECT_TRUE(tables.contains(command)) << command;
    EXPECT_TRUE(std::ranges::any_of(reporters, [&](const Reporter& r) { return r.command == command; })) << command;
  }
}

/// Rows that refer to the common keys have keys of that table, with the same type.
TEST_F(ReportGuide, CommonKeysHaveOneType) {
  const auto tables = documented();
  const Table& common = tables.at("Common keys");
  for (const auto& [command, table] : tables) {
    for (const auto& [path, row] : table) {
      const auto found = common.find(path.substr(path.find_last_of('.') + 1));
      EXPECT_TRUE(!row.common || (found != common.end() && row.type == found->second.type)) << command << ' ' << path;
    }
  }
}

TEST_F(ReportGuide, PlantedFaultsAreFound) {
  const auto table =
      tables_of("## a\n\n| `x.y`, `z` | number | mm | | |\n| `u` | string | | | absent: never |\n").at("a");
  Check check{table, {}};
  check.report(json::parse(R"({"x": {"y": 1, "w": 2}, "z": null, "u": 3, "v": []})"));
  EXPECT_EQ(check.faults,
            (std::set<std::string>{"u: 3 is no string", "v: has no row", "x.w: has no row", "z: null is no number"}));
  EXPECT_TRUE(check.unseen().empty());
  EXPECT_EQ((Check{table, {}}.unseen()), (std::vector<std::string>{"x.y", "z"}));
}

}  // namespace
