// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/least_squares.hpp"
#include "core/text.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "radial_picture.hpp"

namespace petzval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// One distance from the centre of the picture, with the area of the picture at this distance.
struct Node {
  double radius = 0, field = 0;  ///< pixels; rad
  double weight = 0;
  double illumination = 1;  ///< relative to the axis
};

/// Fraction of a circle about the centre of the picture that lies in the picture.
double fraction_inside(double radius, double half_width, double half_height) {
  const auto outside = [&](double half) { return radius > half ? std::acos(half / radius) : 0.0; };
  return std::max(0.0, 1 - 2 * (outside(half_width) + outside(half_height)) / std::numbers::pi);
}

/// Weighted linear least squares: row i of the design has weight weights[i].
VectorXd solved(const Eigen::MatrixXd& design, const VectorXd& wanted, const VectorXd& weights) {
  const VectorXd roots = weights.cwiseSqrt();
  return core_detail::least_squares(roots.asDiagonal() * design, roots.cwiseProduct(wanted));
}

class Fits {
 public:
  Fits(const Camera& camera, std::vector<Node> nodes) : camera_(camera), nodes_(std::move(nodes)) {}

  /// r = sum of coefficients times x^power, for x of a node. Returns the coefficients.
  VectorXd radial(const std::function<double(const Node&)>& x, const std::vector<int>& powers,
                  const std::function<double(const Node&)>& y) const {
    Eigen::MatrixXd design(size(), static_cast<Index>(powers.size()));
    VectorXd wanted(size()), weights(size());
    for (Index i = 0; i < size(); ++i) {
      const Node& node = nodes_[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < powers.size(); ++k) design(i, static_cast<Index>(k)) = std::pow(x(node), powers[k]);
      wanted(i) = y(node), weights(i) = node.weight;
    }
    return solved(design, wanted, weights);
  }
  /// @param error  of a node, pixels
  Calibration found(std::string name, std::vector<std::pair<std::string, double>> values,
                    const std::function<double(const Node&)>& error) const {
    Calibration result{.name = std::move(name), .values = std::move(values)};
    double squares = 0, weights = 0;
    for (const Node& node : nodes_) {
      const double one = error(node);
      squares += node.weight * one * one, weights += node.weight;
      result.largest = std::max(result.largest, std::abs(one));
      result.widest_field_rad = std::max(result.widest_field_rad, node.field);
    }
    result.rms = std::sqrt(squares / weights);
    return result;
  }
  double cx() const noexcept { return camera_.film().columns / 2.0; }
  double cy() const noexcept { return camera_.film().rows / 2.0; }
  double widest() const noexcept { return nodes_.back().field; }
  const std::vector<Node>& nodes() const noexcept { return nodes_; }

 private:
  Index size() const noexcept { return static_cast<Index>(nodes_.size()); }

  const Camera& camera_;
  std::vector<Node> nodes_;
};

double tangent(const Node& node) { return std::tan(node.field); }
double angle(const Node& node) { return node.field; }
double radius(const Node& node) { return node.radius; }

/// OpenCV's f with k1, k2 and, if `terms` is 3, k3.
void add_opencv_polynomial(const Fits& fits, int terms, std::vector<Calibration>& to) {
  std::vector<int> powers{1, 3, 5, 7};
  powers.resize(static_cast<std::size_t>(terms) + 1);
  const VectorXd c = fits.radial(tangent, powers, radius);
  const double f = c(0), k1 = c(1) / f, k2 = c(2) / f, k3 = terms == 3 ? c(3) / f : 0;
  const auto error = [=](const Node& node) {
    const double t = tangent(node), t2 = t * t;
    return f * t * (1 + t2 * (k1 + t2 * (k2 + t2 * k3))) - node.radius;
  };
  const double cx = fits.cx(), cy = fits.cy();
  if (terms == 3) {
    to.push_back(fits.found(
        "opencv_5",
        {{"fx", f}, {"fy", f}, {"cx", cx}, {"cy", cy}, {"k1", k1}, {"k2", k2}, {"p1", 0}, {"p2", 0}, {"k3", k3}},
        error));
    return;
  }
  to.push_back(fits.found("colmap_radial", {{"f", f}, {"cx", cx}, {"cy", cy}, {"k1", k1}, {"k2", k2}}, error));
  to.push_back(fits.found("colmap_opencv",
                          {{"fx", f}, {"fy", f}, {"cx", cx}, {"cy", cy}, {"k1", k1}, {"k2", k2}, {"p1", 0}, {"p2", 0}},
                          error));
}

