#include "mbd_server/model/force_law.hpp"

#include "common/math/interpolation.hpp"

namespace tandem::mbd {

ForceLaw::ForceLaw(double factor, const std::optional<scene::ForceTable>& table) : factor_(factor) {
  if (!table) return;
  tabled_ = true;
  force_ = monotone_cubic(table->arguments, table->values, Ends::straight);
  energy_ = force_.antiderivative();
  energy_ += -energy_.at(0).value;
}

ForceLaw::Value ForceLaw::at(double x) const {
  if (!tabled_) return {factor_ * x, factor_};
  const PiecewisePolynomial::Value v = force_.at(x);
  return {v.value, v.first};
}

double ForceLaw::energy(double x) const {
  return tabled_ ? energy_.at(x).value : 0.5 * factor_ * x * x;
}

}  // namespace tandem::mbd
