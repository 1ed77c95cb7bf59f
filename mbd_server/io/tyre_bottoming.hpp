// Tyres that bottom: a shape of contact on the wheel, such as a rim, bears load on the ground of the tyre
// while the tyre does. Then the load and the friction of the wheel are not those of the tyre alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/tyre_data.hpp"
#include "mbd_server/io/run_totals.hpp"

namespace tandem::mbd {

class TyreBottoming {
 public:
  explicit TyreBottoming(const Model& model);  // the model must outlive this object

  // Sums of a run that begins; empty where the scene has no tyre or no mbd.contact.
  TyreTotals totals() const;
  // Adds a step of length h that has ended in this state.
  void add_step(const State& state, const std::vector<LinkMotion>& links, double h, TyreTotals& totals) const;

  // Of the tyre that bottoms for the largest share of its time in contact.
  struct Longest {
    double share = 0, first_time = 0;  // [-], [s]
    std::string of;                    // names of shape and tyre; empty: no tyre bottomed
  };
  std::optional<Longest> longest(const TyreTotals& totals) const;  // none: totals() is empty

 private:
  bool is_on_ground_of(const TyreOnLink& tyre, const std::vector<LinkMotion>& links, const ContactForce& f,
                       int shape) const;

  const Model& model_;
  std::vector<const TyreOnLink*> all_;  // (tyres)
  std::vector<std::size_t> tyres_;      // on whose wheel is a shape that touches the ground
};

}  // namespace tandem::mbd
