// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "core/text.hpp"
#include "direction_map.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "points.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_nodes.hpp"

namespace petzval {
namespace {

using analysis_detail::DirectionMap;
using analysis_detail::PupilNode;
using Complex = std::complex<double>;

constexpr int most_samples = 4096;

/// The film positions of an image: `pixels` columns and rows of `finer` samples each.
struct SampleGrid {
  int pixels, finer;
  double pixel_mm;

  int samples() const noexcept { return pixels * finer; }
  double step() const noexcept { return pixel_mm / finer; }
  /// Position of a sample relative to the centre of the image, mm.
  double position(int sample) const noexcept { return (sample - 0.5 * (samples() - 1)) * step(); }
};

/// Irradiances of the samples of a grid, mm^2 of the pupil plane per mm^2 of the film, rows from the top; the largest
/// irradiance of the film, and the irradiance at the centre of the same amplitudes in phase.
struct Irradiance {
  std::vector<double> values;
  double peak = 0, in_phase = 0;
};

/// A plane wave on the film: its phase per mm, and its amplitude at the centre of the image.
struct PlaneWave {
  Vec2<double> phase_per_mm;
  Complex amplitude;
};

/// Largest squared sum of plane waves near a position, by Newton's steps of at most `step` mm.
double peak_near(std::span<const PlaneWave> waves, Vec2<double> position, double step) noexcept {
  double largest = 0;
  for (int iteration = 0; iteration < 6; ++iteration) {
    Complex sum = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (const auto& [k, amplitude] : waves) {
      const Complex value = amplitude * std::polar(1.0, glm::dot(k, position));
      sum += value, x += k.x * value, y += k.y * value;
      xx += k.x * k.x * value, xy += k.x * k.y * value, yy += k.y * k.y * value;
    }
    const double before = largest;
    largest = std::max(largest, std::norm(sum));
    if (largest <= before * (1 + 1e-9)) break;
    const auto real_part = [](const Complex& p, const Complex& q) { return (std::conj(p) * q).real(); };
    const double gx = -(std::conj(sum) * x).imag(), gy = -(std::conj(sum) * y).imag();
    const double hxx = std::norm(x) - real_part(sum, xx), hyy = std::norm(y) - real_part(sum, yy);
    const double hxy = real_part(x, y) - real_part(sum, xy), determinant = hxx * hyy - hxy * hxy;
    if (!(determinant > 0 && hxx < 0)) break;
    Vec2<double> move{-(hyy * gx - hxy * gy) / determinant, -(hxx * gy - hxy * gx) / determinant};
    move *= std::min(1.0, step / std::max(glm::length(move), 1e-300));
    position += move;
  }
  return largest;
}

/// Position of the largest sample, mm from the centre of the image.
Vec2<double> brightest(const std::vector<double>& values, const SampleGrid& grid) {
  const auto at = static_cast<int>(std::ranges::max_element(values) - values.begin());
  return {grid.position(at % grid.samples()), -grid.position(at / grid.samples())};
}

Complex wave(double length, double wavelength) noexcept {
  // The whole waves are dropped first: the argument keeps its digits.
  const double waves = length / wavelength;
  return std::polar(1.0, 2 * std::numbers::pi * (waves - std::round(waves)));
}

/// Huygens' sum: the plane wave of each ray at each sample. It is a product of two matrices, because the phase of a
/// plane wave on the film is the sum of a term in x and a term in y.
Irradiance huygens(const DirectionMap& map, const SampleGrid& grid, double wavelength_mm) {
  constexpr std::size_t radii = 64;
  const std::vector<PupilNode> nodes = analysis_detail::pupil_nodes<radii>(map.boundary());
  const double n = map.paths().film_index(), scale = n * n / (wavelength_mm * wavelength_mm);
  const auto samples = static_cast<Eigen::Index>(grid.samples()), count = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXcd columns = Eigen::MatrixXcd::Zero(count, samples), rows = Eigen::MatrixXcd::Zero(samples, count);
  std::vector<PlaneWave> waves;
  double sum = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const PupilNode& node = nodes[static_cast<std::size_t>(i)];
    const auto ray = map.paths()(node.position);
    if (!ray) continue;
    const Vec2<double> direction(ray->direction);
    // The amplitude in a direction is the root of stretch; the ray stands for area / stretch of directions.
    const double amplitude = node.area / std::sqrt(map.stretch(direction));
    sum += amplitude;
    waves.push_back(
        {direction * (2 * std::numbers::pi * n / wavelength_mm), amplitude * wave(ray->path, wavelength_mm)});
    for (Eigen::Index k = 0; k < samples; ++k) {
      const double at = n * grid.position(static_cast<int>(k));
      columns(i, k) = wave(direction.x * at, wavelength_mm);
      rows(samples - 1 - k, i) = amplitude * wave(ray->path + direction.y * at, wavelength_mm);
    }
  }
  const Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> field = rows * columns;
  Irradiance result{.values = std::vector<double>(static_cast<std::size_t>(field.size())),
                    .in_phase = scale * sum * sum};
  std::transform(field.data(), field.data() + field.size(), result.values.begin(),
                 [scale](const Complex& value) { return scale * std::norm(value); });
  result.peak = scale * peak_near(waves, brightest(result.values, grid), grid.step());
  return result;
}

/// Amplitudes of an even grid of directions, with the cells that the rim of the pupil crosses weighted by their lit
/// part.
class DirectionGrid {
 public:
  DirectionGrid(const Lens& lens, const DirectionMap& map, std::size_t wavelength, double step, int threads)
      : lens_(lens), map_(map), wavelength_(wavelength), step_(step) {
    half_ = static_cast<int>(std::ceil(map.half() / step)) + 2;
    lit_.resize(static_cast<std::size_t>(width()) * static_cast<std::size_t>(width()));
    values_.resize(lit_.size());
    const auto rows = static_cast<std::size_t>(width());
    parallel_for(rows, 1, threads, [&](std::size_t row, std::size_t) { light_row(row); });
    parallel_for(rows, 1, threads, [&](std::size_t row, std::size_t) { value_row(row); });
  }

