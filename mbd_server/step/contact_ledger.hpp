// Energy and impulse of contacts over a step: what each point does at both ends, its work, what is lost, and
// the impulse on each boundary body. Reads points and links; changes State::contact_wrench only.
#pragma once

#include <utility>
#include <vector>

#include "mbd_server/step/contact_rules.hpp"
#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

// Of the points in contact at the end of a step; shapes are indices in the model.
struct ContactExtremes {
  double force = 0;        // largest normal force of a point [N]
  double depth_share = 0;  // largest depth over that from the surface to the middle of the thinner shape [-]
  int shape_a = none, shape_b = none;  // of that depth
};

class ContactLedger {
 public:
  using Exchanges = std::vector<ContactExchange>;             // (points in contact)
  using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // on boundary bodies (6 x boundary bodies)

  explicit ContactLedger(const Model& model);

  // Energy that contacts have dissipated [J].
  void lose(double energy, int shape_a, int shape_b);
  void lose(double energy) { lost_ += energy; }  // where there are no outputs
  double take_lost() { return std::exchange(lost_, 0.0); }
  // Calls f(energy, account) with the shares of the outputs in it [J].
  template <class F>
  void take_lost_of_outputs(F&& f) {
    for (std::size_t i = 0; i < lost_of_.size(); ++i)
      f(std::exchange(lost_of_[i], 0.0), model_.contact.outputs[i].account);
  }

  void record_begin(const State& state, const std::vector<LinkMotion>& links) {
    record(state, links, begin_, begin_wrench_);
  }
  void record_end(const State& state, const std::vector<LinkMotion>& links) {
    record(state, links, end_, end_wrench_);
  }
  const Exchanges& begin() const { return begin_; }
  const Exchanges& end() const { return end_; }
  // Work of a point on the links over a step of length h [J].
  double work(const ContactPoint& point, std::size_t k, double h) const;

  // At a start of the method, State::contact_wrench is that of the forces there.
  void start_wrenches(State& state, const std::vector<LinkMotion>& links) {
    if (records_impulses_) record(state, links, begin_, state.contact_wrench);
  }
  // The momentum of a body changes by the algorithmic acceleration: the impulse of a force over a step is
  // that of the algorithmic force.
  void integrate_wrenches(State& state, const GeneralizedAlpha& method, double h);
  const Wrenches& impulses() const { return impulses_; }

 private:
  void record(const State& state, const std::vector<LinkMotion>& links, Exchanges& at, Wrenches& wrenches);

  const Model& model_;
  double lost_ = 0;               // [J]
  std::vector<double> lost_of_;   // share of each output [J]
  std::vector<int> boundary_of_;  // boundary body of each shape; none: it has none (shapes)
  bool records_impulses_ = false;
  Exchanges begin_, end_;
  Wrenches begin_wrench_, end_wrench_, impulses_;
};

}  // namespace tandem::mbd
