// SPDX-License-Identifier: Apache-2.0
// Command lines that a program must refuse: flags that need or exclude each other, and values that are invalid for the
// lens or for a file. The program exits with 1, writes nothing, and one line of standard error names the flag (or the
// file) and the value. hostile_flags_test.cpp has one bad value for each flag of each program.
#include <algorithm>
#include <ostream>

#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

using petzval::testing::Token;

struct Case {
  Arguments arguments;
  std::vector<Token> tokens;
};

struct Refused {
  std::string program;
  Arguments common;  ///< of all cases
  std::vector<Case> cases;
};

std::ostream& operator<<(std::ostream& out, const Refused& refused) { return out << refused.program; }

const std::string f135 = "LENS:double_gauss_100mm_f1.35", triplet = "LENS:cooke_triplet_50mm_f5";
const Arguments thin{"--thin-lens", "50", "--f-number", "2"};

/// The file @text.json has this text.
Case of_text(const std::string& flag, const std::string& text, std::vector<Token> tokens, Arguments more = {}) {
  tokens.push_back("text.json");
  more.insert(more.end(), {flag, "@text.json", "TEXT:" + text});
  return {more, tokens};
}
Case surface(const std::string& points, const std::vector<Token>& tokens, const Arguments& more = {}) {
  return of_text("--points", R"({"points": [)" + points + "]}", tokens, more);
}
Case keys(const std::string& keys, const std::vector<Token>& tokens) {
  return of_text("--keys", R"([{"keys": [)" + keys + "]}]", tokens, thin);
}
Case points(const std::string& points, const std::vector<Token>& tokens, Arguments more = {}) {
  more.insert(more.end(), thin.begin(), thin.end());
  return of_text("--points", points, tokens, more);
}
Case point(const std::string& members, const std::vector<Token>& tokens, const Arguments& more = {}) {
  return points("[{" + members + "}]", tokens, more);
}
std::string deep(const std::string& opening) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += opening;
  return text;
}

