// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/coating.hpp"

#include <algorithm>
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

/// A layer or the medium behind the layers: the component of its wave vector along the normal, in units of the wave
/// number in vacuum, and its complex index squared.
struct LayerMedium {
  Complex normal, index_squared;

  /// Ratio of tangential magnetic and electric fields, in units of the admittance of vacuum.
  Complex admittance(bool p) const noexcept { return p ? index_squared / normal : normal; }
};

Fractions of_stack(double admittance_before, const std::vector<CoatingLayer>& layers,
                   const std::vector<LayerMedium>& media, const LayerMedium& behind, bool p, double wavelength_nm) {
  const Complex substrate = behind.admittance(p);
  // Tangential electric and magnetic field, from the last layer to the first; scaled, so that absorbing layers do not
  // overflow.
  Complex electric = 1, magnetic = substrate;
  double log_scale = 0;
  for (std::size_t i = layers.size(); i-- > 0;) {
    const Complex eta = media[i].admittance(p);
    const Complex phase = 2 * std::numbers::pi * layers[i].thickness_nm / wavelength_nm * media[i].normal;
    // cos and sin of a phase with a large imaginary part, divided by the exponential.
    const double decay = phase.imag();
    const Complex forward = std::polar(1.0, phase.real()) * std::exp(-2 * decay),
                  backward = std::polar(1.0, -phase.real());
    const Complex cosine = (forward + backward) / 2.0, sine = (forward - backward) / Complex(0, 2);
    const Complex next = cosine * electric - Complex(0, 1) * sine / eta * magnetic;
    magnetic = cosine * magnetic - Complex(0, 1) * sine * eta * electric;
    electric = next;
    const double scale = std::abs(electric) + std::abs(magnetic);
    electric /= scale, magnetic /= scale;
    log_scale += decay + std::log(scale);
  }
  const Complex sum = admittance_before * electric + magnetic, difference = admittance_before * electric - magnetic;
  const double norm = std::norm(sum), reflectance = std::norm(difference) / norm;
  const double transmitted = substrate.real() * std::exp(-2 * log_scale);
  const double absorbed = (electric * std::conj(magnetic)).real() - transmitted;
  return {reflectance, 4 * admittance_before * transmitted / norm, 4 * admittance_before * absorbed / norm};
}

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
    check("index", layer.index, layer.index > 0, "positive and finite");
    check("absorption", layer.absorption, layer.absorption >= 0, "0 or more, and finite");
    check("thickness_nm", layer.thickness_nm, layer.thickness_nm >= 0, "0 or more, and finite");
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
  const auto medium = [&](const Complex& index) {
    const Complex squared = index * index;
    Complex normal = std::sqrt(squared - tangential_squared);
    if (normal.imag() < 0) normal = -normal;  // waves decay in the direction of the light
    return LayerMedium{normal, squared};
  };
  const LayerMedium behind = medium(index_behind);
  // Grazing light is reflected, and so is light beyond the critical angle of surfaces without absorption.
  if (cosine == 0 || behind.normal == 0.0) {
    return {.reflectance_s = 1, .reflectance_p = 1, .transmittance_s = 0, .transmittance_p = 0};
  }
  if (!coating.table.empty()) {
    const double reflectance = behind.normal.real() == 0 ? 1 : in_table(coating.table, wavelength_nm);
    return {.reflectance_s = reflectance,
            .reflectance_p = reflectance,
            .transmittance_s = 1 - reflectance,
            .transmittance_p = 1 - reflectance};
  }
  std::vector<CoatingLayer> layers;
  std::vector<LayerMedium> media;
  for (const CoatingLayer& layer : coating.layers) {
    if (layer.thickness_nm == 0) continue;
    layers.push_back(layer);
    media.push_back(medium({layer.index, layer.absorption}));
    // The limit of a layer with a grazing wave is the layer with a wave close to it.
    if (media.back().normal == 0.0) media.back().normal = 1e-8;
  }
  const Fractions s = of_stack(index_before * cosine, layers, media, behind, false, wavelength_nm);
  const Fractions p = of_stack(index_before / cosine, layers, media, behind, true, wavelength_nm);
  return {s.reflectance, p.reflectance, s.transmittance, p.transmittance, s.absorptance, p.absorptance};
}

}  // namespace petzval
