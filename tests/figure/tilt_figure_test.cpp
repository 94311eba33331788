// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/error.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace tilt_figure_test {

using testing::count;
using testing::marks;
using testing::paths;
using testing::Points;

constexpr const char* film_plane = "stroke=\"#111\" stroke-width=\"0.8\"";
constexpr const char* focus_plane_style = "stroke=\"#1a8f3c\" stroke-width=\"2\"";
constexpr const char* principal = "stroke=\"#1f5fc4\" stroke-width=\"1\"";
constexpr const char* wedge = "fill=\"#dff2e3\"";

/// A plane that rises away from the camera: the Scheimpflug line lies within the drawing.
const Plane table{{0, std::cos(0.3), std::sin(0.3)}, -300};

std::vector<FocusTarget> points_of(const Plane& plane) {
  std::vector<FocusTarget> result;
  for (const double z : {-800.0, -1000.0, -1500.0}) {
    result.push_back({{{0.1 * z, (plane.offset - plane.normal.z * z) / plane.normal.y, z}, false}});
  }
  return result;
}

TiltView view(const IdealLens& lens, const Plane& plane, const std::vector<FocusTarget>& points) {
  TiltView result;
  result.title = "A <lens>";
  result.remark = "f/4 & more";
  result.lens = lens;
  result.after = film_in(lens.image_of(plane).value());
  result.before.z_mm = lens.image({{0, 0, -1000}, false})->position.z;
  result.points = points;
  return result;
}

/// The intersection of the lines through two strokes.
std::pair<double, double> crossing(const Points& a, const Points& b) {
  const auto [ax, ay] = a.at(0);
  const auto [bx, by] = b.at(0);
  const double ux = a.at(1).first - ax, uy = a.at(1).second - ay, vx = b.at(1).first - bx, vy = b.at(1).second - by;
  const double t = ((bx - ax) * vy - (by - ay) * vx) / (ux * vy - uy * vx);
  return {ax + t * ux, ay + t * uy};
}

TEST(TiltFigure, FilmLensAndPlaneOfFocusMeetInOnePoint) {
  const std::string svg = tilt_figure(view(thin_lens(100, 4), table, points_of(table)));
  const auto film = paths(svg, film_plane).at(0), focus = paths(svg, focus_plane_style).at(0),
             lens = paths(svg, principal).at(0);
  const auto [x1, y1] = crossing(film, lens);
  const auto [x2, y2] = crossing(focus, lens);
  EXPECT_NEAR(x1, x2, 0.1);
  EXPECT_NEAR(y1, y2, 0.1);
  EXPECT_NE(svg.find(">Scheimpflug line<"), std::string::npos);
  // The mark is there.
  EXPECT_FALSE(testing::matches(svg, "<circle cx=\"" + std::to_string(static_cast<int>(x1)) + "[0-9.]*\"").empty());
}

TEST(TiltFigure, ThickLensHasBothIntersectionsAtOneHeight) {
  const Lens glass = testing::data_lens("double_gauss_100mm_f2_28deg");
  const auto points = points_of(table);
  TiltView thick = view(thick_lens(glass), table, points);
  thick.glass = &glass;
  const std::string svg = tilt_figure(thick);
  const auto planes = paths(svg, principal);  // front and rear, of two panels, and the key's
  const auto front = crossing(paths(svg, focus_plane_style).at(0), planes.at(0));
  const auto rear = crossing(paths(svg, film_plane).at(0), planes.at(1));
  EXPECT_NEAR(front.second, rear.second, 0.1);
  EXPECT_GT(std::abs(front.first - rear.first), 5);
  EXPECT_GE(count(svg, "fill=\"rgb("), 8u);  // glass in both panels
}

TEST(TiltFigure, PointsOfThePlaneLieOnItsLineAndTheirImagesOnTheFilm) {
  const std::string svg = tilt_figure(view(thin_lens(100, 4), table, points_of(table)));
  const auto line = paths(svg, focus_plane_style).at(0);
  const auto [ax, ay] = line.at(0);
  const auto [bx, by] = line.at(1);
  const Points found = marks(svg);
  ASSERT_EQ(found.size(), 3u);
  for (const auto& [x, y] : found) EXPECT_NEAR(y, ay + (x - ax) / (bx - ax) * (by - ay), 0.05);
  const auto film = paths(svg, film_plane).at(1);
  const auto images = testing::matches(svg, "<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\" r=\"2.5\"");
  EXPECT_FALSE(images.empty());
  for (const testing::Match& image : images) {
    const double x = image.number(1), y = image.number(2);
    const auto& [fx, fy] = film.at(0);
    const auto& [gx, gy] = film.at(1);
    EXPECT_NEAR(x, fx + (y - fy) / (gy - fy) * (gx - fx), 0.05);
  }
}