  int half() const noexcept { return half_; }
  int width() const noexcept { return 2 * half_ + 1; }
  /// Amplitude of a cell, with its phase at the centre of the image.
  const Complex& value(int row, int column) const noexcept { return values_[index(row, column)]; }

 private:
  static constexpr int finer = 8;  // samples across a cell on the rim

  std::size_t index(int row, int column) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(column);
  }
  Vec2<double> direction(double row, double column) const noexcept {
    return map_.middle() + Vec2<double>{(column - half_) * step_, (row - half_) * step_};
  }

  /// Sets lit[i] to 1 if the ray through pupil position i passes the lens.
  void pass(std::span<const Vec2<double>> positions, std::span<char> lit) const {
    constexpr std::size_t block = 64;
    std::array<double, 6 * block> numbers;
    std::array<RayFate, block> fates;
    double* const d = numbers.data();
    const RayArrays<double> rays{d, d + block, d + 2 * block, d + 3 * block, d + 4 * block, d + 5 * block};
    for (std::size_t begin = 0; begin < positions.size(); begin += block) {
      const std::size_t count = std::min(block, positions.size() - begin);
      std::array<double, block> x, y;
      for (std::size_t i = 0; i < count; ++i) x[i] = positions[begin + i].x, y[i] = positions[begin + i].y;
      map_.boundary().plane.rays(std::span(x.data(), count), std::span(y.data(), count), rays);
      trace<double>(lens_, count, {rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz}, rays, fates.data(), nullptr,
                    {.wavelengths = {.all = wavelength_}, .arithmetic = Arithmetic::reproducible});
      for (std::size_t i = 0; i < count; ++i) lit[begin + i] = fates[i] == RayFate::transmitted;
    }
  }

  void light_row(std::size_t row) {
    std::vector<Vec2<double>> positions;
    for (int column = 0; column < width(); ++column) {
      positions.push_back(map_.position(direction(static_cast<double>(row), column)));
    }
    pass(positions, std::span(lit_).subspan(row * static_cast<std::size_t>(width()), positions.size()));
  }

