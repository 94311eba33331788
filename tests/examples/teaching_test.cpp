// SPDX-License-Identifier: Apache-2.0
// Runs the programs that teach the library, and checks the optics of their output.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "petzval/core/geometry.hpp"
#include "petzval/image/image.hpp"
#include "program.hpp"

namespace {

class Teaching : public Programs {
 protected:
  /// The standard output of a program, which must succeed.
  std::string output(const std::string& program, const Arguments& arguments = {}) const {
    const Outcome outcome = run(program, arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }

  /// The numbers after a label, up to the end of its line.
  static std::vector<double> numbers(const std::string& text, const std::string& label) {
    const std::size_t start = text.find(label);
    EXPECT_NE(start, std::string::npos) << label << " in " << text;
    if (start == std::string::npos) return std::vector<double>(9, NAN);
    const std::string rest = lines(text.substr(start + label.size())).at(0);
    static const std::regex number("[-+]?[0-9]+([.][0-9]+)?");
    std::vector<double> result;
    for (std::sregex_iterator i(rest.begin(), rest.end(), number), end; i != end; ++i) {
      result.push_back(std::stod(i->str()));
    }
    return result;
  }

  /// A picture that a program wrote: its path is in the output, and its pixels are not uniform.
  petzval::RgbImage picture(const std::string& name, const std::string& out) const {
    EXPECT_NE(out.find(path(name) + '\n'), std::string::npos) << out;
    const bool exr = name.ends_with(".exr");
    const petzval::RgbImage image = exr ? petzval::read_exr(path(name)) : petzval::read_png(path(name));
    const auto [least, most] = std::ranges::minmax(image.pixels);
    EXPECT_GT(most, least + 0.5f) << name;
    return image;
  }

  void expect_svg(const std::string& name, const std::string& out) const {
    EXPECT_NE(out.find(path(name) + '\n'), std::string::npos) << out;
    const std::string svg = read(path(name));
    EXPECT_TRUE(svg.starts_with("<svg"));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
  }
};

TEST_F(Teaching, ProgramsAreShortAndUsePublicHeadersOnly) {
  const auto sources = std::filesystem::path(PETZVAL_TEST_DATA).parent_path() / "examples";
  for (const char* name : {"autofocus", "bokeh_psf", "focus_editor", "hello_blur", "hello_camera", "hello_ghosts",
                           "hello_lens", "path_tracer", "spot_diagram", "tilt_fit"}) {
    SCOPED_TRACE(name);
    const auto source = lines(read(sources / (std::string(name) + ".cpp")));
    EXPECT_LE(source.size(), 100u);
    EXPECT_EQ(source.at(0), "// SPDX-License-Identifier: Apache-2.0");
    for (const std::string& line : source) {
      const bool own = line.starts_with("#include \"petzval/") || line.starts_with("#include <petzval/");
      const bool standard = std::regex_match(line, std::regex("#include <[a-z]+>"));
      EXPECT_TRUE(!line.starts_with("#include") || own || standard) << line;
    }
  }
}

TEST_F(Teaching, HelloGhosts_Coated_AreFainter) {
  const std::string out = output("hello_ghosts", {});
  const auto coated = out.find("magnesium");
  ASSERT_NE(coated, std::string::npos) << out;
  const auto energy = [](const std::string& text) {
    return std::stod(text.substr(text.find(": ", text.find("surfaces")) + 2));
  };
  EXPECT_LT(energy(out.substr(coated)), energy(out) / 10) << out;
}

TEST_F(Teaching, SpotDiagram_OnAxis_HasSmallerSpotsThanAtTheEdge) {
  const std::string out = output("spot_diagram", {lens("cooke_triplet_50mm_f5"), path("")});
  for (const char* line : {"F", "d", "C"}) {
    // RMS radius, largest radius, height of the chief ray.
    const auto axis = numbers(out, std::string("  0.0     ") + line);
    const auto edge = numbers(out, std::string(" 20.0     ") + line);
    ASSERT_EQ(axis.size(), 3u);
    ASSERT_EQ(edge.size(), 3u);
    EXPECT_GT(axis[0], 1);
    EXPECT_LT(axis[0], edge[0]);
    EXPECT_LT(axis[0], axis[1]);
    EXPECT_EQ(axis[2], 0);
    EXPECT_NEAR(edge[2], -50.02 * std::tan(petzval::radians(20)), 0.1);  // the image is inverted
  }
  EXPECT_NEAR(numbers(out, "Airy disc")[0], 1.22 * 0.5876 * 5, 0.1);
  expect_svg("spots.svg", out);
}

TEST_F(Teaching, SpotDiagram_MissingFile_PrintsTheError) {
  const auto outcome = run("spot_diagram", {path("missing.json")});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("missing.json"), std::string::npos) << outcome.err;
}

TEST_F(Teaching, BokehPsf_SixBlades_TransmitTheAreaOfAHexagon) {
  const std::string out = output("bokeh_psf", {path("")});
  const double hexagon = 1.5 * std::numbers::sqrt3 / std::numbers::pi;  // in its circle
  const auto light = numbers(out, "relative to the paraxial entrance pupil: ");
  ASSERT_EQ(light.size(), 2u);
  EXPECT_LT(light[1], light[0]);
  EXPECT_NEAR(light[1] / light[0], hexagon, 0.005);

  const auto bright_pixels = [](const petzval::RgbImage& image) {
    int count = 0;
    for (std::size_t i = 1; i < image.pixels.size(); i += 3) count += image.pixels[i] > 0.25f;
    return static_cast<double>(count);
  };
  const petzval::RgbImage disc = picture("bokeh_round.png", out), blades = picture("bokeh_blades.png", out);
  EXPECT_NEAR(bright_pixels(blades) / bright_pixels(disc), hexagon, 0.03);

  const petzval::RgbImage linear = picture("bokeh_blades.exr", out);
  EXPECT_EQ(linear.width, disc.width);
  EXPECT_EQ(linear.pixels.at(0), 0);  // dark corner
}

TEST_F(Teaching, Autofocus_HeavyTarget_HasTheSmallestBlur) {
  const std::string out = output("autofocus");
  const std::string exact = out.substr(out.find("exact rays"));
  for (const std::string& part : {out, exact}) {
    const double face = numbers(part, "face: ")[0], hand = numbers(part, "hand: ")[0],
                 lamp = numbers(part, "lamp: ")[0];
    EXPECT_LT(std::abs(face), 50);
    EXPECT_LT(std::abs(face), std::abs(hand));
    EXPECT_LT(std::abs(hand), lamp);
    EXPECT_LT(hand, 0);  // in front of the plane of focus
  }
  // Spherical aberration: the rim of the pupil focuses nearer to the lens than its centre.
  EXPECT_LT(numbers(out, "exact rays move the film by ")[0], 0);

  const double focus = numbers(out, "in focus: ")[0];
  const auto depth = numbers(out, "sharp within ");
  ASSERT_EQ(depth.size(), 3u);
  EXPECT_LT(depth[1], focus);
  EXPECT_GT(depth[2], focus);
}

#ifdef PETZVAL_TEST_HAS_tilt
TEST_F(Teaching, FocusEditor_TiltedFilmIsSharperThanTheUprightFilm) {
  const std::string out = output("focus_editor", {});
  const auto largest_blur = [&](const std::string& from, const std::string& to) {
    std::string part = out.substr(out.find(from));
    part.resize(part.find(to));
    double largest = 0;
    static const std::regex blur("blur (-?[0-9.e-]+) px");
    for (std::sregex_iterator found(part.begin(), part.end(), blur), end; found != end; ++found) {
      largest = std::max(largest, std::abs(std::stod((*found)[1])));
    }
    return largest;
  };
  EXPECT_LT(largest_blur("tilted film:", "undo:"), largest_blur("upright film:", "tilted film:"));
  EXPECT_NE(out.find(R"({"type":"undo"})"), std::string::npos);
}

TEST_F(Teaching, TiltFit_TableSeenFromAbove_TiltsTheFilmTowardsTheTable) {
  const std::string out = output("tilt_fit", {path("")});
  const auto film = numbers(out, "film: ");  // tilt, swing, z
  ASSERT_EQ(film.size(), 3u);
  EXPECT_GT(film[0], 0);
  EXPECT_NEAR(film[1], 0, 0.1);

  // The hinge line lies below the lens, at the focal length divided by the tangent of the tilt.
  const auto hinge = numbers(out, "hinge line: ");
  ASSERT_EQ(hinge.size(), 3u);
  EXPECT_NEAR(hinge[0], -99.6 / std::tan(petzval::radians(film[0])), 3);
  EXPECT_NEAR(hinge[2], 0, 0.1);

  // The table: y = 0.4 (-z - 900 mm).
  const auto plane = numbers(out, "plane of focus: ");
  ASSERT_EQ(plane.size(), 4u);
  EXPECT_NEAR(plane[2] / plane[1], 0.4, 0.01);
  EXPECT_NEAR(plane[3] / plane[1], -360, 3);

  for (const char* point : {"point 1: ", "point 2: ", "point 4: ", "point 5: "}) {
    const auto blur = numbers(out, point);
    ASSERT_EQ(blur.size(), 2u);
    EXPECT_LT(std::abs(blur[1]), 0.1 * std::abs(blur[0])) << point;
  }
  expect_svg("tilt.svg", out);
}
#endif

TEST_F(Teaching, PathTracer_SphereInFocus_HasTheSharpestEdge) {
  const petzval::RgbImage image = picture("path_tracer.png", output("path_tracer", {path("")}));
  ASSERT_EQ(image.width, 480);
  ASSERT_EQ(image.height, 320);
  // Red light in front of the sky at the top of a sphere, as a mean over five columns.
  const auto largest_step = [&](int column, int from, int to) {
    float result = 0;
    for (int row = from; row < to; ++row) {
      float step = 0;
      for (int x = column - 2; x <= column + 2; ++x) step += (image.pixel(x, row)[0] - image.pixel(x, row + 1)[0]) / 5;
      result = std::max(result, step);
    }
    return result;
  };
  const float sharp = largest_step(249, 71, 98), blurred = largest_step(398, 52, 90);
  EXPECT_GT(sharp, 0.1f);
  EXPECT_GT(sharp, 2 * blurred);

  // The picture is upright: blue sky above, and it is darker in the corner than in the middle of the upper edge.
  const float* const corner = image.pixel(0, 0);
  const float* const middle = image.pixel(240, 0);
  EXPECT_GT(middle[2], 1.1f * middle[0]);
  EXPECT_LT(corner[2], middle[2]);
}

}  // namespace
