// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/psf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "analysis/points.hpp"
#include "analysis/psf_blend.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/trace_rays.hpp"

namespace petzval {
namespace {

/// Traces the bundle of a kernel. Each ray has its index as weight, which identifies the rays that pass.
void fill_hits(PsfKernel& kernel, const Lens& lens, const PupilSampler& pupil) {
  const auto side = static_cast<std::size_t>(kernel.pixels), count = side * side;
  kernel.hits_x.assign(count, std::numeric_limits<float>::quiet_NaN());
  kernel.hits_y = kernel.hits_x;
  if (pupil.empty()) return;
  std::vector<double> indices(count);
  std::iota(indices.begin(), indices.end(), 0.0);
  const auto start = [&](std::size_t begin, std::size_t end, const RayArrays<double>& rays) {
    std::array<double, pupil_detail::block_rays> buffer_u, buffer_v;
    const std::span u(buffer_u.data(), end - begin), v(buffer_v.data(), end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      const double radius = (static_cast<double>(i / side) + 0.5) / static_cast<double>(side);
      u[i - begin] = (static_cast<double>(i % side) + 0.5) / static_cast<double>(side);
      v[i - begin] = radius * radius;
    }
    pupil(u, v, u, v);
    pupil.plane().rays(u, v, rays);
    return end - begin;
  };
  const RayBundle bundle = pupil_detail::trace_rays(
      lens, lens.film_z(), count, {.wavelength = pupil.wavelength(), .slopes = false, .weights = indices}, start);
  for (std::size_t i = 0; i < bundle.size(); ++i) {
    const auto sample_index = static_cast<std::size_t>(bundle.weights[i]);
    kernel.hits_x[sample_index] = static_cast<float>(kernel.anchor_mm.x - bundle.x[i]);
    kernel.hits_y[sample_index] = static_cast<float>(kernel.anchor_mm.y - bundle.y[i]);
  }
}

struct AxisRule {
  const char* name;
  double least, most;
  bool open;  ///< true if the least value is excluded
  const char* words;
};
constexpr double infinity = std::numeric_limits<double>::infinity(), largest = std::numeric_limits<double>::max();

void check_axis(const std::vector<double>& axis, const AxisRule& rule) {
  const std::string where = std::string("PSF set: ") + rule.name;
  if (axis.empty()) throw Error(where + ": no value; must be at least one");
  for (std::size_t i = 0; i < axis.size(); ++i) {
    if (!(axis[i] >= rule.least && axis[i] <= rule.most) || (rule.open && axis[i] == rule.least)) {
      throw Error(where + ": value = " + to_text(axis[i]) + "; must be " + rule.words);
    }
    if (i > 0 && !(axis[i] > axis[i - 1])) {
      throw Error(where + ": value = " + to_text(axis[i]) + " after " + to_text(axis[i - 1]) + "; must be ascending");
    }
  }
}

/// A node of an axis with its weights in a WeightedKernel.
struct AxisNode {
  std::size_t index;
  double smooth, linear;
};

/// The node at the value, or up to two nodes on either side of the value.
std::vector<AxisNode> around(const std::vector<double>& axis, double at, const char* name, bool inverse) {
  if (!(at >= axis.front() && at <= axis.back())) {
    throw Error(std::string("PSF set: ") + name + " = " + to_text(at) + "; must be " +
                (axis.size() == 1 ? to_text(axis.front()) : to_text(axis.front()) + " to " + to_text(axis.back())));
  }
  const auto upper = static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), at) - axis.begin());
  if (axis[upper] == at) return {{upper, 1, 1}};
  const auto coordinate = [&](double value) { return inverse ? 1 / value : value; };
  const std::size_t first = std::max(upper, std::size_t(2)) - 2, end = std::min(upper + 2, axis.size());
  std::vector<AxisNode> nodes;
  for (std::size_t i = first; i < end; ++i) {
    AxisNode node{i, 1, 0};
    for (std::size_t k = first; k < end; ++k) {  // Lagrange polynomials
      if (k == i) continue;
      const double step = (coordinate(at) - coordinate(axis[k])) / (coordinate(axis[i]) - coordinate(axis[k]));
      node.smooth *= step;
      if ((i == upper && k + 1 == upper) || (i + 1 == upper && k == upper)) node.linear = step;
    }
    nodes.push_back(node);
  }
  return nodes;
}

}  // namespace

