#include "mbd_server/solve/linearisation.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {
namespace {

// Of each link in contact, the links that it touches, sorted.
using Neighbours = std::map<LinkIndex, std::vector<LinkIndex>>;

// The links of those groups that have more pairs than links; a group is what contacts connect.
Neighbours neighbours_in_large_groups(const std::vector<std::pair<LinkIndex, LinkIndex>>& pairs) {
  Neighbours all;
  for (const auto& [a, b] : pairs) all[a].push_back(b), all[b].push_back(a);
  std::map<LinkIndex, LinkIndex> group;   // a link of the same group that is visited first
  std::map<LinkIndex, std::size_t> ends;  // of pairs, twice their number (groups)
  std::map<LinkIndex, std::size_t> links;
  for (const auto& [first, unused] : all) {
    std::vector<LinkIndex> open{first};
    while (!open.empty()) {
      const LinkIndex link = open.back();
      open.pop_back();
      if (!group.emplace(link, first).second) continue;
      ++links[first];
      ends[first] += all.at(link).size();
      for (const LinkIndex other : all.at(link)) open.push_back(other);
    }
  }
  std::erase_if(all, [&](const auto& entry) {
    const LinkIndex of = group.at(entry.first);
    return ends.at(of) <= 2 * links.at(of);
  });
  for (auto& [link, others] : all) std::ranges::sort(others);
  return all;
}

}  // namespace

std::vector<std::size_t> order_in_matrix(const Model& model) {
  std::vector<std::size_t> order(model.forces.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t f) { return model.forces[f]->order().matrix; });
  return order;
}

Linearisation::Linearisation(const Model& model) {
  grounded_of.assign(model.links.size(), none);
  for (const Closure& c : model.closures) {
    connections.push_back({c.a, c.b, c.size(), false, c.is_coupler(), c.first});
    for (std::size_t k = 2; k < c.terms.size(); ++k) connections.back().more.push_back(c.terms[k].link);
  }
  ForceConnections add(*this);
  of_forces.resize(model.forces.size());
  for (const std::size_t f : order_in_matrix(model)) of_forces[f] = model.forces[f]->connect(model, add);
  for (const Closure& c : model.closures)
    stiffness_connection.push_back(
        c.has_geometric_stiffness() ? add.between(c.a, c.b, c.stiffness_is_torque() ? 3 : 6) : none);
  for (const ContactShape& shape : model.contact.shapes) add.between(0, shape.link, 6);
  for (const JointForce& f : model.joint_forces) {
    const bool elsewhere = f.over && f.over->link != f.link && f.link != 0;
    const bool moves = elsewhere && model.links[f.over->link].u != none && model.links[f.link].u != none;
    joint_force_connection.push_back(moves ? add.add({f.over->link, f.link, 1, true, true, none}) : none);
  }
  first_contact = static_cast<int>(connections.size());
  make_blocks(0);
}

void Linearisation::make_blocks(std::size_t first) {
  blocks.resize(connections.size());
  for (std::size_t k = first; k < blocks.size(); ++k) {
    blocks[k] = {Matrix6d::Zero(), Matrix6d::Zero(), Matrix6x18d::Zero(), Matrix6x18d::Zero(), {}, {}, {}};
    blocks[k].more.resize(connections[k].more.size());
  }
}

void Linearisation::set_contacts(const std::vector<std::pair<LinkIndex, LinkIndex>>& links,
                                 const std::vector<bool>& is_free) {
  connections.resize(static_cast<std::size_t>(first_contact));
  contact_places.clear();
  free_pairs.clear();
  std::vector<std::pair<LinkIndex, LinkIndex>> others;
  for (const auto& pair : links)
    if (!is_free[static_cast<std::size_t>(pair.first)]) others.push_back(pair);
  const Neighbours neighbours = neighbours_in_large_groups(others);
  std::map<LinkIndex, int> connection_of;
  for (const auto& [link, around] : neighbours) {
    connection_of[link] = static_cast<int>(connections.size());
    connections.push_back({link, around[0], 6, true, false, none, {around.begin() + 1, around.end()}, true});
  }
  const auto side = [&](LinkIndex of, LinkIndex other) {
    const auto& around = neighbours.at(of);
    return 1 + static_cast<int>(std::ranges::lower_bound(around, other) - around.begin());
  };
  for (const auto& [a, b] : links) {
    if (is_free[static_cast<std::size_t>(a)]) {
      contact_places.push_back({.free_pair = static_cast<int>(free_pairs.size())});
      free_pairs.emplace_back();
    } else if (neighbours.contains(a)) {
      contact_places.push_back(
          {none, connection_of.at(a), side(a, b), connection_of.at(b), side(b, a), none});
    } else {
      contact_places.push_back({.connection = static_cast<int>(connections.size())});
      connections.push_back({a, b, 6, true, false, none});
    }
  }
  make_blocks(static_cast<std::size_t>(first_contact));
}

}  // namespace tandem::mbd