  /// Lit part of a cell: 0 or 1 inside, counted on the rim.
  double coverage(int row, int column) const {
    int lit = 0, cells = 0;
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, width() - 1); ++r) {
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, width() - 1); ++c, ++cells) {
        lit += lit_[index(r, c)];
      }
    }
    if (lit == 0 || lit == cells) return lit > 0;
    std::array<Vec2<double>, finer * finer> positions;
    std::array<char, finer * finer> passed;
    for (int i = 0; i < finer * finer; ++i) {
      const double down = (i / finer + 0.5) / finer - 0.5, right = (i % finer + 0.5) / finer - 0.5;
      positions[static_cast<std::size_t>(i)] = map_.position(direction(row + down, column + right));
    }
    pass(positions, passed);
    return static_cast<double>(std::ranges::count(passed, 1)) / (finer * finer);
  }

  void value_row(std::size_t row_index) {
    const int row = static_cast<int>(row_index);
    const double wavelength_mm = lens_.wavelengths_nm()[wavelength_] * 1e-6;
    for (int column = 0; column < width(); ++column) {
      const double part = coverage(row, column);
      const auto path = part > 0 ? map_.path(direction(row, column)) : std::nullopt;
      if (!path) continue;
      // A partly lit cell has its mean amplitude. The light that the mean lacks falls outside the window.
      const double amplitude = part * std::sqrt(map_.stretch(direction(row, column))) * step_ * step_;
      values_[index(row, column)] = amplitude * wave(*path, wavelength_mm);
    }
  }

  const Lens& lens_;
  const DirectionMap& map_;
  std::size_t wavelength_;
  double step_;
  int half_ = 0;
  std::vector<char> lit_;
  std::vector<Complex> values_;
};

/// The sum over a grid of directions by fast Fourier transforms of `size` samples.
Irradiance transformed(const Lens& lens, const DirectionMap& map, const SampleGrid& grid, std::size_t wavelength,
                       int size, int threads) {
  const double wavelength_mm = lens.wavelengths_nm()[wavelength] * 1e-6, n = map.paths().film_index();
  const double scale = n * n / (wavelength_mm * wavelength_mm);
  const DirectionGrid directions(lens, map, wavelength, wavelength_mm / (n * size * grid.step()), threads);
  const int samples = grid.samples(), half = directions.half();
  const auto wrapped = [size](int at) { return static_cast<std::size_t>((at + size) % size); };
  // Samples lie at multiples of the step, or in the middle between them if their number is even.
  const double shift = samples % 2 == 0 ? 0.5 : 0;
  const auto at_sample = [&](int sample) { return wrapped(sample - samples / 2); };
  const auto shifted = [&](int cell) { return wave(shift * cell, size); };
  const auto width = static_cast<std::size_t>(directions.width()), count = static_cast<std::size_t>(samples);

  constexpr std::size_t block = 16;
  std::vector<Complex> lines(width * count);
  std::vector<double> sums(width);
  parallel_for(width, block, threads, [&](std::size_t begin, std::size_t end) {
    Eigen::FFT<double> fft(Eigen::FFT<double>::impl_type(), Eigen::FFT<double>::Unscaled);
    std::vector<Complex> in(static_cast<std::size_t>(size)), out;
    for (std::size_t row = begin; row < end; ++row) {
      std::ranges::fill(in, Complex{});
      for (int column = 0; column < directions.width(); ++column) {
        const Complex& value = directions.value(static_cast<int>(row), column);
        sums[row] += std::abs(value);
        in[wrapped(column - half)] = value * shifted(column - half);
      }
      fft.inv(out, in);
      for (int k = 0; k < samples; ++k) lines[row * count + static_cast<std::size_t>(k)] = out[at_sample(k)];
    }
  });
  Irradiance result{.values = std::vector<double>(count * count)};
  parallel_for(count, block, threads, [&](std::size_t begin, std::size_t end) {
    Eigen::FFT<double> fft(Eigen::FFT<double>::impl_type(), Eigen::FFT<double>::Unscaled);
    std::vector<Complex> in(static_cast<std::size_t>(size)), out;
    for (std::size_t column = begin; column < end; ++column) {
      std::ranges::fill(in, Complex{});
      for (std::size_t row = 0; row < width; ++row) {
        const int cell = static_cast<int>(row) - half;
        in[wrapped(cell)] = lines[row * count + column] * shifted(cell);
      }
      fft.inv(out, in);
      for (int k = 0; k < samples; ++k) {
        result.values[static_cast<std::size_t>(samples - 1 - k) * count + column] =
            scale * std::norm(out[at_sample(k)]);
      }
    }
  });
  const double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
  result.in_phase = scale * sum * sum;
  std::vector<PlaneWave> waves;
  const double phase_per_mm = 2 * std::numbers::pi / (size * grid.step());
  for (int row = 0; row < directions.width(); ++row) {
    for (int column = 0; column < directions.width(); ++column) {
      const Complex& value = directions.value(row, column);
      if (value != 0.0) waves.push_back({Vec2<double>{column - half, row - half} * phase_per_mm, value});
    }
  }
  result.peak = scale * peak_near(waves, brightest(result.values, grid), grid.step());
  return result;
}

