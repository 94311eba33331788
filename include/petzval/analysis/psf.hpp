// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

class Camera;

/// Geometric image of a point light and its size: the distribution over the film of the light that enters the entrance
/// pupil.
///
/// Counts are exact integers. Their sum is the number of rays that hit the image, for any number of threads; weighted
/// rays count in units of 1 / units_per_ray. Each wavelength has one plane of `pixels` x `pixels` counts, rows from the
/// top (largest y first).
struct Psf {
  int pixels = 0;
  double pixel_mm = 0;
  Vec2<double> centre{0, 0};  ///< film position of the image centre, mm
  std::vector<double> wavelengths_nm;
  std::vector<std::uint64_t> counts;       ///< [wavelength][row][column]
  std::vector<std::uint64_t> sent;         ///< rays started, per wavelength
  std::vector<std::uint64_t> transmitted;  ///< counts of the rays that reached the film, inside or outside the image
  std::uint32_t units_per_ray = 1;         ///< counts of a ray of weight 1
  std::vector<double> sampled_area;        ///< area of the pupil plane where the rays start, mm^2, per wavelength
  double entrance_pupil_area = 0;  ///< area of the paraxial entrance pupil, mm^2; an ellipse for cylindrical lenses
  SpotSize size;                   ///< over all wavelengths with equal weights
  /// Irradiance in 64 rings of equal width from the centroid to size.max_radius, averaged over wavelengths: fraction of
  /// the light on the paraxial entrance pupil, per mm^2. Multiplied by the ring areas it sums to the throughput.
  std::array<double, 64> radial_profile{};
  double mean_throughput = 0;  ///< throughput(), mean over wavelengths
  /// Bound of the relative error of the light in the rings (root of the summed squares); 0 if no ray passes.
  ///
  /// Accuracy: 95 of 100 new runs stay below the bound (tests/analysis/psf_error_test.cpp). It is estimated from eight
  /// consecutive parts of the samples, which complement each other. The bound is therefore about twice the error off
  /// axis and with blades, and four to five times the error of round pupils on the axis. If the weights of a camera
  /// vary strongly, it is 2.25 times as wide, because few rays determine the edge of a bright rim.
  double error = 0;

  /// The fraction of the light on the paraxial entrance pupil that a count of 1 carries; 0 if the pupil is empty or the
  /// wavelength index is out of range.
  PETZVAL_API double ray_weight(std::size_t wavelength) const noexcept;

  /// Area of the pupil plane that transmits to the film, divided by the area of the paraxial entrance pupil.
  ///
  /// Does not depend on the crop of the image. For fields of 89 degrees and more both areas face the point. 0 if the
  /// wavelength index is out of range.
  PETZVAL_API double throughput(std::size_t wavelength) const noexcept;
};

/// Options of point_image().
struct PsfOptions {
  std::uint32_t samples = 1u << 20;  ///< rays per wavelength; an upper limit if `tolerance` is set
  /// If positive, rays are sent until Psf::error is within the tolerance or all samples are used. Starts with
  /// 2^14 rays and doubles their number.
  double tolerance = 0;
  int pixels = 512;
  double half_width_mm = 0;                 ///< half the image width; 0: 5 % larger than the hits, at least 0.1 um
  std::optional<Vec2<double>> centre{};     ///< film position of the image centre, mm; unset: the centroid
  std::optional<std::size_t> wavelength{};  ///< wavelength index; unset: all compiled wavelengths
  std::uint32_t seed = 0;
  int threads = 1;  ///< does not change the results
};

/// Computes the image of a point light in a camera at every compiled wavelength of its lens.
///
/// Uses the ray model and the weights (BokehControls) of the camera, with connections from the point to the entrance
/// pupil. Light is relative to the light on the paraxial entrance pupil, as for a lens. A ray takes 0.5 to 2
/// microseconds.
///
/// @throws Error under the conditions of point_image(Lens); also if the entrance pupil is infinite or the normalisation
///               of the camera is not irradiance
///
/// Limitations: rays that miss the film are lost, so the film must contain the image. First-order models do not
/// conserve etendue, so their throughput differs from the lens.
PETZVAL_API Psf point_image(const Camera& camera, const FieldPoint& point, const PsfOptions& options = {});

/// Traces a point light to the film of a lens at every compiled wavelength. All values are 0 if no ray passes.
///
/// @throws Error if samples, pixels or threads are 0, or half_width_mm, tolerance or centre are invalid; also under the
///               conditions of scene_point()
PETZVAL_API Psf point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options = {});

