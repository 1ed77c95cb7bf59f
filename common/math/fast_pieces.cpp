#include "common/math/fast_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace tandem {
namespace {

using Piece = PiecewisePolynomial::Piece;

constexpr int samples = 8;  // of a piece, with its ends; the degree is at most 7
// Pieces of more steps are resolved as every smooth motion is: the error is 5 / steps^2 of the travel of a
// ramp.
constexpr double most_steps = 64;
// Deviation from a straight line, of the range in the neighbourhood, below which steps as long as the piece
// see what acts.
constexpr double gentle = 0.05;
// Deviation from a uniform motion, of the scale, that one part may have in a change of at most some steps.
constexpr double part_of_scale = 0.05, sudden = 4;
constexpr double most_parts = 1 << 14;
// Of the largest value of what acts: round-off.
constexpr double round_off = 1e-12;

// The polynomial p(x + shift).
Piece shifted(Piece p, double shift) {
  for (std::size_t j = 0; j + 1 < p.size(); ++j)
    for (std::size_t k = p.size() - 1; k-- > j;) p[k] += shift * p[k + 1];
  return p;
}

Piece derivative(const Piece& p) {
  Piece d{};
  for (std::size_t k = 1; k < p.size(); ++k) d[k - 1] = static_cast<double>(k) * p[k];
  return d;
}

double value(const Piece& p, double x) {
  double sum = 0;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * x + p[k];
  return sum;
}

// Linear on [0, length], with the integral and the first moment of p.
Piece linear(const Piece& p, double length) {
  double mean = 0, moment = 0, power = 1;  // the moment about the middle
  for (std::size_t k = 0; k < p.size(); ++k, power *= length) {
    const double n = static_cast<double>(k);
    mean += p[k] * power / (n + 1);
    moment += p[k] * power * (1 / (n + 2) - 0.5 / (n + 1));
  }
  return {mean - 6 * moment, 12 * moment / length};
}

// The cubic on [0, length] with the values and first derivatives of p at both ends: its second derivative is
// linear and has the integral and the first moment of that of p.
Piece cubic(const Piece& p, double length) {
  const double rise = value(p, length) - p[0] - p[1] * length, slope = value(derivative(p), length) - p[1];
  return {p[0], p[1], (3 * rise / length - slope) / length, (slope - 2 * rise / length) / (length * length)};
}

class Divider {
 public:
  Divider(const PiecewisePolynomial& curve, const FastPieces& settings)
      : curve_(curve), knots_(curve.knots()), settings_(settings) {
    for (std::size_t i = 0; i < curve.pieces().size(); ++i) {
      acting_.push_back(settings.order == 0 ? curve.pieces()[i] : derivative(derivative(curve.pieces()[i])));
      ranges_.push_back(range(i));
      largest_ = std::max({largest_, std::abs(ranges_.back().least), std::abs(ranges_.back().most)});
    }
  }

  DividedFunction divide() {
    std::vector<double> knots{knots_.front()};
    std::vector<Piece> pieces{curve_.pieces().front()};
    std::vector<bool> fast{false};
    for (std::size_t i = 1; i < knots_.size(); ++i) {
      const double begin = knots_[i - 1], length = knots_[i] - begin;
      const int n = parts(i);
      if (n > 0) fast.back() = true;
      for (int k = 0; k < std::max(n, 1); ++k) {
        const double from = length * k / std::max(n, 1), to = length * (k + 1) / std::max(n, 1);
        Piece part = shifted(curve_.pieces()[i], from);
        if (n > 0 && settings_.linear_parts)
          part = settings_.order == 0 ? linear(part, to - from) : cubic(part, to - from);
        pieces.push_back(part);
        knots.push_back(k + 1 < n ? begin + to : knots_[i]);
        fast.push_back(n > 0);
      }
    }
    pieces.push_back(curve_.pieces().back());
    return {PiecewisePolynomial(std::move(knots), std::move(pieces)), std::move(fast)};
  }

 private:
  struct Range {
    double least = HUGE_VAL, most = -HUGE_VAL;
    double deviation = 0;  // from the chord
  };

  double length(std::size_t i) const { return i > 0 && i < knots_.size() ? knots_[i] - knots_[i - 1] : 0; }

  static double deviation(const Piece& p, double length) {
    double most = 0;
    for (int k = 1; k < samples; ++k) {
      const double s = static_cast<double>(k) / samples;
      most = std::max(most, std::abs(value(p, s * length) - (1 - s) * p[0] - s * value(p, length)));
    }
    return most;
  }

  Range range(std::size_t i) const {
    Range r;
    for (int k = 0; k <= samples; ++k) {
      const double v = value(acting_[i], length(i) * k / samples);
      r.least = std::min(r.least, v), r.most = std::max(r.most, v);
    }
    r.deviation = deviation(acting_[i], length(i));
    return r;
  }

  // Of what acts in this piece and in its neighbours.
  double range_about(std::size_t i) const {
    double least = ranges_[i].least, most = ranges_[i].most;
    for (const std::size_t k : {i - 1, i + 1})
      least = std::min(least, ranges_[k].least), most = std::max(most, ranges_[k].most);
    return most - least;
  }

  // 0: the piece stays as it is, and steps may contain its ends.
  int parts(std::size_t i) const {
    const double steps = length(i) / settings_.step;
    const Range& r = ranges_[i];
    const bool acts = settings_.order == 0
                          ? r.deviation > round_off * largest_
                          : std::max(std::abs(r.least), std::abs(r.most)) > round_off * largest_;
    if (!acts || !(steps < most_steps)) return 0;
    double n = std::ceil(steps * (1 - 1e-9));
    if (r.deviation > gentle * range_about(i)) n = std::max(n, static_cast<double>(settings_.parts));
    if (settings_.order > 0 && steps < sudden)
      n = std::max(n, std::min(most_parts,
                               deviation(curve_.pieces()[i], length(i)) / (part_of_scale * settings_.scale)));
    const double shortest = 2 * time_resolution(knots_[i]);  // of a part; breaks that are closer are one
    return static_cast<int>(std::max(1.0, std::min(std::ceil(n), std::floor(length(i) / shortest))));
  }

  const PiecewisePolynomial& curve_;
  const std::vector<double>& knots_;
  const FastPieces settings_;
  std::vector<Piece> acting_;  // (pieces)
  std::vector<Range> ranges_;  // of what acts (pieces)
  double largest_ = 0;
};

}  // namespace

DividedFunction divide_fast_pieces(const PiecewisePolynomial& curve, const FastPieces& settings) {
  if (curve.knots().size() < 2) return {curve, std::vector<bool>(curve.knots().size(), false)};
  return Divider(curve, settings).divide();
}

}  // namespace tandem