/// Means of finer x finer samples.
std::vector<double> pixels_of(const std::vector<double>& samples, const SampleGrid& grid) {
  if (grid.finer == 1) return samples;
  const auto pixels = static_cast<std::size_t>(grid.pixels), finer = static_cast<std::size_t>(grid.finer);
  const std::size_t width = pixels * finer;
  std::vector<double> result(pixels * pixels);
  for (std::size_t row = 0; row < width; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      result[row / finer * pixels + column / finer] += samples[row * width + column];
    }
  }
  for (double& value : result) value /= static_cast<double>(finer * finer);
  return result;
}

void check(const DiffractionOptions& options) {
  const auto fail = [](const std::string& message) { throw Error("diffraction_psf: " + message); };
  if (options.pixels < 16 || options.pixels > most_samples) {
    fail("pixels = " + std::to_string(options.pixels) + "; must be 16 to " + std::to_string(most_samples));
  }
  if (!(options.half_width_mm >= 0) || !std::isfinite(options.half_width_mm)) {
    fail("half_width_mm = " + to_text(options.half_width_mm, 6) + "; must be 0 or more");
  }
  if (options.centre && !std::isfinite(options.centre->x + options.centre->y)) fail("centre; must be finite");
  if (options.threads < 1) fail("threads = " + std::to_string(options.threads) + "; must be at least 1");
}

}  // namespace