/// The point spread kernel of one point and wavelength, for renderers and compositors.
///
/// Light: `total`, the sum of all pixels, is the film irradiance of a uniformly bright scene at the kernel's position,
/// relative to the irradiance of the wide-open lens on the axis at its primary wavelength. It includes the relative
/// illumination (cos^4 and vignetting) and the loss by a smaller stop. The kernel is dark where the film point sees no
/// light, even if rays of a point far out of focus arrive there.
///
/// Frame: an upright photograph with +y in the direction of the field, x to the right, rows from the top (largest y
/// first). On the film both axes are reversed. The anchor is the centre of the middle pixel; `pixels` is odd.
///
/// Hits: a bundle of pixels x pixels rays from which kernels are interpolated. Row j and column i hold the ray
/// at (i + 1/2) / pixels of a turn about the pupil's middle, from +y towards +x; a fraction ((j + 1/2) / pixels)^2 of
/// the pupil's area lies nearer to the middle. The light of the ray is proportional to j + 1/2.
struct PsfKernel {
  int pixels = 0;
  double pixel_mm = 0;
  std::vector<float> light{};             ///< [row][column], `pixels` squared
  std::vector<float> hits_x{}, hits_y{};  ///< from the anchor, mm; NaN if the ray is blocked

  bool chief_ray = false;        ///< true if the anchor is the chief ray's hit; else the centroid, or (0, 0) if dark
  Vec2<double> anchor_mm{0, 0};  ///< on the film
  double total = 0;              ///< sum of `light`; includes every ray
  double throughput = 0;         ///< Psf::mean_throughput
  double error = 0;              ///< Psf::error
  double rays = 0;               ///< number of rays sent
  Diffraction diffraction = Diffraction::negligible;
};

/// Computes the kernel of a point at one wavelength.
///
/// @param lens        the focused, stopped-down lens
/// @param wide_open   the lens that defines the unit of light
/// @param point       the scene point
/// @param wavelength  wavelength index
/// @param options     as for point_image(); `pixels` is odd; `centre` and `wavelength` are not used
/// @throws Error      if `pixels` is even or below 3; also under the conditions of point_image() and film_irradiance()
PETZVAL_API PsfKernel psf_kernel(const Lens& lens, const Lens& wide_open, const FieldPoint& point,
                                 std::size_t wavelength, const PsfOptions& options = {.pixels = 129});

/// Total variation distance of two kernels, each normalised by its total: half the sum of absolute pixel differences.
///
/// It is the fraction of light that must move to turn one shape into the other.
///
/// @return       0 if the shapes are equal, 1 if they do not overlap; 0 if a kernel is dark
/// @throws Error if the kernels differ in pixel count or size
PETZVAL_API double total_variation(const PsfKernel& a, const PsfKernel& b);

/// The coordinates of a kernel in a PSF set.
struct PsfSetPoint {
  double field_deg = 0;
  double distance_mm = 0;  ///< may be infinite
  double wavelength_nm = 0;
  double f_number = 0;
};

/// Kernels of a lens on a grid over field angle, subject distance, wavelength and f-number, with interpolation.
///
/// Axes hold the numbers that users enter (angles in degrees), so that nodes are found by exact comparison.
///
/// Limitations: a lens without rotational symmetry (blades, cylinders) is only represented for fields towards +y.
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
    /// The coordinates of a node. Fields vary fastest, then distances, wavelengths and f-numbers.
    PsfSetPoint point(std::size_t node) const noexcept;

    bool operator==(const Axes&) const = default;
  };

  /// @param axes     the coordinates of the nodes
  /// @param kernels  one kernel per node, in the order of Axes::point(), all with the same odd number of pixels
  /// @throws Error   if an axis is empty, not ascending or out of range, or if the number or size of kernels is wrong
  PsfSet(Axes axes, std::vector<PsfKernel> kernels);

  /// @throws Error if an axis is empty, not ascending or out of range
  static void validate(const Axes& axes);

  const Axes& axes() const noexcept { return axes_; }
  const std::vector<PsfKernel>& kernels() const noexcept { return kernels_; }

  /// The kernel at a point: a node's kernel bit for bit, or interpolated between nodes.
  ///
  /// Interpolates the hits of rays through the same pupil point, not images: a blur shrinks towards the focus and grows
  /// again inverted, as on film. The kernel image is drawn with 2^20 rays of the interpolated bundle. Hits, anchor and
  /// the square root of `total` follow polynomials in angle, 1 / distance, nm and 1 / f-number, of degree 3 along an
  /// axis (2 in its end cells, less if there are fewer nodes); `throughput` and `error` are linear.
  ///
  /// @throws Error if the point is outside the axes; an axis with a single value only contains that value
  ///
  /// Accuracy: total_variation() in percent against traced kernels in the middles of cells, median and largest, with a
  /// noise of 0.5 to 1.3 (petzval psf-set --check; steps of 5 to 20 degrees, five distances from 1 m to infinity,
  /// focused at 2 m): double Gauss f/2 1.8 and 5.8, f/2.8 2.2 and 3.1; fisheye 2.5 and 3.4; Tessar 6 and 21; double
  /// Gauss f/1.35 3 and 24. The last two are worst next to the focus, which needs closer nodes. Averaging images
  /// gives 70.
  PsfKernel at(const PsfSetPoint& point) const;

 private:
  Axes axes_;
  std::vector<PsfKernel> kernels_;
};

}  // namespace petzval
