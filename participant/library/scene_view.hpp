// A configuration in the form of the C interface.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "participant/include/tandem/participant.h"
#include "protocol/messages.hpp"

namespace tandem::participant {

class SceneView {
 public:
  // Error{scene} as scene::parse(), and where spheres cannot be placed.
  SceneView(const protocol::Configuration& configuration, protocol::Role role);
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  const scene::Scene& scene() const { return scene_; }
  // Valid as long as this object.
  const tandem_configuration& configuration() const { return view_; }
  // Indices of the bodies with walls, ascending.
  const std::vector<std::uint32_t>& boundary() const { return boundary_; }
  bool ground_has_walls() const { return ground_has_walls_; }
  // Name of the first group with a sphere that rotates at the start; empty where there is none.
  const std::string& spinning_group() const { return spinning_group_; }
  // State at t = 0 as the scene gives it.
  protocol::BodyMotion start_of(std::uint32_t body) const;

 private:
  const char* kept(const std::string& text);
  void view_bodies();
  void view_grains(const std::vector<protocol::NamedMesh>& meshes);
  void view_liquid(const std::vector<protocol::NamedMesh>& meshes);
  void view_walls(const std::vector<scene::Wall>& walls, const std::vector<protocol::NamedMesh>& meshes);
  void set_domain(const std::optional<double>& micro_step, const scene::Box& domain);
  void view_spheres(const std::vector<protocol::NamedText>& files);

  scene::Scene scene_;
  tandem_configuration view_{};
  std::deque<std::string> texts_;
  std::deque<std::vector<double>> triangles_, boxes_;
  std::vector<tandem_body> bodies_;
  std::vector<tandem_material> materials_;
  std::vector<tandem_pair> pairs_;
  std::vector<tandem_wall> walls_;
  std::vector<tandem_liquid> liquids_;
  std::vector<std::uint32_t> boundary_, sphere_material_;
  std::vector<double> position_, velocity_, spin_, radius_;
  std::vector<const char*> element_columns_;
  bool ground_has_walls_ = false;
  std::string spinning_group_;
};

}  // namespace tandem::participant
