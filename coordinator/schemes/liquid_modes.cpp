#include "coordinator/schemes/liquid_modes.hpp"

#include <algorithm>

namespace tandem::launch {

std::vector<Response> by_body(const std::vector<protocol::BodyResponse>& responses) {
  std::vector<Response> result;
  for (auto begin = responses.begin(); begin != responses.end();) {
    const auto end =
        std::find_if(begin, responses.end(), [&](const auto& r) { return r.body != begin->body; });
    result.emplace_back(begin, end);
    begin = end;
  }
  return result;
}

std::vector<std::pair<LiquidMode, Vector6>> liquid_modes(Response response, const scene::Body& body,
                                                         const scene::Freedom& freedom, const Pose& pose,
                                                         double window) {
  // Early impulses may be zero: the load takes some steps to answer.
  constexpr std::size_t answered = 5;
  auto at = std::ranges::find_if(response, [window](const auto& r) { return r.time >= window; });
  at = std::max(std::min(at, response.end() - 1),
                response.begin() + static_cast<std::ptrdiff_t>(std::min(answered, response.size() - 1)));
  std::vector<std::pair<LiquidMode, Vector6>> result;
  for (const BodyMode& found : modes_of(at->impulse, body, freedom, pose)) {
    if (!(found.value > 0)) continue;
    LiquidMode& mode = result.emplace_back(LiquidMode{}, found.shape).first;
    for (const protocol::BodyResponse& point : response) {
      mode.time.push_back(point.time);
      mode.impulse.push_back(found.shape.dot(Eigen::Map<const Matrix6>(point.impulse.data()) * found.shape));
    }
  }
  return result;
}

Matrix6 passed_in(Response response, const scene::Body& body, const scene::Freedom& freedom, const Pose& pose,
                  double window) {
  Matrix6 sum = Matrix6::Zero();
  const Matrix6 mass = mass_matrix(body, pose);
  for (const auto& [mode, shape] : liquid_modes(response, body, freedom, pose, window)) {
    const Vector6 momentum = mass * shape;
    sum += std::max(0.0, mode.passed(window)) * momentum * momentum.transpose();
  }
  return sum;
}

}  // namespace tandem::launch