const std::vector<Refused> all = {
    {"models",
     {},
     {{{}, {"LENS"}},
      {{f135, "--size", "10.5x20"}, {"--size", "\"10.5x20\""}},
      {{f135, "--size", "0x20"}, {"--size", "\"0\""}}}},
    {"psf",
     {f135, "--out", "@out", "--at", "1000"},
     {{{}, {"--focus"}},
      {{"--focus", "900", "--blades", "2"}, {"--blades", 2}},
      {{"--focus", "900", "--roundness", "0.5"}, {"--roundness", "--blades"}},
      {{"--focus", "900", "--iris-rotation", "10"}, {"--iris-rotation", "--blades"}},
      {{"--focus", "900", "--iris-area", "equal", "--f-number", "4"}, {"--iris-area", "--blades"}},
      {{"--focus", "900", "--blades", "5", "--iris-area", "equal"}, {"--iris-area", "--f-number"}},
      {{"--focus", "900", "--keep-light"}, {"--keep-light", "--lens-ratio", "--rate-of-change"}},
      {{"--focus", "900", "--weight-strength", "0.6"}, {"--weight-strength", "--weight-distribution"}},
      {{"--focus", "900", "--white-point", "@none.csv"}, {"none.csv"}},
      {{"--focus", "900", "--weight-map", "@none.png"}, {"none.png"}},
      {{"--focus", "900", "--iris-image", "@black.png"}, {"map", "black"}},
      {{"--focus", "900", "--iris-image", "@a.png", "--weight-map", "@a.png"}, {"--weight-map", "--iris-image"}},
      {{"--focus", "800,1000,8e2"}, {"--focus", 800}},
      {{"--focus", "inf,inf"}, {"--focus", "inf"}},
      {{"--focus", "900", "--wavelengths", "500,500"}, {"--wavelengths", 500}},
      {{"--focus", "15"}, {"--focus", 15, 17.0613434}},
      {{"--focus", "2"}, {"--focus", 2, 2000}},  // metres?
      {{"--focus", "900", "--f-number", "1"}, {"--f-number", 1, 1.353314189}},
      {{"--focus", "900", "--fields", "60"}, {"--fields", 60}},
      {{"--focus", "900", "--fields", "60", "--model", "thin"}, {"--fields", 60}},
      {{"--focus", "900", "--fields", "95"}, {95}},
      {{"--focus", "900", "--at", "100", "--from", "film"}, {100, "film", 169.792}},
      {{"--focus", "900", "--at", "1e-3"}, {0.001, 0.178171}},
      {{"--at", "inf", "--focus", "inf", "--diffraction", "--model", "thin"}, {"--diffraction", "--model"}},
      {{"--at", "inf", "--focus", "inf", "--diffraction", "--lens-ratio", "1.2"}, {"--diffraction"}},
      {{"--focus", "900", "--wavelengths", "visible:0"}, {"visible:STEP"}}}},
    {"camera-rays",
     {f135, "--table", "@samples.csv", "--out", "@out", "--focus", "3000", "--model", "thick"},
     {{{"--film", "36x240", "--tilt", "60"}, {"film", -120, "surface"}},
      {{"--iris-rotation", "5"}, {"--iris-rotation", "--blades"}},
      {{"--weight-strength", "1"}, {"--weight-strength", "--weight-distribution"}},
      {{"--spp", "4"}, {"--spp", "--povray"}},
      {{"--povray"}, {"--povray", "--table"}}}},
    {"choose",
     {f135, "--budget", "1"},
     {{{"--far", "inf"}, {"--near"}},
      {{"--near", "1000"}, {"--far"}},
      {{"--near", "1000", "--far", "500"}, {"far_mm", 500}},
      {{"--near", "10", "--far", "500", "--from", "film"}, {"near_mm", 10, "film", 158.933}}}},
    {"colour",
     {"--out", "@out"},
     {{{f135, "--focus", "15"}, {"--focus", 15, 17.0762701}},
      {{f135, "--white-point", "moon"}, {"--white-point", "\"moon\""}},
      {{f135, "--fields", "0,60"}, {"--fields", 60}},
      {{"LENS:fisheye_10mm_f4"}, {"surface 0", "V_d", 587.5618, 430}}}},
    {"convert",
     {f135},
     {{{"@lens.doc"}, {"lens.doc", ".zmx"}}, {{}, {"OUT"}}, {{"--configuration", "tele", "@out"}, {"out"}}}},
    {"expressive",
     {f135, "--out", "@out"},
     {{{"--power-spline", "0.5"}, {"--power-spline", "\"0.5\""}},
      {{"--power-spline", "0:1", "0:2"}, {"power", "knot 2", 0}},
      {{"--power-spline", "0:x"}, {"--power-spline", "\"x\""}},
      {{"--curvature-points", "1:2"}, {"--curvature-points", "\"1:2\""}},
      {{"--curvature-points", "0,0:-500"}, {"film offsets", 124.49150670677673}},
      {{"--model", "exact_float"}, {"--model", "exact_float"}},
      {{"--at", "20", "--from-lens", "1", "--from", "film"}, {"scene point", "z"}}}},
    {"surface",
     {"LENS", "--out", "@out"},
     {surface(R"({"pixel": [1, 2], "distance_mm": 100})", {"point 1", "entrance pupil"}, {"--from", "film"}),
      surface(R"({"pixel": [1, 2], "distance_mm": 20})", {"point 1", "distance_mm", 20}, {"--from", "film"}),
      surface(R"({"pixel": [1, 2], "distance_mm": 3000, "fade": 2})", {"point 1", "fade", 2}),
      surface(R"({"pixel": [1, 2], "distance_mm": 3000, "weight": 0})", {1, "weight"}),
      surface(R"({"pixel": [1, 2], "distance_mm": 3000, "blur_px": 1e9})", {"point 1", "blur"}),
      surface(R"({"pixel": [1, 2], "distance_mm": 3000, "sharp": 1})", {"point 1", "\"sharp\""}),
      surface(R"({"distance_mm": 4})", {"point 1", "pixel", "world_mm"}),
      surface(R"({"pixel": [1, 2]})", {"point 1", "distance", "extent_stops"}),
      surface(R"({"pixel": [1, 2], "distance_mm": 4, "at_infinity": true})", {"point 1", "at_infinity"}),
      surface(R"({"world_mm": [0, 0, -9], "distance_mm": 4, "at_infinity": true})", {"point 1", "at_infinity"}),
      surface(R"({"world_mm": [0, 0, 0], "at_infinity": true})", {"point 1", "world_mm"}),
      surface(R"({"world_mm": [0, 0, -900], "blur_px": 1, "blur_mm": 1})", {"point 1", "blur_px", "blur_mm"}),
      surface(R"({"world_mm": [0, 0, -900], "from_s": 1})", {"point 1", "from_s"}),
      surface(R"({"pixel": [1], "distance_mm": 4})", {"point 1", "pixel", "[1]"}),
      surface(R"({"world_mm": [0, 0, 500]})", {"point 1", "world_mm", "[0,0,500]"}),
      of_text("--points", "{}", {"points", "null"}),
      {{"--points", "@surface.json", "--table", "@none.csv"}, {"none.csv"}},
      {{"--points", "@surface.json", "--table", "@samples.csv"}, {"samples.csv", "line 1"}},
      {{"--points", "@surface.json", "--beta", "9"}, {"--beta", 9}}}},
    {"focus",
     {},
     {{{}, {"LENS"}},
      {{triplet, "--fields", "0,75"}, {"--fields", 75}},
      {{f135, "--at", "2"}, {2, 2000}},  // metres?
      {{f135, "--criterion", "thin,thin"}, {"--criterion", "thin"}},
      {{"LENS:zoom_14-30mm_f4", "--criterion", "min_rms", "--at", "0.001"}, {"--at", -0.001}}}},
    {"export",
     {f135, "--calibration", "@out"},
     {{{"--film", "1x9"}, {"--film", "1x9"}},
      {{"--size", "20000"}, {"--size", 20000}},
      {{"--ray-map", "@rays.png"}, {"--ray-map", ".exr"}},
      {{"--camera", "@camera.txt"}, {"--camera", ".txt", ".h"}},
      {{"--camera", "@camera.h", "--model", "thin"}, {"thin", "exact_float"}},
      {{"--camera", "@cameras", "--all"}, {"--all", "LENS"}},
      {{"--all"}, {"--all", "--camera"}},
      {{"--lens-samples", "300", "--ray-map", "@rays.exr"}, {"--lens-samples", 300}},
      {{"--half"}, {"--half", "--ray-map"}}}},
    {"metadata",
     {f135, "--out", "@out"},
     {{{"--film", "1x9"}, {"--film", "\"1x9\""}}, {{"--film", "4000x1"}, {"--film", "\"4000x1\""}}}},
    {"report",
     {},
     {{{}, {"LENS"}},
      {{"@none.json"}, {"none.json"}},
      {{f135, "--colour"}, {"--colour"}},
      {{f135, "--wavelengths", "10x"}, {"--wavelengths", "\"10x\""}},
      {{f135, "--fields", "5"}, {"--fields", "--out"}},
      {{f135, "--out", "@out", "--fields", "0,70"}, {"--fields", 70}},
      {{f135, "--f-number", "1"}, {"--f-number", 1, 1.353314189}},
      {{f135, "--at", "15"}, {"--at", 15}},
      {{"LENS:zoom_70-210mm_f4", "--configuration", "far"}, {"wide", "middle", "tele"}},
      {{"LENS:fisheye_10mm_f4", "--wavelengths", "500"}, {"V_d", 587.5618, 500}}}},
    {"psf-set",
     {"LENS", "--out", "@out"},
     {{{"--at", "1000"}, {"--fields"}},
      {{"--fields", "0"}, {"--at"}},
      {{"--fields", "", "--at", "1000"}, {"--fields", "\"\""}},
      {{"--fields", "7,0", "--at", "1000"}, {"field_deg", 0, 7}},
      {{"--fields", "0,95", "--at", "1000"}, {95}},
      {{"--fields", "0,60", "--at", "1000, 2000"}, {"--fields", 60}},
      {{"--fields", "0", "--at", "1000,1000"}, {"--at", 1000}},
      {{"--fields", "0", "--at", "1000", "--f-number", "1"}, {"--f-number", 1, 1.999999995}},
      {{"--fields", "0", "--at", "1000", "--size", "32"}, {"--size", "\"32\""}},
      {{"--fields", "0", "--at", "1000", "--focus", "20"}, {"--focus", 20}},
      {{"--fields", "0", "--at", "1000", "--iris-rotation", "5"}, {"--iris-rotation", "--blades"}},
      {{"--fields", "0", "--at", "1000", "--check", "--shard", "1/2"}, {"--check", "--shard 1/2"}},
      {{"--fields", "0", "--at", "1000", "--shard", "5/4"}, {"--shard", "\"5/4\""}},
      {{"--fields", "0", "--at", "1000", "--shard", "0/4"}, {"--shard", "\"0/4\""}},
      {{"--fields", "0", "--at", "1000", "--shard", "1/2/3"}, {"--shard", "\"1/2/3\""}},
      {{"--fields", "0", "--at", "1000", "--shard", "1.5/2"}, {"--shard", "\"1.5/2\""}},
      {{"--fields", "0", "--at", "1000", "--shard", ""}, {"--shard", "\"\""}}}},
    {"spots",
     {"--out", "@out"},
     {{{triplet, "--wavelengths", "F,x"}, {"--wavelengths", "x"}},
      {{triplet, "--fields", "0,,10"}, {"--fields", "\"\""}},
      {{triplet, "--fields", "0,10,-0"}, {"--fields", 0}},
      {{triplet, "--fields", "0,60"}, {"--fields", 60}},
      {{triplet, "--fields", "95", "--at", "1000"}, {-1000, 95}},
      {{triplet, "--at", "10"}, {"--at", 10, 37.6892731}},
      {{triplet, "--defocus", "-1e160"}, {"--defocus", "\"-1e160\""}},
      {{triplet, "--rays", "1.5"}, {"--rays", "\"1.5\""}},
      {{"LENS:fisheye_10mm_f4", "--wavelengths", "500"}, {"V_d", 587.5618, 500}}}},
    {"ghosts",
     {f135, "--out", "@out"},
     {{{}, {"--light"}},
      {{"--light", "5"}, {"--light", "\"5\"", "X,Y"}},
      {{"--light", "5,x"}, {"--light", "\"x\""}},
      {{"--light", "1px,2"}, {"--light", "\"1px,2\"", "Xpx,Ypx"}},
      {{"--light", "1,2px,3m"}, {"--light", "\"1,2px,3m\"", "Xpx,Ypx"}},
      {{"--light", "1,2,"}, {"--light", "\"1,2,\"", "X,Y"}},
      {{"--light", "5,0,-1m"}, {"--light", "-1m"}},
      {{"--light", "180,0"}, {"light"}},
      {{"--light", "1e6px,0px"}, {"--light"}},
      {{"--light", "0,0", "--pairs", "0"}, {"--pairs", "\"0\""}},
      {{"--light", "0,0", "--film-reflectance", "2"}, {"--film-reflectance", "\"2\""}},
      {{"--light", "0,0", "--coatings", "file"}, {"--coatings", "file"}}}},
    {"trace",
     {f135, "--out", "@out"},
     {{{}, {"--table"}},
      {{"--table", "@none.csv"}, {"none.csv"}},
      {{"--table", "@samples.csv", "--fast"}, {"--fast"}}}},
#ifdef PETZVAL_TEST_HAS_tilt
    {"pull",
     {"--out", "@out"},
     {of_text("--keys", "[]", {"[]"}, thin),
      of_text("--keys", "[{}]", {"point 1", "position_mm"}, thin),
      keys("", {"point 1", "keys", "[]"}),
      keys(R"({"position_mm": [0, 0, -1]})", {"point 1", "key 1", "time_s"}),
      keys(R"({"time_s": 0, "position_mm": [0, -1]})", {"key 1", "position_mm", "[0,-1]"}),
      keys(R"({"time_s": "0", "position_mm": [0, 0, -1]})", {"key 1", "time_s", "\"0\""}),
      keys(R"({"time_s": 1, "position_mm": [0, 0, -9]}, {"time_s": 1, "position_mm": [0, 0, -8]})",
           {"key 2", "time_s", 1}),
      keys(R"({"time_s": 1, "position_mm": [0, 0, -9], "extent_stops": 1}, {"time_s": 2, "position_mm": [0, 0, -8]})",
           {"key 2", "extent_stops"}),
      keys(R"({"time_s": 0, "position_mm": [0, 0, 900]})", {"point 1", "lens"}),
      of_text("--keys", R"([{"weight": 2, "keys": [{"time_s": 0, "position_mm": [0, 0, -900]}]}])", {"weight"}, thin),
      keys(R"({"time_s": 0, "position_mm": [0, 0, -900]}, {"time_s": 1e9, "position_mm": [0, 0, -900]})", {100000}),
      of_text("--keys", R"([{"until": 3, "keys": [{"time_s": 0, "position_mm": [0, 0, -1]}]}])", {"\"until\""}, thin),
      of_text("--keys", R"([{"from_s": 2, "until_s": 1, "keys": [{"time_s": 0, "position_mm": [0, 0, -1]}]}])",
              {"point 1", "until_s", 1}, thin),
      of_text("--keys", deep(R"([{"keys":)"), {8}, thin),
      {{"LENS"}, {"--keys"}},
      {{"--keys", "@keys.json"}, {"LENS", "--thin-lens"}},
      {{"LENS", "--keys", "@keys.json", "--model", "thick", "--criterion", "min_max"},
       {"--criterion", "--model thick"}},
      {{"--keys", "@keys.json", "--thin-lens", "50", "--f-number", "2",  //
        "--configuration", "1"},
       {"--configuration", "LENS"}}}},
    {"tilt",
     {"--out", "@out"},
     {points("what", {"JSON"}),
      points("", {"JSON"}),
      points(R"([{"position_mm": [0, 0, NaN]}])", {"JSON"}),
      points(R"([{"position_mm": [0, 0, -1e999]}])", {"JSON"}),
      points(R"({"position_mm": [0, 0, -1000]})", {"list"}),
      points("[1]", {"point 1", 1, "position_mm"}),
      points(R"([{"position_mm": [0, 0, -9]}, {"position_mm": [0, -9]}])", {"point 2", "position_mm", "[0,-9]"}),
      point(R"("position_mm": [0, "0", -1000])", {"point 1", "position_mm", "[0,\"0\",-1000]"}),
      point(R"("position_mm": [0, null, -1000])", {"point 1", "position_mm", "[0,null,-1000]"}),
      point(R"("weight": 1)", {"point 1", "position_mm"}),
      point(R"("position_mm": [0, 0, -1000], "weight": -1)", {"point 1", "weight", -1}),
      point(R"("position_mm": [0, 0, -1000], "weight": "1")", {"point 1", "weight", "\"1\""}),
      point(R"("position_mm": [0, 0, -1000], "blur_mm": true)", {"point 1", "blur_mm", "true"}),
      point(R"("position_mm": [0, 0, -1000], "at_infinity": 1)", {"point 1", "at_infinity", 1}),
      point(R"("position_mm": [0, 0, -1000], "extent_stops": 21)", {"point 1", "extent_stops", 21}),
      point(R"("position_mm": [0, 0, -1000], "fixes_distance": 0)", {"point 1", "fixes_distance", 0}),
      point(R"("position_mm": [0, 0, -1000], "wieght": 2)", {"point 1", "\"wieght\""}),
      point(R"("position_mm": [0, 0, -1000], "position_mm": [0, 0, -1])", {"\"position_mm\""}),
      point(R"("position_mm": [0, 0, 1000])", {"point 1", "image"}),
      point(R"("position_mm": [0, 0, 0])", {"point 1"}),
      point(R"("position_mm": [0, 0, -1000], "weight": 0)", {"point 1", "weight", 0}),
      point(R"("position_mm": [0, 0, -1000], "extent_stops": 2, "fixes_distance": false)", {"point 1", "distance"}),
      point(R"("position_mm": [0, 0, -1000], "fixes_distance": false)", {"point 1", "extent_stops"}),
      point(R"("position_mm": [0, 0, -1000], "fixes_distance": false, "extent_stops": 1, "blur_mm": 1)", {"blur_mm"}),
      point(R"("position_mm": [0, 0, -1000], "until_s": 1)", {"point 1", "until_s"}),
      point(R"("position_mm": [0, 900, -1000])", {"point 1", "picture"}, {"--film", "36x24"}),
      points(deep("["), {8}),
      {{"LENS"}, {"--points"}},
      {{"--points", "@points.json"}, {"LENS", "--thin-lens"}},
      {{"--points", "@points.json", "--thin-lens", "50", "--f-number", "2", "--model", "thick"},
       {"--thin-lens", "--model thin"}},
      {{"--points", "@points.json", "--thin-lens", "50"}, {"--thin-lens", "--f-number"}},
      {{"LENS", "--points", "@points.json", "--thin-lens", "50", "--f-number", "2"},
       {"--thin-lens", "double_gauss_100mm_f2_28deg.json"}},
      {{"--points", "@points.json", "--thin-lens", "50", "--f-number", "2", "--glasses", "x"}, {"--glasses", "LENS"}}}},
#endif
#ifdef PETZVAL_TEST_HAS_render
    {"render",
     {"--scene", "balls", "LENS", "--focus", "1000", "--out", "@out", "--spp", "1"},
     {{{"--scene", "town"}, {"town", "balls", "chess", "statues", "street"}},
      {{"--scene", "@none.json"}, {"none.json"}},
      {{"--scene", "@inside.json"}, {"inside.json"}},
      {{"--shard", "3/2"}, {"--shard", "\"3/2\""}},
      {{"--focus", "10"}, {"--focus", 10, 28.3682134}},
      {{"--budget", "1"}, {"--budget", "--model auto"}},
      {{"--model", "auto", "--shard", "1/2"}, {"--model auto", "--shard 1/2"}},
      {{"--shard", "1/2", "--format", "pfm"}, {"--format", "--shard 1/2", "render merge"}},
      {{"--kind", "affine"}, {"--kind", "--points"}},
      {{"--beta", "2"}, {"--beta", "--points"}},
      {{"--iris-area", "equal"}, {"--iris-area", "--blades"}},
      {{"--keep-light"}, {"--keep-light", "--lens-ratio"}},
      {{"--points", "@surface.json"}, {"exact_float", "pinhole", "thick"}},
      {{"--points", "@surface.json", "--model", "auto"}, {"--model auto", "pinhole", "thick"}}}},
#endif
#ifdef PETZVAL_TEST_HAS_blur
    {"blur",
     {"--out", "@out", "--focus", "3000"},
     {{{"--thin-lens", "50", "--f-number", "5.56"}, {"--scene", "--image", "--deep"}},
      {{"--scene", "town"}, {"--thin-lens", "LENS", "--singlet"}},
      {{"--thin-lens", "50", "--f-number", "5.56", "--image", "@black.png"}, {"black.png", "--depth"}},
      {{"--thin-lens", "50", "--f-number", "5.56", "--image", "@black.png", "--depth", "@black.png"},
       {"black.png", "--near", "--far"}},
      {{"--thin-lens", "50", "--f-number", "5.56", "--image", "@none.exr"}, {"none.exr"}},
      {{"--thin-lens", "50", "--f-number", "5.56", "--deep", "@black.png"}, {"black.png"}},
      {{"--scene", "town", f135, "--focus", "1"}, {"--focus", 1, 1000}},  // metres?
      {{"--scene", "town", f135, "--focus", "70", "--from", "entrance_pupil"}, {"--focus", 70, "entrance pupil"}},
      {{"--scene", "town", f135, "--depth-kind", "distance"}, {"--depth-kind", "distance", "--scene"}},
      {{"--scene", "town", f135, "--fps", "24"}, {"--fps", "--points"}},
      {{"--scene", "town", f135, "--travel", "500"}, {"--travel", "--frames"}},
      {{"--scene", "town", f135, "--travel", "500", "--frames", "1"}, {"--travel", 1, 2}},
      {{"--scene", "town", f135, "--kind", "affine"}, {"--kind", "--points"}},
      {{"--scene", "town", f135, "--beta", "2"}, {"--beta", "--points"}},
      {{"--scene", "town", f135, "--iris-rotation", "10"}, {"--iris-rotation", "--blades"}},
      {{"--scene", "town", "--singlet", "50,-50,5,N-BK7", "--configuration", "tele"}, {"--configuration", "LENS"}},
      {{"--scene", "town", "--singlet", "50,-50,5,N-BK7", "--glasses", "x"}, {"--glasses", "LENS"}}}},
#endif
};