PsfKernel psf_kernel(const Lens& lens, const Lens& wide_open, const FieldPoint& point, std::size_t wavelength,
                     const PsfOptions& options) {
  if (options.pixels < 3 || options.pixels % 2 == 0) {
    throw Error("psf_kernel: pixels = " + std::to_string(options.pixels) +
                "; must be odd and at least 3, because the anchor is the middle of a pixel");
  }
  const auto chief = analysis_detail::chief_point(lens, point, wavelength);
  PsfOptions centred = options;
  centred.centre = chief, centred.wavelength = wavelength;
  const Psf psf = point_image(lens, point, centred);
  PsfKernel kernel;
  kernel.pixels = psf.pixels;
  kernel.pixel_mm = psf.pixel_mm;
  kernel.chief_ray = chief.has_value();
  kernel.anchor_mm = psf.centre;
  kernel.throughput = psf.mean_throughput;
  kernel.error = psf.error;
  kernel.rays = static_cast<double>(psf.sent[0]);
  kernel.diffraction = diffraction(airy_radius(lens, wavelength), psf.size);

  const double axis = film_irradiance(with_film(wide_open, lens.film_z()), {}, wide_open.primary_wavelength());
  if (psf.mean_throughput > 0 && axis > 0) {
    kernel.total = film_irradiance(lens, {kernel.anchor_mm.x, kernel.anchor_mm.y}, wavelength) / axis;
  }
  // A photograph is rotated by 180 degrees.
  const double per_ray = psf.transmitted[0] > 0 ? kernel.total / static_cast<double>(psf.transmitted[0]) : 0.0;
  for (auto count = psf.counts.rbegin(); count != psf.counts.rend(); ++count) {
    kernel.light.push_back(static_cast<float>(per_ray * static_cast<double>(*count)));
  }
  fill_hits(kernel, lens, PupilSampler(pupil_boundary(lens, point, wavelength)));
  return kernel;
}

double total_variation(const PsfKernel& a, const PsfKernel& b) {
  if (a.pixels != b.pixels || a.pixel_mm != b.pixel_mm) {
    throw Error("total_variation: grids of " + std::to_string(a.pixels) + " pixels of " + to_text(a.pixel_mm) +
                " mm and " + std::to_string(b.pixels) + " of " + to_text(b.pixel_mm) + " mm; must be equal");
  }
  if (a.total == 0 || b.total == 0) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.light.size(); ++i) {
    sum += std::abs(static_cast<double>(a.light[i]) / a.total - static_cast<double>(b.light[i]) / b.total);
  }
  return sum / 2;
}

PsfSetPoint PsfSet::Axes::point(std::size_t node) const noexcept {
  const auto next = [&](const std::vector<double>& axis) {
    const std::size_t i = node % axis.size();
    node /= axis.size();
    return axis[i];
  };
  PsfSetPoint point;
  point.field_deg = next(fields_deg);
  point.distance_mm = next(distances_mm);
  point.wavelength_nm = next(wavelengths_nm);
  point.f_number = next(f_numbers);
  return point;
}

void PsfSet::validate(const Axes& axes) {
  check_axis(axes.fields_deg, {"field_deg", 0, 180, false, "0 to 180"});
  check_axis(axes.distances_mm, {"distance_mm", 0, infinity, true, "above 0, or inf"});
  check_axis(axes.wavelengths_nm, {"wavelength_nm", 0, largest, true, "finite and above 0"});
  check_axis(axes.f_numbers, {"f_number", 0, largest, true, "finite and above 0"});
}

PsfSet::PsfSet(Axes axes, std::vector<PsfKernel> kernels) : axes_(std::move(axes)), kernels_(std::move(kernels)) {
  validate(axes_);
  if (kernels_.size() != axes_.size()) {
    throw Error("PSF set: " + std::to_string(kernels_.size()) + " kernels; must be one for each of " +
                std::to_string(axes_.size()) + " nodes");
  }
  const int pixels = kernels_.front().pixels;
  const std::size_t plane = static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels);
  for (const PsfKernel& kernel : kernels_) {
    if (kernel.pixels == pixels && kernel.light.size() == plane && kernel.hits_x.size() == plane &&
        kernel.hits_y.size() == plane && pixels % 2 == 1) {
      continue;
    }
    throw Error("PSF set: a kernel has " + std::to_string(kernel.pixels) + " pixels with " +
                std::to_string(kernel.light.size()) + " of light and " + std::to_string(kernel.hits_x.size()) +
                " hits; must be " + std::to_string(pixels) + " squared of each, and odd");
  }
}

PsfKernel PsfSet::at(const PsfSetPoint& point) const {
  std::vector<analysis_detail::WeightedKernel> nodes;
  const auto fields = around(axes_.fields_deg, point.field_deg, "field_deg", false);
  const auto distances = around(axes_.distances_mm, point.distance_mm, "distance_mm", true);
  const auto wavelengths = around(axes_.wavelengths_nm, point.wavelength_nm, "wavelength_nm", false);
  for (const AxisNode& stop : around(axes_.f_numbers, point.f_number, "f_number", true)) {
    for (const AxisNode& colour : wavelengths) {
      for (const AxisNode& distance : distances) {
        for (const AxisNode& field : fields) {
          const std::size_t row =
              (stop.index * axes_.wavelengths_nm.size() + colour.index) * axes_.distances_mm.size() + distance.index;
          nodes.push_back({&kernels_[row * axes_.fields_deg.size() + field.index],
                           stop.smooth * colour.smooth * distance.smooth * field.smooth,
                           stop.linear * colour.linear * distance.linear * field.linear});
        }
      }
    }
  }
  return nodes.size() == 1 ? *nodes.front().kernel : analysis_detail::blend(nodes);
}

}  // namespace petzval
