#include "protocol/start_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace tandem::protocol {
namespace {

using Rows = std::map<std::uint32_t, std::vector<double>>;

NamedText text_of_rows(std::string_view name, const Rows& rows) {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [body, values] : rows) all.push_back({body, values});
  return {std::string(name), all.dump()};
}

Rows start_rows(const std::vector<NamedText>& files, std::string_view name, std::size_t values) {
  Rows rows;
  const auto file = std::ranges::find(files, name, &NamedText::name);
  if (file == files.end()) return rows;
  try {
    for (const auto& [body, row] : nlohmann::json::parse(file->text)
                                       .get<std::vector<std::pair<std::uint32_t, std::vector<double>>>>()) {
      const auto is_finite = [](double x) { return std::isfinite(x); };
      if (row.size() != values || !std::ranges::all_of(row, is_finite)) throw std::runtime_error("a row");
      rows[body] = row;
    }
  } catch (const std::exception&) {
    throw Error(
        ErrorCode::protocol, "the text '" + std::string(name) + "' is damaged", "configure",
        "send one list for each body: its index, and a list of " + std::to_string(values) + " numbers");
  }
  return rows;
}

}  // namespace

NamedText text_of_start_loads(const std::map<std::uint32_t, Wrench>& loads) {
  Rows rows;
  for (const auto& [body, load] : loads) {
    const Vec3d &f = load.force, &t = load.torque;
    rows[body] = {f.x, f.y, f.z, t.x, t.y, t.z};
  }
  return text_of_rows(start_loads_file, rows);
}

NamedText text_of_start_poses(const std::vector<BodyMotion>& boundary) {
  Rows rows;
  for (const BodyMotion& body : boundary) {
    const auto& [p, q] = body.begin_pose;
    rows[body.body] = {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
  }
  return text_of_rows(start_poses_file, rows);
}

std::map<std::uint32_t, Wrench> start_loads(const std::vector<NamedText>& files) {
  std::map<std::uint32_t, Wrench> loads;
  for (const auto& [body, v] : start_rows(files, start_loads_file, 6))
    loads[body] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  return loads;
}

std::map<std::uint32_t, Pose> start_poses(const std::vector<NamedText>& files) {
  std::map<std::uint32_t, Pose> poses;
  for (const auto& [body, v] : start_rows(files, start_poses_file, 7))
    poses[body] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
  return poses;
}

}  // namespace tandem::protocol
