// Chain of uniform rods by Pinocchio's articulated-body algorithm and the classical Runge-Kutta method of
// order 4, for against_peers.py, which compiles it with the headers of the Python package `pin`. In C++ like
// ours: no time goes into a loop of Python.
//
//   pinocchio_chain LINKS END STEPS REPETITIONS
//
// prints a line for each repetition, with its processor time in seconds, and a last line with the joint
// angles.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/multibody.hpp>

namespace {

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

pinocchio::Model chain(int links) {
  const double length = .1, mass = .1, inertia = mass * length * length / 12;
  pinocchio::Model model;
  model.gravity.linear() << 0, -9.81, 0;
  pinocchio::JointIndex parent = 0;
  for (int i = 0; i < links; ++i) {
    pinocchio::SE3 placement = pinocchio::SE3::Identity();
    if (i > 0) placement.translation().x() = length;
    parent = model.addJoint(parent, pinocchio::JointModelRZ(), placement, "j" + std::to_string(i));
    model.appendBodyToJoint(
        parent,
        pinocchio::Inertia(mass, Eigen::Vector3d(length / 2, 0, 0), inertia * Eigen::Matrix3d::Identity()),
        pinocchio::SE3::Identity());
  }
  return model;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) return 2;
  const int links = std::atoi(arguments[1]), steps = std::atoi(arguments[3]),
            repetitions = std::atoi(arguments[4]);
  const double h = std::atof(arguments[2]) / steps;
  const pinocchio::Model model = chain(links);
  pinocchio::Data data(model);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(links);
  Eigen::VectorXd q = zero, v = zero, k1 = zero, k2 = zero, k3 = zero, k4 = zero, q1 = zero, v2 = zero,
                  v3 = zero, v4 = zero;
  for (int r = 0; r < repetitions; ++r) {
    q.setZero(), v.setZero();
    const double begin = cpu_seconds();
    for (int i = 0; i < steps; ++i) {
      k1 = pinocchio::aba(model, data, q, v, zero);
      v2 = v + h / 2 * k1, q1 = q + h / 2 * v;
      k2 = pinocchio::aba(model, data, q1, v2, zero);
      v3 = v + h / 2 * k2, q1 = q + h / 2 * v2;
      k3 = pinocchio::aba(model, data, q1, v3, zero);
      v4 = v + h * k3, q1 = q + h * v3;
      k4 = pinocchio::aba(model, data, q1, v4, zero);
      q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    std::printf("%.9g\n", cpu_seconds() - begin);
  }
  for (int i = 0; i < links; ++i) std::printf("%.17g ", q[i]);
  std::printf("\n");
}
