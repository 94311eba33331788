// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numbers>

#include "petzval/focus/focus.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "program.hpp"

namespace {

class BokehPsf : public Programs {
 protected:
  static constexpr const char* id = "double_gauss_100mm_f1.35";

  nlohmann::json bokeh(std::vector<std::string> more, const std::string& out = "bokeh") const {
    std::vector<std::string> arguments{lens(id), "--out", path(out), "--rays", "32768"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run("psf", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    for (const auto& file : lines(outcome.out)) EXPECT_TRUE(std::filesystem::exists(file)) << file;
    return read_json(path(out + '/' + id + "_bokeh.json"));
  }

  static double ring_sum(const nlohmann::json& result) {
    const double width = result["radius_mm"].get<double>() / 64;
    double sum = 0;
    for (int k = 0; k < 64; ++k) {
      sum += result["radial_profile"][static_cast<std::size_t>(k)].get<double>() * std::numbers::pi * width * width *
             (2 * k + 1);
    }
    return sum;
  }
};

TEST_F(BokehPsf, KeepsAllTheLight) {
  const auto json = bokeh({"--at", "1000", "--focus", "800,1200"});
  EXPECT_EQ(json["dispersion"], "catalogue");
  ASSERT_EQ(json["results"].size(), 2u);
  const std::array<const char*, 2> names{"800", "1200"};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& result = json["results"][i];
    EXPECT_EQ(result["focus_mm"], std::stod(names[i]));
    EXPECT_EQ(result["criterion"], "min_rms");
    ASSERT_EQ(result["radial_profile"].size(), 64u);
    const double throughput = result["throughput"];
    EXPECT_GT(throughput, 0.9);
    EXPECT_NEAR(ring_sum(result), throughput, 1e-12);

    const auto image = petzval::read_exr(path(std::string("bokeh/") + id + "_focus_" + names[i] + "mm.exr"));
    const double pixel_mm = result["picture_pixel_mm"];
    double sum = 0;
    for (std::size_t p = 0; p < image.pixels.size(); p += 3) sum += image.pixels[p] * pixel_mm * pixel_mm;
    EXPECT_NEAR(sum, throughput, 1e-6);
    EXPECT_TRUE(read(path(std::string("bokeh/") + id + "_focus_" + names[i] + "mm.png")).starts_with("\x89PNG"));
  }
  EXPECT_TRUE(read(path(std::string("bokeh/") + id + "_bokeh.svg")).starts_with("<svg"));
}

// The light within 15 Airy radii is 98 to 99 % of the light; --width sets the width.
TEST_F(BokehPsf, DiffractionSpreadsTheLight) {
  const auto json = bokeh({"--at", "inf", "--focus", "inf", "--f-number", "22", "--diffraction", "--width", "0.4"});
  EXPECT_TRUE(json["with_diffraction"]);
  const auto& result = json["results"][0];
  EXPECT_NEAR(result["strehl"][0].get<double>(), 1, 0.02);
  const double pixel_mm = result["picture_pixel_mm"];
  EXPECT_NEAR(pixel_mm * 512, 0.4, 1e-12);
  const auto image = petzval::read_exr(path(std::string("bokeh/") + id + "_focus_infmm.exr"));
  double sum = 0;
  for (std::size_t p = 0; p < image.pixels.size(); p += 3) sum += image.pixels[p] * pixel_mm * pixel_mm;
  EXPECT_GT(sum, 0.95 * result["throughput"].get<double>());
  EXPECT_LT(sum, result["throughput"].get<double>());
  const auto plain = bokeh({"--at", "inf", "--focus", "inf", "--width", "0.4"}, "plain");
  EXPECT_NEAR(plain["results"][0]["picture_pixel_mm"].get<double>() * 512, 0.4, 1e-12);
  EXPECT_TRUE(plain["results"][0]["strehl"].is_null());
  expect_failure("psf", {lens(id), "--at", "inf", "--focus", "1000", "--diffraction", "--out", path("wide")}, {4096});
}

// An aborted run keeps the complete images and their data.
TEST_F(BokehPsf, KilledRunKeepsCompletePictures) {
  const std::string first = path("cut/") + id + "_focus_900mm.exr", numbers = path("cut/") + id + "_bokeh.json";
  write("kill.sh", invocation("psf") + " '" + lens(id) + "' --at 1000 --focus 900,1000,1100 --rays 4194304 --out '" +
                       path("cut") + "' > /dev/null 2>&1 & pid=$!\nwhile [ ! -e '" + numbers +
                       "' ] && kill -0 $pid; do :; done 2> /dev/null\nkill -INT $pid 2> /dev/null\n"
                       "kill -9 $pid 2> /dev/null\nwait $pid\nexit 0\n");
  ASSERT_EQ(std::system(("sh '" + path("kill.sh") + "' 2> /dev/null").c_str()), 0);
  EXPECT_TRUE(std::filesystem::exists(first));
  const auto json = read_json(numbers);
  EXPECT_GE(json["results"].size(), 1u);
  EXPECT_EQ(json["results"][0]["focus_mm"], 900);
}

// Far out of focus at f/16 the blur has the shape of the iris: area and moments agree.
TEST_F(BokehPsf, HasTheShapeOfTheIris) {
  const auto all = [&](std::vector<std::string> iris) {
    iris.insert(iris.end(), {"--at", "3000", "--focus", "1500", "--f-number", "16"});
    return bokeh(iris);
  };
  const auto result = [&](const std::vector<std::string>& iris) { return all(iris)["results"][0]; };
  const auto number = [](const nlohmann::json& row, const char* key) { return row.at(key).get<double>(); };
  const auto round = result({});
  EXPECT_EQ(number(round, "iris_area_share"), 1);
  constexpr double pi = std::numbers::pi;
  for (const int n : {3, 6, 9}) {
    const auto bladed = result({"--blades", std::to_string(n), "--iris-rotation", "10"});
    const double share = n / (2 * pi) * std::sin(2 * pi / n), square = (2 + std::cos(2 * pi / n)) / 12;
    EXPECT_NEAR(number(bladed, "iris_area_share"), share, 1e-14);
    EXPECT_NEAR(number(bladed, "throughput") / number(round, "throughput") / share, 1, 5e-3);
    const auto moments = bladed.at("second_moments_mm2").get<std::array<double, 3>>();
    const auto of_round = round.at("second_moments_mm2").get<std::array<double, 3>>();
    EXPECT_NEAR(moments[0] / of_round[0] / (square / 0.25), 1, 0.01) << n;
    EXPECT_NEAR(moments[1] / of_round[1] / (square / 0.25), 1, 0.01) << n;
    EXPECT_NEAR(moments[2] / of_round[0], 0, 0.01) << n;
    EXPECT_EQ(bladed.at("diffraction"), "visible");
    EXPECT_NEAR(number(bladed, "airy_radius_mm"), 1.22 * 587.5618e-6 * 16 * 1581.11 / (1581.11 - 100.44), 2e-4);

    // Throughputs are fractions of the paraxial pupil, which grows with the corners of the iris.
    const auto equal = all({"--blades", std::to_string(n), "--iris-area", "equal"});
    const double opened = 16 / equal.at("f_number_real").get<double>();
    EXPECT_NEAR(opened * opened * share, 1, 1e-11);
    EXPECT_NEAR(number(equal["results"][0], "throughput") * opened * opened / number(round, "throughput"), 1, 5e-3);
    EXPECT_NEAR(number(equal["results"][0], "throughput_of_round_iris") / number(round, "throughput"), 1, 5e-3);
    EXPECT_EQ(number(bladed, "throughput_of_round_iris"), number(bladed, "throughput"));
  }
  EXPECT_EQ(result({"--blades", "5", "--roundness", "1"}), round);
  EXPECT_LT(number(result({"--blades", "5", "--roundness", "-1"}), "throughput"),
            number(result({"--blades", "5", "--roundness", "-0.5"}), "throughput"));
}

TEST_F(BokehPsf, WritesTheRequestedFormats) {
  bokeh({"--at", "1000", "--focus", "900", "--format", "exr,pfm"});
  const std::string stem = path(std::string("bokeh/") + id + "_focus_900mm");
  EXPECT_FALSE(std::filesystem::exists(stem + ".png"));
  const auto twice = run("psf", {lens(id), "--at", "1000", "--focus", "900", "--rays", "64", "--format", "pfm,pfm",
                                 "--out", path("twice")});
  EXPECT_EQ(lines(twice.out).size(), 3u) << twice.out;  // the file, the contact sheet, the numbers
  const std::string pfm = read(stem + ".pfm"), head = "PF\n512 512\n-1.0\n";
  ASSERT_TRUE(pfm.starts_with(head));
  ASSERT_EQ(pfm.size(), head.size() + 4 * 3 * 512 * 512);
  const auto image = petzval::read_exr(stem + ".exr");
  int lit = 0;
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      const std::size_t row = 511 - static_cast<std::size_t>(y);
      float value = 0;
      std::memcpy(&value, pfm.data() + head.size() + 4 * (3 * (512 * row + static_cast<std::size_t>(x)) + 1), 4);
      ASSERT_EQ(value, image.pixel(x, y)[1]);
      lit += value > 0;
    }
  }
  EXPECT_GT(lit, 10000);
}