/// The rational model: linear least squares for numerator and denominator together, repeated with the denominator of
/// the last step as weight (Sanathanan and Koerner, 1963).
void add_opencv_rational(const Fits& fits, std::vector<Calibration>& to) {
  const std::vector<Node>& nodes = fits.nodes();
  const Index count = static_cast<Index>(nodes.size());
  VectorXd denominators = VectorXd::Ones(count), c;
  const double scale = std::pow(std::tan(fits.widest()), 2);  // powers of t^2 / scale give columns of similar size
  for (int step = 0; step < 20; ++step) {
    Eigen::MatrixXd design(count, 7);
    VectorXd wanted(count), weights(count);
    for (Index i = 0; i < count; ++i) {
      const Node& node = nodes[static_cast<std::size_t>(i)];
      const double t = tangent(node), s = t * t / scale;
      double power = 1;
      for (int k = 0; k < 4; ++k, power *= s) {
        design(i, k) = t * power;
        if (k > 0) design(i, 3 + k) = -node.radius * power;
      }
      wanted(i) = node.radius;
      weights(i) = node.weight / (denominators(i) * denominators(i));
    }
    c = solved(design, wanted, weights);
    for (Index i = 0; i < count; ++i) {
      const double s = std::pow(tangent(nodes[static_cast<std::size_t>(i)]), 2) / scale;
      denominators(i) = std::max(0.05, std::abs(1 + s * (c(4) + s * (c(5) + s * c(6)))));
    }
  }
  const double f = c(0);
  const std::array<double, 6> k{c(1) / f / scale, c(2) / f / std::pow(scale, 2), c(3) / f / std::pow(scale, 3),
                                c(4) / scale,     c(5) / std::pow(scale, 2),     c(6) / std::pow(scale, 3)};
  const auto error = [=](const Node& node) {
    const double t = tangent(node), t2 = t * t;
    return f * t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * k[2]))) / (1 + t2 * (k[3] + t2 * (k[4] + t2 * k[5]))) -
           node.radius;
  };
  std::vector<std::pair<std::string, double>> values{{"fx", f},    {"fy", f},    {"cx", fits.cx()}, {"cy", fits.cy()},
                                                     {"k1", k[0]}, {"k2", k[1]}, {"p1", 0},         {"p2", 0},
                                                     {"k3", k[2]}, {"k4", k[3]}, {"k5", k[4]},      {"k6", k[5]}};
  to.push_back(fits.found("opencv_8", values, error));
  for (const char* const prism : {"s1", "s2", "s3", "s4"}) values.emplace_back(prism, 0);
  to.push_back(fits.found("opencv_12", values, error));
}

void add_fisheye(const Fits& fits, std::vector<Calibration>& to) {
  const VectorXd c = fits.radial(angle, {1, 3, 5, 7, 9}, radius);
  const double f = c(0);
  const std::array<double, 4> k{c(1) / f, c(2) / f, c(3) / f, c(4) / f};
  const auto error = [=](const Node& node) {
    const double a = node.field, a2 = a * a;
    return f * a * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))) - node.radius;
  };
  for (const char* const name : {"opencv_fisheye", "kannala_brandt"}) {
    to.push_back(fits.found(name,
                            {{"fx", f},
                             {"fy", f},
                             {"cx", fits.cx()},
                             {"cy", fits.cy()},
                             {"k1", k[0]},
                             {"k2", k[1]},
                             {"k3", k[2]},
                             {"k4", k[3]}},
                            error));
  }
}

