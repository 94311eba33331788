// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

/// A number with enclosures of its exact values over a box of inputs, and a bound for the rounding error.
///
/// The exact values lie in an affine form over the coordinates of the box and in an interval. |computed - exact| <=
/// error() everywhere in the box, with every operation rounded to nearest in the IEEE type R. Each operation adds half
/// an eps of the largest result and multiplies the errors of its operands by the largest derivatives. Products with
/// powers of two and sums with 0 are exact. Underflow is ignored.
///
/// The analysis computes in double and widens its bounds by more than its own rounding.
///
/// A comparison with different results within the box sets `ambiguous`, as does a division by 0 or a root of a negative
/// number. Nothing is proven from there on, and the box must be divided.
/// N: number of coordinates of the box.
template <class R, std::size_t N>
class Bounded {
 public:
  using Scalar = Bounded;  // constants of surfaces are intervals as well
  static inline bool ambiguous = false;

  Bounded() = default;
  Bounded(double exact) : middle_(exact), least_(exact), most_(exact) {}  // literals in kernels

  /// One of the coordinates of the box.
  static Bounded coordinate(std::size_t which, double least, double most) {
    Bounded result((least + most) / 2);
    result.parts_[which] = widened((most - least) / 2);
    result.least_ = least, result.most_ = most;
    return result;
  }
  /// An input number without rounding error. `off`: largest deviation from these values.
  Bounded given(double off = 0) const {
    Bounded result = *this;
    result.error_ = 0;
    result.rest_ += off, result.least_ -= off, result.most_ += off;
    return result;
  }
  /// This number with a given error.
  Bounded with_error(double error) const {
    Bounded result = *this;
    result.error_ = error;
    return result;
  }

  double least() const { return least_; }
  double most() const { return most_; }
  double error() const { return error_; }
  double magnitude() const { return std::max(std::abs(least_), std::abs(most_)); }