// For any spectrum of the light, the total of the image is white and contains all light; throughputs of wavelengths
// differ by one percent.
TEST_F(BokehPsf, LightOfTheWhitePointIsWhite) {
  std::ofstream(path("led.csv")) << "wavelength_nm,power\n440,0\n455,10\n470,2\n560,6\n700,0\n";
  const auto reddest = [&](const std::string& white) {
    const auto json =
        bokeh({"--at", "1000", "--focus", "900", "--wavelengths", "450,520,590,650", "--white-point", white});
    EXPECT_EQ(json["white_point"], white);
    const auto image = petzval::read_exr(path(std::string("bokeh/") + id + "_focus_900mm.exr"));
    const double area = std::pow(json["results"][0]["picture_pixel_mm"].get<double>(), 2);
    std::array<double, 3> sums{};
    double result = 0;
    for (std::size_t p = 0; p < image.pixels.size(); ++p) sums[p % 3] += image.pixels[p] * area;
    for (std::size_t p = 0; p < image.pixels.size(); p += 3) {
      result = std::max(result, double{image.pixels[p]} - image.pixels[p + 2]);
    }
    for (const double sum : sums) EXPECT_NEAR(sum, json["results"][0]["throughput"].get<double>(), 0.01) << white;
    return result;
  };
  EXPECT_NE(reddest("D65"), reddest("A"));
  EXPECT_NE(reddest("D65"), reddest(path("led.csv")));
}