/// The field is a polynomial of the distance in pixels; errors in pixels by the slope of the polynomial.
void add_f_theta(const Fits& fits, std::vector<Calibration>& to) {
  const double scale = std::hypot(fits.cx(), fits.cy());
  const VectorXd c = fits.radial([=](const Node& node) { return node.radius / scale; }, {1, 2, 3, 4}, angle);
  const std::array<double, 4> k{c(0) / scale, c(1) / std::pow(scale, 2), c(2) / std::pow(scale, 3),
                                c(3) / std::pow(scale, 4)};
  const auto error = [=](const Node& node) {
    const double r = node.radius, found = r * (k[0] + r * (k[1] + r * (k[2] + r * k[3])));
    const double slope = k[0] + r * (2 * k[1] + r * (3 * k[2] + r * 4 * k[3]));
    return (node.field - found) / slope;
  };
  to.push_back(fits.found(
      "f_theta",
      {{"k0", 0}, {"k1", k[0]}, {"k2", k[1]}, {"k3", k[2]}, {"k4", k[3]}, {"cx", fits.cx()}, {"cy", fits.cy()}},
      error));
}

/// Lensfun's polynomials: the slope at the centre follows from the rule that 1 maps to 1, so that a free scale takes
/// the place of the focal length.
void add_lensfun(const Fits& fits, std::vector<Calibration>& to) {
  const bool fisheye = fits.widest() > radians(85);
  const double half = std::min(fits.cx(), fits.cy());
  const auto x = fisheye ? angle : tangent;
  const auto y = [=](const Node& node) { return node.radius / half; };
  for (const bool ptlens : {true, false}) {
    const std::vector<int> powers = ptlens ? std::vector<int>{1, 2, 3, 4} : std::vector<int>{1, 3};
    const VectorXd c = fits.radial(x, powers, y);
    // r' = sum C_n x^n and q = s x with the scale s for which the coefficients of q sum to 1.
    double s = c(0);
    for (int i = 0; i < 50; ++i) {
      double sum = 0, slope = 0;
      for (std::size_t k = 0; k < powers.size(); ++k) {
        sum += c(static_cast<Index>(k)) / std::pow(s, powers[k]);
        slope -= powers[k] * c(static_cast<Index>(k)) / std::pow(s, powers[k] + 1);
      }
      s -= (sum - 1) / slope;
    }
    const auto error = [=](const Node& node) {
      double sum = 0;
      for (std::size_t k = 0; k < powers.size(); ++k) sum += c(static_cast<Index>(k)) * std::pow(x(node), powers[k]);
      return half * (sum - node.radius / half);
    };
    const auto term = [&](Index k) { return c(k) / std::pow(s, powers[static_cast<std::size_t>(k)]); };
    const double focal = s * half;  // of the undistorted picture
    to.push_back(ptlens ? fits.found("lensfun_ptlens",
                                     {{"a", term(3)}, {"b", term(2)}, {"c", term(1)}, {"undistorted_f", focal}}, error)
                        : fits.found("lensfun_poly3", {{"k1", term(1)}, {"undistorted_f", focal}}, error));
  }
  const double corner = std::hypot(fits.cx(), fits.cy());
  const VectorXd v = fits.radial([=](const Node& node) { return node.radius / corner; }, {2, 4, 6},
                                 [](const Node& node) { return node.illumination - 1; });
  to.push_back(fits.found("lensfun_pa", {{"k1", v(0)}, {"k2", v(1)}, {"k3", v(2)}}, [=](const Node& node) {
    const double r2 = std::pow(node.radius / corner, 2);
    return 1 + r2 * (v(0) + r2 * (v(1) + r2 * v(2))) - node.illumination;
  }));
  to.back().of_irradiance = true;
}

