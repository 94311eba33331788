// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// The image of a point light at one wavelength, for renderers and compositors to spread a pixel's light with.
///
/// Light: an evenly bright scene gives the film irradiance where the kernel stands; `total`, the sum of all pixels, is
/// that as a share of what the wide-open lens gives on the axis, at its primary wavelength. So a kernel holds the
/// relative illumination of its field (cos^4 and vignetting) and the light that a smaller stop takes. It is dark where
/// the film sees nothing, although rays of a point far out of focus may arrive there.
///
/// Frame: a photograph's, upright, with +y away from its middle: in the direction of the field. Rows come from the top
/// (largest y first); x runs to the right. On the film both axes are the other way round. The anchor lies in the middle
/// of the middle pixel: `pixels` is odd.
///
/// Beside the picture stand the hits of a bundle of pixels x pixels rays, by which kernels are interpolated: in row j
/// and column i that of PupilSampler's u = (i + 1/2) / pixels and v = ((j + 1/2) / pixels)^2; the light of a ray goes
/// with j + 1/2.
struct PsfKernel {
  int pixels = 0;
  double pixel_mm = 0;
  std::vector<float> light{};             ///< [row][column], `pixels` squared
  std::vector<float> hits_x{}, hits_y{};  ///< from the anchor, mm; NaN where no ray passes

  bool chief_ray = false;        ///< the anchor is the chief ray's point; else the centroid, or (0, 0) of dark ones
  Vec2<double> anchor_mm{0, 0};  ///< on the film
  double total = 0;              ///< light of all pixels, which hold every ray
  double throughput = 0;         ///< PointImage::throughput
  double error = 0;              ///< PointImage::error
  double rays = 0;               ///< sent
  Diffraction diffraction = Diffraction::negligible;
};

struct PsfKernelOptions {
  std::uint32_t samples = 1u << 20;
  int pixels = 129;  ///< a side, odd
  std::uint32_t seed = 0;
  int threads = 1;           ///< results do not depend on it
  double half_width_mm = 0;  ///< of the picture; 0: 5 % more than the hits need
};

/// The kernel of a point at a wavelength of a focused, stopped-down lens. wide_open: the lens that gives the unit of
/// light. Throws Error where point_image and film_irradiance do, and for pixels that are even or fewer than 3.
PETZVAL_API PsfKernel psf_kernel(const Lens& lens, const Lens& wide_open, const FieldPoint& point,
                                 std::size_t wavelength, const PsfKernelOptions& options = {});

/// The share of light that has to be moved to make one kernel's shape the other's: half of the sum of differences of
/// their pixels, each divided by its total. 0: the same; 1: apart. Both have the same grid. 0 for dark ones.
PETZVAL_API double light_moved(const PsfKernel& a, const PsfKernel& b);

/// A point in which a set is looked up.
struct PsfSetPoint {
  double field_deg = 0;
  double distance_mm = 0;  ///< may be infinite
  double wavelength_nm = 0;
  double f_number = 0;
};

/// Kernels of a lens on a grid over field angle, subject distance, wavelength and f-number, to be interpolated.
///
/// The axes are in the numbers that users give, degrees too, so that a node is found by them. Of a lens without
/// symmetry of revolution (blades, cylinders) a set holds the fields towards +y.
///
///     petzval::PsfSet set = petzval::read_psf_set("set.exr");
///     petzval::PsfKernel kernel = set.at({.field_deg = 12, .distance_mm = 900, .wavelength_nm = 550, .f_number = 2});
class PETZVAL_API PsfSet {
 public:
  struct Axes {
    std::vector<double> fields_deg;    ///< 0 to 180
    std::vector<double> distances_mm;  ///< positive, the last may be infinite
    std::vector<double> wavelengths_nm;
    std::vector<double> f_numbers;

    std::size_t size() const noexcept {
      return fields_deg.size() * distances_mm.size() * wavelengths_nm.size() * f_numbers.size();
    }
    /// The point of a node; fields come one after the other, then distances, wavelengths, f-numbers.
    PsfSetPoint point(std::size_t node) const noexcept;

    bool operator==(const Axes&) const = default;
  };

  /// kernels: one for each node, in the order of Axes::point. Throws Error for an axis that is empty, not in ascending
  /// order or out of range, and for another number of kernels.
  PsfSet(Axes axes, std::vector<PsfKernel> kernels);

  /// Throws Error as the constructor does for axes.
  static void validate(const Axes& axes);

  const Axes& axes() const noexcept { return axes_; }
  const std::vector<PsfKernel>& kernels() const noexcept { return kernels_; }

  /// The kernel at a point: that of the node, bit for bit, or between nodes by polynomials in angle, 1 / distance, nm
  /// and 1 / f-number, of degree 3 along an axis (2 in its end cells, and as far as there are nodes).
  ///
  /// Hits of rays through the same place of the pupil are interpolated, not pictures: a blur shrinks to the focus and
  /// grows again turned over, as it does on film, and 2^20 rays of that bundle make the picture. So are the anchor and
  /// the root of `total`; `throughput` and `error` are linear between those of the next nodes.
  ///
  /// Error in percent of light moved against traced kernels in the middles of cells, median and worst, with a noise of
  /// 0.5 to 1.3 (psf_set --check; steps of 5 to 20 degrees, five distances from 1 m to infinity, focused at 2 m):
  /// double Gauss f/2 1.8 and 5.8, f/2.8 2.2 and 3.1; fisheye 2.5 and 3.4; Tessar 6 and 21, double Gauss f/1.35 3 and
  /// 24, both worst next to the focus, where nodes have to be closer. The means of pictures are 70 off. Throws Error
  /// for a point outside the axes; on an axis of one number only that number is inside.
  PsfKernel at(const PsfSetPoint& point) const;

 private:
  Axes axes_;
  std::vector<PsfKernel> kernels_;
};

}  // namespace petzval
