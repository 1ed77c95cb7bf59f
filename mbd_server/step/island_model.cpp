#include "mbd_server/step/island_model.hpp"

namespace tandem::mbd {

IslandModel island_model(const Model& whole, const std::vector<FreeBodies::Body>& free,
                         const std::vector<int>& bodies) {
  IslandModel island;
  Model& model = island.model;
  model.gravity = whole.gravity, model.origin = whole.origin, model.size = whole.size;
  model.gyroscopic = whole.gyroscopic, model.damped = whole.damped;
  model.scale.resize(6 * std::ssize(bodies));
  model.links.push_back(whole.links[0]);
  std::vector<LinkIndex> link_of(whole.links.size(), none);
  link_of[0] = 0;
  for (const int body : bodies) {
    const FreeBodies::Body& b = free[static_cast<std::size_t>(body)];
    model.scale.segment<6>(model.freedoms) = whole.scale.segment<6>(b.u);
    for (const LinkIndex i : {b.translation, b.rotation}) {
      Link& link = model.links.emplace_back(whole.links[i]);
      link_of[i] = static_cast<LinkIndex>(std::ssize(model.links) - 1);
      link.parent = link_of[link.parent];
      for (int k = 0; k < link.freedoms(); ++k)
        model.coordinate_names.push_back(whole.coordinate_names[link.u + k]);
      link.q = model.coordinates, link.u = model.freedoms;
      model.coordinates += coordinates(link.kind), model.freedoms += link.freedoms();
    }
  }
  std::vector<int> body_of(whole.bodies.size(), none);
  for (std::size_t b = 0; b < whole.bodies.size(); ++b) {
    const LinkIndex link = link_of[whole.bodies[b].link];
    if (link == none) continue;
    body_of[b] = static_cast<int>(std::ssize(model.bodies));
    model.bodies.push_back(whole.bodies[b]);
    model.bodies.back().link = link;
  }
  BodyContactModel& contact = model.contact;
  contact.impacts_within_steps = whole.contact.impacts_within_steps;
  contact.laws = whole.contact.laws, contact.materials = whole.contact.materials;
  for (std::size_t s = 0; s < whole.contact.shapes.size(); ++s) {
    const ContactShape& shape = whole.contact.shapes[s];
    if (link_of[shape.link] == none) continue;
    island.shapes.push_back(static_cast<int>(s));
    ContactShape& own = contact.shapes.emplace_back(shape);
    own.link = link_of[shape.link];
    if (shape.body != none) own.body = body_of[shape.body];
  }
  for (const auto& [a, b] : whole.contact.apart) {
    const int x = a == none ? none : body_of[a], y = b == none ? none : body_of[b];
    if ((a == none || x != none) && (b == none || y != none)) contact.apart.emplace_back(x, y);
  }
  return island;
}

}  // namespace tandem::mbd
