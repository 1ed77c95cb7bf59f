// Implicit generalized-alpha [Chung1993] on a Lie group with constraints [Arnold2015]. With x the increment
// of the configuration over a step of length h,
//
//   q1 = q0 o exp(x)         x  = h u0 + h^2 (1/2 - beta) a0 + h^2 beta a1 - s
//                            u1 = u0 + h ((1 - gamma) a0 + gamma a1)
//   r(t1, q1, u1, u1', lambda1) = 0
//   (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) u1' + alpha_f u0'
//   index 3: phi(t1, q1) = 0, s = 0
//   index 2: phi(t1, q1) = 0 and its derivative = 0, with s in the range of A^-1 G^T [Gear1985]
//
// The equation of motion holds at the end of the step with the true acceleration u'; a is the filtered,
// algorithmic acceleration, which stands for u' at the time t + (alpha_m - alpha_f) h. The method is of
// second order and unconditionally stable for linear systems; high frequencies decay by rho_inf per step.
//
// States of first order z' = g(t, q, u, z) use the same constants [Bruels2006], [Jansen2000]:
//
//   (1 - alpha_m) w1 + alpha_m w0 = (1 - alpha_f) z1' + alpha_f z0',   z1' = g(t1, q1, u1, z1)
//   z1 = z0 + h ((1 - gamma) w0 + gamma w1)
//
// For given q1 and u1 this is z1 = z_known + z_weight g(t1, q1, u1, z1), which the system solves itself.
#pragma once

#include "common/error.hpp"
#include "mbd_server/step/controlled_method.hpp"
#include "mbd_server/step/rate_jump.hpp"

namespace tandem::mbd {

struct GeneralizedAlphaConstants {
  double alpha_m, alpha_f, gamma, beta;
  // The optimal one-parameter family; rho_inf in [0, 1].
  explicit GeneralizedAlphaConstants(double rho_inf);
  // Local error of the position per h^3 times the third derivative of the position.
  double error_constant() const { return (1 - 6 * beta - 3 * (alpha_m - alpha_f)) / 6; }
  // Local error of the velocity per h^3 times the third derivative of the velocity.
  double velocity_error_constant() const {
    const double d = alpha_m - alpha_f;
    return -1. / 12 + d * d - d * (alpha_m - 0.5);
  }
};

struct NewtonSettings {
  double tolerance = 1e-10;  // of the weighted norm of the last increment [-]
  int max_iterations = 20;
};

enum class Constraints { index2, index3 };

// Steps of a fixed length that had to be taken in parts.
struct ShortenedSteps {
  std::uint64_t count = 0;
  // Parts of the shortest length that were accepted although their iteration did not contract.
  std::uint64_t doubtful = 0;
  double first_time = 0;  // begin of the first [s]
  double shortest = 0;    // of the parts [s]
  std::string worst;      // coordinate that did not converge in the first one, in the user's words
};

class GeneralizedAlpha final : public ControlledMethod {
 public:
  GeneralizedAlpha(double rho_inf, const NewtonSettings& newton, const System& system, const State& state,
                   Constraints constraints = Constraints::index2);

  // Afterwards u' and lambda solve the equation of motion, and a stands for its time in steps of length h,
  // so that already the first step is of second order.
  void start(System& system, State& state, double h) override;

  // Both accelerations jump with the forces. Where prescribed rates jump, the other rates jump as well: M
  // du + G^T Lambda = -M_fd dU, G du = -G_d dU, with the impulses Lambda of the constraints.
  void jump(System& system, State& state) override;
  void jump(System& system, const State& before, State& state) override;

  // Where try_step() fails for h, the step is taken in parts. A failed part is halved, down to h / 2^10;
  // the part after a successful one is twice as long. Throws Error{numerics} where the shortest part fails
  // too.
  void step(System& system, State& state, double h) override;

  // A step is impossible where Newton's method does not converge or does not contract.
  std::optional<LocalError> try_step(System& system, State& state, double h) override;
  void undo(State& state) const override { state = begin_; }
  [[noreturn]] void give_up(const System& system, double h) const override;
  std::string largest_position_error(const System& system) const override { return system.worst(dx_); }
  std::string largest_velocity_error(const System& system) const override { return system.worst(shift_); }
  ControlTraits traits() const override;

  std::string largest_state_error(const System& system) const override { return system.worst_state(dz_); }
  const ShortenedSteps& shortened() const { return shortened_; }
  // A step that is repeated takes back what it has counted.
  void back(const ShortenedSteps& shortened) { shortened_ = shortened; }
  // Sum of the local errors of the position of the parts of the last step() [-]; none: it was taken whole.
  std::optional<double> error_of_parts() const { return error_of_parts_; }
  // The sizes of these errors, coordinate by coordinate (freedoms) [rad or m].
  const VectorXd& errors_of_parts() const { return errors_of_parts_; }
  // Adds what the method of a part of the machine has counted from `before` to `after`, and its steps in
  // parts.
  void count(const StepCounters& before, const StepCounters& after, const ShortenedSteps& shortened);
  const GeneralizedAlphaConstants& constants() const { return c_; }
  // Whether the last step took its algorithmic accelerations at the begin from itself.
  bool began_afresh() const { return afresh_; }
  // Multiplies Newton's tolerance by that factor.
  void loosen(double factor) { newton_.tolerance *= factor; }

 private:
  void solve_acceleration(System& system, State& state);
  void jump_states(State& state);
  void start_states(System& system, State& state, double h, double dt);
  void predict_states(State& state, double h);
  double finish_states(System& system, State& state, double h, double apart);
  void perturb_velocity(System& system, State& state, double h);
  std::optional<LocalError> attempt(System& system, State& state, double h);
  void step_in_parts(System& system, State& state, double h);
  enum class Trust { contracting, any };  // which roots are accepted
  bool find(System& system, State& state, double h, Trust trust);
  bool begins_afresh(double h) const;
  LocalError finish(System& system, State& state, double h);
  void leave_out_constrained(System& system, State& state, double h);
  // Start of the iteration: the quantity that is constant.
  enum class Begin { acceleration, velocity, position };
  void predict(System& system, State& state, double h, Begin begin);
  MatrixWeights step_weights(double h) const;
  bool correct(System& system, State& state, double h, Trust trust);

  GeneralizedAlphaConstants c_;
  NewtonSettings newton_;
  Constraints constraints_;
  RateJump rate_jump_;
  State begin_, ahead_;      // at the begin of the step; of start()
  bool afresh_ = false;      // whether a0_ follows from the step itself
  VectorXd a0_;              // algorithmic acceleration at the begin, at its time for this h
  VectorXd x_, dx_, shift_;  // increment of the step; of the iteration; its part in s (freedoms)
  VectorXd phi_, dlambda_;   // (constraints)
  VectorXd zero_;            // (freedoms)
  VectorXd w0_, dz_;         // as a0_; change of z' (first-order states)
  double last_norm_ = 0, last_time_ = 0;
  int last_iterations_ = 0;
  ShortenedSteps shortened_;
  std::optional<double> error_of_parts_;
  VectorXd errors_of_parts_;  // (freedoms)
  // The system had no forces at an iterate of the last try_step() that failed, and why.
  bool singular_ = false;
  std::optional<Error> failure_;
};

}  // namespace tandem::mbd
