#include "common/math/piecewise_polynomial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tandem {

PiecewisePolynomial::PiecewisePolynomial(std::vector<double> knots, std::vector<Piece> pieces)
    : knots_(std::move(knots)), pieces_(std::move(pieces)) {}

std::size_t PiecewisePolynomial::piece_at(double x) const {
  return static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), x) - knots_.begin());
}

std::size_t PiecewisePolynomial::piece_at(double x, double side) const {
  const std::size_t piece = piece_at(x);
  if (breaks_.empty()) return piece;
  // The pieces between the last break that `side` has passed and the next one.
  const auto next =
      std::upper_bound(breaks_.begin(), breaks_.end(), side + time_resolution(side)) - breaks_.begin();
  const std::size_t first = next > 0 ? break_knots_[static_cast<std::size_t>(next) - 1] + 1 : 0;
  const std::size_t last =
      next < std::ssize(breaks_) ? break_knots_[static_cast<std::size_t>(next)] : pieces_.size() - 1;
  return std::clamp(piece, first, last);
}

PiecewisePolynomial::Value PiecewisePolynomial::evaluate(std::size_t piece, double x) const {
  if (pieces_.empty()) return {};
  const Piece& c = pieces_[piece];
  const double s = x - anchor(piece);
  if (piece > 0 && s < 0) return {c[0] + c[1] * s, c[1] + 2 * c[2] * s, 2 * c[2]};
  if (piece < knots_.size() && x > knots_[piece]) {
    const Value end = evaluate(piece, knots_[piece]);
    const double d = x - knots_[piece];
    return {end.value + end.first * d, end.first + end.second * d, end.second};
  }
  // Horner's scheme for the value and both derivatives.
  Value v;
  for (std::size_t k = c.size(); k-- > 0;) {
    v.second = v.second * s + 2 * v.first;
    v.first = v.first * s + v.value;
    v.value = v.value * s + c[k];
  }
  return v;
}

// Jumps below 1e-10 of the largest possible value of a derivative are round-off.
void PiecewisePolynomial::find_breaks(int order, double steep, const std::vector<bool>& given) {
  breaks_.clear(), break_knots_.clear();
  std::array<double, 3> scale{};
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (std::size_t k = 0; k < knots_.size(); ++k)
    least = std::min({least, before(k).value, after(k).value}),
    most = std::max({most, before(k).value, after(k).value});
  // Whether the piece that ends at a knot is steep.
  const auto is_steep = [&](std::size_t k) {
    return k > 0 && k < knots_.size() &&
           std::abs(before(k).value - after(k - 1).value) > steep * (most - least);
  };
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    const double h = knots_[i] - knots_[i - 1];
    std::array<double, 3> bound{};
    for (std::size_t k = pieces_[i].size(); k-- > 0;) {
      bound[2] = bound[2] * h + 2 * bound[1];
      bound[1] = bound[1] * h + bound[0];
      bound[0] = bound[0] * h + std::abs(pieces_[i][k]);
    }
    for (std::size_t d = 0; d < scale.size(); ++d) scale[d] = std::max(scale[d], bound[d]);
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const Value left = before(k), right = after(k);
    const std::array<double, 3> jump{right.value - left.value, right.first - left.first,
                                     right.second - left.second};
    const auto jumps = [&](std::size_t d) { return std::abs(jump[d]) > 1e-10 * scale[d]; };
    if ((!given.empty() && given[k]) || jumps(0) || (order > 0 && jumps(1)) || (order > 1 && jumps(2)) ||
        is_steep(k) || is_steep(k + 1))
      breaks_.push_back(knots_[k]), break_knots_.push_back(k);
  }
}

PiecewisePolynomial PiecewisePolynomial::antiderivative() const {
  PiecewisePolynomial integral(knots_, pieces_);
  double sum = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    Piece& piece = integral.pieces_[i];
    for (std::size_t k = piece.size() - 1; k > 0; --k) piece[k] = pieces_[i][k - 1] / static_cast<double>(k);
    piece[0] = sum;
    if (i > 0 && i < knots_.size()) sum = integral.evaluate(i, knots_[i]).value;
  }
  return integral;
}

PiecewisePolynomial& PiecewisePolynomial::operator+=(double constant) {
  for (Piece& piece : pieces_) piece[0] += constant;
  return *this;
}

}  // namespace tandem