/// Moves the optical centre of an OpenCV model. OpenCV counts positions from the centre of the first pixel; rasters and
/// COLMAP count from its corner.
Calibration centred(Calibration own, double shift) {
  if (!own.name.starts_with("opencv_")) return own;
  for (auto& [name, value] : own.values) {
    if (name == "cx" || name == "cy") value += shift;
  }
  return own;
}

}  // namespace

double Calibration::value(std::string_view wanted) const {
  for (const auto& [own, number_of] : values) {
    if (own == wanted) return number_of;
  }
  throw Error(name + ": value \"" + std::string(wanted) + "\" is missing; must be a parameter of the model");
}

std::vector<Calibration> calibrations(const Camera& camera, std::optional<double> subject_z_mm) {
  const exports_detail::RadialPicture picture(camera, subject_z_mm);
  const Film& film = camera.film();
  const Lens& lens = camera.lens();
  const double half_width = film.columns / 2.0, half_height = film.rows / 2.0;
  const double corner = picture.corner, on_axis = exports_detail::irradiance(camera, 0);
  constexpr int count = 200;
  std::vector<Node> nodes;
  for (int i = 1; i <= count; ++i) {
    Node node{.radius = corner * (i - 0.5) / count};
    const auto field = picture.primary.field(node.radius, picture.widest);
    if (!field) break;
    node.illumination = exports_detail::irradiance(camera, node.radius * film.pixel_mm()) / on_axis;
    if (!(node.illumination > 0)) break;
    node.field = *field;
    node.weight = node.radius * fraction_inside(node.radius, half_width, half_height);
    nodes.push_back(node);
  }
  if (nodes.size() < 20)
    throw Error(lens.name() + ": calibration: the picture is dark outside its centre; must be lit");
  const Fits fits(camera, std::move(nodes));
  std::vector<Calibration> result;
  if (fits.widest() < radians(85)) {
    add_opencv_polynomial(fits, 3, result);
    add_opencv_rational(fits, result);
    add_opencv_polynomial(fits, 2, result);
  }
  add_fisheye(fits, result);
  add_f_theta(fits, result);
  add_lensfun(fits, result);
  const double half = std::min(half_width, half_height);
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    if (w == lens.primary_wavelength()) continue;
    const exports_detail::ChiefProfile own = picture.at(w);
    const auto ratio = [&](const Node& node) { return own.radius(node.field).value_or(node.radius); };
    const VectorXd c = fits.radial([=](const Node& node) { return node.radius / half; }, {1, 2, 3},
                                   [&](const Node& node) { return ratio(node) / half; });
    result.push_back(fits.found("lensfun_tca_" + to_text(lens.wavelengths_nm()[w]),
                                {{"v", c(0)}, {"c", c(1)}, {"b", c(2)}}, [&](const Node& node) {
                                  const double r = node.radius / half;
                                  return half * r * (c(0) + r * (c(1) + r * c(2))) - ratio(node);
                                }));
  }
  for (Calibration& one : result) one = centred(std::move(one), -0.5);
  return result;
}