TEST_F(BokehPsf, AcceptsEveryModelWithWeights) {
  const std::vector<std::string> plain{"--at", "2000", "--focus", "1000", "--f-number", "4"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), plain.begin(), plain.end());
    return bokeh(more)["results"][0];
  };
  const auto exact = with({});
  for (const char* model : {"thin", "thin_two_disc", "thick", "polynomial_7", "exact_float"}) {
    const auto result = with({"--model", model});
    EXPECT_NEAR(result["throughput"].get<double>(), exact["throughput"].get<double>(), 0.02) << model;
    EXPECT_NEAR(result["rms_radius_mm"].get<double>() / exact["rms_radius_mm"].get<double>(), 1, 0.04) << model;
    EXPECT_NEAR(ring_sum(result), result["throughput"].get<double>(), 1e-9);
  }
  const auto ring = with({"--weight-distribution", "20", "--weight-strength", "0.6"});
  EXPECT_NEAR(ring["throughput"].get<double>() / exact["throughput"].get<double>(), 1, 0.03);
  EXPECT_GT(ring["rms_radius_mm"].get<double>(), 1.15 * exact["rms_radius_mm"].get<double>());
  const auto eye = with({"--model", "thin", "--fields", "8", "--rate-of-change", "1"});
  EXPECT_LT(eye["throughput"].get<double>(), 0.75 * exact["throughput"].get<double>());
  EXPECT_LT(eye["second_moments_mm2"][1].get<double>(), 0.5 * eye["second_moments_mm2"][0].get<double>());
  EXPECT_NEAR(
      with({"--model", "thin", "--fields", "8", "--rate-of-change", "1", "--keep-light"})["throughput"].get<double>(),
      with({"--model", "thin", "--fields", "8"})["throughput"].get<double>(), 0.01);
}

