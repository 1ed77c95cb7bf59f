// A function of one argument that is a polynomial between knots.
#pragma once

#include <array>
#include <vector>

namespace tandem {

class PiecewisePolynomial {
 public:
  static constexpr int degree = 7;
  // Coefficients of the powers of (x - anchor), lowest first.
  using Piece = std::array<double, degree + 1>;

  PiecewisePolynomial() = default;  // zero everywhere
  // `knots` increase; pieces[0] holds before the first knot, pieces[k] from knot k - 1 on, so that there is
  // one piece more than there are knots. The origin of a piece is the knot where it begins, that of the
  // first piece is the first knot.
  PiecewisePolynomial(std::vector<double> knots, std::vector<Piece> pieces);

  struct Value {
    double value = 0, first = 0, second = 0;  // the value and its derivatives
  };
  Value at(double x) const { return evaluate(piece_at(x), x); }
  // Evaluation that does not step over a break: where a break separates two pieces, the piece of `side` is
  // used and continued to x. A break at `side` counts as passed. Outside its piece, value and first
  // derivative are continued by their tangents, as a steep polynomial has arbitrary values there.
  Value at(double x, double side) const { return evaluate(piece_at(x, side), x); }

  // Defines breaks: the knots where a derivative of order 0 to `order` jumps, both ends of the pieces over
  // which the value changes by more than `steep` times the range of the values at the knots, and the knots
  // that `given` marks, if it marks any.
  void find_breaks(int order, double steep = 1, const std::vector<bool>& given = {});
  const std::vector<double>& breaks() const { return breaks_; }

  // Limits from the left and from the right at a knot.
  Value before(std::size_t knot) const { return evaluate(knot, knots_[knot]); }
  Value after(std::size_t knot) const { return evaluate(knot + 1, knots_[knot]); }
  const std::vector<double>& knots() const { return knots_; }
  const std::vector<Piece>& pieces() const { return pieces_; }

  // Continuous, with the value 0 at the first knot.
  PiecewisePolynomial antiderivative() const;
  PiecewisePolynomial& operator+=(double constant);

 private:
  std::size_t piece_at(double x) const;
  std::size_t piece_at(double x, double side) const;
  Value evaluate(std::size_t piece, double x) const;
  double anchor(std::size_t piece) const { return knots_[piece > 0 ? piece - 1 : 0]; }

  std::vector<double> knots_, breaks_;
  std::vector<std::size_t> break_knots_;  // index of each break among the knots
  std::vector<Piece> pieces_;
};

// Times that differ by less are equal: two breaks, or a break and the end of a step.
inline double time_resolution(double t) {
  return 1e-12 * (1 + (t < 0 ? -t : t));
}

}  // namespace tandem