std::string format_calibration(const Calibration& calibration, const Camera& camera, CalibrationFormat format) {
  const Calibration own = format == CalibrationFormat::opencv ? calibration : centred(calibration, 0.5);
  const Film& film = camera.film();
  const std::string size = std::to_string(film.columns) + ' ' + std::to_string(film.rows);
  const auto list = [&](std::initializer_list<const char*> names, const char* between) {
    std::string text;
    for (const char* const one : names) text += (text.empty() ? "" : between) + to_text(own.value(one));
    return text;
  };
  const bool opencv = own.name.starts_with("opencv_"), fisheye = own.name == "opencv_fisheye";
  const double first = first_order(camera.lens()).effective_focal_length;
  switch (format) {
    case CalibrationFormat::opencv: {
      if (!opencv) return "";
      std::string text = "%YAML:1.0\n---\nimage_width: " + std::to_string(film.columns) +
                         "\nimage_height: " + std::to_string(film.rows) +
                         "\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ " +
                         list({"fx"}, "") + ", 0., " + list({"cx"}, "") + ", 0., " + list({"fy", "cy"}, ", ") +
                         ", 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: " +
                         std::to_string(own.values.size() - 4) + "\n   dt: d\n   data: [ ";
      for (std::size_t i = 4; i < own.values.size(); ++i) text += (i > 4 ? ", " : "") + to_text(own.values[i].second);
      return text + " ]\n";
    }
    case CalibrationFormat::colmap: {
      const auto line = [&](const char* model, const std::string& values) {
        return std::string("1 ") + model + ' ' + size + ' ' + values + '\n';
      };
      if (own.name == "colmap_radial") return line("RADIAL", list({"f", "cx", "cy", "k1", "k2"}, " "));
      if (own.name == "colmap_opencv") {
        return line("OPENCV", list({"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}, " "));
      }
      if (own.name == "opencv_8") {
        return line("FULL_OPENCV", list({"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}, " "));
      }
      if (fisheye) return line("OPENCV_FISHEYE", list({"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}, " "));
      return "";
    }
    case CalibrationFormat::lensfun: {
      const auto attributes = [&](std::initializer_list<const char*> names) {
        std::string text;
        for (const char* const one : names) text += std::string(" ") + one + "=\"" + to_text(own.value(one)) + '"';
        return text + "/>\n";
      };
      const std::string focal = " focal=\"" + to_text(first) + '"';
      if (own.name == "lensfun_ptlens") {
        return "<distortion model=\"ptlens\"" + focal + attributes({"a", "b", "c"});
      }
      if (own.name == "lensfun_poly3") return "<distortion model=\"poly3\"" + focal + attributes({"k1"});
      if (own.name == "lensfun_pa") {
        return "<vignetting model=\"pa\"" + focal + attributes({"k1", "k2", "k3"});
      }
      return "";
    }
    case CalibrationFormat::usd: {
      const auto text = [&](const std::string& schema, const std::string& model, bool nominal,
                            const std::vector<std::pair<std::string, double>>& values) {
        const std::string prefix = "omni:lensdistortion:" + model + ':';
        std::string lines =
            "prepend apiSchemas = [\"" + schema + "\"]\nuniform token omni:lensdistortion:model = \"" + model + "\"\n";
        if (nominal) {
          lines += "float " + prefix + "nominalWidth = " + std::to_string(film.columns) + "\nfloat " + prefix +
                   "nominalHeight = " + std::to_string(film.rows) + "\nfloat2 " + prefix + "opticalCenter = (" +
                   list({"cx", "cy"}, ", ") + ")\nfloat " + prefix +
                   "maxFov = " + to_text(2 * degrees(own.widest_field_rad)) + '\n';
        } else {
          lines += "int2 " + prefix + "imageSize = (" + std::to_string(film.columns) + ", " +
                   std::to_string(film.rows) + ")\n";
        }
        for (const auto& [name, value] : values) lines += "float " + prefix + name + " = " + to_text(value) + '\n';
        return lines;
      };
      if (own.name == "opencv_12")
        return text("OmniLensDistortionOpenCvPinholeAPI", "opencvPinhole", false, own.values);
      if (fisheye) return text("OmniLensDistortionOpenCvFisheyeAPI", "opencvFisheye", false, own.values);
      if (own.name == "kannala_brandt") {
        std::vector<std::pair<std::string, double>> values;
        for (int k = 0; k < 4; ++k) {
          values.emplace_back("k" + std::to_string(k), own.value("k" + std::to_string(k + 1)));
        }
        return text("OmniLensDistortionKannalaBrandtK3API", "kannalaBrandtK3", true, values);
      }
      if (own.name == "f_theta") {
        const std::vector<std::pair<std::string, double>> values(own.values.begin(), own.values.begin() + 5);
        return text("OmniLensDistortionFthetaAPI", "ftheta", true, values);
      }
      return "";
    }
  }
  return "";
}

}  // namespace petzval
