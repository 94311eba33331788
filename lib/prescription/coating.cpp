// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/coating.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using Complex = std::complex<double>;

/// Reflectance, transmittance and absorptance of one polarisation.
struct Fractions {
  double reflectance, transmittance, absorptance;
};

/// Tangential fields of one polarisation in front of a layer, divided by a scale. The wave behind the last layer has an
/// electric field of 1.
struct Fields {
  Complex electric, magnetic;
  double substrate;  ///< real part of the admittance behind the layers
  double log_scale = 0;

  /// Adds a layer in front. T: double if the numbers are real.
  template <class T>
  void pass(const T& cosine, const T& sine_over_admittance, const T& sine_times_admittance) {
    const auto times_i = [](const Complex& z) { return Complex(-z.imag(), z.real()); };
    const Complex next = cosine * electric - sine_over_admittance * times_i(magnetic);
    magnetic = cosine * magnetic - sine_times_admittance * times_i(electric);
    electric = next;
    const double size =
        std::abs(electric.real()) + std::abs(electric.imag()) + std::abs(magnetic.real()) + std::abs(magnetic.imag());
    if (size > 1e-50 && size < 1e50) return;
    electric /= size, magnetic /= size;
    log_scale += std::log(size);
  }

  Fractions fractions(double admittance_before) const {
    const Complex sum = admittance_before * electric + magnetic, difference = admittance_before * electric - magnetic;
    const double norm = std::norm(sum), transmitted = substrate * std::exp(-2 * log_scale);
    const double absorbed = (electric * std::conj(magnetic)).real() - transmitted;
    return {std::norm(difference) / norm, 4 * admittance_before * transmitted / norm,
            4 * admittance_before * absorbed / norm};
  }
};

/// The wave in a layer or in the medium behind the layers.
struct LayerWave {
  CoatingLayer layer{};
  std::array<Complex, 2> admittance;             ///< of s and p, in units of the admittance of vacuum
  Complex cosine;                                ///< of the phase, times exp(-decay)
  std::array<Complex, 2> sine_over, sine_times;  ///< sine over and times the admittances of s and p
  double decay = 0;                              ///< imaginary part of the phase
  bool real = false;                             ///< true if all numbers are real

  /// @param tangential_squared square of the component of the wave vector along the surface
  LayerWave(const CoatingLayer& own, double tangential_squared, double wavelength_nm) : layer(own) {
    const double wave_number = 2 * std::numbers::pi * own.thickness_nm / wavelength_nm;
    const double squared = own.index * own.index - tangential_squared;
    real = own.absorption == 0 && squared >= 0;
    if (real) {
      // A layer with a grazing wave has a limit: a layer whose wave is close to grazing.
      const double s = squared == 0 ? 1e-8 : std::sqrt(squared), p = own.index * own.index / s;
      const double sine = std::sin(wave_number * s);
      cosine = std::cos(wave_number * s);
      admittance = {s, p}, sine_over = {sine / s, sine / p}, sine_times = {sine * s, sine * p};
      return;
    }
    const Complex index(own.index, own.absorption);
    // Waves decay in the direction of the light.
    const Complex s =
        own.absorption == 0 ? Complex(0, std::sqrt(-squared)) : std::sqrt(index * index - tangential_squared);
    const Complex p = index * index / s, phase = wave_number * s;
    decay = phase.imag();
    const Complex forward = std::polar(1.0, phase.real()) * std::exp(-2 * decay),
                  backward = std::polar(1.0, -phase.real()), sine = (forward - backward) / Complex(0, 2);
    cosine = (forward + backward) / 2.0;
    admittance = {s, p}, sine_over = {sine / s, sine / p}, sine_times = {sine * s, sine * p};
  }
};

double in_table(const std::vector<ReflectanceEntry>& table, double wavelength_nm) {
  const auto above = std::ranges::lower_bound(table, wavelength_nm, {}, &ReflectanceEntry::wavelength_nm);
  if (above == table.end() || (above == table.begin() && above->wavelength_nm > wavelength_nm)) {
    throw Error("surface_light: wavelength = " + to_text(wavelength_nm, 7) + " nm; must be within the table, " +
                to_text(table.front().wavelength_nm, 7) + " to " + to_text(table.back().wavelength_nm, 7) + " nm");
  }
  if (above == table.begin()) return above->reflectance;
  const ReflectanceEntry &a = *(above - 1), &b = *above;
  return std::lerp(a.reflectance, b.reflectance,
                   (wavelength_nm - a.wavelength_nm) / (b.wavelength_nm - a.wavelength_nm));
}

}  // namespace

Coating Coating::quarter_wave(double index, double wavelength_nm) {
  return {.layers = {{.index = index, .thickness_nm = wavelength_nm / (4 * index)}}};
}

