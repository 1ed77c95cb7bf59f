#include "launch/study/explicit_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace tandem::launch {
namespace {

using scene::IntegrationMethod;

constexpr const char* explicit_name = "dormand_prince";

std::vector<Row> rows_with(const std::vector<Row>& rows, IntegrationMethod method) {
  std::vector<Row> found;
  for (const Row& row : rows)
    if (method_of(row.run) == method) found.push_back(row);
  return found;
}

double smallest_error(const std::vector<Row>& rows, std::size_t measure) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Row& row : rows)
    if (counts(row, measure)) smallest = std::min(smallest, row.errors[measure]);
  return smallest;
}

}  // namespace

bool suits_explicit_method(const scene::Mbd& mbd) {
  if (!mbd.couplers.empty()) return false;
  // Two bodies that are joined already close a loop; the last index stands for the ground.
  std::vector<std::size_t> group(mbd.bodies.size() + 1);
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto group_of = [&](BodyId body) {
    std::size_t i = body == ground ? mbd.bodies.size() : body.value;
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const scene::Joint& joint : mbd.joints) {
    if (joint.limits || joint.cut || joint.type == scene::JointType::distance) return false;
    if (joint.friction && joint.friction->breakaway) return false;
    if (joint.type == scene::JointType::free) continue;
    const std::size_t a = group_of(joint.parent), b = group_of(joint.child);
    if (a == b) return false;
    group[a] = b;
  }
  return true;
}

std::optional<IntegrationMethod> method_of(const PlannedRun& run) {
  std::optional<IntegrationMethod> method;
  for (const Setting& setting : run.settings) {
    const std::string at = setting.at.to_string();
    if (at == "/mbd/integrator/method")
      method = setting.value == explicit_name ? IntegrationMethod::dormand_prince
                                              : IntegrationMethod::generalized_alpha;
    if (at == "/mbd/integrator")
      method = setting.value.value("method", "") == explicit_name ? IntegrationMethod::dormand_prince
                                                                  : IntegrationMethod::generalized_alpha;
  }
  return method;
}

std::string compare_methods(const std::vector<Row>& rows, std::size_t measure) {
  const std::vector<Row> implicit_rows = rows_with(rows, IntegrationMethod::generalized_alpha),
                         explicit_rows = rows_with(rows, IntegrationMethod::dormand_prince);
  const double error =
      std::max(smallest_error(implicit_rows, measure), smallest_error(explicit_rows, measure));
  const auto a = cheapest(implicit_rows, measure, error), b = cheapest(explicit_rows, measure, error);
  if (!a || !b) return {};
  const double implicit_time = implicit_rows[*a].cpu, explicit_time = explicit_rows[*b].cpu;
  return explicit_time < implicit_time
             ? fmt::format(
                   "  suggested: method=dormand_prince, {:.3g} s for an error of {:.3g}, where "
                   "generalized_alpha takes {:.3g} s\n",
                   explicit_time, error, implicit_time)
             : fmt::format(
                   "  method=dormand_prince does not win: {:.3g} s for an error of {:.3g}, where "
                   "generalized_alpha takes {:.3g} s\n",
                   explicit_time, error, implicit_time);
}

}  // namespace tandem::launch
