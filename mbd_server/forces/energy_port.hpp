// The part of an element in the balance of energy (io/energy_balance.hpp): work and losses over each step, by
// Simpson's rule from what is known at its ends.
#pragma once

#include "mbd_server/forces/energy_sums.hpp"
#include "mbd_server/forces/instant.hpp"

namespace tandem::mbd {

// A step whose work is added up.
struct EnergyStep {
  const Model& model;
  double begin = 0, length = 0;  // [s]
  bool sudden = false;           // it is between close breaks of functions of time
  const State& between;          // time and inputs in its middle, else empty
};

class EnergyPort {
 public:
  virtual ~EnergyPort() = default;
  virtual void begin(const Instant& at) = 0;
  // `end`: the end of the step.
  virtual void add_step(const Instant& end, const EnergyStep& step, EnergySums& sums) = 0;
};

// A port that knows the same quantities at both ends of a step. `Own` is the class itself, with
//   Sample sample(const Instant&) const
//   void add(const Sample& from, const Sample& to, const EnergyStep&, EnergySums&) const
template <class Own, class Sample>
class SampledPort : public EnergyPort {
 public:
  void begin(const Instant& at) override { last_ = own().sample(at); }
  void add_step(const Instant& end, const EnergyStep& step, EnergySums& sums) override {
    const Sample now = own().sample(end);
    own().add(last_, now, step, sums);
    last_ = now;
  }

 private:
  const Own& own() const { return static_cast<const Own&>(*this); }
  Sample last_{};
};

// Rate in the middle of a step, from the cubic through the displacement `moved` and the rates v0 and v1.
template <class Value>
Value middle_rate(const Value& moved, const Value& v0, const Value& v1, double h) {
  return 1.5 / h * moved - 0.25 * (v0 + v1);
}

// Value in the middle of a step, from the cubic.
template <class Value>
Value middle(const Value& x0, const Value& x1, const Value& v0, const Value& v1, double h) {
  return 0.5 * (x0 + x1) + h / 8 * (v0 - v1);
}

inline double product(double a, double b) {
  return a * b;
}
inline double product(const Vector3d& a, const Vector3d& b) {
  return a.dot(b);
}

// The same rate where the accelerations a0 and a1 are known, in a step that is `sudden`.
template <class Value>
Value middle_rate(bool sudden, const Value& moved, const Value& v0, const Value& v1, const Value& a0,
                  const Value& a1, double h) {
  constexpr double round_off = 1e-3;
  const bool keeps = product(a0, a1) >= -round_off * (product(a0, a0) + product(a1, a1));
  return sudden && keeps ? middle(v0, v1, a0, a1, h) : middle_rate(moved, v0, v1, h);
}

inline double simpson(double begin, double middle, double end, double h) {
  return h / 6 * (begin + 4 * middle + end);
}

// A coordinate and its rate in the middle of a step.
inline CoordinateMotion between_of(const CoordinateMotion& from, const CoordinateMotion& to, double h) {
  return {middle(from.value, to.value, from.rate, to.rate, h),
          middle_rate(to.value - from.value, from.rate, to.rate, h), 0};
}

// Integral of the angular velocity over a step from orientation q0 to q1, in the axes of both rates: the
// rotation vector, plus the first term of the series of [Magnus1954] for rotations about different axes.
inline Vector3d integrated_rate(const Quaterniond& q0, const Quaterniond& q1, const Vector3d& w0,
                                const Vector3d& w1, double h) {
  return to_eigen(rotation_vector(to_quat(q1 * q0.conjugate()))) + h * h / 12 * w0.cross(w1);
}

}  // namespace tandem::mbd