void validate(const Coating& coating, const std::string& what) {
  const auto fail = [&](const std::string& message) { throw Error(what + ": coating: " + message); };
  if (!coating.layers.empty() && !coating.table.empty()) fail("has layers and a table; must have one of them");
  for (std::size_t i = 0; i < coating.layers.size(); ++i) {
    const CoatingLayer& layer = coating.layers[i];
    const auto check = [&](const char* name, double value, bool valid, const char* rule) {
      if (valid && std::isfinite(value)) return;
      fail("layer " + std::to_string(i) + ": " + name + " = " + to_text(value, 6) + "; must be " + rule);
    };
    // Metals reach n = 0.05 in visible and n, k = 200 in infrared light. Thicker layers are not coherent.
    check("index", layer.index, layer.index >= 1e-3 && layer.index <= 1e3, "0.001 to 1000");
    check("absorption", layer.absorption, layer.absorption >= 0 && layer.absorption <= 1e3, "0 to 1000");
    check("thickness_nm", layer.thickness_nm, layer.thickness_nm >= 0 && layer.thickness_nm <= 1e7, "0 to 1e7");
  }
  for (std::size_t i = 0; i < coating.table.size(); ++i) {
    const auto& [nm, reflectance] = coating.table[i];
    if (!(nm > (i == 0 ? 0 : coating.table[i - 1].wavelength_nm)) || !std::isfinite(nm)) {
      fail("wavelength_nm = " + to_text(nm, 7) + "; must be positive and increase");
    }
    if (!(reflectance >= 0 && reflectance <= 1)) {
      fail("reflectance = " + to_text(reflectance, 6) + "; must be 0 to 1");
    }
  }
}

Coating reversed(Coating coating) {
  std::ranges::reverse(coating.layers);
  return coating;
}

SurfaceLight surface_light(const Coating& coating, double index_before, double index_behind, double cosine,
                           double wavelength_nm) {
  const auto check = [](const char* name, double value, bool valid, const char* rule) {
    if (!valid || !std::isfinite(value)) {
      throw Error("surface_light: " + std::string(name) + " = " + to_text(value, 6) + "; must be " + rule);
    }
  };
  check("index_before", index_before, index_before > 0, "positive and finite");
  check("index_behind", index_behind, index_behind > 0, "positive and finite");
  check("cosine", cosine, cosine >= 0 && cosine <= 1, "0 to 1");
  check("wavelength_nm", wavelength_nm, wavelength_nm > 0, "positive and finite");

  const double tangential_squared = index_before * index_before * (1 - cosine * cosine);
  // Grazing light is reflected, and so is light beyond the critical angle of surfaces without absorption.
  const double behind_squared = index_behind * index_behind - tangential_squared;
  if (cosine == 0 || behind_squared == 0) {
    return {.reflectance_s = 1, .reflectance_p = 1, .transmittance_s = 0, .transmittance_p = 0};
  }
  if (!coating.table.empty()) {
    const double reflectance = behind_squared < 0 ? 1 : in_table(coating.table, wavelength_nm);
    return {.reflectance_s = reflectance,
            .reflectance_p = reflectance,
            .transmittance_s = 1 - reflectance,
            .transmittance_p = 1 - reflectance};
  }
  if (coating.layers.empty()) {  // Fresnel
    if (behind_squared < 0) return {.reflectance_s = 1, .reflectance_p = 1, .transmittance_s = 0, .transmittance_p = 0};
    const double normal = std::sqrt(behind_squared);
    const auto fractions = [](double before, double after) {
      const double sum = before + after, difference = before - after;
      return std::array{difference * difference / (sum * sum), 4 * before * after / (sum * sum)};
    };
    const auto s = fractions(index_before * cosine, normal),
               p = fractions(index_before / cosine, index_behind * index_behind / normal);
    return {.reflectance_s = s[0], .reflectance_p = p[0], .transmittance_s = s[1], .transmittance_p = p[1]};
  }
  const LayerWave behind({.index = index_behind}, tangential_squared, wavelength_nm);
  const auto start = [](const Complex& admittance) { return Fields{1, admittance, admittance.real()}; };
  Fields s = start(behind.admittance[0]), p = start(behind.admittance[1]);
  // Stacks repeat their layers, mostly in pairs.
  std::array waves{behind, behind};
  for (std::size_t i = coating.layers.size(); i-- > 0;) {
    const CoatingLayer& layer = coating.layers[i];
    if (layer.thickness_nm == 0) continue;
    LayerWave& wave = waves[i % 2];
    if (wave.layer != layer) wave = LayerWave(layer, tangential_squared, wavelength_nm);
    if (wave.real) {
      s.pass(wave.cosine.real(), wave.sine_over[0].real(), wave.sine_times[0].real());
      p.pass(wave.cosine.real(), wave.sine_over[1].real(), wave.sine_times[1].real());
    } else {
      s.pass(wave.cosine, wave.sine_over[0], wave.sine_times[0]);
      p.pass(wave.cosine, wave.sine_over[1], wave.sine_times[1]);
      s.log_scale += wave.decay, p.log_scale += wave.decay;
    }
  }
  const Fractions of_s = s.fractions(index_before * cosine), of_p = p.fractions(index_before / cosine);
  return {of_s.reflectance,   of_p.reflectance, of_s.transmittance,
          of_p.transmittance, of_s.absorptance, of_p.absorptance};
}

}  // namespace petzval