TEST(TiltFigure, WedgeEndsAtTheRequestedBlur) {
  const IdealLens lens = thin_lens(100, 4);
  const auto points = points_of(table);
  TiltView shown = view(lens, table, points);
  shown.blur_mm = 0.2;
  const std::string svg = tilt_figure(shown);
  // From pixels back to millimetres, by two known points.
  const Points marked = marks(svg);
  const auto& p = points.at(0).point.position;
  const auto& q = points.at(2).point.position;
  const double per_z = (q.z - p.z) / (marked.at(2).first - marked.at(0).first),
               per_y = (q.y - p.y) / (marked.at(2).second - marked.at(0).second);
  EXPECT_NEAR(per_z, -per_y, 0.01 * per_z);  // one scale
  const Points corners = paths(svg, wedge).at(0);
  double left = 1e9;
  for (const auto& [x, y] : corners) left = std::min(left, x);
  int limits = 0;
  for (const auto& [x, y] : corners) {
    if (x > left + 0.1) continue;
    const Vec3<double> place{0, p.y + (y - marked.at(0).second) * per_y, p.z + (x - marked.at(0).first) * per_z};
    EXPECT_NEAR(std::abs(signed_blur(lens.image({place, false}).value(), shown.after)), 0.2, 0.004);
    ++limits;
  }
  EXPECT_EQ(limits, 2);
  EXPECT_GE(corners.size(), 3u);
}

TEST(TiltFigure, PlaneOfFocusIsDrawnForAnyFilm) {
  const auto points = points_of(table);
  const TiltView ideal = view(thin_lens(100, 4), table, points);
  TiltView real = ideal;
  real.after.z_mm = real.after.z() - 0.5;
  real.before.z_mm = real.before.z() - 0.5;
  const auto hinge = [](const std::string& svg) {
    const auto at = svg.find("Hinge line");
    return svg.substr(at, svg.find("from the axis", at) - at);
  };
  EXPECT_NE(hinge(tilt_figure(real)), hinge(tilt_figure(ideal)));
  real.focus = focus_plane(ideal.lens, ideal.after);
  const std::string svg = tilt_figure(real);
  EXPECT_EQ(hinge(svg), hinge(tilt_figure(ideal)));
  EXPECT_NE(paths(svg, film_plane), paths(tilt_figure(ideal), film_plane));
}

TEST(TiltFigure, SwingIsSeenFromAbove) {
  const Plane wall{{std::cos(0.3), 0, std::sin(0.3)}, -300};
  const std::vector<FocusTarget> points{{{{-100, 50, (-300 + 100 * std::cos(0.3)) / std::sin(0.3)}, false}}};
  const std::string svg = tilt_figure(view(thin_lens(100, 4), wall, points));
  EXPECT_NE(svg.find(">x (mm)<"), std::string::npos);
  EXPECT_EQ(svg.find(">y (mm)<"), std::string::npos);
}

TEST(TiltFigure, AnUprightFilmHasNoLinesAndPointsAtInfinityArrows) {
  std::vector<FocusTarget> points{
      {{{0, 0.1, -1}, true}}, {{{0, 0, -3000}, false}}, {.point = {{0, 900, -2500}}, .weight = 0}};
  TiltView upright = view(thin_lens(50, 2), {{0, 0, 1}, -2000}, points);
  upright.after.tilt_rad = upright.after.swing_rad = 0;
  const std::string svg = tilt_figure(upright);
  EXPECT_EQ(svg.find(">hinge line<"), std::string::npos);
  EXPECT_EQ(marks(svg).size(), 3u);
  EXPECT_EQ(count(svg, "r=\"4\" fill=\"#fff\""), 1u);
  for (const char* word : {"nan", "inf\"", "-0\u00b0"}) EXPECT_EQ(svg.find(word), std::string::npos) << word;
  EXPECT_EQ(count(svg, "A &lt;lens&gt;"), 1u);
  // A film in the rear focal plane.
  upright.after.z_mm = upright.lens.rear_focal_z;
  EXPECT_NE(tilt_figure(upright).find("infinity"), std::string::npos);
}

TEST(TiltFigure, RequiresFiniteFilmsABlurAndAFrame) {
  const auto points = points_of(table);
  const TiltView good = view(thin_lens(100, 4), table, points);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TiltView v = good;
    v.after.tilt_rad = bad;
    EXPECT_THROW(tilt_figure(v), Error);
    v = good;
    v.before.z_mm = bad;
    EXPECT_THROW(tilt_figure(v), Error);
  }
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    TiltView v = good;
    v.blur_mm = bad;
    EXPECT_THROW(tilt_figure(v), Error);
    v = good;
    v.after.width_mm = bad;
    EXPECT_THROW(tilt_figure(v), Error);
  }
}

}  // namespace tilt_figure_test
}  // namespace petzval
