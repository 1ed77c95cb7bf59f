#include "mbd_server/solve/articulated_body.hpp"

#include <cmath>
#include <limits>

namespace tandem::mbd {
namespace {

// A pivot below this share of its terms is zero, as in the elimination.
constexpr double pivot_round_off = 4 * std::numeric_limits<double>::epsilon();

}  // namespace

ArticulatedBody::ArticulatedBody(const Model& model)
    : model_(model),
      articulated_(model.links.size()),
      change_(model.links.size(), Vector6d::Zero()),
      acceleration_(VectorXd::Zero(model.freedoms)) {
  for (const Link& link : model.links)
    if (link.u != none && link.kind == Elementary::spherical) spherical_.push_back(link.u);
}

Eigen::Index ArticulatedBody::solve(const Dynamics& dynamics, const VectorXd& udot, const VectorXd& forces) {
  const auto end = static_cast<LinkIndex>(articulated_.size());
  for (LinkIndex i = 1; i < end; ++i) {
    articulated_[i].I = dynamics.inertia(i);
    articulated_[i].F = dynamics.force(i);
  }
  for (LinkIndex i = end - 1; i > 0; --i) {
    const Link& link = model_.links[i];
    const int n = link.freedoms();
    bool regular = true;
    if (n == 1) {
      regular = eliminate<1>(i, dynamics, forces);
    } else if (n == 3) {
      regular = eliminate<3>(i, dynamics, forces);
    } else {
      articulated_[link.parent].I += articulated_[i].I;
      articulated_[link.parent].F += articulated_[i].F;
    }
    if (!regular) return link.u;
  }
  for (LinkIndex i = 1; i < end; ++i) {
    const int n = model_.links[i].freedoms();
    if (n == 1)
      substitute<1>(i, dynamics, udot);
    else if (n == 3)
      substitute<3>(i, dynamics, udot);
    else
      change_[i] = change_[model_.links[i].parent];
  }
  return -1;
}

template <int n>
bool ArticulatedBody::eliminate(LinkIndex i, const Dynamics& dynamics, const VectorXd& forces) {
  const Link& link = model_.links[i];
  Articulated& own = articulated_[i];
  const Eigen::Matrix<double, 6, n> S = dynamics.links()[i].S.leftCols<n>();
  const Eigen::Matrix<double, 6, n> U = own.I * S;
  Eigen::Matrix<double, n, n> D = S.transpose() * U;
  if constexpr (n == 1) D(0, 0) += dynamics.rotor(link.u);
  Eigen::Matrix<double, n, n> inverse;
  if constexpr (n == 1) {
    if (!(std::abs(D(0, 0)) > pivot_round_off * S.cwiseProduct(U).template lpNorm<1>())) return false;
    inverse(0, 0) = 1 / D(0, 0);
  } else {
    if (!(std::abs(D.determinant()) > pivot_round_off * D.cwiseAbs().colwise().maxCoeff().prod()))
      return false;
    inverse = D.inverse();
  }
  const Eigen::Matrix<double, n, 1> r = S.transpose() * own.F + forces.segment<n>(link.u);
  own.U.leftCols<n>() = U;
  own.inverse.topLeftCorner<n, n>() = inverse;
  own.r.head<n>() = r;
  if (link.parent == 0) return true;
  const Eigen::Matrix<double, 6, n> U_inverse = U * inverse;
  Articulated& parent = articulated_[link.parent];
  parent.I.noalias() += own.I - U_inverse.lazyProduct(U.transpose());
  parent.F.noalias() += own.F - U_inverse * r;
  return true;
}

template <int n>
void ArticulatedBody::substitute(LinkIndex i, const Dynamics& dynamics, const VectorXd& udot) {
  const Link& link = model_.links[i];
  const Articulated& own = articulated_[i];
  const Vector6d& inboard = change_[link.parent];
  const Eigen::Matrix<double, n, 1> a =
      -own.inverse.topLeftCorner<n, n>() * (own.r.head<n>() + own.U.leftCols<n>().transpose() * inboard);
  acceleration_.segment<n>(link.u) = udot.segment<n>(link.u) + a;
  change_[i].noalias() = inboard + dynamics.links()[i].S.leftCols<n>() * a;
}

}  // namespace tandem::mbd
