// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::figure_detail {

/// A point of a section through the axis: z and the height y or x (lens frame, mm).
struct SectionPoint {
  double z = 0, height = 0;
};
using SectionLine = std::vector<SectionPoint>;

/// A glass element of a lens: one closed outline, or two if it has a central hole.
struct GlassBody {
  double index = 1;
  std::vector<SectionLine> outlines;
};

/// The section of a lens in the plane y-z or x-z.
class LensSection {
 public:
  /// @param needed  largest ray height on each surface, used for surfaces without a rim
  LensSection(const Lens& lens, Meridian meridian, std::span<const double> needed, std::size_t wavelength);

  /// The glass between surfaces at which the index changes.
  ///
  /// Rims of different height are joined by a flat ring at the lower rim and a cylinder at the higher rim, or by a
  /// straight edge if the ring would cut the other surface. Cemented surfaces extend to the rims of their neighbours.
  std::vector<GlassBody> bodies() const;

  std::vector<SectionLine> mirrors() const;

  /// A surface from its lower to its upper rim; two pieces if it has a hole.
  std::vector<SectionLine> surface(std::size_t i) const;

  double z(std::size_t surface, double height) const;
  double rim(std::size_t surface) const { return rims_[surface]; }

 private:
  struct Edge {
    double front = 0, back = 0;  ///< heights at which the two surfaces of a body end
  };

  bool bends(std::size_t i) const;
  bool glass_behind(std::size_t i) const;
  double farthest_defined(std::size_t surface, double height) const;
  SectionLine line(std::size_t surface, double from, double to) const;
  double gap(std::size_t front, std::size_t back, double height) const;
  void extend_cemented(const std::vector<std::size_t>& bending);
  GlassBody body(std::size_t front, std::size_t back, double index) const;
  SectionLine edge(std::size_t front, std::size_t back, const Edge& edge) const;

  Lens lens_;
  Meridian meridian_;
  std::size_t wavelength_;
  std::vector<double> rims_;
  std::vector<double> drawn_;  ///< rims after extending cemented surfaces
};

}  // namespace petzval::figure_detail