DiffractionPsf diffraction_psf(const Lens& lens, const FieldPoint& point, const DiffractionOptions& options) {
  check(options);
  std::vector<std::size_t> wavelengths;
  if (options.wavelength) {
    wavelengths.push_back(lens.wavelength_index(*options.wavelength));
  } else {
    for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) wavelengths.push_back(w);
  }
  DiffractionPsf psf{.point = point, .pixels = options.pixels};
  if (options.centre) {
    psf.centre = *options.centre;
  } else {
    const std::size_t chief = options.wavelength ? wavelengths.front() : lens.primary_wavelength();
    psf.centre = analysis_detail::chief_point(lens, point, chief).value_or(Vec2<double>{0, 0});
  }
  const Vec3<double> centre{psf.centre.x, psf.centre.y, lens.film_z()};

  // Width of the Airy disc of the whole pupil, in units without the wavelength: wavelength / (n half).
  double widest = 0, narrowest = std::numeric_limits<double>::infinity(), blur = 0;
  std::vector<DirectionMap> maps;
  for (const std::size_t w : wavelengths) {
    const DirectionMap& map = maps.emplace_back("diffraction_psf", lens, point, w, centre);
    psf.wavelengths_nm.push_back(lens.wavelengths_nm()[w]);
    if (map.empty()) continue;
    const double unit = psf.wavelengths_nm.back() * 1e-6 / (map.paths().film_index() * map.half());
    widest = std::max(widest, unit), narrowest = std::min(narrowest, unit), blur = std::max(blur, map.blur());
  }
  const auto planes = static_cast<std::size_t>(psf.pixels) * static_cast<std::size_t>(psf.pixels);
  psf.irradiance.resize(planes * maps.size());
  psf.throughput.resize(maps.size()), psf.strehl.resize(maps.size());
  if (widest == 0) {
    psf.pixel_mm = 2 * (options.half_width_mm > 0 ? options.half_width_mm : 1e-3) / psf.pixels;
    return psf;
  }

  const double half_width =
      options.half_width_mm > 0 ? options.half_width_mm : std::max(15 * 0.61 * widest, 1.05 * blur);
  psf.pixel_mm = 2 * half_width / psf.pixels;
  // Irradiance has details down to half of the unit of the field, and needs two samples for each.
  psf.samples_per_pixel = std::max(1, static_cast<int>(std::ceil(std::min(psf.pixel_mm / (narrowest / 4), 1e6))));
  const SampleGrid grid{psf.pixels, psf.samples_per_pixel, psf.pixel_mm};
  // The transform needs the blur in its window, and 128 cells across the pupil; 32 if samples are that fine.
  const auto refuse = [&](const std::string& rule) {
    throw Error("diffraction_psf: width of the image = " + to_text(2 * half_width, 4) + " mm (blur of the rays " +
                to_text(2 * blur, 4) + " mm); must be " + rule);
  };
  if (const double narrowest_mm = 16 * widest / most_samples * psf.pixels; grid.step() * most_samples < 16 * widest) {
    refuse("at least " + to_text(narrowest_mm, 3) + " mm");
  }
  const double needed = std::max(1.0 * psf.pixels * grid.finer, 2.1 * blur / grid.step());
  if (needed > most_samples) {
    refuse("at most " + std::to_string(most_samples) +
           " samples wide: choose a smaller width, focus closer to the point, or use rays (no --diffraction)");
  }
  // Twice the image, if possible: spikes that leave the window return on the other side, outside of the image.
  const double wide =
      std::max(needed, std::min(std::max(2.0 * grid.samples(), 64 * widest / grid.step()), 1.0 * most_samples));
  const auto samples = static_cast<std::size_t>(grid.samples());
  psf.line_x.resize(samples * maps.size()), psf.line_y.resize(samples * maps.size());
  const int size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(wide))));
  const double entrance = analysis_detail::entrance_pupil_area(lens);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (maps[i].empty()) continue;
    const Irradiance image = options.huygens ? huygens(maps[i], grid, psf.wavelengths_nm[i] * 1e-6)
                                             : transformed(lens, maps[i], grid, wavelengths[i], size, options.threads);
    psf.strehl[i] = image.peak / image.in_phase;
    psf.throughput[i] = maps[i].boundary().area() / entrance;
    const double light = grid.step() * grid.step() / entrance;
    for (std::size_t row = 0; row < samples; ++row) {
      for (std::size_t column = 0; column < samples; ++column) {
        const double value = light * image.values[row * samples + column];
        psf.line_x[i * samples + column] += value, psf.line_y[(i + 1) * samples - 1 - row] += value;
      }
    }
    std::ranges::transform(pixels_of(image.values, grid),
                           psf.irradiance.begin() + static_cast<std::ptrdiff_t>(i * planes),
                           [entrance](double value) { return value / entrance; });
  }
  return psf;
}

std::vector<MtfPoint> diffraction_mtf(const DiffractionPsf& psf, std::span<const double> frequencies_per_mm,
                                      std::span<const double> wavelength_weights) {
  const std::size_t wavelengths = psf.wavelengths_nm.size();
  const auto weights = analysis_detail::mtf_weights(wavelengths, wavelength_weights);
  const std::size_t samples = psf.line_x.size() / std::max<std::size_t>(wavelengths, 1);
  std::vector<double> across(samples), down(samples);
  double total = 0;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    total += weights[w] * psf.throughput[w];
    for (std::size_t i = 0; i < samples; ++i) {
      across[i] += weights[w] * psf.line_x[w * samples + i], down[i] += weights[w] * psf.line_y[w * samples + i];
    }
  }
  std::vector<MtfPoint> result;
  for (const double frequency : frequencies_per_mm) {
    const double phase = 2 * std::numbers::pi * frequency * psf.pixel_mm / psf.samples_per_pixel;
    const auto contrast = [&](const std::vector<double>& light) {
      Complex sum = 0;
      for (std::size_t i = 0; i < samples; ++i) sum += std::polar(light[i], phase * static_cast<double>(i));
      return total > 0 ? std::abs(sum) / total : 0;
    };
    result.push_back({psf.point.field_rad, frequency, contrast(down), contrast(across)});
  }
  return result;
}

}  // namespace petzval