  friend Bounded operator+(const Bounded& a, const Bounded& b) { return sum(a, b, 1); }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return sum(a, b, -1); }
  Bounded operator-() const {
    Bounded result = *this;
    result.middle_ = -middle_;
    for (double& part : result.parts_) part = -part;
    result.least_ = -most_, result.most_ = -least_;
    return result;
  }

  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    Bounded result;
    result.middle_ = a.middle_ * b.middle_;
    for (std::size_t i = 0; i < N; ++i) result.parts_[i] = a.middle_ * b.parts_[i] + b.middle_ * a.parts_[i];
    result.rest_ = std::abs(a.middle_) * b.rest_ + std::abs(b.middle_) * a.rest_ + a.reach() * b.reach();
    const auto [least, most] =
        std::minmax({a.least_ * b.least_, a.least_ * b.most_, a.most_ * b.least_, a.most_ * b.most_});
    result.narrow(least, most);
    const double carried = a.magnitude() * b.error_ + b.magnitude() * a.error_ + a.error_ * b.error_;
    result.error_ = carried;
    if (!a.scales_exactly() && !b.scales_exactly()) result.round();
    return result;
  }

  friend Bounded operator/(const Bounded& a, const Bounded& b) {
    if (b.most_ < 0) return -a / -b;
    if (!(b.least_ - b.error_ > 0)) {
      ambiguous = true;
      return a;
    }
    // 1/b over [least, most] lies between two parallel lines with the slope at the far end.
    const double slope = -1 / (b.most_ * b.most_), at_least = 1 / b.least_ - slope * b.least_,
                 at_most = 1 / b.most_ - slope * b.most_;
    Bounded result =
        a * b.linear(slope, (at_least + at_most) / 2, std::abs(at_least - at_most) / 2, 1 / b.most_, 1 / b.least_);
    result.error_ = (a.error_ + result.magnitude() * b.error_) / (b.least_ - b.error_);
    result.round();
    return result;
  }

  friend Bounded sqrt(const Bounded& a) {
    if (!(a.least_ - a.error_ > 0)) {
      ambiguous = true;
      return a;
    }
    const double low = std::sqrt(a.least_), high = std::sqrt(a.most_), slope = 1 / (2 * high),
                 at_least = low - slope * a.least_, at_most = high - slope * a.most_;
    Bounded result = a.linear(slope, (at_least + at_most) / 2, std::abs(at_least - at_most) / 2, low, high);
    result.error_ = a.error_ / (low + std::sqrt(a.least_ - a.error_));
    result.round();
    return result;
  }

  /// |a|, also for values of both signs.
  friend Bounded absolute(const Bounded& a) {
    if (a.least_ >= 0) return a;
    if (a.most_ <= 0) return -a;
    Bounded result(a.magnitude() / 2);
    result.rest_ = widened(a.magnitude() / 2);
    result.least_ = 0, result.most_ = a.magnitude(), result.error_ = a.error_;
    return result;
  }

  friend bool operator<(const Bounded& a, const Bounded& b) {
    const double slack = a.error_ + b.error_;
    if (a.most_ + slack < b.least_) return true;
    if (a.least_ - slack >= b.most_) return false;
    ambiguous = true;
    return false;
  }
  friend bool operator>(const Bounded& a, const Bounded& b) { return b < a; }
  friend bool operator>=(const Bounded& a, const Bounded& b) { return !(a < b); }
  friend bool operator<=(const Bounded& a, const Bounded& b) { return !(b < a); }

 private:
  static constexpr double unit = std::numeric_limits<R>::epsilon() / 2;

  /// More than the rounding of a few operations in double.
  static double widened(double bound) { return bound * (1 + 1e-13) + 1e-300; }

  static Bounded sum(const Bounded& a, const Bounded& b, double sign) {
    Bounded result;
    result.middle_ = a.middle_ + sign * b.middle_;
    for (std::size_t i = 0; i < N; ++i) result.parts_[i] = a.parts_[i] + sign * b.parts_[i];
    result.rest_ = a.rest_ + b.rest_ + 1e-15 * (std::abs(a.middle_) + std::abs(b.middle_));
    result.narrow(a.least_ + (sign > 0 ? b.least_ : -b.most_), a.most_ + (sign > 0 ? b.most_ : -b.least_));
    result.error_ = a.error_ + b.error_;
    if (!a.is(0) && !b.is(0)) result.round();
    return result;
  }

  /// slope x + offset, +- apart; the values are from least to most.
  Bounded linear(double slope, double offset, double apart, double least, double most) const {
    Bounded result;
    result.middle_ = slope * middle_ + offset;
    for (std::size_t i = 0; i < N; ++i) result.parts_[i] = slope * parts_[i];
    result.rest_ = std::abs(slope) * rest_ + apart + 1e-15 * (std::abs(slope * middle_) + std::abs(offset));
    result.narrow(least, most);
    return result;
  }

  /// Largest distance of values from the middle.
  double reach() const {
    double sum = rest_;
    for (const double part : parts_) sum += std::abs(part);
    return sum;
  }
  /// Sets the interval to the intersection of the affine form and these ends.
  void narrow(double least, double most) {
    const double slack = 1e-14 * (std::abs(middle_) + reach() + std::abs(least) + std::abs(most)) + 1e-300;
    rest_ += slack;
    const double far = reach();
    least_ = std::max(least - slack, middle_ - far), most_ = std::min(most + slack, middle_ + far);
  }
  void round() { error_ = widened(error_ + unit * (magnitude() + error_)); }

  bool is(double number) const { return least_ == number && most_ == number && error_ == 0; }
  bool scales_exactly() const {
    int exponent = 0;
    return is(0) || (least_ == most_ && error_ == 0 && std::abs(std::frexp(least_, &exponent)) == 0.5);
  }

  double middle_ = 0;
  std::array<double, N> parts_{};  // change of the value with each coordinate
  double rest_ = 0;
  double least_ = 0, most_ = 0;
  double error_ = 0;
};

template <class R, std::size_t N>
class std::numeric_limits<Bounded<R, N>> : public std::numeric_limits<R> {};