TEST_F(BokehPsf, SeveralLensesAndFieldsHaveOneScaleAndOneTable) {
  const std::vector<std::string> lenses{"double_gauss_52mm_f1.8", "planar_50mm_f1.4"};
  const auto psf = [&](const Arguments& names, const std::string& fields, const std::string& out) {
    Arguments arguments = names;
    arguments.insert(arguments.end(), {"--at", "5m", "--focus", "2m", "--rays", "4096", "--fields", fields});
    arguments.insert(arguments.end(), {"--format", "png", "--out", path(out)});
    const Outcome outcome = run("psf", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const auto& file : lines(outcome.out)) EXPECT_TRUE(std::filesystem::exists(file)) << file;
    return lines(outcome.out).size();
  };
  EXPECT_EQ(psf(lenses, "0,10", "both"), 8u);  // pictures, two sheets, CSV, JSON
  const auto both = read_json(path("both/bokeh.json"));
  ASSERT_EQ(both["lenses"].size(), 2u);
  const auto table = lines(read(path("both/bokeh.csv")));
  ASSERT_EQ(table.size(), 5u);
  const auto scale = both["lenses"][0]["results"][0]["picture_pixel_mm"];
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(both["lenses"][i]["fields_deg"], nlohmann::json({0.0, 10.0}));
    const auto& results = both["lenses"][i]["results"];
    ASSERT_EQ(results.size(), 2u);
    psf({lenses[i]}, "10", "alone");
    const auto alone = read_json(path("alone/") + lenses[i] + "_bokeh.json")["results"][0];
    for (const char* key : {"field_deg", "throughput", "rms_radius_mm", "radius_mm", "centroid_mm", "film_z_mm"}) {
      EXPECT_EQ(results[1][key], alone[key]) << lenses[i] << ' ' << key;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(results[k]["picture_pixel_mm"], scale);
      EXPECT_GT(512 * scale.get<double>(), 2 * results[k]["radius_mm"].get<double>());
      const std::string row = '"' + lenses[i] + "\"," + results[k]["field_deg"].dump() + ",2000.0,";
      EXPECT_TRUE(table[1 + 2 * i + k].starts_with(row)) << table[1 + 2 * i + k];
    }
  }
  expect_failure("psf", {lenses[0], lens(lenses[0]), "--at", "5m", "--focus", "2m", "--out", path("twice")},
                 {"LENS", lenses[0]});
}

// Lights at 90 degrees and more have their distance along the ray; a far light equals a light at infinity.
TEST_F(BokehPsf, FisheyeSeesLightsBesideItAtADistance) {
  const std::string fisheye = "fisheye_6.3mm_f2.8";
  const auto at = [&](const char* distance) {
    EXPECT_EQ(run("psf", {fisheye, "--at", distance, "--focus", "1m", "--fields", "0,90,100,108", "--rays", "16384",
                          "--format", "png", "--out", path(distance)})
                  .status,
              0);
    return read_json(path(distance) + '/' + fisheye + "_bokeh.json")["results"];
  };
  const auto near = at("1m"), far = at("1km"), infinite = at("inf");
  ASSERT_EQ(near.size(), 4u);
  const auto throughput = [](const nlohmann::json& result) { return result.at("throughput").get<double>(); };
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(throughput(far[i]), throughput(infinite[i]), 2e-3);
    EXPECT_NEAR(far[i]["centroid_mm"][1].get<double>(), infinite[i]["centroid_mm"][1].get<double>(), 1e-3);
    EXPECT_NEAR(throughput(near[i]), throughput(infinite[i]), 0.15);
  }
  EXPECT_GE(throughput(near[1]), throughput(near[2]));
  EXPECT_GE(throughput(near[2]), throughput(near[3]));
  expect_failure("psf", {fisheye, "--at", "1mm", "--focus", "1m", "--fields", "100", "--out", path("inside")},
                 {"--at", 1, 100});
}

TEST_F(BokehPsf, AcceptsAnImageAsIris) {
  petzval::RgbImage half(8, 8);  // the part at -x passes
  for (int y = 0; y < 8; ++y) std::fill_n(half.pixel(0, y), 12, 1.0f);
  petzval::write_exr(half, path("half.exr"));
  petzval::write_png(petzval::to_srgb8(half), path("half.png"));
  for (const char* file : {"half.exr", "half.png"}) {
    const auto json = bokeh({"--at", "2000", "--focus", "1000", "--f-number", "4", "--iris-image", path(file)});
    const auto& result = json["results"][0];
    EXPECT_NEAR(result["iris_area_share"].get<double>(), 0.5, 0.01);
    EXPECT_NEAR(result["throughput"].get<double>(), 0.5, 0.02);
    // Focused nearer than the light: rays cross in front of the film, and the image of the stop is inverted.
    EXPECT_GT(result["centroid_mm"][0].get<double>(), 0.3 * result["radius_mm"].get<double>());
  }
}

}  // namespace