class Refusals : public Programs, public testing::WithParamInterface<Refused> {
 protected:
  void SetUp() override {
    Programs::SetUp();
    write_inputs();
    petzval::write_png({2, 2, std::vector<std::uint8_t>(12, 0)}, path("black.png"));
    write("inside.json", R"({"camera": {"position_mm": [0, 0, 0]}, "objects": [
      {"sphere": {"centre_mm": [0, 0, 0], "radius_mm": 500}, "emission": [1, 1, 1]}]})");
  }
};

TEST_P(Refusals, NameTheFlagAndTheValue) {
  const auto& [program, common, cases] = GetParam();
  for (const Case& c : cases) {
    Arguments arguments = common;
    for (std::size_t i = 0; i < c.arguments.size(); ++i) {
      const std::string& word = c.arguments[i];
      if (word.starts_with("TEXT:")) {
        write("text.json", word.substr(5));
        continue;
      }
      const auto own = std::find(arguments.begin(), arguments.end(), word);
      if (word.starts_with("--") && own != arguments.end()) {
        *(own + 1) = c.arguments[++i];
      } else {
        arguments.push_back(word);
      }
    }
    SCOPED_TRACE(testing::PrintToString(arguments));
    expect_failure(program, expanded(arguments), c.tokens);
    EXPECT_FALSE(std::filesystem::exists(path("out")));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Refusals, testing::ValuesIn(all), [](const auto& test) {
  std::string name = test.param.program;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
